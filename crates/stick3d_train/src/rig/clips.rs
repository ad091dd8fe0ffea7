//! Motions that come with a rig.

use glam::{Quat, Vec3};

use super::Pose;

/// A motion: poses at ascending times.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// Its name in the file.
    pub name: String,
    /// When each pose is reached, seconds, ascending, the first 0.
    pub times_s: Vec<f32>,
    /// One pose per time; in between rotations turn the short way round.
    pub poses: Vec<Pose>,
}

impl Clip {
    /// How long it takes, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f32 {
        self.times_s.last().copied().unwrap_or(0.0)
    }

    /// The pose at a time, seconds from the beginning; before it the first, past the end the last.
    ///
    /// `None` for a clip without poses.
    #[must_use]
    pub fn sample(&self, time_s: f32) -> Option<Pose> {
        let after = self.times_s.partition_point(|&time| time <= time_s);
        let (before, after) = (after.saturating_sub(1), after.min(self.poses.len() - 1));
        let (first, second) = (self.poses.get(before)?, self.poses.get(after)?);
        let span = self.times_s[after] - self.times_s[before];
        let part = if span > 0.0 {
            ((time_s - self.times_s[before]) / span).clamp(0.0, 1.0)
        } else {
            0.0
        };
        Some(between(first, second, part))
    }

    /// `count` poses evenly spread over the clip, from its beginning on; the end, which in a walk is the
    /// beginning again, is left out.
    #[must_use]
    pub fn spread(&self, count: usize) -> Vec<Pose> {
        let step = self.duration_s() / count.max(1) as f32;
        (0..count)
            .filter_map(|number| self.sample(step * number as f32))
            .collect()
    }
}

fn between(first: &Pose, second: &Pose, part: f32) -> Pose {
    let rotations = first.rotations.iter().zip(&second.rotations);
    Pose {
        rotations: rotations.map(|(a, b)| short_way(*a, *b, part)).collect(),
        root_translation: first.root_translation.lerp(second.root_translation, part),
    }
}

/// Spherical interpolation along the shorter arc.
pub(super) fn short_way(from: Quat, to: Quat, part: f32) -> Quat {
    if part <= 0.0 {
        return from;
    }
    if part >= 1.0 {
        return to;
    }
    from.slerp(to, part).normalize()
}

/// Where every joint of the skin stands at one time: (whole rotation against the rest, head).
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub(super) time_s: f32,
    pub(super) joints: Vec<(Quat, Vec3)>,
}

/// A motion before the bones' order is known.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub(super) name: String,
    pub(super) frames: Vec<Frame>,
}
