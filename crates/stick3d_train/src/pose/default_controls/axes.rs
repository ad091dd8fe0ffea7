//! About which axes a bone turns: bend, side and twist, from how it stands at rest and how the clips move it.

use glam::{Quat, Vec3};

use super::anatomy::{Anatomy, Role};
use crate::pose::spec::Lateral;
use crate::rig::Rig;

/// A hinge that is bent at rest by this folds further that way, whatever the clips do, degrees.
const BENT_DEG: f32 = 15.0;

/// A bend at rest that is smaller than this says nothing about a hinge, degrees.
const SLIGHTLY_BENT_DEG: f32 = 2.0;

/// The least a bone turns in the clips for its axis to be read from there (root of the mean square), degrees.
const TURNING_DEG: f32 = 8.0;

/// Directions closer than this (cosine) are one line.
const ALONG: f32 = 0.9;

/// Of a limb's first bones, those that run across the body (cosine) and are shorter than this share of the next are
/// the girdle, not the limb.
const ACROSS: f32 = 0.7;
const GIRDLE_LENGTH: f32 = 0.75;

/// What a bone of the body does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Joint {
    /// Yaw, pitch and roll of the whole body.
    Root,
    /// One of several bones that curve together, or the only one.
    Curve,
    /// Clavicle, scapula, or a stump of the hips.
    Girdle,
    /// A limb's first bone: turns all ways.
    Ball {
        /// How far an arm is from hanging down, degrees; nothing for a leg.
        raised_deg: Option<f32>,
    },
    /// Knee or elbow: folds one way.
    Hinge {
        /// How far it is folded at rest, degrees.
        folded_deg: f32,
    },
    /// The end of a limb, and whatever else the clips move.
    End,
}

/// The axes of a bone at rest, the outermost turn first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    pub(super) joint: Joint,
    /// Axis and what it does, see [`Turning`].
    pub(super) turns: [(Turning, Vec3); 3],
}

/// What a turn does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turning {
    /// Folds a hinge, swings a limb forward, lifts a nose or a tail.
    Bend,
    /// To a side.
    Side,
    /// About the bone itself.
    Twist,
}

impl Turning {
    pub(super) fn name(self, joint: Joint) -> &'static str {
        match (self, joint) {
            (Self::Side, Joint::Root) => "yaw",
            (Self::Bend, Joint::Root) => "pitch",
            (Self::Twist, Joint::Root) => "roll",
            (Self::Bend, _) => "bend",
            (Self::Side, _) => "side",
            (Self::Twist, _) => "twist",
        }
    }
}

/// Toward the figure's left, and the way it faces.
pub(super) fn left_and_forward(lateral: Lateral) -> (Vec3, Vec3) {
    (lateral.facing(Vec3::X), lateral.facing(Vec3::Z))
}

/// The axes of `bone`.
pub(super) fn axes(rig: &Rig, anatomy: &Anatomy, bone: usize) -> Axes {
    let (left, forward) = left_and_forward(anatomy.lateral);
    let joint = joint(rig, anatomy, bone);
    if joint == Joint::Root {
        let turns = [
            (Turning::Side, Vec3::Y),
            (Turning::Bend, -left),
            (Turning::Twist, forward),
        ];
        return Axes { joint, turns };
    }
    let mut along = direction(rig, anatomy, bone);
    if anatomy.mirror[bone] == Some(bone) {
        // Exactly in the middle, so that values for one side are values for the other.
        along = along.reject_from(left).try_normalize().unwrap_or(Vec3::Y);
    }
    let bend = match (anatomy.roles[bone], joint) {
        // What is straight and never moves folds as knees and elbows of people do.
        (Some(Role::Limb(limb)), Joint::Hinge { .. } | Joint::End) => {
            fold(rig, anatomy, bone, BENT_DEG)
                .or_else(|| clip_axis(rig, bone))
                .or_else(|| fold(rig, anatomy, bone, SLIGHTLY_BENT_DEG))
                .unwrap_or(if anatomy.is_leg[limb] { left } else { -left })
        }
        (Some(Role::Limb(_)), _) if along.dot(left).abs() < ALONG => -left,
        // An arm that is held out swings forward.
        (Some(Role::Limb(_)), _) => along.cross(forward),
        _ => -left,
    };
    let bend = bend.reject_from_normalized(along);
    let bend = bend
        .try_normalize()
        .unwrap_or_else(|| along.any_orthonormal_vector());
    // An arm or a leg of the left goes up or out.
    let side = bend.cross(along);
    let mut turns = [
        (Turning::Bend, bend),
        (Turning::Side, side),
        (Turning::Twist, along),
    ];
    // The middle one of three angles must stay clear of 90 degrees; arms are raised and lowered by more.
    if let Joint::Ball {
        raised_deg: Some(_),
    } = joint
    {
        turns.swap(0, 1);
    }
    Axes { joint, turns }
}

/// Where a bone points: to the bone that it goes on in, else to the middle of what follows it.
fn direction(rig: &Rig, anatomy: &Anatomy, bone: usize) -> Vec3 {
    let head = rig.skeleton.bones[bone].head;
    let toward_heir = anatomy
        .heir(rig, bone)
        .and_then(|child| (rig.skeleton.bones[child].head - head).try_normalize());
    let above = rig.skeleton.bones[bone].parent;
    let from_above = || above.and_then(|up| (head - rig.skeleton.bones[up].head).try_normalize());
    toward_heir
        .or_else(|| middle_of_flesh(rig, bone).and_then(|at| (at - head).try_normalize()))
        .or_else(from_above)
        .unwrap_or(Vec3::Y)
}

