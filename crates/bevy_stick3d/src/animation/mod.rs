//! Clips: sketched motions as Bevy animations.
//!
//! A clip is a Bevy [`AnimationClip`] whose curve animates the figure's [`Latent`](crate::Latent), so `AnimationPlayer`,
//! `AnimationGraph`, `AnimationTransitions`, speed, repetition, seeking and events work as they do for any other animation.
//!
//! | you have | you want | take |
//! | --- | --- | --- |
//! | a `.clip.ron` file | a figure that plays it | [`PlayStickClip`] |
//! | sketches or latents | a clip | [`StickClip::builder`], add it to `Assets<StickClip>` |
//! | clips | to blend them, go over from one to the other, mix them with other animations | [`StickClips::animation`], and an `AnimationGraph` of your own |
//! | a [`Motion`](stick3d_model::Motion) | an animation clip | [`LatentCurve::new`], [`LatentCurve::into_clip`] |
//! | a curve of your own through latents | an animation clip | [`LatentProperty`] |
//!
//! # Where it stands
//! A grounded clip moves its figure over the ground as its feet push it: [`RootMotion`].
//!
//! # What it costs
//! A frame of a playing figure samples the curve, decodes and writes the mesh; it allocates nothing. A figure whose clips are
//! paused, or at rest, is not decoded. A playing figure that no camera saw in the last frame is not decoded either; see
//! [`DecodeOutOfSight`].
//!
//! # When something is wrong
//! A clip that cannot be loaded or built leaves the figure as it is: [`FigureStatus`](crate::FigureStatus),
//! [`Stick3dStatus`] and [`StickClips::problem`] say why.

mod clip_asset;
mod clips;
mod curve;
mod evaluator;
mod player;
mod property;
mod root_motion;

use bevy::animation::AnimationPlugin;
use bevy::app::AnimationSystems;
use bevy::prelude::*;

pub use clip_asset::{
    BuildClipError, StickClip, StickClipBuilder, StickClipLoader, StickClipLoaderError,
};
pub use clips::StickClips;
pub use curve::{LatentCurve, STICK_TARGET};
pub use evaluator::{LatentCurveEvaluator, PlayError};
pub use player::{PlayStickClip, StartedClip};
pub use property::LatentProperty;
pub use root_motion::{ClipPlayback, RootMotion};

use crate::inference::StickInference;
use crate::schedule::Stick3dSystems;
use crate::status::Stick3dStatus;

/// Decodes a playing figure in every frame, also while no camera sees it: for code that reads its mesh.
///
/// Without it a figure with an `AnimationPlayer` that no view saw in the last frame keeps the mesh that it had, and is decoded
/// when it comes into sight. Its `Aabb` is large enough meanwhile for any pose.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
pub struct DecodeOutOfSight;

/// Clips: assets, animations, players, and root motion.
///
/// Adds Bevy's `AnimationPlugin` where it is missing.
#[derive(Debug, Default, Clone, Copy)]
pub struct Stick3dAnimationPlugin;

impl Plugin for Stick3dAnimationPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<AnimationPlugin>() {
            app.add_plugins(AnimationPlugin);
        }
        app.init_asset::<StickClip>()
            .init_asset_loader::<StickClipLoader>()
            .init_resource::<StickClips>()
            .init_resource::<StickInference>()
            .init_resource::<Stick3dStatus>()
            .register_type::<StickClip>()
            .register_type::<PlayStickClip>()
            .register_type::<StartedClip>()
            .register_type::<RootMotion>()
            .register_type::<ClipPlayback>()
            .register_type::<DecodeOutOfSight>()
            .add_systems(
                PostUpdate,
                (
                    player::link_players.before(AnimationSystems),
                    root_motion::move_figures.in_set(Stick3dSystems::Animate),
                    (
                        clips::note_changed_clips,
                        player::request_clips,
                        clips::build_clips,
                        player::stop_clips,
                        player::start_clips,
                        player::tell_status,
                    )
                        .chain()
                        .in_set(Stick3dSystems::Clips),
                ),
            );
    }
}
