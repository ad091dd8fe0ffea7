//! New poses: natural ones from a library, free ones from the joints' limits.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::controls::{Controls, PoseValues};
use super::library::PoseLibrary;
use crate::rig::{Pose, Rig};

/// Attempts at one pose before falling back to a known good one.
const ATTEMPTS: usize = 40;
/// Share of the natural poses whose right side is made the like of the left.
const EVEN_SHARE: f64 = 0.2;
/// Share of the natural poses that are tipped as a whole, and how far: standard deviation, degrees. Bodies that fall, dive,
/// fly, bow or roll are drawn as often as they are rare.
const TIPPED_SHARE: f64 = 0.2;
const TIPPED_DEG: f32 = 30.0;
/// Share of the natural poses that stand at any angle, upside down as well.
const TUMBLED_SHARE: f64 = 0.05;

/// Which poses a [`PoseSampler`] draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleKind {
    /// Poses of the library, blended, limbs exchanged, mirrored and perturbed.
    Natural,
    /// Any angles inside the limits, mostly not far from ease.
    Free,
    /// Two natural ones for each free one, at random.
    Mixed,
}

/// Draws poses that keep inside the limits and do not run into themselves. The same seed draws the same.
#[derive(Debug, Clone)]
pub struct PoseSampler<'a> {
    controls: &'a Controls,
    poses: Vec<PoseValues>,
    random: ChaCha8Rng,
}

