//! Where a moving figure stands: on the ground, on the feet that are down.
//!
//! Decoded bodies are centred on the root joint. What moves them over the ground is that what treads on the ground stays
//! where it is: the root moves against it. A foot is down between two keys if it is down in both. A runner whose feet are all
//! up flies; all others have their lowest point on the ground.

mod contact;
mod flight;

use glam::{Vec2, Vec3};
use stick3d_figure::figure::Figure;

use super::path::LatentPath;
use super::{PathError, Repeat};
use crate::infer::Inference;
use contact::{Interval, Stance, horizontal_velocities};

/// An end of a bone of the template this near to the ground, as a share of the template's height, is a foot.
const FOOT: f32 = 0.15;

/// Steps of the table a second, and the fewest and the most between two knots.
const STEPS_PER_S: f32 = 40.0;
const STEPS: [usize; 2] = [8, 32];
/// How many intervals beyond its ends an endless path is followed; farther, the figure moves on the spot.
const ENDLESS_INTERVALS: f32 = 8.0;

/// The joints that a figure stands on: the ends of its bones that are lowest in its template.
#[must_use]
pub fn feet(figure: &Figure) -> Vec<usize> {
    let heights = || figure.template.iter().map(|point| point.y);
    let lowest = heights().fold(f32::INFINITY, f32::min);
    let highest = heights().fold(f32::NEG_INFINITY, f32::max);
    let is_end = |joint: &usize| figure.bones_at(*joint) == 1;
    let is_low = |joint: &usize| figure.template[*joint].y - lowest <= FOOT * (highest - lowest);
    (0..figure.joint_count())
        .filter(is_end)
        .filter(is_low)
        .collect()
}

/// Where the root joint of a figure is while it moves along a path: a table made once.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GroundTrack {
    /// Times on the path, seconds, rising.
    times_s: Vec<f32>,
    /// Metres.
    translations: Vec<Vec3>,
    /// How high the lowest point of the body is above the ground, metres: 0 but in flight.
    lifts_m: Vec<f32>,
    /// How far a loop comes in one round, metres.
    per_round: Vec3,
}

impl GroundTrack {
    /// Follows a path.
    pub(super) fn along(path: &LatentPath, inference: &mut Inference) -> Result<Self, PathError> {
        let feet = feet(inference.figure());
        let mut positions = vec![[0.0; 3]; inference.vertex_count()];
        let stance = Stance::of_template(inference, &feet, &mut positions)?;
        let (times_s, intervals) = times(path);
        let mut steps = Vec::with_capacity(times_s.len());
        let mut latent = vec![0.0; path.latent_len()];
        for time_s in &times_s {
            path.write_at(path.place(*time_s), &mut latent);
            steps.push(stance.step(&latent, inference, &mut positions)?);
        }
        let is_loop = matches!(path.repeat(), Repeat::Loop { .. });
        let carried = horizontal_velocities(&steps, &times_s, &intervals, &stance);
        let lifts = flight::lifts(&carried, &times_s, stance.height_m, is_loop);
        let lowest_m = steps.iter().map(|step| step.lowest_m);
        let velocities = flight::filled(&carried, is_loop);
        let first_key = path.knot_time_s(0);
        Ok(Self::new(times_s, lowest_m, lifts, &velocities, first_key))
    }

    /// Adds up velocities, so that the first key is above the origin.
    fn new(
        times_s: Vec<f32>,
        lowest_m: impl Iterator<Item = f32>,
        lifts_m: Vec<f32>,
        velocities: &[Vec2],
        origin_s: f32,
    ) -> Self {
        let mut at = Vec2::ZERO;
        let mut translations = Vec::with_capacity(times_s.len());
        for (index, (lowest_m, lift_m)) in lowest_m.zip(&lifts_m).enumerate() {
            if let Some(before) = index.checked_sub(1) {
                at += velocities[before] * (times_s[index] - times_s[before]);
            }
            translations.push(Vec3::new(at.x, lift_m - lowest_m, at.y));
        }
        let mut track = Self {
            times_s,
            translations,
            lifts_m,
            per_round: Vec3::ZERO,
        };
        let start = track.at(origin_s) * Vec3::new(1.0, 0.0, 1.0);
        track.translations.iter_mut().for_each(|t| *t -= start);
        if let [first, .., last] = track.translations.as_slice() {
            track.per_round = (last - first) * Vec3::new(1.0, 0.0, 1.0);
        }
        track
    }

    /// Where the root is at a time on the path, after some rounds.
    pub(super) fn translation(&self, path_s: f32, rounds: f32) -> Vec3 {
        self.at(path_s) + rounds * self.per_round
    }

    /// How high the lowest point is above the ground at a time on the path, metres.
    pub(super) fn lift_m(&self, path_s: f32) -> f32 {
        let (before, after, share) = self.between(path_s);
        let (from, to) = (self.lifts_m[before], self.lifts_m[after]);
        from + share * (to - from)
    }

    fn at(&self, path_s: f32) -> Vec3 {
        let (before, after, share) = self.between(path_s);
        self.translations[before].lerp(self.translations[after], share)
    }

    /// The steps of the table before and after a time on the path, and the share of the way between them.
    fn between(&self, path_s: f32) -> (usize, usize, f32) {
        let after = self.times_s.partition_point(|t| *t <= path_s);
        let last = self.times_s.len().saturating_sub(1);
        let (before, after) = (after.saturating_sub(1), after.min(last));
        let span = self.times_s[after] - self.times_s[before];
        if span <= 0.0 {
            return (before, before, 0.0);
        }
        let share = (path_s - self.times_s[before]) / span;
        (before, after, share.clamp(0.0, 1.0))
    }
}

/// The times of the table, and its intervals.
fn times(path: &LatentPath) -> (Vec<f32>, Vec<Interval>) {
    let segments = path.segment_count();
    let knot = |index: usize| path.knot_time_s(index);
    let (mut start_s, mut end_s) = path.course().range_s();
    start_s = start_s.max(knot(0) - ENDLESS_INTERVALS * (knot(1) - knot(0)));
    end_s = end_s.min(knot(segments) + ENDLESS_INTERVALS * (knot(segments) - knot(segments - 1)));
    let mut times_s = vec![];
    let mut intervals = vec![];
    let mut add = |from_s: f32, to_s: f32, ends: Option<bool>| {
        if to_s <= from_s {
            return;
        }
        let count = ((to_s - from_s) * STEPS_PER_S).ceil() as usize;
        let count = count.clamp(STEPS[0], STEPS[1]);
        if times_s.is_empty() {
            times_s.push(from_s);
        }
        let first_step = times_s.len() - 1;
        let time = |i: usize| from_s + (to_s - from_s) * i as f32 / count as f32;
        times_s.extend((1..count).map(time));
        times_s.push(to_s);
        let last_step = times_s.len() - 1;
        let keys = match ends {
            None => [first_step, last_step],
            Some(true) => [last_step; 2],
            Some(false) => [first_step; 2],
        };
        intervals.push(Interval {
            first_step,
            last_step,
            keys,
        });
    };
    add(start_s, knot(0), Some(true));
    for segment in 0..segments {
        add(knot(segment), knot(segment + 1), None);
    }
    add(knot(segments), end_s, Some(false));
    (times_s, intervals)
}

#[cfg(test)]
mod tests;
