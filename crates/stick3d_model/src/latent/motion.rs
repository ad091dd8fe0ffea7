//! A path with everything that playing it needs: how far it is to be trusted, and where the figure stands.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::extrapolation::Extrapolation;
use super::grounding::GroundTrack;
use super::path::{Interpolation, LatentKey, LatentPath, Place};
use super::{PathError, Repeat};
use crate::infer::Inference;

/// The farthest horizon, in units of the distance between the last two keys.
const FARTHEST: f32 = 8.0;
/// The first step of the search for a horizon, and how its steps grow.
const FIRST_STEP: f32 = 0.125;
const GROWTH: f32 = 0.25;
/// Halvings of the step in which trust was lost.
const HALVINGS: usize = 5;

/// How keys become a motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MotionSettings {
    /// What is between two keys.
    pub interpolation: Interpolation,
    /// What comes after the last key.
    pub repeat: Repeat,
    /// What is beyond the first and the last key of a motion that does not repeat.
    pub extrapolation: Extrapolation,
    /// Whether the figure stands on the ground, and walks on it.
    pub grounded: bool,
}

impl Default for MotionSettings {
    fn default() -> Self {
        Self {
            interpolation: Interpolation::default(),
            repeat: Repeat::default(),
            extrapolation: Extrapolation::default(),
            grounded: true,
        }
    }
}

/// A motion of one figure, ready to play.
///
/// Making one decodes some dozens of bodies; after that, everything is a pure function of time and allocates nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    path: LatentPath,
    /// Place on the path and trust there, by rising place.
    trust: Vec<(Place, f32)>,
    ground: Option<GroundTrack>,
}

impl Motion {
    /// The motion through keys.
    ///
    /// # Errors
    /// [`PathError`], for the first key at fault or for settings that are out of range.
    pub fn new(
        keys: &[LatentKey],
        settings: MotionSettings,
        inference: &mut Inference,
    ) -> Result<Self, PathError> {
        let MotionSettings {
            interpolation,
            repeat,
            extrapolation,
            grounded,
        } = settings;
        let mut path = LatentPath::new(keys, interpolation, repeat)?;
        let expected = inference.latent_len();
        if path.latent_len() != expected {
            return Err(PathError::LatentLength {
                key: 1,
                expected,
                found: path.latent_len(),
            });
        }
        let least_trust = extrapolation.least_trust()?;
        let mut surveyor = Surveyor::new(&path, inference)?;
        let mut trust = vec![];
        let mut horizons = [0.0; 2];
        let goes_on = repeat == Repeat::Once && extrapolation != Extrapolation::Hold;
        if goes_on {
            let (horizon, survey) = surveyor.survey_end(|u| -u, least_trust)?;
            horizons[0] = horizon;
            trust.extend(survey.into_iter().rev());
        }
        trust.extend(surveyor.survey_keys()?);
        if goes_on {
            let last = path.segment_count() as f32;
            let (horizon, survey) = surveyor.survey_end(|u| last + u, least_trust)?;
            horizons[1] = horizon;
            trust.extend(survey);
        }
        if goes_on && extrapolation == Extrapolation::Unbounded {
            horizons = [f32::INFINITY; 2];
        }
        path.set_ends(extrapolation, horizons);
        let ground = grounded
            .then(|| GroundTrack::along(&path, inference))
            .transpose()?;
        Ok(Self {
            path,
            trust,
            ground,
        })
    }

    /// The path through latent space.
    #[must_use]
    pub fn path(&self) -> &LatentPath {
        &self.path
    }

    /// Writes the latent at a time.
    ///
    /// # Errors
    /// As [`LatentPath::sample_into`].
    pub fn sample_into(&self, time_s: f32, latent: &mut [f32]) -> Result<(), PathError> {
        self.path.sample_into(time_s, latent)
    }

    /// Where the root joint is at a time, metres: x and z from where it is at the first key, y above the ground. `None` for
    /// a motion that is not grounded, and for a time that is not finite.
    ///
    /// A decoded body has its root joint at the origin; add this to its transform. Loops go on from where they came to.
    #[must_use]
    pub fn root_translation(&self, time_s: f32) -> Option<Vec3> {
        let ground = self.ground.as_ref().filter(|_| time_s.is_finite())?;
        let (path_s, rounds) = self.path.course().place(time_s);
        Some(ground.translation(path_s, rounds))
    }

