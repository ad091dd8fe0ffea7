//! How points of a body move when the raw numbers behind its rotations change.

use glam::{Mat3, Vec3};

use super::Rotations;
use super::rotations::{SMALLEST_SQUARE, column_pair, turn_at};

impl Rotations {
    /// The derivative of a point's coordinates by the raw numbers.
    ///
    /// A half-way rotation is taken to turn by half of what both its bones turn, which is exact for equal bones and close
    /// for bent ones: enough for the steps of a search, which look at the point again. [`Rotations::pull_back`] is exact.
    ///
    /// # Shapes
    /// - `code`: `[3][2 · bone_count]`; `features`: what [`Rotations::expand`] makes of it
    /// - `row`: the point as a function of the features, `[feature_columns]`
    /// - `arms`: memory, `[bone_count]`
    /// - `slopes`: one `[3][2 · bone_count]` for each of x, y and z
    pub(crate) fn slopes(
        &self,
        code: &[f32],
        features: &[f32],
        row: &[f32],
        arms: &mut [Vec3],
        slopes: [&mut [f32]; 3],
    ) {
        self.arms(features, row, arms);
        let [along_x, along_y, along_z] = slopes;
        let columns = self.code_columns();
        for (axis, slope) in [(Vec3::X, along_x), (Vec3::Y, along_y), (Vec3::Z, along_z)] {
            slope.fill(0.0);
            for (bone, arm) in arms
                .iter()
                .enumerate()
                .filter(|(_, arm)| **arm != Vec3::ZERO)
            {
                let (u, v) = column_pair(code, columns, bone);
                let (by_u, by_v) = slope_of_pair(u, v, arm.cross(axis));
                for i in 0..3 {
                    slope[i * columns + 2 * bone] = by_u[i];
                    slope[i * columns + 2 * bone + 1] = by_v[i];
                }
            }
        }
    }

    /// From the derivative of a number by the features to that by the raw numbers.
    ///
    /// A rotation's derivative is the torque on it. That on the rotation half way between two bones is shared between them:
    /// with `w` turning either by a little, the way between turns by `(I + Q)^-1 (w_b + Q w_a)`, where `Q` leads from `a`
    /// half way to `b`; `(I + Q)^-1` is half of the identity and of the cross product with Q's axis times the tangent of half
    /// its angle.
    ///
    /// # Shapes
    /// - `code`, `by_code`: `[3][2 · bone_count]`
    /// - `features`: what [`Rotations::expand`] makes of the code
    /// - `by_features`: `[3][3 · (bone_count + halves)]`
    /// - `torques`: memory, `[bone_count]`
    pub fn pull_back(
        &self,
        code: &[f32],
        features: &[f32],
        by_features: &[f32],
        torques: &mut [Vec3],
        by_code: &mut [f32],
    ) {
        let (columns, width) = (self.code_columns(), self.feature_columns());
        let torque = |slot: usize| {
            let (turn, by_turn) = (
                turn_at(features, width, slot),
                turn_at(by_features, width, slot),
            );
            let of_columns = (0..3).map(|j| turn.col(j).cross(by_turn.col(j)));
            of_columns.sum::<Vec3>()
        };
        for (bone, out) in torques.iter_mut().enumerate() {
            *out = torque(bone);
        }
        for (index, [a, b]) in self.halves.iter().enumerate() {
            let slot = self.bone_count + index;
            let [a, b] = [*a, *b].map(usize::from);
            let half = turn_at(features, width, slot) * turn_at(features, width, a).transpose();
            let torque = torque(slot);
            let across = half_tangent(half).cross(torque);
            torques[a] += 0.5 * (torque - across);
            torques[b] += 0.5 * (torque + across);
        }
        for (bone, torque) in torques.iter().enumerate() {
            let (u, v) = column_pair(code, columns, bone);
            let (by_u, by_v) = slope_of_pair(u, v, *torque);
            for axis in 0..3 {
                by_code[axis * columns + 2 * bone] = by_u[axis];
                by_code[axis * columns + 2 * bone + 1] = by_v[axis];
            }
        }
    }

    /// From each bone's pivot to the point, as far as the bone carries it.
    fn arms(&self, features: &[f32], row: &[f32], arms: &mut [Vec3]) {
        let width = self.feature_columns();
        let arm = |slot: usize| {
            let weights = Vec3::from_slice(&row[3 * slot..3 * slot + 3]);
            if weights == Vec3::ZERO {
                return Vec3::ZERO;
            }
            turn_at(features, width, slot) * weights
        };
        for (bone, out) in arms.iter_mut().enumerate() {
            *out = arm(bone);
        }
        for (index, pair) in self.halves.iter().enumerate() {
            let half = 0.5 * arm(self.bone_count + index);
            for bone in pair {
                arms[usize::from(*bone)] += half;
            }
        }
    }
}

