//! Limbs that are only begun: a straight line from the trunk may be a whole limb or its first bones, until more is drawn.

use glam::Vec2;

use crate::figure::{Figure, Limb};
use crate::stroke::Stroke;

/// A joint at which a line bends by this much is drawn, radians.
const BEND_RAD: f32 = 0.4;
/// A stroke that ends nearer to a joint than this part of the shorter bone ends there.
const AT_JOINT: f32 = 0.3;
/// Figures are drawn no smaller than this part of their usual size while their size is not known better.
const LEAST_SIZE: f32 = 0.5;

/// Takes limbs that are too short to be whole for their first bones: the joints beyond are drawn no more. Says whether
/// there were any.
///
/// A joint in mid-limb is where it was put when strokes end there or the line bends; otherwise it was only put where the
/// template has it, and what was read as the rest of the limb is as many bones as its length fits best, beside the bones
/// that are sure.
pub(super) fn shorten(
    figure: &Figure,
    strokes: &[Stroke],
    usual_scale: f32,
    placed: &mut [Option<Vec2>],
) -> bool {
    let tails: Vec<Tail> = figure
        .limbs()
        .iter()
        .filter_map(|limb| Tail::of(limb, strokes, placed))
        .collect();
    let scale = scale(figure, &tails, placed).max(LEAST_SIZE * usual_scale);
    let mut is_shorter = false;
    for tail in &tails {
        is_shorter |= tail.shorten(figure, scale, placed);
    }
    is_shorter
}

/// The last bones of a limb, drawn as one line that does not say where they meet.
struct Tail {
    /// From the last sure joint outwards.
    joints: Vec<usize>,
    from: Vec2,
    to: Vec2,
}

impl Tail {
    /// None when every joint of the limb shows, or the limb is not whole.
    fn of(limb: &Limb, strokes: &[Stroke], placed: &[Option<Vec2>]) -> Option<Self> {
        let joints: Vec<usize> = std::iter::once(limb.base)
            .chain(limb.joints.iter().copied())
            .collect();
        let points: Option<Vec<Vec2>> = joints.iter().map(|&joint| placed[joint]).collect();
        let points = points?;
        let inner = 1..joints.len().saturating_sub(1);
        let last_sure = inner.rev().find(|&at| {
            let [before, here, after] = [points[at - 1], points[at], points[at + 1]];
            let (one, two) = (here - before, after - here);
            let near = AT_JOINT * one.length().min(two.length());
            one.angle_to(two).abs() > BEND_RAD || ends_near(strokes, here, near)
        });
        let start = last_sure.unwrap_or(0);
        (start + 2 < joints.len()).then(|| Self {
            joints: joints[start..].to_vec(),
            from: points[start],
            to: points[points.len() - 1],
        })
    }

    /// Lengths of the bones in the template.
    fn template<'a>(&'a self, figure: &'a Figure) -> impl Iterator<Item = f32> + 'a {
        self.joints
            .windows(2)
            .map(|bone| figure.template[bone[0]].distance(figure.template[bone[1]]))
    }

    fn shorten(&self, figure: &Figure, scale: f32, placed: &mut [Option<Vec2>]) -> bool {
        let length = self.from.distance(self.to);
        let lengths: Vec<f32> = self.template(figure).collect();
        let misfit = |bones: usize| {
            let whole: f32 = lengths[..bones].iter().sum();
            (length / (scale * whole)).max(1.0e-3).ln().abs()
        };
        let bones = (1..=lengths.len())
            .min_by(|a, b| misfit(*a).total_cmp(&misfit(*b)))
            .unwrap_or(lengths.len());
        if bones == lengths.len() {
            return false;
        }
        let whole: f32 = lengths[..bones].iter().sum();
        let mut along = 0.0;
        for (bone, &joint) in self.joints[1..].iter().enumerate() {
            along += lengths[bone];
            placed[joint] = (bone < bones).then(|| self.from.lerp(self.to, along / whole));
        }
        true
    }
}

fn ends_near(strokes: &[Stroke], at: Vec2, near: f32) -> bool {
    let mut ends = strokes.iter().flat_map(|stroke| {
        let points = stroke.points();
        [points.first(), points.last()]
    });
    ends.any(|end| end.is_some_and(|end| end.position_px.distance(at) < near))
}

/// How large the bones are drawn that are sure, compared with the template.
fn scale(figure: &Figure, tails: &[Tail], placed: &[Option<Vec2>]) -> f32 {
    let is_sure = |bone: &&[usize; 2]| {
        let mut tails = tails.iter();
        !tails.any(|tail| bone.iter().all(|joint| tail.joints.contains(joint)))
    };
    let (drawn, template) = figure
        .bones
        .iter()
        .enumerate()
        .filter(|(_, joints)| is_sure(joints))
        .filter_map(|(bone, &[a, b])| {
            let drawn = placed[a]?.distance(placed[b]?);
            Some((drawn, figure.template_bone_length(bone)))
        })
        .fold((0.0, 0.0), |sum, bone| (sum.0 + bone.0, sum.1 + bone.1));
    if template > 0.0 {
        drawn / template
    } else {
        0.0
    }
}