    /// How high the lowest point of the body is above the ground at a time, metres: 0 but while a runner flies. `None` as for
    /// [`Motion::root_translation`], whose height it is part of.
    #[must_use]
    pub fn lift_m(&self, time_s: f32) -> Option<f32> {
        let ground = self.ground.as_ref().filter(|_| time_s.is_finite())?;
        Some(ground.lift_m(self.path.course().place(time_s).0))
    }

    /// How far the body at a time is to be trusted, between 0 and 1; see [`Trust::value`](super::Trust::value). Edges may be
    /// as long as in the keys. For a time that is not finite, 0.
    #[must_use]
    pub fn trust(&self, time_s: f32) -> f32 {
        if !time_s.is_finite() {
            return 0.0;
        }
        let place = self.path.place(self.path.course().place(time_s).0);
        let after = self.trust.partition_point(|(at, _)| *at <= place);
        match (after.checked_sub(1), self.trust.get(after)) {
            (Some(before), Some((to, next))) => {
                let (from, trust) = self.trust[before];
                trust + (next - trust) * (place - from) / (to - from)
            }
            (None, Some((_, trust))) => *trust,
            (Some(before), None) => self.trust[before].1,
            (None, None) => 0.0,
        }
    }

    /// Whether a time is beyond the keys: extrapolated.
    #[must_use]
    pub fn is_beyond(&self, time_s: f32) -> bool {
        let place = self.path.place(self.path.course().place(time_s).0);
        !(0.0..=self.path.segment_count() as f32).contains(&place)
    }
}

/// Measures trust along a path that goes on for ever.
struct Surveyor<'a> {
    path: LatentPath,
    inference: &'a mut Inference,
    longest: super::LongestEdges,
    latent: Vec<f32>,
}

impl<'a> Surveyor<'a> {
    fn new(path: &LatentPath, inference: &'a mut Inference) -> Result<Self, PathError> {
        let path = path.clone();
        let keys = (0..path.key_count()).map(|key| path.knot(key));
        let longest = inference.longest_edges(keys)?;
        Ok(Self {
            latent: vec![0.0; path.latent_len()],
            path,
            inference,
            longest,
        })
    }

    fn trust(&mut self, place: Place) -> Result<f32, PathError> {
        self.path.write_at(place, &mut self.latent);
        let trust = self
            .inference
            .trust_beside(&self.latent, Some(&self.longest))?;
        Ok(trust.value())
    }

    /// At the keys and half way between them.
    fn survey_keys(&mut self) -> Result<Vec<(Place, f32)>, PathError> {
        (0..=2 * self.path.segment_count())
            .map(|half| 0.5 * half as f32)
            .map(|place| Ok((place, self.trust(place)?)))
            .collect()
    }

    /// The horizon of an end, and the trust on the way to it by rising distance; `place` is where a distance is. Without a
    /// least trust, as far as the search goes.
    fn survey_end(
        &mut self,
        place: impl Fn(f32) -> f32,
        least_trust: Option<f32>,
    ) -> Result<(f32, Vec<(Place, f32)>), PathError> {
        let mut survey = vec![];
        let mut distance = 0.0;
        while distance < FARTHEST {
            let next = (distance + (GROWTH * distance).max(FIRST_STEP)).min(FARTHEST);
            let trust = self.trust(place(next))?;
            if least_trust.is_some_and(|least| trust < least) {
                let horizon = self.halve([distance, next], &place, least_trust)?;
                if horizon > distance {
                    survey.push((place(horizon), self.trust(place(horizon))?));
                }
                survey.push((place(next), trust));
                return Ok((horizon, survey));
            }
            survey.push((place(next), trust));
            distance = next;
        }
        Ok((FARTHEST, survey))
    }

    /// Where trust falls to the least between two distances: the nearer side of it.
    fn halve(
        &mut self,
        [mut near, mut far]: [f32; 2],
        place: &impl Fn(f32) -> f32,
        least_trust: Option<f32>,
    ) -> Result<f32, PathError> {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            let trust = self.trust(place(middle))?;
            if least_trust.is_some_and(|least| trust < least) {
                far = middle;
            } else {
                near = middle;
            }
        }
        Ok(near)
    }
}

#[cfg(test)]
mod tests;
