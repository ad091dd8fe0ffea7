//! Strokes made ready for the search: a bounded number of samples, and the cost of a straight piece in O(1).

use std::ops::Range;

use glam::{DVec2, Vec2};

use crate::stroke::Stroke;

/// About how many samples a drawing is reduced to: a head of a human drawn in one line still gets six.
const SAMPLES: usize = 120;
/// Nobody draws a figure with more strokes; it bounds the work.
pub(super) const MAX_STROKES: usize = 256;
/// Strokes smaller than this part of the drawing's diagonal are slips of the pen.
const DOT: f32 = 0.005;
/// A hand does not get steadier on a small drawing: below this diagonal, tolerances shrink no more.
const SMALL_DRAWING_PX: f32 = 180.0;
/// Below this, coordinates are metres or the like, not pixels.
const NOT_PIXELS: f32 = 20.0;
/// How far from straight a bone is drawn, in parts of the tolerance length.
const STRAIGHTNESS: f32 = 0.014;
/// How far bones bulge besides, in parts of their own length.
const BOW: f64 = 0.03;
/// Deviations along a line are alike over about this part of the diagonal.
const CORRELATION: f32 = 0.03;

/// Sums over samples, from which the deviation from any chord follows.
#[derive(Clone, Copy, Default)]
struct Moments {
    sum: DVec2,
    xx: f64,
    xy: f64,
    yy: f64,
}

/// All strokes as one row of samples about equally far apart along the ink.
pub(super) struct Ink {
    pub(super) samples: Vec<Vec2>,
    /// Which samples belong to which stroke, in drawing order; none is empty.
    pub(super) strokes: Vec<Range<usize>>,
    /// Per sample: does a stroke start here?
    pub(super) starts: Vec<bool>,
    /// The length of the box round the ink.
    pub(super) diagonal: f32,
    /// The length that tolerances are parts of: the diagonal, except for small drawings.
    pub(super) tolerance_length: f32,
    /// Length of ink up to each sample, gaps between strokes not counted.
    arc: Vec<f32>,
    moments: Vec<Moments>,
}

impl Ink {
    /// None when there is no stroke of any size, or more strokes than [`MAX_STROKES`].
    pub(super) fn new(strokes: &[Stroke]) -> Option<Self> {
        if strokes.len() > MAX_STROKES {
            return None;
        }
        let (low, high) = crate::stroke::bounds_px(strokes)?;
        let diagonal = low.distance(high);
        if diagonal.is_nan()
            || diagonal <= (low.abs().max(high.abs()).max_element() * 1.0e-5).max(1.0e-12)
        {
            return None;
        }
        let smooth: Vec<Vec<Vec2>> = strokes
            .iter()
            .map(|stroke| without_jitter(stroke, 0.008 * tolerance_length(diagonal)))
            .filter(|points| extent(points) > DOT * tolerance_length(diagonal))
            .collect();
        let total: f32 = smooth.iter().map(|points| length(points)).sum();
        if total <= 0.0 {
            return None;
        }
        let mut ink = Self {
            samples: Vec::with_capacity(SAMPLES * 2),
            strokes: Vec::with_capacity(smooth.len()),
            starts: Vec::new(),
            diagonal,
            tolerance_length: tolerance_length(diagonal),
            arc: Vec::new(),
            moments: Vec::new(),
        };
        for points in &smooth {
            let start = ink.samples.len();
            // At least four pieces, so that a short stroke of two bones can still bend.
            let pieces = ((length(points) / total * SAMPLES as f32).round() as usize).max(4);
            ink.samples.extend(even(points, pieces));
            ink.strokes.push(start..ink.samples.len());
        }
        ink.sum_up();
        Some(ink)
    }

