//! Whether what was recognised is what was meant.

use glam::Vec2;
use rand_chacha::ChaCha8Rng;

use super::any_order::{Habits, draw};
use super::{Hand, on_canvas};
use crate::figure::Figure;
use crate::recognize::any_order::{recognize_any, sides};

/// A joint is right that is nearer than this part of the figure's height to where it is meant.
const RIGHT: f32 = 0.06;

/// Draws a pose (metres, as large as people and horses are) with strokes in any order, and says whether
/// [`recognize_any`] puts every joint within 6 % of the figure's height of where it is meant, left and right by its rule.
pub fn is_recognised(
    figure: &Figure,
    rng: &mut ChaCha8Rng,
    pose: &[Vec2],
    hand: Hand,
    habits: Habits,
) -> bool {
    let meant = on_canvas(pose, hand.height_px);
    let strokes = draw(figure, rng, &meant, &[], hand, habits);
    recognize_any(figure, &strokes).is_ok_and(|found| {
        let meant = by_the_rule(figure, &meant, &found.joints);
        farthest_px(&found.joints, &meant) < RIGHT * hand.height_px
    })
}

/// The largest distance of a joint from where it is meant, pixels; infinite when one was not found.
pub fn farthest_px(found: &[Option<Vec2>], meant: &[Vec2]) -> f32 {
    let away = |(found, meant): (&Option<Vec2>, &Vec2)| {
        found.map_or(f32::INFINITY, |found| found.distance(*meant))
    };
    found.iter().zip(meant).map(away).fold(0.0, f32::max)
}

/// The joints as meant, left and right by the rule of [`recognize_any`](crate::recognize_any). Pairs that the rule calls
/// ambiguous are put as they were found.
fn by_the_rule(figure: &Figure, meant: &[Vec2], found: &[Option<Vec2>]) -> Vec<Vec2> {
    let mut joints: Vec<Option<Vec2>> = meant.iter().copied().map(Some).collect();
    let ambiguous = sides::put_on_sides(figure, &mut joints);
    let mut joints: Vec<Vec2> = joints.into_iter().flatten().collect();
    for pair in ambiguous {
        let mut swapped = joints.clone();
        sides::swap(&pair, &mut swapped);
        if farthest_px(found, &swapped) < farthest_px(found, &joints) {
            joints = swapped;
        }
    }
    joints
}