/// The axis of a rotation, as long as the tangent of half its angle.
fn half_tangent(turn: Mat3) -> Vec3 {
    let twice_sine = Vec3::new(
        turn.y_axis.z - turn.z_axis.y,
        turn.z_axis.x - turn.x_axis.z,
        turn.x_axis.y - turn.y_axis.x,
    );
    let trace = turn.x_axis.x + turn.y_axis.y + turn.z_axis.z;
    // Half-way rotations turn by at most a right angle, where the divisor is 2.
    twice_sine / (1.0 + trace).max(1.0)
}

/// What `gradient` by the small turn of a rotation is by the two columns that Gram and Schmidt make the rotation of.
fn slope_of_pair(u: Vec3, v: Vec3, gradient: Vec3) -> (Vec3, Vec3) {
    let u_len = (u.length_squared() + SMALLEST_SQUARE).sqrt();
    let x = u / u_len;
    let along = x.dot(v);
    let q = v - along * x;
    let q_len = (q.length_squared() + SMALLEST_SQUARE).sqrt();
    let y = q / q_len;
    let z = x.cross(y);
    let (about_x, about_y, about_z) = (gradient.dot(x), gradient.dot(y), gradient.dot(z));
    let by_u = z * (-about_y - about_x * along / q_len) / u_len + y * (about_z / u_len);
    (by_u, z * (about_x / q_len))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point that hangs on two bones and, where `halved`, on the way between them.
    fn check(halved: bool, tolerance: f32) {
        let rotations = Rotations {
            bone_count: 2,
            halves: vec![[0, 1]],
        };
        let code: Vec<f32> = (0..12)
            .map(|i| (1.3 * i as f32 + 0.4).sin() + 0.2 * (i as f32).cos())
            .collect();
        let mut code = code;
        if halved {
            // Nearly the same rotation twice.
            for axis in 0..3 {
                code[4 * axis + 2] = code[4 * axis] + 0.01 * axis as f32;
                code[4 * axis + 3] = code[4 * axis + 1] - 0.02;
            }
        }
        let mut row = [0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.0, 0.0, 0.0];
        if halved {
            row[6..].copy_from_slice(&[0.2, 0.6, -0.3]);
        }
        let point = |code: &[f32]| {
            let mut features = vec![0.0; 27];
            rotations.expand(code, &mut features);
            let along = |axis: usize| -> f32 {
                row.iter()
                    .zip(&features[9 * axis..])
                    .map(|(a, b)| a * b)
                    .sum()
            };
            Vec3::new(along(0), along(1), along(2))
        };
        let mut features = vec![0.0; 27];
        rotations.expand(&code, &mut features);
        let (mut x, mut y, mut z) = (vec![0.0; 12], vec![0.0; 12], vec![0.0; 12]);
        let mut arms = vec![Vec3::ZERO; 2];
        rotations.slopes(&code, &features, &row, &mut arms, [&mut x, &mut y, &mut z]);
        for i in 0..12 {
            let step = 1e-2;
            let moved = |by: f32| {
                let mut code = code.clone();
                code[i] += by;
                point(&code)
            };
            let expected = (moved(step) - moved(-step)) / (2.0 * step);
            let found = Vec3::new(x[i], y[i], z[i]);
            assert!(
                found.distance(expected) < tolerance,
                "{i}: {found} {expected}"
            );
        }
    }

    #[test]
    fn pulled_back_derivatives_are_differences() {
        let rotations = Rotations {
            bone_count: 3,
            halves: vec![[0, 1], [2, 1]],
        };
        let weights: Vec<f32> = (0..45).map(|i| (2.1 * i as f32).sin()).collect();
        let sum = |code: &[f32]| -> f64 {
            let mut features = vec![0.0; 45];
            rotations.expand(code, &mut features);
            let pairs = features.iter().zip(&weights);
            pairs.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
        };
        for seed in 0..3 {
            // Bones are bent by up to a right angle against each other: near half a turn the way between them is any.
            let number = |i: usize| {
                let common = (1.7 * (i / 6 * 2 + i % 2) as f32 + seed as f32).sin();
                1.5 * common + 0.5 * (2.3 * i as f32).sin()
            };
            let code: Vec<f32> = (0..18).map(number).collect();
            let mut features = vec![0.0; 45];
            rotations.expand(&code, &mut features);
            let (mut torques, mut found) = (vec![Vec3::ZERO; 3], vec![0.0; 18]);
            rotations.pull_back(&code, &features, &weights, &mut torques, &mut found);
            for i in 0..18 {
                let moved = |by: f32| {
                    let mut code = code.clone();
                    code[i] += by;
                    sum(&code)
                };
                let expected = (moved(2e-3) - moved(-2e-3)) / 4e-3;
                assert!(
                    (f64::from(found[i]) - expected).abs() < 5e-3 * (1.0 + expected.abs()),
                    "{seed} {i}: {} {expected}",
                    found[i]
                );
            }
        }
    }

    #[test]
    fn slopes_are_differences() {
        check(false, 1e-3);
    }

    #[test]
    fn between_nearly_equal_bones_slopes_are_differences_too() {
        check(true, 3e-2);
    }
}
