//! Where a figure goes while its clips play.

use bevy::animation::{ActiveAnimation, AnimatedBy};
use bevy::prelude::*;

use super::curve::LatentCurve;
use super::evaluator::PlayError;

/// What the steps of a grounded clip do: a walk made of a few sketches walks on, across loops, for as long as it plays.
///
/// Feet that are down stay where they are, so the figure moves over them. Each frame's step is taken in the figure's own
/// directions: turn the [`Transform`] and the walk goes where it faces; set its translation and it walks on from there.
/// When clips are blended, so are their steps. A seek changes the pose, not the place.
///
/// How high the body is, [`Grounded`](crate::Grounded) says as ever: its lowest point at y = 0, or, while a clip has it in flight,
/// above.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Debug, Default, PartialEq, Clone)]
pub enum RootMotion {
    /// The step moves the [`Transform`].
    #[default]
    MoveTransform,
    /// The step is told in [`ClipPlayback::step_m`] and nothing is moved: for a character controller, or to walk on the spot.
    Report,
}

/// How a figure's clips stand in this frame. Written by the plugin, in [`Stick3dSystems::Animate`](crate::Stick3dSystems::Animate).
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
pub struct ClipPlayback {
    /// The step of this frame, in the figure's own space, metres; y is 0.
    pub step_m: Vec3,
    /// How high the body's lowest point is above the ground, metres: 0 but in flight.
    pub lift_m: f32,
    /// What plays; from an earlier frame unless `played`.
    #[reflect(ignore)]
    shares: Vec<ClipShare>,
    /// Whether clips were evaluated since the last look.
    played: bool,
    #[reflect(ignore)]
    error: Option<PlayError>,
    /// Whether the figure's status tells of a clip.
    pub(super) told: bool,
}

/// The part of a clip in a blend.
#[derive(Clone, Debug)]
pub(super) struct ClipShare {
    pub(super) curve: LatentCurve,
    pub(super) node: AnimationNodeIndex,
    /// The shares of a blend add up to 1.
    pub(super) share: f32,
}

impl ClipPlayback {
    /// Why the clips could not move the figure; `None` while all is well.
    pub fn error(&self) -> Option<&PlayError> {
        self.error.as_ref()
    }

    /// Notes what was evaluated in this frame.
    pub(super) fn play(
        &mut self,
        shares: impl Iterator<Item = ClipShare>,
        error: Option<PlayError>,
    ) {
        self.shares.clear();
        self.shares.extend(shares);
        self.played = true;
        self.error = error;
    }
}

/// Takes the steps of the clips that were evaluated in this frame.
pub(super) fn move_figures(
    mut figures: Query<(
        &AnimatedBy,
        Option<&RootMotion>,
        &mut ClipPlayback,
        &mut Transform,
    )>,
    players: Query<(&AnimationPlayer, &AnimationGraphHandle)>,
    graphs: Res<Assets<AnimationGraph>>,
    clips: Res<Assets<AnimationClip>>,
    time: Res<Time>,
) {
    for (&AnimatedBy(player), root_motion, mut playback, mut transform) in &mut figures {
        let bypassed = playback.bypass_change_detection();
        let played = std::mem::take(&mut bypassed.played);
        if !played {
            bypassed.error = None;
        }
        let (mut step_m, mut lift_m) = (Vec3::ZERO, 0.0);
        if played && let Ok((player, graph)) = players.get(player) {
            let graph = graphs.get(graph);
            for ClipShare { curve, node, share } in &bypassed.shares {
                let Some(active) = player.animation(*node) else {
                    continue;
                };
                let clip = graph.and_then(|graph| clip_of(graph, *node, &clips));
                let duration_s = clip.map_or(curve.duration_s(), AnimationClip::duration);
                step_m += *share * step(curve, active, duration_s, time.delta_secs());
                lift_m += *share * curve.lift_m(active.seek_time());
            }
            // How high it is, the stream takes care of.
            step_m.y = 0.0;
        }
        if bypassed.step_m != step_m || bypassed.lift_m != lift_m {
            playback.step_m = step_m;
            playback.lift_m = lift_m;
        }
        let moves = root_motion.copied().unwrap_or_default() == RootMotion::MoveTransform;
        if moves && step_m != Vec3::ZERO {
            let step = transform.rotation * (transform.scale * step_m);
            transform.translation += step;
        }
    }
}

/// The clip of a node.
fn clip_of<'a>(
    graph: &AnimationGraph,
    node: AnimationNodeIndex,
    clips: &'a Assets<AnimationClip>,
) -> Option<&'a AnimationClip> {
    match &graph.get(node)?.node_type {
        AnimationNodeType::Clip(clip) => clips.get(clip),
        AnimationNodeType::Blend | AnimationNodeType::Add => None,
    }
}

/// How far a clip came in this frame, metres.
fn step(curve: &LatentCurve, active: &ActiveAnimation, duration_s: f32, delta_s: f32) -> Vec3 {
    let (Some(from_s), to_s) = (active.last_seek_time(), active.seek_time()) else {
        return Vec3::ZERO;
    };
    if active.is_paused() || from_s == to_s {
        return Vec3::ZERO;
    }
    let at = |clip_s: f32| curve.root_translation(clip_s);
    if !active.just_completed() || active.is_finished() {
        return at(to_s) - at(from_s);
    }
    // The clip started again, once or, after a long frame, several times: to its end, whole rounds, and from its start.
    let way_s = from_s + delta_s * active.speed() - to_s;
    let rounds = (way_s / duration_s).round();
    if !rounds.is_finite() {
        return Vec3::ZERO;
    }
    at(to_s) - at(from_s) + rounds * (at(duration_s) - at(0.0))
}
