//! How near bodies are to each other, and drawings: pure arithmetic.

use bevy::math::Vec2;
use stick3d_figure::figure::Limb;
use stick3d_model::Alternative;

/// A drawing whose joints move less than this on average is the same, changed: a share of how far they are from their middle.
const SAME_DRAWING: f32 = 0.15;

/// Whether a drawing is another one with a few joints moved. Where it is and how large does not matter.
pub(super) fn is_same_drawing(before: &[Vec2], after: &[Vec2]) -> bool {
    if before.len() != after.len() || before.is_empty() {
        return false;
    }
    let (old, new) = (Frame::of(before), Frame::of(after));
    let pairs = before.iter().zip(after);
    let moved: f32 = pairs
        .map(|(a, b)| old.place(*a).distance(new.place(*b)))
        .sum();
    moved / (before.len() as f32) < SAME_DRAWING
}

/// Where a drawing is, and how large.
struct Frame {
    middle: Vec2,
    radius: f32,
}

impl Frame {
    fn of(points: &[Vec2]) -> Self {
        let count = points.len() as f32;
        let middle = points.iter().sum::<Vec2>() / count;
        let squares: f32 = points.iter().map(|p| p.distance_squared(middle)).sum();
        Self {
            middle,
            radius: (squares / count).sqrt().max(f32::MIN_POSITIVE),
        }
    }

    fn place(&self, point: Vec2) -> Vec2 {
        (point - self.middle) / self.radius
    }
}

/// The index of the body nearest to another, of those that will do.
pub(super) fn nearest(
    bodies: &[Alternative],
    to: &Alternative,
    will_do: impl Fn(&Alternative) -> bool,
) -> Option<usize> {
    let candidates = bodies.iter().enumerate().filter(|(_, body)| will_do(body));
    candidates
        .map(|(index, body)| (index, body.distance_m(to)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(index, _)| index)
}

/// Where the joints are when the depth of a limb is turned round.
pub(super) fn turned(body: &Alternative, limb: &Limb) -> Alternative {
    let mut turned = body.clone();
    let base_m = body.joints[limb.base].z;
    for &joint in &limb.joints {
        let depth_m = &mut turned.joints[joint].z;
        *depth_m = 2.0 * base_m - *depth_m;
    }
    turned
}

/// Whether a limb points toward the viewer in one body and away in the other.
pub(super) fn is_flipped(body: &Alternative, other: &Alternative, limb: &Limb) -> bool {
    body.toward_viewer_m(limb) * other.toward_viewer_m(limb) < 0.0
}

/// How far the joint that is farthest from where it was is, of those that are not of the limb, metres.
pub(super) fn farthest_elsewhere_m(body: &Alternative, other: &Alternative, limb: &Limb) -> f32 {
    let joints = 0..body.joints.len().min(other.joints.len());
    joints
        .filter(|joint| !limb.joints.contains(joint))
        .map(|joint| body.joints[joint].distance(other.joints[joint]))
        .fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;
    use proptest::prelude::*;
    use stick3d_figure::Figure;

    use super::*;

    fn body(depth_of: impl Fn(usize) -> f32) -> Alternative {
        let mut body = Alternative::default();
        let points = Figure::human().template.iter().enumerate();
        body.joints = points
            .map(|(joint, point)| point.extend(depth_of(joint)))
            .collect::<Vec<Vec3>>();
        body
    }

    fn arm() -> Limb {
        let human = Figure::human();
        let hand = human.joint_index("hand_r").unwrap();
        let mut limbs = human.limbs().into_iter();
        limbs.find(|limb| limb.joints.contains(&hand)).unwrap()
    }

    #[test]
    fn turning_a_limb_flips_it_and_nothing_else() {
        let (body, arm) = (body(|joint| 0.1 * joint as f32), arm());
        let turned = turned(&body, &arm);
        assert!(is_flipped(&body, &turned, &arm));
        assert_eq!(farthest_elsewhere_m(&body, &turned, &arm), 0.0);
        for limb in Figure::human().limbs() {
            let sum = body.toward_viewer_m(&limb) + turned.toward_viewer_m(&limb);
            assert_eq!(sum.abs() < 1.0e-6, limb == arm);
        }
        assert_eq!(super::turned(&turned, &arm).distance_m(&body), 0.0);
    }

    #[test]
    fn the_nearest_that_will_do_is_found() {
        let bodies = [body(|_| 0.0), body(|_| 0.2), body(|_| 1.0)];
        let to = body(|_| 0.3);
        assert_eq!(nearest(&bodies, &to, |_| true), Some(1));
        let deep = |body: &Alternative| body.joints[0].z > 0.5;
        assert_eq!(nearest(&bodies, &to, deep), Some(2));
        assert_eq!(nearest(&bodies, &to, |_| false), None);
    }

    #[test]
    fn a_moved_limb_is_the_same_drawing_and_another_pose_is_not() {
        let human = Figure::human();
        let before = human.template.clone();
        let mut after = before.clone();
        after[human.joint_index("hand_r").unwrap()] += Vec2::new(-0.1, 0.3);
        assert!(is_same_drawing(&before, &after));
        for name in ["elbow_r", "elbow_l", "hand_l", "knee_r", "foot_r", "knee_l"] {
            after[human.joint_index(name).unwrap()] += Vec2::new(0.1, 0.4);
        }
        assert!(!is_same_drawing(&before, &after));
        assert!(!is_same_drawing(&before, &after[1..]) && !is_same_drawing(&[], &[]));
    }

    proptest! {
        #[test]
        fn place_and_size_do_not_matter(x in -900.0_f32..900.0, y in -900.0_f32..900.0, scale in 0.01_f32..800.0) {
            let before = &Figure::human().template;
            let after: Vec<Vec2> = before.iter().map(|p| *p * scale + Vec2::new(x, y) * scale).collect();
            prop_assert!(is_same_drawing(before, &after));
        }
    }
}
