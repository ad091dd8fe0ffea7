//! Drawings of random poses in any order must be recovered.

use super::*;
use crate::simulate::any_order::{
    Freedom, HORSE_FREEDOM, HUMAN_FREEDOM, Habits, draw, flat_pose, is_readable,
};
use crate::simulate::{self, Hand};

/// A joint is right within this part of the figure's height.
const RIGHT: f32 = 0.06;
const HEIGHT_PX: f32 = 500.0;

fn hand() -> Hand {
    Hand { height_px: HEIGHT_PX, jitter_px: 3.0, ..Hand::default() }
}

fn farthest(found: &[Option<Vec2>], meant: &[Vec2]) -> f32 {
    let pairs = found.iter().zip(meant);
    pairs
        .map(|(found, meant)| found.map_or(f32::INFINITY, |found| found.distance(*meant)) / HEIGHT_PX)
        .fold(0.0, f32::max)
}

/// The least error over all ways to exchange pairs.
fn farthest_up_to_sides(figure: &Figure, found: &[Option<Vec2>], meant: &[Vec2]) -> f32 {
    let pairs = sides::pairs(figure);
    (0..1_u32 << pairs.len())
        .map(|mask| {
            let mut found = found.to_vec();
            for (i, pair) in pairs.iter().enumerate() {
                if mask >> i & 1 == 1 {
                    sides::swap(pair, &mut found);
                }
            }
            farthest(&found, meant)
        })
        .fold(f32::INFINITY, f32::min)
}

fn readable(figure: &Figure, seed: u64, freedom: Freedom) -> (Vec<Vec2>, rand_chacha::ChaCha8Rng) {
    let mut rng = simulate::rng(seed);
    loop {
        let pose = flat_pose(figure, &mut rng, freedom);
        if is_readable(figure, &pose) {
            return (simulate::on_canvas(&pose, HEIGHT_PX), rng);
        }
    }
}

#[test]
fn survey() {
    for (figure, freedom) in [(Figure::human(), HUMAN_FREEDOM), (Figure::horse(), HORSE_FREEDOM)] {
        let count = 500;
        let mut right = 0;
        let started = std::time::Instant::now();
        let mut spent = std::time::Duration::ZERO;
        for seed in 0..count {
            let (meant, mut rng) = readable(figure, seed, freedom);
            let strokes = draw(figure, &mut rng, &meant, &[], hand(), Habits::default());
            let before = std::time::Instant::now();
            let found = recognize_any(figure, &strokes).unwrap();
            spent += before.elapsed();
            let error = farthest_up_to_sides(figure, &found.joints, &meant);
            if error < RIGHT {
                right += 1;
            } else {
                println!("{} {seed}: {error} cost {} confidence {} left {}", figure.name, found.cost, found.confidence, found.leftover);
            }
        }
        println!("{}: {right} of {count}, {:?} each, {:?}", figure.name, spent / count as u32, started.elapsed());
    }
}
