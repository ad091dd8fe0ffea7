//! Paths through latent space: keys, and what is between and beyond them.

use super::course::{Course, Repeat};
use super::extrapolation::{End, Extrapolation};
use super::{Easing, PathError};

use serde::{Deserialize, Serialize};

/// The largest number that a key's latent may have: far beyond any body.
const LARGEST: f32 = 1e9;

/// A pose that a path meets at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct LatentKey {
    /// The pose.
    pub latent: Vec<f32>,
    /// When, seconds.
    pub time_s: f32,
    /// How time passes from here to the next key.
    pub easing: Easing,
}

/// What is between two keys.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Interpolation {
    /// The straight line (paper section 5.3).
    #[default]
    Linear,
    /// A cubic through all keys without a kink in time where easings are [`Easing::Linear`]. It never leaves the straight
    /// line between two keys by more than a quarter of their distance.
    Cubic,
}

/// A path through latent space that meets its keys exactly.
///
/// Sampling is a pure function of time and allocates nothing, so seeking costs what playing costs.
#[derive(Debug, Clone, PartialEq)]
pub struct LatentPath {
    latent_len: usize,
    /// Times of the knots: those of the keys, and of the first key again where a loop closes.
    times_s: Vec<f32>,
    /// `[knot][latent_len]`.
    latents: Vec<f32>,
    /// `[knot][latent_len]`, per second; empty for straight lines.
    tangents: Vec<f32>,
    /// One per segment between two knots.
    easings: Vec<Easing>,
    key_count: usize,
    repeat: Repeat,
    interpolation: Interpolation,
    extrapolation: Extrapolation,
    ends: [End; 2],
    course: Course,
}

/// A place on a path: the number of a knot and the share of the way to the next one; below the first and above the last
/// knot in units of the distance between the last two.
pub(super) type Place = f32;

impl LatentPath {
    /// A path through keys that holds its first and its last pose outside of them; see
    /// [`LatentPath::unbounded`] and [`Motion`](super::Motion) for what goes on beyond.
    ///
    /// # Errors
    /// [`PathError`], for the first key at fault.
    pub fn new(
        keys: &[LatentKey],
        interpolation: Interpolation,
        repeat: Repeat,
    ) -> Result<Self, PathError> {
        check(keys)?;
        let (first, last) = (&keys[0], &keys[keys.len() - 1]);
        let mut times_s: Vec<f32> = keys.iter().map(|key| key.time_s).collect();
        let mut latents: Vec<f32> = keys.iter().flat_map(|key| &key.latent).copied().collect();
        let mut easings: Vec<Easing> = keys.iter().map(|key| key.easing).collect();
        if let Some(closing_s) = closing_time(keys, repeat)? {
            times_s.push(last.time_s + closing_s);
            latents.extend(&first.latent);
        } else {
            easings.pop();
        }
        let mut path = Self {
            latent_len: first.latent.len(),
            times_s,
            latents,
            tangents: vec![],
            easings,
            key_count: keys.len(),
            repeat,
            interpolation,
            extrapolation: Extrapolation::Hold,
            ends: [End::default(); 2],
            course: Course::Clamped {
                start_s: 0.0,
                end_s: 0.0,
            },
        };
        if interpolation == Interpolation::Cubic {
            path.tangents = path.tangents();
        }
        path.set_ends(Extrapolation::Hold, [0.0; 2]);
        Ok(path)
    }

    /// The path with the straight lines of the paper (section 5.4) beyond its first and its last key, which never end. A
    /// path that [repeats](Repeat) has nothing beyond its keys.
    #[must_use]
    pub fn unbounded(mut self) -> Self {
        self.set_ends(Extrapolation::Unbounded, [f32::INFINITY; 2]);
        self
    }

    /// Sets how far the path goes beyond its ends, in units of the distance between the last two keys.
    pub(super) fn set_ends(&mut self, extrapolation: Extrapolation, horizons: [f32; 2]) {
        let (first, last) = (self.times_s[0], self.times_s[self.times_s.len() - 1]);
        let (start_s, end_s) = (first, last);
        self.extrapolation = extrapolation;
        self.course = match self.repeat {
            Repeat::Loop { .. } => Course::Round { start_s, end_s },
            Repeat::PingPong => Course::BackAndForth { start_s, end_s },
            Repeat::Once => {
                let segments = self.segment_count();
                let end = |segment: usize, slope: usize, horizon: f32| End {
                    interval_s: self.times_s[segment + 1] - self.times_s[segment],
                    slope: self.easings[segment].end_slopes()[slope],
                    horizon,
                };
                self.ends = [end(0, 0, horizons[0]), end(segments - 1, 1, horizons[1])];
                let start_s = first - self.ends[0].duration_s();
                let end_s = last + self.ends[1].duration_s();
                match extrapolation {
                    Extrapolation::PingPong { .. } => Course::BackAndForth { start_s, end_s },
                    _ => Course::Clamped { start_s, end_s },
                }
            }
        };
    }

