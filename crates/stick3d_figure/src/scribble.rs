//! The scribble: a quick zigzag over the drawing, which undoes the last stroke (paper, section 4.4).

use glam::Vec2;

use crate::stroke::Stroke;

/// A zigzag has at least this many runs to and fro.
const MIN_RUNS: usize = 5;
/// On average a run takes no longer than this.
const MAX_RUN_S: f64 = 0.2;
/// A turn counts when the pen comes back by this part of the swing.
const TURN: f32 = 0.35;
/// The swing is at least this part of the stroke's largest extent, or it is tremor across a line.
const MIN_SWING: f32 = 0.2;
/// Every second run is alike: within this angle,
const MAX_TURN_DEG: f32 = 45.0;
/// within this ratio of lengths,
const MAX_LENGTH_RATIO: f32 = 2.5;
/// and shifted by at most this part of its length.
const MAX_SHIFT: f32 = 0.95;
const SAMPLES: usize = 160;
const DIRECTIONS: usize = 12;

/// Is `stroke`, just drawn over the strokes `drawn` before it, a scribble?
///
/// It is when it swings to and fro at least five times, quickly, each swing like the one before the last, and crosses
/// what was drawn. Limbs that are drawn there and back differ: after each way back the pen leaves for another place.
/// Without times, or with nothing drawn before, nothing is a scribble.
pub fn is_scribble(stroke: &Stroke, drawn: &[Stroke]) -> bool {
    let duration_s = stroke.duration_s();
    if duration_s <= 0.0 || stroke.points().len() < 2 * MIN_RUNS {
        return false;
    }
    let samples: Vec<Vec2> = stroke
        .resampled(SAMPLES)
        .into_iter()
        .map(|p| p.position_px)
        .collect();
    let turns = turns(&samples);
    let runs = turns.len().saturating_sub(1);
    runs >= MIN_RUNS
        && duration_s <= MAX_RUN_S * runs as f64
        && runs_are_alike(&turns)
        && crosses(&samples, drawn)
}

/// The points where the stroke starts, turns round and ends, seen along the direction in which it turns most often.
fn turns(samples: &[Vec2]) -> Vec<Vec2> {
    let extent = |direction: Vec2| {
        let along = samples.iter().map(|p| p.dot(direction));
        let (low, high) = along.fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        high - low
    };
    let directions = (0..DIRECTIONS)
        .map(|i| Vec2::from_angle(i as f32 * std::f32::consts::PI / DIRECTIONS as f32));
    let largest = directions.clone().map(extent).fold(0.0, f32::max);
    // Among directions with equally many turns the one of the widest swing shows them best.
    directions
        .filter(|&direction| extent(direction) >= MIN_SWING * largest)
        .map(|direction| {
            (
                turns_along(samples, direction, TURN * extent(direction)),
                extent(direction),
            )
        })
        .max_by(|a, b| a.0.len().cmp(&b.0.len()).then(a.1.total_cmp(&b.1)))
        .map_or_else(Vec::new, |(turns, _)| turns)
}

/// The ends and those extremes along a direction from which the pen comes back by at least `back`.
fn turns_along(samples: &[Vec2], direction: Vec2, back: f32) -> Vec<Vec2> {
    let Some(&first) = samples.first() else {
        return Vec::new();
    };
    let mut turns = vec![first];
    let mut sign = 0.0;
    let mut extreme = first;
    for &p in samples {
        let travelled = (p - extreme).dot(direction);
        if sign == 0.0 {
            // Not yet known which way the first run goes.
            if travelled.abs() >= back {
                (sign, extreme) = (travelled.signum(), p);
            }
        } else if travelled * sign > 0.0 {
            extreme = p;
        } else if -travelled * sign >= back {
            turns.push(extreme);
            (sign, extreme) = (-sign, p);
        }
    }
    if sign != 0.0 {
        turns.push(extreme);
    }
    turns
}

/// Is every run like the one before the last? One in five may differ (the first, begun before the hand was in swing).
fn runs_are_alike(turns: &[Vec2]) -> bool {
    let runs: Vec<(Vec2, Vec2)> = turns.windows(2).map(|w| (w[0], w[1])).collect();
    let alike = runs
        .iter()
        .zip(&runs[2..])
        .filter(|((a0, a1), (b0, b1))| {
            let (a, b) = (*a1 - *a0, *b1 - *b0);
            let (short, long) = (a.length().min(b.length()), a.length().max(b.length()));
            let shift = (*a0 + *a1 - *b0 - *b1).length() / 2.0;
            a.angle_to(b).abs().to_degrees() <= MAX_TURN_DEG
                && long <= MAX_LENGTH_RATIO * short
                && shift <= MAX_SHIFT * long
        })
        .count();
    let pairs = runs.len() - 2;
    alike * 5 >= pairs * 4
}

fn crosses(samples: &[Vec2], drawn: &[Stroke]) -> bool {
    drawn.iter().any(|stroke| {
        let points = stroke.resampled(SAMPLES);
        points.windows(2).any(|line| {
            let (a, b) = (line[0].position_px, line[1].position_px);
            samples
                .windows(2)
                .any(|step| segments_cross(a, b, step[0], step[1]))
        })
    })
}

