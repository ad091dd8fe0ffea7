//! A person who draws figures, to measure recognition by: orders of drawing, an unsteady hand, a judge of what was
//! recognised. For tests, and for evaluation through the feature `simulate`.

pub mod any_order;
#[cfg(test)]
pub(crate) mod guided;
mod judge;
#[cfg(test)]
pub(crate) mod subjects;

pub use judge::{farthest_px, is_recognised};

use glam::Vec2;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::stroke::Stroke;

/// Height of a figure that [`on_canvas`] draws as high as it is told, metres: a man's.
const HEIGHT_M: f32 = 1.8;

/// How steadily and quickly it is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Hand {
    /// How high a figure of usual height is drawn, pixels.
    pub height_px: f32,
    /// From one point of a stroke to the next, pixels.
    pub spacing_px: f32,
    /// How far points lie beside their line, at most, pixels along x and y.
    pub jitter_px: f32,
    /// How far strokes start beside the joint they mean, at most, pixels along x and y.
    pub aim_px: f32,
    /// How fast the pen goes, pixels a second.
    pub speed_px_per_s: f32,
    /// How far bones bulge, at most, in parts of their length.
    pub bow: f32,
}

impl Default for Hand {
    fn default() -> Self {
        Self {
            height_px: 450.0,
            spacing_px: 4.0,
            jitter_px: 2.0,
            aim_px: 6.0,
            speed_px_per_s: 700.0,
            bow: 0.04,
        }
    }
}

impl Hand {
    /// The hand that recognition in any order is measured by: 3 px of jitter on a figure of 500 px, whose strokes end up to
    /// 6 px in x and y beside the joint that they mean.
    pub fn any_order() -> Self {
        Self {
            height_px: 500.0,
            jitter_px: 3.0,
            ..Self::default()
        }
    }
}

/// Random numbers that depend on the seed alone.
pub fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// A stroke from corner to corner by an unsteady hand.
pub(crate) fn line(rng: &mut ChaCha8Rng, corners: &[Vec2], hand: Hand, time_s: &mut f64) -> Stroke {
    let mut stroke = Stroke::default();
    for pair in corners.windows(2) {
        let length = pair[0].distance(pair[1]);
        let steps = (length / hand.spacing_px).ceil().max(1.0);
        // A slight bow, since nobody draws a straight line.
        let bow = (pair[1] - pair[0]).perp() * rng.random_range(-hand.bow..=hand.bow);
        for i in 0..=steps as usize {
            let t = i as f32 / steps;
            let p = pair[0].lerp(pair[1], t) + bow * (4.0 * t * (1.0 - t));
            // What is no number leaves no ink.
            let _ = stroke.push(p + wobble(rng, hand.jitter_px), *time_s);
            *time_s += f64::from(length / steps / hand.speed_px_per_s);
        }
    }
    stroke
}

/// Anywhere in a square round zero.
pub(crate) fn wobble(rng: &mut ChaCha8Rng, size: f32) -> Vec2 {
    Vec2::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0)) * size
}

/// A pose, metres, in canvas pixels: 1.8 metres become `height_px`.
pub fn on_canvas(pose: &[Vec2], height_px: f32) -> Vec<Vec2> {
    let scale = height_px / HEIGHT_M;
    pose.iter()
        .map(|p| *p * scale + Vec2::new(400.0, 380.0))
        .collect()
}