    /// Writes the latent at a time.
    ///
    /// # Errors
    /// [`PathError::Buffer`], [`PathError::Time`] for NaN or infinity.
    pub fn sample_into(&self, time_s: f32, latent: &mut [f32]) -> Result<(), PathError> {
        if latent.len() != self.latent_len {
            return Err(PathError::Buffer {
                expected: self.latent_len,
                found: latent.len(),
            });
        }
        if !time_s.is_finite() {
            return Err(PathError::Time { time_s });
        }
        self.write_at(self.place(self.course.place(time_s).0), latent);
        Ok(())
    }

    /// The place at a time of the path itself, repetition undone.
    pub(super) fn place(&self, path_s: f32) -> Place {
        let (knots, segments) = (&self.times_s, self.segment_count());
        if path_s < knots[0] {
            return -self.ends[0].distance(knots[0] - path_s);
        }
        if path_s > knots[segments] {
            return segments as f32 + self.ends[1].distance(path_s - knots[segments]);
        }
        let segment = knots.partition_point(|knot| *knot <= path_s);
        let segment = (segment - 1).min(segments - 1);
        let t = (path_s - knots[segment]) / (knots[segment + 1] - knots[segment]);
        segment as f32 + self.easings[segment].apply(t)
    }

    /// Writes the latent at a place; `latent` has the path's length.
    pub(super) fn write_at(&self, place: Place, latent: &mut [f32]) {
        let segments = self.segment_count();
        let segment = (place.floor().max(0.0) as usize).min(segments - 1);
        let t = place - segment as f32;
        let (a, b) = (self.knot(segment), self.knot(segment + 1));
        if self.tangents.is_empty() || !(0.0..=1.0).contains(&t) {
            // So written, both keys are met exactly.
            for ((out, a), b) in latent.iter_mut().zip(a).zip(b) {
                *out = (1.0 - t) * a + t * b;
            }
            return;
        }
        let interval_s = self.times_s[segment + 1] - self.times_s[segment];
        let tangent = |knot: usize| &self.tangents[knot * self.latent_len..][..self.latent_len];
        let to = t * t * (3.0 - 2.0 * t);
        let leave = interval_s * t * (1.0 - t) * (1.0 - t);
        let arrive = -interval_s * t * t * (1.0 - t);
        let knots = a.iter().zip(b);
        let tangents = tangent(segment).iter().zip(tangent(segment + 1));
        for ((out, (a, b)), (m, n)) in latent.iter_mut().zip(knots).zip(tangents) {
            *out = (1.0 - to) * a + to * b + leave * m + arrive * n;
        }
    }

    /// The velocity of the path at every knot, `[knot][latent_len]`, per second.
    fn tangents(&self) -> Vec<f32> {
        let segments = self.segment_count();
        let slope = |segment: usize| -> Vec<f32> {
            let interval_s = self.times_s[segment + 1] - self.times_s[segment];
            let ends = self.knot(segment).iter().zip(self.knot(segment + 1));
            ends.map(|(a, b)| (b - a) / interval_s).collect()
        };
        let interval = |segment: usize| self.times_s[segment + 1] - self.times_s[segment];
        let between = |before: usize, after: usize| {
            mean_slope(
                (&slope(before), interval(before)),
                (&slope(after), interval(after)),
            )
        };
        let still = || vec![0.0; self.latent_len];
        let (first, last) = match self.repeat {
            Repeat::Once => (slope(0), slope(segments - 1)),
            // It turns back there.
            Repeat::PingPong => (still(), still()),
            Repeat::Loop { .. } => (between(segments - 1, 0), between(segments - 1, 0)),
        };
        let inner = (1..segments).flat_map(|knot| between(knot - 1, knot));
        first.into_iter().chain(inner).chain(last).collect()
    }

    /// The latent of a knot.
    pub(super) fn knot(&self, knot: usize) -> &[f32] {
        &self.latents[knot * self.latent_len..][..self.latent_len]
    }

    /// The time of a knot, seconds.
    pub(super) fn knot_time_s(&self, knot: usize) -> f32 {
        self.times_s[knot]
    }

    /// How many segments there are between knots; at least one.
    pub(super) fn segment_count(&self) -> usize {
        self.times_s.len() - 1
    }