fn segments_cross(a: Vec2, b: Vec2, c: Vec2, d: Vec2) -> bool {
    let side = |p: Vec2, q: Vec2, r: Vec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::Rng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::simulate::guided::{self, STYLES};
    use crate::simulate::subjects::HUMAN;
    use crate::simulate::{self, Hand};

    fn drawing(rng: &mut ChaCha8Rng, hand: Hand) -> Vec<Stroke> {
        let figure = (HUMAN.figure)();
        let meant = simulate::on_canvas(&(HUMAN.pose)(rng), hand.height_px);
        let style = STYLES[rng.random_range(0..STYLES.len())];
        let cuts = guided::cuts(figure, rng, style);
        guided::draw(figure, rng, &meant, &cuts, hand)
    }

    /// A zigzag of `runs` swings of `size_px`, seen from `centre`.
    fn zigzag(rng: &mut impl Rng, centre: Vec2, size_px: f32, runs: usize, run_s: f64) -> Stroke {
        let swing = Vec2::from_angle(rng.random_range(0.0..std::f32::consts::TAU));
        // Between scratching on one line and a wide zigzag.
        let drift = swing.perp() * rng.random_range(0.0..0.3) * size_px;
        let mut corner = |i: usize| {
            let wobble = 0.08 * size_px;
            let uneven =
                Vec2::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0)) * wobble;
            let side = if i.is_multiple_of(2) { -0.5 } else { 0.5 };
            centre + swing * side * size_px + drift * (i as f32 - runs as f32 / 2.0) + uneven
        };
        let corners: Vec<Vec2> = (0..=runs).map(&mut corner).collect();
        let mut stroke = Stroke::default();
        for (i, pair) in corners.windows(2).enumerate() {
            for k in 0..12 {
                let t = k as f32 / 12.0;
                // The hand is fastest in mid-swing, and its turns are round.
                let eased = t * t * (3.0 - 2.0 * t);
                let jitter = Vec2::new(rng.random_range(-1.5..1.5), rng.random_range(-1.5..1.5));
                let time_s = run_s * (i as f64 + f64::from(t));
                stroke
                    .push(pair[0].lerp(pair[1], eased) + jitter, time_s)
                    .unwrap();
            }
        }
        stroke
    }

    proptest! {
        #[test]
        fn ordinary_strokes_are_never_scribbles(
            seed in any::<u64>(),
            height_px in 150.0f32..900.0,
            // Whoever draws a whole figure faster than this scribbles.
            figure_s in 3.5f32..20.0,
            jitter_px in 0.0f32..4.0,
        ) {
            // The whole path is about six metres of a man of 1.8.
            let speed_px_per_s = 3.4 * height_px / figure_s;
            let hand = Hand { height_px, jitter_px, speed_px_per_s, ..Hand::default() };
            let strokes = drawing(&mut simulate::rng(seed), hand);
            for n in 0..strokes.len() {
                prop_assert!(!is_scribble(&strokes[n], &strokes[..n]), "stroke {}", n);
                // A second figure drawn over the first is not a scribble either.
                prop_assert!(!is_scribble(&strokes[n], &strokes), "stroke {} again", n);
            }
        }

        #[test]
        fn zigzags_over_the_drawing_are_scribbles(
            seed in any::<u64>(),
            size in 0.15f32..1.1,
            runs in 5usize..14,
            run_s in 0.04f64..0.18,
        ) {
            let hand = Hand::default();
            let mut rng = simulate::rng(seed);
            let strokes = drawing(&mut rng, hand);
            let drawn = &strokes[..rng.random_range(1..=strokes.len())];
            let over = &drawn[rng.random_range(0..drawn.len())].resampled(9)[4];
            let stroke = zigzag(&mut rng, over.position_px, size * hand.height_px, runs, run_s);
            // A wide zigzag can pass on both sides of a short stroke, and is then not over it.
            let samples: Vec<Vec2> =
                stroke.resampled(SAMPLES).into_iter().map(|p| p.position_px).collect();
            prop_assume!(crosses(&samples, drawn));
            prop_assert!(is_scribble(&stroke, drawn));
        }

        #[test]
        fn zigzags_elsewhere_or_slow_ones_are_not(seed in any::<u64>(), runs in 5usize..14) {
            let mut rng = simulate::rng(seed);
            let strokes = drawing(&mut rng, Hand::default());
            let beside = zigzag(&mut rng, Vec2::new(4000.0, 0.0), 200.0, runs, 0.1);
            prop_assert!(!is_scribble(&beside, &strokes));
            prop_assert!(!is_scribble(&beside, &[]));
            let slow = zigzag(&mut rng, strokes[0].points()[0].position_px, 200.0, runs, 0.5);
            prop_assert!(!is_scribble(&slow, &strokes));
        }
    }

    #[test]
    fn a_stroke_without_times_is_none() {
        let zigzag = (0..40).map(|i| Vec2::new(if i % 2 == 0 { 0.0 } else { 100.0 }, i as f32));
        let stroke = Stroke::from_positions(zigzag).unwrap();
        let line = Stroke::from_positions([Vec2::new(50.0, -10.0), Vec2::new(50.0, 90.0)]).unwrap();
        assert!(!is_scribble(&stroke, &[line]));
    }
}
