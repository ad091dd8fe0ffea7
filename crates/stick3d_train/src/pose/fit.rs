//! From a pose of the skeleton to control values: where a motion came from elsewhere, for instance a clip.

use glam::{Quat, Vec3};
use nalgebra::{DMatrix, DVector};

use super::controls::{Controls, PoseValues};
use super::posing::BoneTransforms;
use crate::rig::Pose;

/// Rounds of the solver; clips of whole bodies need about ten.
const ROUNDS: usize = 40;
/// Step of the finite differences, degrees.
const STEP_DEG: f32 = 0.1;
/// Cost of leaving the start, per degree, against one of a radian: decides what no bone shows.
const STAY_PER_DEG: f32 = 2e-4;
/// A round that gains less than this share ends the search.
const LEAST_GAIN: f32 = 1e-5;
/// The most that a round turns a control, degrees.
const LONGEST_STEP_DEG: f32 = 30.0;

impl Controls {
    /// The values, inside their limits, that come nearest to a pose, and how far the steered bones are
    /// off: the root of the mean square of the angles between their whole rotations, radians.
    ///
    /// Bones that no control turns are not compared. `lift_m` is the height of the body's lowest part as
    /// the pose stands, nothing where that is below the ground.
    #[must_use]
    pub fn fit(&self, pose: &Pose) -> (PoseValues, f32) {
        self.fit_from(pose, &self.ease())
    }

    /// As [`Controls::fit`], starting from values known to be near: those of the moment before, in a clip.
    #[must_use]
    pub fn fit_from(&self, pose: &Pose, start: &PoseValues) -> (PoseValues, f32) {
        let target = self.skeleton.bone_transforms(pose);
        let steered = self.steered_bones();
        let misses = |values: &PoseValues| -> Vec<Vec3> {
            let made = self.skeleton.bone_transforms(&self.rotations(values));
            let miss = |&bone: &usize| rotation_vector(target[bone].0.inverse() * made[bone].0);
            steered.iter().map(miss).collect()
        };
        let evaluate = |values: &PoseValues| -> DVector<f32> {
            let turns = misses(values).into_iter().flat_map(|v| v.to_array());
            let stay = values.degrees.iter().zip(&start.degrees);
            let stay = stay.map(|(now, then)| (now - then) * STAY_PER_DEG);
            DVector::from_vec(turns.chain(stay).collect())
        };
        let mut values = start.clone();
        self.clamp(&mut values);
        self.search(&mut values, &evaluate);
        values.lift_m = self.lift_m(&target);
        let squares: f32 = misses(&values).iter().map(|v| v.length_squared()).sum();
        (values, (squares / steered.len().max(1) as f32).sqrt())
    }

    /// The height of the body's lowest part, nothing where that is below the ground.
    pub(super) fn lift_m(&self, transforms: &BoneTransforms) -> f32 {
        let lowest_m = self.body().lowest_m(transforms);
        if lowest_m.is_finite() {
            lowest_m.max(0.0)
        } else {
            0.0
        }
    }

    /// Damped least squares (Levenberg-Marquardt) inside the limits.
    fn search(&self, values: &mut PoseValues, evaluate: &dyn Fn(&PoseValues) -> DVector<f32>) {
        let count = self.list().len();
        let mut residual = evaluate(values);
        let mut damping = 1e-3;
        for _ in 0..ROUNDS {
            let mut jacobian = DMatrix::zeros(residual.len(), count);
            for column in 0..count {
                let mut moved = values.clone();
                moved.degrees[column] += STEP_DEG;
                jacobian.set_column(column, &((evaluate(&moved) - &residual) / STEP_DEG));
            }
            let normal = jacobian.tr_mul(&jacobian);
            let gradient = jacobian.tr_mul(&residual);
            // At its limit a control cannot give way; the others go on without it.
            let held = |i: usize| {
                let (min, max) = self.limits(i, values);
                let at = values.degrees[i];
                (at <= min && gradient[i] > 0.0) || (at >= max && gradient[i] < 0.0)
            };
            let free: Vec<usize> = (0..count).filter(|&i| !held(i)).collect();
            let mut gained = false;
            while damping < 1e6 {
                let Some(next) = self.step(values, &free, &normal, &gradient, damping) else {
                    return;
                };
                let after = evaluate(&next);
                let (before_cost, after_cost) = (residual.norm_squared(), after.norm_squared());
                if after_cost < before_cost {
                    gained = before_cost - after_cost > LEAST_GAIN * before_cost;
                    (*values, residual) = (next, after);
                    damping *= 0.3;
                    break;
                }
                damping *= 5.0;
            }
            if !gained {
                return;
            }
        }
    }

