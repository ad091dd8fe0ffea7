//! When everything runs: the system sets, ordered here and nowhere else.

use bevy::app::AnimationSystems;
use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::prelude::*;

/// The stages of the plugin, each a set to run your systems before or after.
///
/// [`Stick3dSystems::Input`] runs in [`PreUpdate`], so that whatever a game does in [`Update`] sees
/// the sketch of this frame. The others run in [`PostUpdate`], one after the other, after Bevy's
/// animation and before mesh assets are handed to the renderer: a sketch or latent that changes
/// anywhere in `Update` is on screen in the same frame.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stick3dSystems {
    /// Pointer input becomes strokes, strokes become a [`StickSketch`](crate::StickSketch). (`PreUpdate`)
    Input,
    /// Clips that play, which Bevy's animation has evaluated, move their figures over the ground. (`PostUpdate`)
    Animate,
    /// Drawings that code changed are told, and their sketches put on the figures. (`PostUpdate`)
    Tell,
    /// Loaded, changed and removed models are made ready to run. (`PostUpdate`)
    Models,
    /// A changed [`StickSketch`](crate::StickSketch) becomes a [`Latent`](crate::Latent), and
    /// [other bodies](crate::SketchAlternatives) of it are chosen. (`PostUpdate`)
    Encode,
    /// Clips whose model is ready become animations, and start. (`PostUpdate`)
    Clips,
    /// A changed [`Latent`](crate::Latent) becomes the vertices of the entity's mesh. (`PostUpdate`)
    Decode,
    /// Bodies that were given no material get the default one. (`PostUpdate`)
    Dress,
}

/// Orders [`Stick3dSystems`].
#[derive(Debug, Default, Clone, Copy)]
pub struct Stick3dSchedulePlugin;

impl Plugin for Stick3dSchedulePlugin {
    fn build(&self, app: &mut App) {
        app.configure_sets(
            PreUpdate,
            Stick3dSystems::Input.after(bevy::input::InputSystems),
        )
        .configure_sets(
            PostUpdate,
            (
                Stick3dSystems::Animate,
                Stick3dSystems::Tell,
                Stick3dSystems::Models,
                Stick3dSystems::Encode,
                Stick3dSystems::Clips,
                Stick3dSystems::Decode,
                Stick3dSystems::Dress,
            )
                .chain()
                .after(AnimationSystems)
                .before(AssetEventSystems)
                .before(TransformSystems::Propagate)
                .before(VisibilitySystems::VisibilityPropagate)
                .before(VisibilitySystems::CalculateBounds),
        );
    }
}
