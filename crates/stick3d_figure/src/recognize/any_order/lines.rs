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
#[derive(Clone, Copy, Debug)]
pub(super) struct Samples {
    words: [u64; WORDS],
    /// So many of the words may be other than zero.
    used: usize,
}

impl Samples {
    pub(super) const NONE: Self = Self {
        words: [0; WORDS],
        used: 0,
    };
    pub(super) const ALL: Self = Self {
        words: [u64::MAX; WORDS],
        used: WORDS,
    };

    pub(super) fn add(&mut self, other: &Self) {
        for (word, other) in self.words.iter_mut().zip(&other.words[..other.used]) {
            *word |= other;
        }
        self.used = self.used.max(other.used);
    }

    pub(super) fn insert(&mut self, sample: usize) {
        if let Some(word) = self.words.get_mut(sample / 64) {
            *word |= 1 << (sample % 64);
            self.used = self.used.max(sample / 64 + 1);
        }
    }

    /// The sum of what is given for samples that are not in another set.
    pub(super) fn sum_without(&self, other: &Self, weights: &[f32]) -> f32 {
        let mut sum = 0.0;
        for (at, (word, other)) in self.words[..self.used].iter().zip(&other.words).enumerate() {
            let mut left = word & !other;
            while left != 0 {
                let sample = at * 64 + left.trailing_zeros() as usize;
                sum += weights.get(sample).copied().unwrap_or(0.0);
                left &= left - 1;
            }
        }
        sum
    }

    pub(super) fn contains(&self, sample: usize) -> bool {
        self.words
            .get(sample / 64)
            .is_some_and(|word| word >> (sample % 64) & 1 == 1)
    }
}

/// A straight line between two marks that ink speaks for.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// How unlikely it is that this ink was meant as one straight line.
    pub(super) cost: f32,
    /// All ink that the line explains, what passes by its ends included.
    pub(super) ink: Samples,
    /// The ink along the line where something must be drawn, away from its ends.
    pub(super) inner: Samples,
    /// The length of that ink,
    pub(super) drawn: f32,
    /// and of that part of the line.
    pub(super) needed: f32,
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
    let is_free = |bin: usize| {
        let along = (bin as f32 + 0.5) / bins * length;
        along < near_end || along > length - near_end.max(1.1 * inside)
    };
    let mut found = Line {
        cost: 0.0,
        ink: Samples::NONE,
        inner: Samples::NONE,
        drawn: 0.0,
        needed: 0.0,
    };
    let mut reached = vec![false; bins as usize];
    let (mut squares, mut weight) = (0.0, 0.0);
    for (sample, &p) in ink.samples.iter().enumerate() {
        if head.is_some_and(|head| head.samples.contains(&sample)) {
            found.ink.insert(sample);
            continue;
        }
        let (along, beside) = (direction.dot(p - from), direction.perp_dot(p - from));
        if beside.abs() > width.max(near_end) || along < -near_end || along > length + near_end {
            continue;
        }
        let here = marks.weights[sample];
        let is_inner = (0.0..=length).contains(&along) && beside.abs() <= width;
        if is_inner && marks.tangents[sample].dot(direction).abs() >= MIN_ALIGNMENT {
            found.ink.insert(sample);
            if !is_free(bin_of(along)) {
                found.inner.insert(sample);
                found.drawn += here;
            }
            reached[bin_of(along - 0.75 * here)..=bin_of(along + 0.75 * here)].fill(true);
            squares += here * beside * beside;
            weight += here;
        } else if p.distance(from).min(p.distance(to)) <= near_end {
            found.ink.insert(sample);
        }
    }
    let needed = (0..reached.len()).filter(|&bin| !is_free(bin));
    let undrawn = needed.clone().filter(|&bin| !reached[bin]).count();
    found.needed = needed.count() as f32 / bins * length;
    let gap = undrawn as f32 / bins * length;
    if gap > MAX_GAP * length || (weight <= 0.0 && head.is_none()) {
        return None;
    }
    let sigma = STRAIGHTNESS * unit + BOW * length;
    let independent = 1.0 + length / (CORRELATION * unit);
    let bend = 0.5 * independent * squares / weight.max(f32::MIN_POSITIVE) / (sigma * sigma);
    found.cost = bend + GAP_COST * gap / unit;
    Some(found)
}