    fn sum_up(&mut self) {
        let mut moments = Moments::default();
        let mut arc = 0.0;
        self.moments.push(moments);
        for stroke in &self.strokes {
            for i in stroke.clone() {
                if i > stroke.start {
                    arc += self.samples[i].distance(self.samples[i - 1]);
                }
                self.starts.push(i == stroke.start);
                self.arc.push(arc);
                let p = self.samples[i].as_dvec2();
                moments.sum += p;
                moments.xx += p.x * p.x;
                moments.xy += p.x * p.y;
                moments.yy += p.y * p.y;
                self.moments.push(moments);
            }
        }
    }

    /// The length of ink between two samples of one stroke.
    pub(super) fn arc_between(&self, from: usize, to: usize) -> f32 {
        self.arc[to] - self.arc[from]
    }

    /// How unlikely it is that the ink between two samples of one stroke was meant as one straight line,
    /// as a negative logarithm of a probability: squared distances from the chord, and ink beyond its length
    /// (which tells a line from one drawn forth and back).
    pub(super) fn straightness_cost(&self, from: usize, to: usize) -> f32 {
        let (a, b) = (self.samples[from].as_dvec2(), self.samples[to].as_dvec2());
        let chord = b - a;
        let chord_length = chord.length();
        let count = (to - from + 1) as f64;
        let (m, n) = (self.moments[to + 1], self.moments[from]);
        let sum = m.sum - n.sum;
        // Second moments about the chord's start.
        let xx = m.xx - n.xx - 2.0 * a.x * sum.x + count * a.x * a.x;
        let yy = m.yy - n.yy - 2.0 * a.y * sum.y + count * a.y * a.y;
        let xy = m.xy - n.xy - a.x * sum.y - a.y * sum.x + count * a.x * a.y;
        let squares = if chord_length > 1.0e-9 {
            let u = chord / chord_length;
            xx * u.y * u.y - 2.0 * xy * u.x * u.y + yy * u.x * u.x
        } else {
            xx + yy
        };
        let arc = f64::from(self.arc_between(from, to));
        let unit = f64::from(self.tolerance_length);
        let sigma = f64::from(STRAIGHTNESS) * unit + BOW * chord_length;
        let independent = 1.0 + arc / (f64::from(CORRELATION) * unit);
        let bend = independent * squares.max(0.0) / count / (2.0 * sigma * sigma);
        let excess = (arc - chord_length).max(0.0) / (0.04 * unit + 0.12 * chord_length);
        (bend + excess * excess) as f32
    }
}

fn tolerance_length(diagonal: f32) -> f32 {
    if diagonal > NOT_PIXELS {
        diagonal.max(SMALL_DRAWING_PX)
    } else {
        diagonal
    }
}

/// The polyline without tremor: points within `radius` are merged into their mean, except the two ends.
fn without_jitter(stroke: &Stroke, radius: f32) -> Vec<Vec2> {
    let mut merged = Vec::new();
    let (mut anchor, mut sum, mut count) = (None, Vec2::ZERO, 0.0_f32);
    for p in stroke.positions() {
        let from = *anchor.get_or_insert(p);
        if p.distance(from) > radius {
            merged.push(sum / count);
            (anchor, sum, count) = (Some(p), Vec2::ZERO, 0.0);
        }
        sum += p;
        count += 1.0;
    }
    if count > 0.0 {
        merged.push(sum / count);
    }
    if let (Some(first), Some(last)) = (stroke.positions().next(), stroke.positions().next_back()) {
        merged.insert(0, first);
        merged.push(last);
    }
    merged
}

fn length(points: &[Vec2]) -> f32 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

fn extent(points: &[Vec2]) -> f32 {
    let first = points.first().copied().unwrap_or_default();
    points.iter().map(|p| p.distance(first)).fold(0.0, f32::max)
}

/// `pieces + 1` points at equal distances along a polyline.
fn even(points: &[Vec2], pieces: usize) -> Vec<Vec2> {
    Stroke::from_positions(points.iter().copied()).map_or_else(
        |_| Vec::new(),
        |stroke| {
            stroke
                .resampled(pieces + 1)
                .into_iter()
                .map(|p| p.position_px)
                .collect()
        },
    )
}
