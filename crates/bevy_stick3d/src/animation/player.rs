//! Figures that play: the one-line way, and what every figure with a player needs.

use bevy::animation::{AnimatedBy, AnimationTargetId};
use bevy::prelude::*;

use super::clip_asset::StickClip;
use super::clips::StickClips;
use super::curve::STICK_TARGET;
use super::root_motion::ClipPlayback;
use crate::figure::{FigureStatus, Latent, StickFigure};
use crate::model_asset::StickModel;
use crate::status::Stick3dStatus;
use crate::stream::StreamedBody;

/// Plays a clip on a [`StickFigure`], as often as its author meant it, from when clip and model are loaded.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_stick3d::prelude::*;
/// fn setup(mut commands: Commands, assets: Res<AssetServer>) {
///     let walk = assets.load("clips/walk.clip.ron");
///     commands.spawn((StickFigure::human(), PlayStickClip(walk)));
/// }
/// ```
///
/// The figure's `AnimationPlayer` is yours to pause, seek and speed up; its graph is the plugin's. Another handle starts another
/// clip at once; to blend clips, or to go over from one to the other, make a graph of your own with
/// [`StickClips::animation`], and leave this component out. Taking the component away stops the clip, and the figure keeps its pose.
///
/// While a clip plays it writes the figure's [`Latent`] in every frame.
#[derive(Component, Clone, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
#[require(AnimationPlayer, ClipPlayback, StartedClip)]
pub struct PlayStickClip(pub Handle<StickClip>);

/// What [`PlayStickClip`] has started. Written by the plugin.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
pub struct StartedClip {
    started: Option<Started>,
}

#[derive(Clone, Copy, Debug, Reflect)]
struct Started {
    clip: AssetId<StickClip>,
    model: AssetId<StickModel>,
    /// Which build of the clip.
    version: u64,
    node: AnimationNodeIndex,
}

impl StartedClip {
    /// The clip's node in the figure's graph, once it plays.
    pub fn node(&self) -> Option<AnimationNodeIndex> {
        self.started.map(|started| started.node)
    }
}

/// Figures with a player of their own are its targets, and all that are targets are told how it stands.
pub(super) fn link_players(
    mut commands: Commands,
    players: Query<
        Entity,
        (
            With<StickFigure>,
            With<AnimationPlayer>,
            Or<(Without<AnimationTargetId>, Without<AnimatedBy>)>,
        ),
    >,
    targets: Query<Entity, (With<StickFigure>, With<AnimatedBy>, Without<ClipPlayback>)>,
) {
    for figure in &players {
        commands.entity(figure).insert_if_new((
            STICK_TARGET,
            AnimatedBy(figure),
            ClipPlayback::default(),
        ));
    }
    for figure in &targets {
        commands.entity(figure).insert(ClipPlayback::default());
    }
}

/// The clips of figures that play one are in use.
pub(super) fn request_clips(
    figures: Query<(&PlayStickClip, &StickFigure)>,
    mut clips: ResMut<StickClips>,
    animations: Res<Assets<AnimationClip>>,
) {
    for (play, figure) in &figures {
        clips.entry(&play.0, &figure.0, &animations);
    }
}

/// Starts clips that were built, and stops those that are no longer asked for.
pub(super) fn start_clips(
    mut commands: Commands,
    mut figures: Query<(
        Entity,
        &PlayStickClip,
        &StickFigure,
        &mut StartedClip,
        &mut AnimationPlayer,
        &mut Latent,
    )>,
    mut clips: ResMut<StickClips>,
    animations: Res<Assets<AnimationClip>>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
) {
    for (entity, play, figure, mut started, mut player, mut latent) in &mut figures {
        let entry = clips.entry(&play.0, &figure.0, &animations);
        let Some((curve, version)) = entry.curve() else {
            // What is left of another model's clip would be no body of this one.
            let foreign = started
                .started
                .filter(|before| before.model != figure.0.id());
            if let Some(before) = foreign {
                player.stop(before.node);
                started.started = None;
            }
            continue;
        };
        let repeat = curve.repeat_animation();
        let same = started
            .started
            .filter(|started| (started.clip, started.model) == (play.0.id(), figure.0.id()));
        if let Some(same) = same {
            if same.version != version {
                // Built anew: it goes on where it is.
                if let Some(active) = player.animation_mut(same.node) {
                    active.set_repeat(repeat);
                }
                started.started = Some(Started { version, ..same });
            }
            continue;
        }
        if let Ok(first) = curve.latent(0.0) {
            // In its first pose at once: Bevy plays from the next frame.
            latent.0 = first;
        }
        let (graph, node) = entry.graph(&mut graphs);
        if let Some(before) = started.started {
            player.stop(before.node);
        }
        player.start(node).set_repeat(repeat);
        commands.entity(entity).insert(AnimationGraphHandle(graph));
        started.started = Some(Started {
            clip: play.0.id(),
            model: figure.0.id(),
            version,
            node,
        });
    }
}

/// Figures that no longer have a clip to play keep their pose.
pub(super) fn stop_clips(
    mut removed: RemovedComponents<PlayStickClip>,
    mut figures: Query<(&mut StartedClip, &mut AnimationPlayer), Without<PlayStickClip>>,
) {
    for entity in removed.read() {
        if let Ok((mut started, mut player)) = figures.get_mut(entity)
            && let Some(before) = started.started.take()
        {
            player.stop(before.node);
        }
    }
}

/// Figures whose clips cannot move them say so, and say so no longer when they can; those whose clip is not there yet wait.
pub(super) fn tell_status(
    mut figures: Query<(
        &StickFigure,
        Option<(&PlayStickClip, &StartedClip)>,
        &StreamedBody,
        &mut ClipPlayback,
        &mut FigureStatus,
    )>,
    clips: Res<StickClips>,
    assets: Res<Stick3dStatus>,
) {
    for (figure, play, body, mut playback, mut status) in &mut figures {
        let of_clip = || {
            let clip = &play?.0.0;
            let unbuilt = clips.curve(clip, &figure.0).is_none();
            // A file that failed before anybody asked for it is known to the status alone.
            let of_file = || assets.problem(clip).filter(|_| unbuilt);
            clips.problem(clip, &figure.0).or_else(of_file)
        };
        let of_playback = || playback.error().map(ToString::to_string);
        let problem = of_clip().map(str::to_owned).or_else(of_playback);
        let told = &mut playback.bypass_change_detection().told;
        if let Some(problem) = problem {
            status.set_if_neq(FigureStatus::Failed(problem));
            *told = true;
            continue;
        }
        let recovers = std::mem::take(told) && !body.has_failed();
        if recovers && status.problem().is_some() {
            *status = FigureStatus::Ready;
        }
        let waits = play.is_some_and(|(_, started)| started.started.is_none());
        if waits && *status == FigureStatus::Ready {
            *status = FigureStatus::Waiting;
        }
    }
}
