//! Where a moving figure stands: on the ground, on the feet that are down.
//!
//! Decoded bodies are centred on the root joint. What moves them over the ground is that a foot which is down stays
//! where it is: the root moves against it. A foot is down between two keys if it is down in both.

use glam::{Vec2, Vec3};
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::Sketch;

use super::PathError;
use super::path::LatentPath;
use crate::infer::Inference;

/// A foot is down whose height above where it is at rest is at most this share of the body's height.
const DOWN: f32 = 0.045;
/// Of several feet down, those that are higher than the lowest by this share of the body's height carry nothing.
const BESIDE: f32 = 0.015;
/// Two feet that slip against each other by more than this share of the body's height cannot both stay.
const SLIP: f32 = 0.1;
/// An end of a bone of the template this near to the ground, as a share of the template's height, is a foot.
const FOOT: f32 = 0.15;

/// Steps of the table a second, and the fewest and the most between two knots.
const STEPS_PER_S: f32 = 40.0;
const STEPS: [usize; 2] = [8, 48];
/// How many intervals beyond its ends an endless path is followed; farther, the figure moves on the spot.
const ENDLESS_INTERVALS: f32 = 8.0;

/// The joints that a figure stands on: the ends of its bones that are lowest in its template.
#[must_use]
pub fn feet(figure: &Figure) -> Vec<usize> {
    let heights = || figure.template.iter().map(|point| point.y);
    let lowest = heights().fold(f32::INFINITY, f32::min);
    let highest = heights().fold(f32::NEG_INFINITY, f32::max);
    let is_end = |joint: &usize| {
        figure
            .bones
            .as_flattened()
            .iter()
            .filter(|b| *b == joint)
            .count()
            == 1
    };
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
    /// How far a loop comes in one round, metres.
    per_round: Vec3,
}

impl GroundTrack {
    /// Follows a path.
    pub(super) fn along(path: &LatentPath, inference: &mut Inference) -> Result<Self, PathError> {
        let feet = feet(inference.figure());
        let stance = Stance::of_template(inference, &feet)?;
        let (times_s, intervals) = times(path);
        let mut steps = Vec::with_capacity(times_s.len());
        let mut latent = vec![0.0; path.latent_len()];
        for time_s in &times_s {
            path.write_at(path.place(*time_s), &mut latent);
            steps.push(Step::of(&latent, inference, &feet)?);
        }
        let horizontal = horizontal_velocities(&steps, &times_s, &intervals, &stance);
        let first_key = path.knot_time_s(0);
        Ok(Self::new(times_s, &steps, &horizontal, first_key))
    }