    /// How the clock's time runs along the path.
    pub(super) fn course(&self) -> Course {
        self.course
    }

    /// Length of its latents.
    #[must_use]
    pub fn latent_len(&self) -> usize {
        self.latent_len
    }

    /// How many keys it has.
    #[must_use]
    pub fn key_count(&self) -> usize {
        self.key_count
    }

    /// The latent of a key, counted from 0.
    #[must_use]
    pub fn key_latent(&self, key: usize) -> Option<&[f32]> {
        (key < self.key_count).then(|| self.knot(key))
    }

    /// The times of the keys, seconds.
    #[must_use]
    pub fn key_times_s(&self) -> &[f32] {
        &self.times_s[..self.key_count]
    }

    /// From the first key to the last, or, for a loop, to the first key again, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f32 {
        self.times_s[self.segment_count()] - self.times_s[0]
    }

    /// When it comes to rest before its first and after its last key, seconds; infinite where it never does. A path that
    /// repeats, or turns back, returns where its round begins and ends.
    #[must_use]
    pub fn range_s(&self) -> (f32, f32) {
        self.course.range_s()
    }

    /// What comes after the last key.
    #[must_use]
    pub fn repeat(&self) -> Repeat {
        self.repeat
    }

    /// What is between two keys.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// What is beyond the keys.
    #[must_use]
    pub fn extrapolation(&self) -> Extrapolation {
        self.extrapolation
    }

    /// How far the path goes before its first and after its last key, in units of the distance between the last two keys.
    #[must_use]
    pub fn horizons(&self) -> [f32; 2] {
        self.ends.map(|end| end.horizon)
    }
}

fn check(keys: &[LatentKey]) -> Result<(), PathError> {
    if keys.len() < 2 {
        return Err(PathError::TooFewKeys { found: keys.len() });
    }
    let expected = keys[0].latent.len();
    for (index, LatentKey { latent, time_s, .. }) in keys.iter().enumerate() {
        let (key, time_s) = (index + 1, *time_s);
        if !time_s.is_finite() {
            return Err(PathError::KeyTime { key, time_s });
        }
        if latent.len() != expected || expected == 0 {
            let (expected, found) = (expected.max(1), latent.len());
            return Err(PathError::LatentLength {
                key,
                expected,
                found,
            });
        }
        if let Some(index) = latent.iter().position(|x| x.is_nan() || x.abs() > LARGEST) {
            return Err(PathError::NotFinite { key, index });
        }
        let Some(before) = index.checked_sub(1).map(|before| &keys[before]) else {
            continue;
        };
        if time_s == before.time_s {
            return Err(PathError::EqualTimes { key, time_s });
        }
        if time_s < before.time_s {
            let before_s = before.time_s;
            return Err(PathError::OutOfOrder {
                key,
                time_s,
                before_s,
            });
        }
    }
    Ok(())
}

/// How long the way from the last key to the first takes, where there is one.
fn closing_time(keys: &[LatentKey], repeat: Repeat) -> Result<Option<f32>, PathError> {
    let Repeat::Loop { closing_s } = repeat else {
        return Ok(None);
    };
    let (first, last) = (&keys[0], &keys[keys.len() - 1]);
    let mean = (last.time_s - first.time_s) / (keys.len() - 1) as f32;
    let closing_s = closing_s.unwrap_or(mean);
    // Below this share of the loop, single precision could not tell the two times apart.
    let least = 1e-4 * (last.time_s - first.time_s);
    if !(closing_s.is_finite() && closing_s > least) {
        return Err(PathError::ClosingTime { closing_s });
    }
    Ok((first.latent != last.latent).then_some(closing_s))
}

/// The slope at a knot between two segments: of the parabola through the three knots, no steeper than the flatter
/// segment. That keeps a cubic within a quarter of its keys' distance from the straight line: the part of it that is not on
/// the line is `h (t (1 - t)² m - t² (1 - t) n)`, and `|m|, |n| <= distance / h`.
fn mean_slope((before, before_s): (&[f32], f32), (after, after_s): (&[f32], f32)) -> Vec<f32> {
    let norm = |v: &[f32]| v.iter().map(|x| x * x).sum::<f32>().sqrt();
    let mut slope: Vec<f32> = before
        .iter()
        .zip(after)
        .map(|(b, a)| (after_s * b + before_s * a) / (before_s + after_s))
        .collect();
    let (length, most) = (norm(&slope), norm(before).min(norm(after)));
    if length > most {
        slope.iter_mut().for_each(|x| *x *= most / length);
    }
    slope
}

#[cfg(test)]
mod tests;