impl<'a> PoseSampler<'a> {
    /// A sampler over the poses of `library` (leave out there what shall be held out).
    ///
    /// `rig` is the rig that `controls` are bound to.
    pub fn new(rig: &Rig, controls: &'a Controls, library: &PoseLibrary, seed: u64) -> Self {
        debug_assert_eq!(rig.skeleton.bones.len(), controls.skeleton.bones.len());
        Self {
            controls,
            poses: library
                .poses
                .iter()
                .map(|pose| pose.values.clone())
                .collect(),
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// Draws a pose, on the ground.
    pub fn sample(&mut self, kind: SampleKind) -> Pose {
        let values = self.sample_values(kind);
        self.controls.pose(&values)
    }

    /// Draws the control values of a pose.
    pub fn sample_values(&mut self, kind: SampleKind) -> PoseValues {
        let natural = match kind {
            SampleKind::Natural => true,
            SampleKind::Free => false,
            SampleKind::Mixed => self.random.random_bool(2.0 / 3.0),
        };
        for attempt in 0..ATTEMPTS {
            // Wild draws near the limits fail most: later attempts keep closer to what is known good.
            let boldness = 1.0 - attempt as f32 / ATTEMPTS as f32;
            let mut values = if natural && !self.poses.is_empty() {
                self.natural(boldness)
            } else {
                self.free(boldness)
            };
            self.controls.clamp(&mut values);
            if self.random.random_bool(0.5) {
                values = self.controls.mirror(&values);
            }
            if self.is_free(&values) {
                return values;
            }
        }
        if natural && !self.poses.is_empty() {
            let pick = self.random.random_range(0..self.poses.len());
            self.poses[pick].clone()
        } else {
            self.controls.ease()
        }
    }

    /// A pose, every control moved at random: by `strength` times its spread, standard deviation. It keeps inside the
    /// limits and does not run into itself; where that does not succeed, it is the pose as it was.
    pub fn perturbed(&mut self, values: &PoseValues, strength: f32) -> PoseValues {
        for attempt in 0..ATTEMPTS {
            let boldness = 1.0 - attempt as f32 / ATTEMPTS as f32;
            let mut moved = values.clone();
            for (degrees, control) in moved.degrees.iter_mut().zip(self.controls.list()) {
                *degrees += gaussian(&mut self.random) * control.spread_deg * strength * boldness;
            }
            self.controls.clamp(&mut moved);
            if self.is_free(&moved) {
                return moved;
            }
        }
        values.clone()
    }

    /// Whether a body does not run into itself.
    fn is_free(&self, values: &PoseValues) -> bool {
        let transforms = self.controls.transforms(&self.controls.rotations(values));
        let body = self.controls.body();
        let overlaps = body.overlaps(&transforms, body.allowed_overlap_m());
        overlaps.is_empty()
    }

    /// A blend of two or three poses of the library, with own mixtures for the limbs.
    fn natural(&mut self, boldness: f32) -> PoseValues {
        let count = self.random.random_range(2..=3).min(self.poses.len());
        let picks: Vec<usize> = (0..count)
            .map(|_| self.random.random_range(0..self.poses.len()))
            .collect();
        let body = self.weights(count);
        let limbs: Vec<Vec<f32>> = (0..self.controls.limb_count())
            .map(|_| {
                if self.random.random_bool(0.35) {
                    body.clone()
                } else {
                    self.weights(count)
                }
            })
            .collect();
        let mut values = self.controls.ease();
        for index in 0..values.degrees.len() {
            let weights = self
                .controls
                .limb_of(index)
                .map_or(&body, |limb| &limbs[limb]);
            let blended: f32 = weights
                .iter()
                .zip(&picks)
                .map(|(w, p)| w * self.poses[*p].degrees[index])
                .sum();
            let control = &self.controls.list()[index];
            values.degrees[index] =
                blended + gaussian(&mut self.random) * control.spread_deg * 0.45 * boldness;
        }
        values.lift_m = body
            .iter()
            .zip(&picks)
            .map(|(w, pick)| w * self.poses[*pick].lift_m)
            .sum();
        if self.random.random_bool(EVEN_SHARE) {
            self.even_out(&mut values);
        }
        self.tip(&mut values);
        values
    }

    /// Bows some bodies as a whole, forward or backward.
    fn tip(&mut self, values: &mut PoseValues) {
        let Some(pitch) = self.controls.body_pitch() else {
            return;
        };
        if self.random.random_bool(TUMBLED_SHARE) {
            values.degrees[pitch] = self.random.random_range(-180.0..180.0);
        } else if self.random.random_bool(TIPPED_SHARE) {
            values.degrees[pitch] += TIPPED_DEG * gaussian(&mut self.random);
        }
    }

    /// Weights that sum to 1, one of them mostly in the lead: poses averaged evenly all look alike.
    fn weights(&mut self, count: usize) -> Vec<f32> {
        let whole_share = f64::from(self.controls.whole_share());
        if whole_share > 0.0 && self.random.random_bool(whole_share) {
            let whole = self.random.random_range(0..count);
            return (0..count)
                .map(|i| f32::from(u8::from(i == whole)))
                .collect();
        }
        let mut weights: Vec<f32> = (0..count)
            .map(|_| self.random.random::<f32>().powi(3) + 1e-3)
            .collect();
        let sum: f32 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        weights
    }

    /// Every control for itself, bell-shaped around a middle at ease with a broad tail; whole limbs are
    /// sometimes calm, and both sides sometimes alike, as bodies are.
    fn free(&mut self, boldness: f32) -> PoseValues {
        let mut values = self.controls.ease();
        let energy = (0.35 + 0.9 * self.random.random::<f32>()) * (0.4 + 0.6 * boldness);
        for index in 0..values.degrees.len() {
            let control = &self.controls.list()[index];
            let (min, max) = self.controls.limits(index, &values);
            let reach = control.spread_deg * energy;
            // The middle moves from ease into the range as the limb gets livelier.
            let middle = control.ease_deg + (0.5 * (min + max) - control.ease_deg) * 0.5 * energy;
            let tail = if self.random.random_bool(0.12) {
                2.2
            } else {
                1.0
            };
            let bell = gaussian(&mut self.random) * reach * tail;
            values.degrees[index] = reflect(middle + bell, min, max);
        }
        if self.random.random_bool(0.25) {
            self.even_out(&mut values);
        }
        values
    }

    /// Makes the right side the like of the left.
    fn even_out(&self, values: &mut PoseValues) {
        let mirrored = self.controls.mirror(values);
        for (index, control) in self.controls.list().iter().enumerate() {
            if control.mirror > index {
                values.degrees[control.mirror] = mirrored.degrees[control.mirror];
            }
        }
    }
}

/// Normally distributed, mean 0, standard deviation 1 (Box and Muller, 1958).
fn gaussian(random: &mut ChaCha8Rng) -> f32 {
    let radius = (-2.0 * (1.0 - random.random::<f32>()).ln()).sqrt();
    radius * (std::f32::consts::TAU * random.random::<f32>()).cos()
}

/// Folds a value back into a range, so that it does not pile up at the ends.
fn reflect(value: f32, min: f32, max: f32) -> f32 {
    let folded = if value > max {
        2.0 * max - value
    } else if value < min {
        2.0 * min - value
    } else {
        value
    };
    folded.clamp(min, max)
}