    fn step(
        &self,
        values: &PoseValues,
        free: &[usize],
        normal: &DMatrix<f32>,
        gradient: &DVector<f32>,
        damping: f32,
    ) -> Option<PoseValues> {
        let mut system =
            DMatrix::from_fn(free.len(), free.len(), |r, c| normal[(free[r], free[c])]);
        for i in 0..free.len() {
            system[(i, i)] += damping * (system[(i, i)] + 1e-6);
        }
        let right = DVector::from_fn(free.len(), |i, _| gradient[free[i]]);
        let step = system.cholesky()?.solve(&right);
        let mut next = values.clone();
        for (i, &index) in free.iter().enumerate() {
            next.degrees[index] -= step[i].clamp(-LONGEST_STEP_DEG, LONGEST_STEP_DEG);
        }
        self.clamp(&mut next);
        Some(next)
    }

    /// The bones that some control turns.
    fn steered_bones(&self) -> Vec<usize> {
        let swings = |bone: usize| {
            self.swings
                .iter()
                .any(|s| s.bone == bone || s.girdle == bone)
        };
        (0..self.skeleton.bones.len())
            .filter(|&bone| !self.turns[bone].is_empty() || swings(bone))
            .collect()
    }
}

/// A rotation as its axis times its angle, the short way round.
fn rotation_vector(rotation: Quat) -> Vec3 {
    let short = if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    };
    short.to_scaled_axis()
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use proptest::prelude::*;

    use super::*;
    use crate::pose::{PoseLibrary, PoseSampler, SampleKind, ShippedBody};
    use crate::rig::Rig;

    static RIG: LazyLock<Rig> = LazyLock::new(|| {
        Rig::from_glb(include_bytes!("../../../../assets/rigs/human.glb")).unwrap()
    });
    static CONTROLS: LazyLock<Controls> = LazyLock::new(|| {
        Controls::from_ron(ShippedBody::named("human").unwrap().controls, &RIG).unwrap()
    });

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        #[test]
        fn what_controls_made_they_find_again(seed in any::<u64>()) {
            let mut sampler = PoseSampler::new(&RIG, &CONTROLS, &PoseLibrary::default(), seed);
            let values = sampler.sample_values(SampleKind::Free);
            let pose = CONTROLS.pose(&values);
            // From far away the search may end in another attitude of a shoulder; this is a moment before.
            let mut near = values.clone();
            for (index, degrees) in near.degrees.iter_mut().enumerate() {
                *degrees += 10.0 * (index as f32).sin();
            }
            let (found, residual_rad) = CONTROLS.fit_from(&pose, &near);
            prop_assert!(residual_rad < 0.01, "{residual_rad} rad");
            prop_assert!((found.lift_m - values.lift_m).abs() < 0.001);
            CONTROLS.check(&found, "fitted").unwrap();
        }
    }

    #[test]
    fn what_is_out_of_reach_is_met_as_nearly_as_the_limits_permit() {
        let knee = CONTROLS.index("knee_l.flexion", "test").unwrap();
        let mut values = CONTROLS.ease();
        values.degrees[knee] = CONTROLS.list()[knee].max_deg + 40.0;
        let (found, residual_rad) = CONTROLS.fit(&CONTROLS.pose(&values));
        assert!((found.degrees[knee] - CONTROLS.list()[knee].max_deg).abs() < 1.0);
        assert!(residual_rad > 0.01, "the miss is said");
    }
}
