//! Editing a sketch: picking and dragging joints, pins, mirroring, redrawing limbs, undo and redo.

mod drag;
mod history;
mod reach;
mod redraw;

use glam::Vec2;

pub use drag::{Drag, Grip, bone_lengths};
pub use history::History;
pub use redraw::redrawn;

use crate::figure::Figure;
use crate::recognize::any_order::sides;
use crate::sketch::Sketch;

/// The joint nearest to `at` among those not farther than `radius`; of joints at one place the last.
pub fn nearest_joint(sketch: &Sketch, at: Vec2, radius: f32) -> Option<usize> {
    let mut nearest = None;
    let mut least = radius;
    for (joint, point) in sketch.points().iter().enumerate() {
        let distance = point.distance(at);
        if distance <= least {
            (nearest, least) = (Some(joint), distance);
        }
    }
    nearest
}

/// The bone nearest to `at` among those not farther than `radius`, by its index.
pub fn nearest_bone(figure: &Figure, points: &[Vec2], at: Vec2, radius: f32) -> Option<usize> {
    let distance = |bone: &[usize; 2]| {
        let [a, b] = [points.get(bone[0])?, points.get(bone[1])?];
        Some(distance_to_line(at, *a, *b))
    };
    let bones = figure.bones.iter().enumerate();
    bones
        .filter_map(|(bone, joints)| Some((bone, distance(joints)?)))
        .filter(|(_, distance)| *distance <= radius)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(bone, _)| bone)
}

/// How far a point is from the line between two others.
pub fn distance_to_line(point: Vec2, from: Vec2, to: Vec2) -> f32 {
    let line = to - from;
    let along = (point - from).dot(line) / line.length_squared().max(f32::MIN_POSITIVE);
    point.distance(from + line * along.clamp(0.0, 1.0))
}

/// The sketch mirrored where it is: sides exchanged, x turned round the middle of its extent.
#[must_use]
pub fn mirrored_in_place(figure: &Figure, sketch: &Sketch) -> Sketch {
    let xs = || sketch.points().iter().map(|p| p.x);
    let (low, high) = (
        xs().fold(f32::INFINITY, f32::min),
        xs().fold(f32::NEG_INFINITY, f32::max),
    );
    let mirrored = sketch.mirrored(figure);
    let mut moved = mirrored.clone();
    for (joint, point) in mirrored.points().iter().enumerate() {
        let target = Vec2::new(point.x + low + high, point.y);
        // Points stay within the extent they had, so none can leave the valid range.
        if moved.set_point(figure, joint, target).is_err() {
            return mirrored;
        }
    }
    moved
}

/// The limb to which a joint belongs and the one of the other side, left before right, each from the trunk outwards.
/// None for a joint of the middle.
pub fn limb_pair(figure: &Figure, joint: usize) -> Option<[Vec<usize>; 2]> {
    sides::pair_of(figure, joint).map(|pair| [pair.left, pair.right])
}

/// Exchanges what is said of the joints of one limb with what is said of those of the other side. Says whether the joint
/// belongs to a pair.
pub fn swap_pair_in<T>(figure: &Figure, of_joints: &mut [T], joint: usize) -> bool {
    let pair = sides::pair_of(figure, joint);
    if let Some(pair) = &pair {
        sides::swap(pair, of_joints);
    }
    pair.is_some()
}

/// Exchanges the limb to which a joint belongs with the one of the other side: which leg is the right one cannot be
/// seen in every drawing. Says whether the joint belongs to a pair; the sketch is otherwise unchanged.
pub fn swap_pair(figure: &Figure, sketch: &mut Sketch, joint: usize) -> bool {
    let mut points = sketch.points().to_vec();
    if !swap_pair_in(figure, &mut points, joint) {
        return false;
    }
    match Sketch::new(figure, points) {
        Ok(swapped) => *sketch = swapped,
        Err(_) => return false,
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirroring_in_place_keeps_the_place() {
        let human = Figure::human();
        let points = human
            .template
            .iter()
            .map(|p| (*p + Vec2::new(0.2 * p.y, 0.0)) * 100.0);
        let sketch = Sketch::new(human, points.map(|p| p + Vec2::splat(300.0)).collect()).unwrap();
        let mirrored = mirrored_in_place(human, &sketch);
        let left = |s: &Sketch| s.points().iter().map(|p| p.x).fold(f32::INFINITY, f32::min);
        assert!((left(&sketch) - left(&mirrored)).abs() < 1.0e-3);
        assert!(mirrored != sketch);
        for (a, b) in mirrored_in_place(human, &mirrored)
            .points()
            .iter()
            .zip(sketch.points())
        {
            assert!(a.distance(*b) < 1.0e-3);
        }
    }
}
