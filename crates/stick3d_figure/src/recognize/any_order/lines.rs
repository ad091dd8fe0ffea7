//! Straight lines between marks, and the ink that speaks for each of them.

use glam::Vec2;

use super::marks::{Head, Marks, SAME_PLACE};
use crate::recognize::ink::{Ink, MAX_STROKES};

/// How far ink may lie from a line that it belongs to, in parts of the tolerance length.
const WIDTH: f32 = 0.02;
/// The same in parts of the line's length, since long lines bulge more.
const BULGE: f32 = 0.06;
/// And at most so far.
const MAX_WIDTH: f32 = 0.05;
/// How far from straight a bone is drawn, in parts of the tolerance length,
const STRAIGHTNESS: f32 = 0.014;
/// and in parts of its own length.
const BOW: f32 = 0.03;
/// Deviations along a line are alike over about this part of the tolerance length.
const CORRELATION: f32 = 0.06;
/// The cosine of the angle by which ink may turn from the line that it belongs to.
const MIN_ALIGNMENT: f32 = 0.72;
/// The length of the bins in which ink is counted along a line, in parts of the tolerance length.
const BIN: f32 = 0.025;
const MAX_BINS: f32 = 48.0;
/// A line with more of it undrawn is no bone.
const MAX_GAP: f32 = 0.4;
/// What undrawn line costs, per tolerance length of it.
const GAP_COST: f32 = 70.0;
/// Room for every sample of the most strokes that are read.
const WORDS: usize = MAX_STROKES * 6 / 64;

/// A set of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Samples([u64; WORDS]);

impl Samples {
    pub(super) const NONE: Self = Self([0; WORDS]);

    pub(super) const ALL: Self = Self([u64::MAX; WORDS]);

    pub(super) fn add(&mut self, other: &Self) {
        for (word, other) in self.0.iter_mut().zip(&other.0) {
            *word |= other;
        }
    }

    pub(super) fn contains(&self, sample: usize) -> bool {
        self.0
            .get(sample / 64)
            .is_some_and(|word| word >> (sample % 64) & 1 == 1)
    }

    /// Adds a sample and says whether it is new.
    pub(super) fn insert(&mut self, sample: usize) -> bool {
        let Some(word) = self.0.get_mut(sample / 64) else {
            return false;
        };
        let bit = 1 << (sample % 64);
        let new = *word & bit == 0;
        *word |= bit;
        new
    }
}

/// A sample that belongs to a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub(super) sample: u16,
    /// Where along the line; none where the ink only passes by one of its ends.
    pub(super) bin: Option<u8>,
}

/// A straight line between two marks that ink speaks for.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) length: f32,
    /// How unlikely it is that this ink was meant as one straight line.
    pub(super) cost: f32,
    pub(super) touches: Vec<Touch>,
    /// Per bin: nothing needs to be drawn there.
    pub(super) free: Vec<bool>,
}

impl Line {
    /// The length of a bin.
    pub(super) fn bin_length(&self) -> f32 {
        self.length / self.free.len() as f32
    }
}

/// All lines between marks. The mark after the last place is the middle of the head's loop.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    pub(super) marks: usize,
    lines: Vec<Option<Line>>,
}

impl Lines {
    pub(super) fn new(ink: &Ink, marks: &Marks) -> Self {
        let places: Vec<Vec2> = marks
            .places
            .iter()
            .copied()
            .chain(marks.head.iter().map(|head| head.center))
            .collect();
        let count = places.len();
        let mut lines = vec![None; count * count];
        for b in 0..count {
            let head = marks.head.as_ref().filter(|_| b == marks.places.len());
            for a in 0..b {
                lines[a * count + b] = line(ink, marks, [places[a], places[b]], head);
            }
        }
        Self {
            marks: count,
            lines,
        }
    }

    pub(super) fn between(&self, a: usize, b: usize) -> Option<&Line> {
        self.lines.get(a.min(b) * self.marks + a.max(b))?.as_ref()
    }
}

/// The line from one place to another; `head` when its second end is the middle of the head.
fn line(ink: &Ink, marks: &Marks, [from, to]: [Vec2; 2], head: Option<&Head>) -> Option<Line> {
    let unit = ink.tolerance_length;
    let length = from.distance(to);
    let inside = head.map_or(0.0, |head| head.radius);
    if length < (SAME_PLACE * unit).max(0.8 * inside) {
        return None;
    }
    let direction = (to - from) / length;
    let width = (WIDTH * unit + BULGE * length).min(MAX_WIDTH * unit);
    let near_end = SAME_PLACE * unit;
    let bins = (length / (BIN * unit)).ceil().clamp(3.0, MAX_BINS);
    let bin_of = |along: f32| (along / length * bins).clamp(0.0, bins - 1.0) as usize;
    let mut touches = Vec::new();
    let mut drawn = vec![false; bins as usize];
    let (mut squares, mut weight) = (0.0, 0.0);
    for (sample, &p) in ink.samples.iter().enumerate() {
        if head.is_some_and(|head| head.samples.contains(&sample)) {
            touches.push(Touch {
                sample: sample as u16,
                bin: None,
            });
            continue;
        }
        let (along, beside) = (direction.dot(p - from), direction.perp_dot(p - from));
        if beside.abs() > width.max(near_end) || along < -near_end || along > length + near_end {
            continue;
        }
        let is_inner = (0.0..=length).contains(&along);
        let aligned = marks.tangents[sample].dot(direction).abs() >= MIN_ALIGNMENT;
        if is_inner && aligned && beside.abs() <= width {
            touches.push(Touch {
                sample: sample as u16,
                bin: Some(bin_of(along) as u8),
            });
            let reach = 0.75 * marks.weights[sample];
            drawn[bin_of(along - reach)..=bin_of(along + reach)].fill(true);
            squares += marks.weights[sample] * beside * beside;
            weight += marks.weights[sample];
        } else if p.distance(from).min(p.distance(to)) <= near_end {
            touches.push(Touch {
                sample: sample as u16,
                bin: None,
            });
        }
    }
    let free: Vec<bool> = (0..drawn.len())
        .map(|bin| {
            let along = (bin as f32 + 0.5) / bins * length;
            along < near_end || along > length - near_end.max(1.1 * inside)
        })
        .collect();
    let gap = drawn
        .iter()
        .zip(&free)
        .filter(|(drawn, free)| !**drawn && !**free)
        .count();
    let gap = gap as f32 / bins * length;
    if gap > MAX_GAP * length || (weight <= 0.0 && head.is_none()) {
        return None;
    }
    let sigma = STRAIGHTNESS * unit + BOW * length;
    let independent = 1.0 + length / (CORRELATION * unit);
    let bend = 0.5 * independent * squares / weight.max(f32::MIN_POSITIVE) / (sigma * sigma);
    Some(Line {
        length,
        cost: bend + GAP_COST * gap / unit,
        touches,
        free,
    })
}