fn middle_of_flesh(rig: &Rig, bone: usize) -> Option<Vec3> {
    let mut sum = (Vec3::ZERO, 0.0_f32);
    for (list, position) in rig.influences.iter().zip(&rig.mesh.positions) {
        for &(_, weight) in list.iter().filter(|(b, _)| usize::from(*b) == bone) {
            sum = (sum.0 + weight * *position, sum.1 + weight);
        }
    }
    (sum.1 > 0.0).then(|| sum.0 / sum.1)
}

/// The bones of a limb from its root to `bone`.
fn limb_above(rig: &Rig, anatomy: &Anatomy, bone: usize) -> Vec<usize> {
    let above = std::iter::successors(Some(bone), |&at| rig.skeleton.bones[at].parent);
    let mut line: Vec<usize> = above
        .take_while(|&at| anatomy.roles[at] == anatomy.roles[bone])
        .collect();
    line.reverse();
    line
}

fn length(rig: &Rig, anatomy: &Anatomy, bone: usize) -> f32 {
    let heir = anatomy.heir(rig, bone);
    heir.map_or(0.0, |child| {
        rig.skeleton.bones[child]
            .head
            .distance(rig.skeleton.bones[bone].head)
    })
}

fn joint(rig: &Rig, anatomy: &Anatomy, bone: usize) -> Joint {
    match anatomy.roles[bone] {
        Some(Role::Root) => Joint::Root,
        Some(Role::Trunk | Role::Free(_)) => Joint::Curve,
        Some(Role::Limb(limb)) => {
            let (left, _) = left_and_forward(anatomy.lateral);
            let line = limb_above(rig, anatomy, bone);
            let is_girdle = |&at: &usize| {
                let next = anatomy
                    .heir(rig, at)
                    .map_or(0.0, |next| length(rig, anatomy, next));
                direction(rig, anatomy, at).dot(left).abs() > ACROSS
                    && length(rig, anatomy, at) < GIRDLE_LENGTH * next
            };
            let girdle = line.iter().take_while(|at| is_girdle(at)).count();
            let goes_on = anatomy
                .heir(rig, bone)
                .is_some_and(|child| anatomy.roles[child] == anatomy.roles[bone]);
            match line.len() {
                depth if depth <= girdle => Joint::Girdle,
                depth if depth == girdle + 1 => Joint::Ball {
                    raised_deg: (!anatomy.is_leg[limb])
                        .then(|| raised_deg(direction(rig, anatomy, bone))),
                },
                _ if goes_on => Joint::Hinge {
                    folded_deg: folded_deg(rig, anatomy, bone),
                },
                _ => Joint::End,
            }
        }
        _ => Joint::End,
    }
}

fn raised_deg(direction: Vec3) -> f32 {
    direction.angle_between(Vec3::NEG_Y).to_degrees()
}

/// The direction of the bone above and that of the bone itself.
fn above_and_own(rig: &Rig, anatomy: &Anatomy, bone: usize) -> Option<(Vec3, Vec3)> {
    let parent = rig.skeleton.bones[bone].parent?;
    let above = rig.skeleton.bones[bone].head - rig.skeleton.bones[parent].head;
    Some((above.try_normalize()?, direction(rig, anatomy, bone)))
}

fn folded_deg(rig: &Rig, anatomy: &Anatomy, bone: usize) -> f32 {
    above_and_own(rig, anatomy, bone)
        .map_or(0.0, |(above, own)| above.angle_between(own).to_degrees())
}

/// The axis about which a bone that is bent at rest by at least so much folds further.
fn fold(rig: &Rig, anatomy: &Anatomy, bone: usize, least_deg: f32) -> Option<Vec3> {
    let (above, own) = above_and_own(rig, anatomy, bone)?;
    (above.angle_between(own).to_degrees() > least_deg)
        .then(|| above.cross(own).try_normalize())
        .flatten()
}

/// The axis about which the clips turn a bone most, toward where they turn it more.
fn clip_axis(rig: &Rig, bone: usize) -> Option<Vec3> {
    let turns: Vec<Vec3> = rig
        .clips
        .iter()
        .flat_map(|clip| &clip.poses)
        .filter_map(|pose| pose.rotations.get(bone))
        .map(|turn| short(*turn).to_scaled_axis())
        .collect();
    let mut covariance = nalgebra::Matrix3::<f32>::zeros();
    for turn in &turns {
        let v = nalgebra::Vector3::from(turn.to_array());
        covariance += v * v.transpose() / turns.len() as f32;
    }
    if covariance.trace().sqrt().to_degrees() < TURNING_DEG {
        return None;
    }
    let eigen = covariance.symmetric_eigen();
    let axis = eigen
        .eigenvectors
        .column(eigen.eigenvalues.imax())
        .into_owned();
    let axis = Vec3::new(axis[0], axis[1], axis[2]);
    let mean: Vec3 = turns.iter().sum();
    (axis * if mean.dot(axis) < 0.0 { -1.0 } else { 1.0 }).try_normalize()
}

fn short(turn: Quat) -> Quat {
    if turn.w < 0.0 { -turn } else { turn }
}