    /// Adds up velocities, so that the first key is above the origin.
    fn new(times_s: Vec<f32>, steps: &[Step], velocities: &[Vec2], origin_s: f32) -> Self {
        let mut at = Vec2::ZERO;
        let mut translations = Vec::with_capacity(steps.len());
        for (index, step) in steps.iter().enumerate() {
            if let Some(before) = index.checked_sub(1) {
                at += velocities[before] * (times_s[index] - times_s[before]);
            }
            translations.push(Vec3::new(at.x, -step.lowest_m, at.y));
        }
        let mut track = Self {
            times_s,
            translations,
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

    fn at(&self, path_s: f32) -> Vec3 {
        let after = self.times_s.partition_point(|t| *t <= path_s);
        let last = self.times_s.len().saturating_sub(1);
        let (before, after) = (after.saturating_sub(1), after.min(last));
        let span = self.times_s[after] - self.times_s[before];
        if span <= 0.0 {
            return self.translations[before];
        }
        let share = ((path_s - self.times_s[before]) / span).clamp(0.0, 1.0);
        self.translations[before].lerp(self.translations[after], share)
    }
}

/// A stretch of the table between two knots, or beyond the last one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Interval {
    first_step: usize,
    last_step: usize,
    /// The steps at the keys whose feet decide; the same twice beyond the ends.
    keys: [usize; 2],
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

/// What is known of a body at one time.
#[derive(Debug, Clone, PartialEq)]
struct Step {
    feet: Vec<Vec3>,
    lowest_m: f32,
}

impl Step {
    fn of(latent: &[f32], inference: &mut Inference, feet: &[usize]) -> Result<Self, PathError> {
        let mut joints = vec![Vec3::ZERO; inference.figure().joint_count()];
        inference.joints(latent, &mut joints)?;
        Ok(Self {
            feet: feet.iter().map(|joint| joints[*joint]).collect(),
            lowest_m: inference.lowest_m(latent)?,
        })
    }
}

/// How the feet stand when the figure is at rest.
#[derive(Debug, Clone, PartialEq)]
struct Stance {
    /// Of the foot's joint above the ground, metres.
    rest_m: Vec<f32>,
    /// Of the body, metres.
    height_m: f32,
}

impl Stance {
    fn of_template(inference: &mut Inference, feet: &[usize]) -> Result<Self, PathError> {
        let sketch = Sketch::template(inference.figure());
        let mut latent = vec![0.0; inference.latent_len()];
        inference.encode(&sketch, &mut latent)?;
        let step = Step::of(&latent, inference, feet)?;
        let mut joints = vec![Vec3::ZERO; inference.figure().joint_count()];
        inference.joints(&latent, &mut joints)?;
        let top = joints.iter().map(|j| j.y).fold(f32::NEG_INFINITY, f32::max);
        Ok(Self {
            rest_m: step
                .feet
                .iter()
                .map(|foot| foot.y - step.lowest_m)
                .collect(),
            height_m: (top - step.lowest_m).max(f32::MIN_POSITIVE),
        })
    }

    /// How far each foot is above where it is at rest, as a share of the body's height.
    fn heights<'a>(&'a self, step: &'a Step) -> impl Iterator<Item = f32> + 'a {
        step.feet
            .iter()
            .zip(&self.rest_m)
            .map(|(foot, rest_m)| (foot.y - step.lowest_m - rest_m) / self.height_m)
    }
}

/// How fast the root moves over the ground in every step, metres a second, x and z.
fn horizontal_velocities(
    steps: &[Step],
    times_s: &[f32],
    intervals: &[Interval],
    stance: &Stance,
) -> Vec<Vec2> {
    let mut velocities: Vec<Option<Vec2>> = vec![None; steps.len().saturating_sub(1)];
    for interval in intervals {
        let planted = planted_feet(steps, *interval, stance);
        for step in interval.first_step..interval.last_step {
            let moved = slip(&steps[step], &steps[step + 1], &planted, stance);
            velocities[step] = moved.map(|moved| -moved / (times_s[step + 1] - times_s[step]));
        }
    }
    fill_flights(&velocities)
}

/// The feet that are down in both keys of an interval; only the lowest of them where they do not stay together.
fn planted_feet(steps: &[Step], interval: Interval, stance: &Stance) -> Vec<usize> {
    let down =
        |step: usize| -> Vec<bool> { stance.heights(&steps[step]).map(|h| h <= DOWN).collect() };
    let [from, to] = interval.keys.map(down);
    let mut feet: Vec<usize> = (0..from.len()).filter(|f| from[*f] && to[*f]).collect();
    let (first, last) = (&steps[interval.first_step], &steps[interval.last_step]);
    let apart = |step: &Step, a: usize, b: usize| flat(step.feet[a] - step.feet[b]);
    let slips = feet.iter().any(|&foot| {
        apart(first, feet[0], foot).distance(apart(last, feet[0], foot)) > SLIP * stance.height_m
    });
    if slips {
        let mean_height = |foot: usize| -> f32 {
            let heights = steps[interval.first_step..=interval.last_step].iter();
            heights
                .filter_map(|step| stance.heights(step).nth(foot))
                .sum()
        };
        let lowest = feet
            .iter()
            .copied()
            .min_by(|a, b| mean_height(*a).total_cmp(&mean_height(*b)));
        feet = lowest.into_iter().collect();
    }
    feet
}

/// By how much the planted feet move between two steps, against the root; `None` while all of them are up.
fn slip(from: &Step, to: &Step, planted: &[usize], stance: &Stance) -> Option<Vec2> {
    let heights: Vec<f32> = stance
        .heights(from)
        .zip(stance.heights(to))
        .map(|(a, b)| 0.5 * (a + b))
        .collect();
    let lowest = planted
        .iter()
        .map(|foot| heights[*foot])
        .fold(f32::INFINITY, f32::min);
    if lowest > 2.0 * DOWN {
        return None;
    }
    let (mut sum, mut weights) = (Vec2::ZERO, 0.0);
    for &foot in planted {
        let weight = (1.0 - (heights[foot] - lowest) / BESIDE).max(0.0).powi(2);
        sum += weight * flat(to.feet[foot] - from.feet[foot]);
        weights += weight;
    }
    (weights > 0.0).then(|| sum / weights)
}

/// While no foot is down the body flies on: its speed goes evenly from what it was to what it will be.
fn fill_flights(velocities: &[Option<Vec2>]) -> Vec<Vec2> {
    let mut filled: Vec<Vec2> = velocities.iter().map(|v| v.unwrap_or_default()).collect();
    let mut step = 0;
    while step < velocities.len() {
        if velocities[step].is_some() {
            step += 1;
            continue;
        }
        let until = (step..velocities.len()).find(|i| velocities[*i].is_some());
        let end = until.unwrap_or(velocities.len());
        let before = mean_of(velocities[..step].iter().rev());
        let after = mean_of(velocities[end..].iter());
        let (from, to) = match (before, after) {
            (Some(before), Some(after)) => (before, after),
            (Some(only), None) | (None, Some(only)) => (only, only),
            (None, None) => (Vec2::ZERO, Vec2::ZERO),
        };
        let count = (end - step + 1) as f32;
        for (index, slot) in filled[step..end].iter_mut().enumerate() {
            *slot = from.lerp(to, (index + 1) as f32 / count);
        }
        step = end;
    }
    filled
}

/// The mean over the next few steps with a foot down.
fn mean_of<'a>(velocities: impl Iterator<Item = &'a Option<Vec2>>) -> Option<Vec2> {
    let near: Vec<Vec2> = velocities.map_while(|v| *v).take(4).collect();
    (!near.is_empty()).then(|| near.iter().sum::<Vec2>() / near.len() as f32)
}

fn flat(v: Vec3) -> Vec2 {
    Vec2::new(v.x, v.z)
}

#[cfg(test)]
mod tests;
