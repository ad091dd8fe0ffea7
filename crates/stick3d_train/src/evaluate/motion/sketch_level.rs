//! Interpolation of sketches, the paper's second baseline (section 5.3): every bone of the figure is turned from its
//! direction in one sketch to that in the next.

use glam::{Quat, Vec2};
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::{Sketch, SketchError};

/// The sketch a share of the way between two: bones from the root joint outward, each turned by a part of the best rotation
/// (spherical linear interpolation of its quaternion), its length changing evenly.
pub(crate) fn between(
    figure: &Figure,
    from: &Sketch,
    to: &Sketch,
    share: f32,
) -> Result<Sketch, SketchError> {
    // Both drawings in one unit and place.
    let normalised = |sketch: &Sketch| -> Vec<Vec2> {
        let (scale, root) = (sketch.scale(figure), sketch.points()[figure.root]);
        sketch
            .points()
            .iter()
            .map(|p| (*p - root) / scale)
            .collect()
    };
    let (from, to) = (normalised(from), normalised(to));
    let mut points: Vec<Option<Vec2>> = vec![None; figure.joint_count()];
    points[figure.root] = Some(Vec2::ZERO);
    // The bones are a tree: as many rounds as bones reach every joint.
    for _ in 0..figure.bones.len() {
        for &[a, b] in &figure.bones {
            for (parent, child) in [(a, b), (b, a)] {
                if let (Some(at), None) = (points[parent], points[child]) {
                    let bones = [&from, &to].map(|points| points[child] - points[parent]);
                    points[child] = Some(at + turned(bones, share));
                }
            }
        }
    }
    let points = points.into_iter().map(Option::unwrap_or_default);
    Sketch::new(figure, points.collect())
}

/// A bone, part of the way from one sketch to the next.
fn turned([from, to]: [Vec2; 2], share: f32) -> Vec2 {
    let turn = Quat::IDENTITY.slerp(best_rotation(from, to), share);
    let length = from.length() + share * (to.length() - from.length());
    (turn * from.extend(0.0)).truncate().normalize_or_zero() * length
}

/// The rotation that brings a drawn bone closest to another in the least squares sense.
///
/// The paper takes that of Arun, Huang, Blostein, "Least-squares fitting of two 3-D point sets", IEEE PAMI 9 (1987). One
/// bone leaves a turn free; of the solutions this is the one in the plane of the sketch, which keeps the drawing a drawing.
fn best_rotation(from: Vec2, to: Vec2) -> Quat {
    Quat::from_rotation_z(from.perp_dot(to).atan2(from.dot(to)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_way_a_raised_arm_points_half_way_and_is_as_long() {
        let human = Figure::human();
        let from = Sketch::template(human);
        let mut to = from.clone();
        let [neck, elbow, hand] =
            ["neck", "elbow_l", "hand_l"].map(|name| human.joint_index(name).unwrap());
        // The arm straight up instead of down.
        for joint in [elbow, hand] {
            let point = from.points()[joint];
            let up = Vec2::new(point.x, 2.0 * from.points()[neck].y - point.y);
            to.set_point(human, joint, up).unwrap();
        }
        let middle = between(human, &from, &to, 0.5).unwrap();
        let arm = |sketch: &Sketch| sketch.points()[hand] - sketch.points()[elbow];
        let unit = arm(&from).length() / from.scale(human);
        assert!((arm(&middle).length() / unit - 1.0).abs() < 1e-4);
        assert!(arm(&middle).y.abs() < 1e-4 && arm(&middle).x > 0.0);
        for (share, end) in [(0.0, &from), (1.0, &to)] {
            let found = between(human, &from, &to, share).unwrap();
            let (found, end) = (
                found.input_vector(human).unwrap(),
                end.input_vector(human).unwrap(),
            );
            assert!(found.iter().zip(&end).all(|(a, b)| (a - b).abs() < 1e-4));
        }
    }
}
