//! Bones that clips move by themselves, hung where they belong.
//!
//! A [`Pose`](super::Pose) turns bones; only the roots move freely. Files for games often let a bone slide:
//! the hips under a root that stays on the floor, or feet that were pinned to targets outside the legs. A
//! foot that slides yet never leaves the end of its leg is carried by the leg.

use glam::{Quat, Vec3};

use super::clips::Motion;
use super::joints::{Joints, extent};
use super::report::RigReport;

/// A bone slides if its head leaves its place in its parent by more than this share of the skeleton's extent
/// (root of the mean square over the clips).
const SLIDES: f32 = 0.01;

/// Another bone carries it if it slides there by less than this share of what it slides where it hangs.
const CARRIES: f32 = 0.3;

/// A bone that carries at least this share of the surface is the trunk: when it slides, it is a root.
const TRUNK: f32 = 0.5;

/// Hangs sliding bones elsewhere, judged by the clips; `weights` is how much surface follows each joint.
pub(super) fn hang_sliding_bones(
    joints: &mut Joints,
    weights: &[f32],
    motions: &[Motion],
    report: &mut RigReport,
) {
    let heads = joints.heads();
    let extent = extent(&heads);
    let limit = SLIDES * extent;
    let total: f32 = weights.iter().sum();
    let slides = |joints: &Joints, joint: usize| match joints.parents[joint] {
        Some(parent) => slide(&heads, motions, joint, parent),
        None => slide_from_leader(&heads, motions, joint, leader(joints, weights)),
    };
    let (mut roots, mut hung) = (Vec::new(), Vec::new());
    for joint in 0..joints.nodes.len() {
        let carried = subtree_weight(joints, weights, joint);
        let hangs = joints.parents[joint].is_some();
        if hangs && carried >= TRUNK * total && slides(joints, joint) > limit {
            joints.parents[joint] = None;
            roots.push(joints.name(joint).to_owned());
        }
    }
    let mut worst: Option<(f32, usize)> = None;
    for joint in 0..joints.nodes.len() {
        let sliding = slides(joints, joint);
        if sliding <= limit || subtree_weight(joints, weights, joint) <= 0.0 {
            continue;
        }
        let carriers = (0..joints.nodes.len())
            .filter(|&other| weights[other] > 0.0 && !is_below(joints, other, joint));
        let best = carriers
            .map(|other| (slide(&heads, motions, joint, other), other))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some((left, carrier)) if left < CARRIES * sliding => {
                joints.parents[joint] = Some(carrier);
                hung.push(format!(
                    "`{}` on `{}`",
                    joints.name(joint),
                    joints.name(carrier)
                ));
                if left > limit && worst.is_none_or(|(most, _)| left > most) {
                    worst = Some((left, joint));
                }
            }
            _ if worst.is_none_or(|(most, _)| sliding > most) => worst = Some((sliding, joint)),
            _ => {}
        }
    }
    if !roots.is_empty() {
        report.notes.push(format!(
            "the clips move the body against the bone above it; a root of its own is now: `{}`",
            roots.join("`, `")
        ));
    }
    if !hung.is_empty() {
        report.notes.push(format!(
            "the clips move bones that nothing carries; hung where they stay in place: {}",
            hung.join(", ")
        ));
    }
    if let Some((slide, joint)) = worst {
        report.notes.push(format!(
            "the clips slide bones by themselves (`{}` by {:.1} cm), which poses cannot; only turns are kept",
            joints.name(joint),
            100.0 * slide
        ));
    }
}

/// How far a joint leaves its place in `carrier`'s frame, root of the mean square over all frames, metres.
fn slide(heads: &[Vec3], motions: &[Motion], joint: usize, carrier: usize) -> f32 {
    let rest = heads[joint] - heads[carrier];
    root_mean_square(motions, |joints| {
        let (turn, head) = joints[carrier];
        turn.inverse() * (joints[joint].1 - head) - rest
    })
}

/// The root that carries most: the others move along with it ([`Pose::root_translation`](super::Pose)).
fn leader(joints: &Joints, weights: &[f32]) -> usize {
    let roots = (0..weights.len()).filter(|&joint| joints.parents[joint].is_none());
    let carries = |joint: usize| subtree_weight(joints, weights, joint);
    roots
        .rev()
        .max_by(|&a, &b| carries(a).total_cmp(&carries(b)))
        .unwrap_or(0)
}

/// As [`slide`], for a root: how far it strays from where the leading root's way takes it.
fn slide_from_leader(heads: &[Vec3], motions: &[Motion], joint: usize, leader: usize) -> f32 {
    let rest = heads[joint] - heads[leader];
    root_mean_square(motions, |joints| joints[joint].1 - joints[leader].1 - rest)
}

fn root_mean_square(motions: &[Motion], miss: impl Fn(&[(Quat, Vec3)]) -> Vec3) -> f32 {
    let frames = || motions.iter().flat_map(|motion| &motion.frames);
    let sum: f64 = frames()
        .map(|frame| f64::from(miss(&frame.joints).length_squared()))
        .sum();
    (sum / frames().count().max(1) as f64).sqrt() as f32
}

fn is_below(joints: &Joints, joint: usize, ancestor: usize) -> bool {
    std::iter::successors(Some(joint), |&at| joints.parents[at]).any(|at| at == ancestor)
}

/// How much of the surface follows a joint and what hangs on it.
fn subtree_weight(joints: &Joints, weights: &[f32], joint: usize) -> f32 {
    (0..weights.len())
        .filter(|&other| weights[other] > 0.0 && is_below(joints, other, joint))
        .map(|other| weights[other])
        .sum()
}
