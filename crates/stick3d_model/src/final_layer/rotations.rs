//! From a head's raw numbers to rotation matrices: what keeps limbs stiff.
//!
//! An average of two poses' meshes is no pose: limbs come out short and flat. An average of rotations, made orthonormal
//! again, is one. So the head of a rigged figure gives two columns a bone, which Gram and Schmidt complete to a rotation
//! ([Zhou et al. 2019](https://arxiv.org/abs/1812.07035), section 4.2), and the mesh is linear in these rotations and in
//! those *half way* between neighbouring bones, which carry what a bent joint needs to keep its volume.

use glam::{Mat3, Vec3};

use super::FinalLayerError;

/// Which rotations a skinned mesh is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rotations {
    /// How many bones turn.
    pub bone_count: usize,
    /// Pairs of bones whose half-way rotation is used too.
    pub halves: Vec<[u16; 2]>,
}

/// Keeps a vanishing column from being divided by zero. The same in the Burn module.
pub(crate) const SMALLEST_SQUARE: f32 = 1e-12;
/// Cosine of half of the angle between two bones is at least this: at 180° the way between them is any. The same in the Burn module.
pub(crate) const LEAST_COSINE: f32 = 0.05;

impl Rotations {
    /// Checks that the pairs name bones there are.
    pub(crate) fn validate(&self) -> Result<(), FinalLayerError> {
        match self
            .halves
            .as_flattened()
            .iter()
            .find(|bone| usize::from(**bone) >= self.bone_count)
        {
            Some(bone) => {
                let problem = format!("bone {bone} is named, {} turn", self.bone_count);
                Err(FinalLayerError {
                    what: "halves",
                    problem,
                })
            }
            None => Ok(()),
        }
    }

    /// Columns of the head's raw output: two a bone.
    #[must_use]
    pub fn code_columns(&self) -> usize {
        2 * self.bone_count
    }

    /// Columns of the rotations: three a bone and three a half-way one.
    #[must_use]
    pub fn feature_columns(&self) -> usize {
        3 * (self.bone_count + self.halves.len())
    }

    /// The raw numbers of given rotations: their first two columns, `[3][2 · bone_count]`.
    #[must_use]
    pub fn code(&self, rotations: &[Mat3]) -> Vec<f32> {
        let column = |axis: usize| {
            rotations
                .iter()
                .flat_map(move |r| [r.x_axis[axis], r.y_axis[axis]])
        };
        (0..3).flat_map(column).collect()
    }

    /// Makes rotations of raw numbers.
    ///
    /// # Shapes
    /// - `code`: `[3][2 · bone_count]`
    /// - `features`: `[3][3 · (bone_count + halves)]`
    pub fn expand(&self, code: &[f32], features: &mut [f32]) {
        let (from, to) = (self.code_columns(), self.feature_columns());
        for bone in 0..self.bone_count {
            let (u, v) = column_pair(code, from, bone);
            put(features, to, bone, gram_schmidt(u, v));
        }
        for (index, [a, b]) in self.halves.iter().enumerate() {
            let [a, b] = [*a, *b].map(|bone| turn_at(features, to, usize::from(bone)));
            put(features, to, self.bone_count + index, half_way(a, b));
        }
    }
}

/// The two raw columns of a bone in a code `[3][columns]`.
pub(super) fn column_pair(code: &[f32], columns: usize, bone: usize) -> (Vec3, Vec3) {
    let column = |j: usize| Vec3::new(code[j], code[columns + j], code[2 * columns + j]);
    (column(2 * bone), column(2 * bone + 1))
}

/// The rotation at a place of the features `[3][width]`.
pub(super) fn turn_at(features: &[f32], width: usize, slot: usize) -> Mat3 {
    let column = |j: usize| Vec3::new(features[j], features[width + j], features[2 * width + j]);
    Mat3::from_cols(column(3 * slot), column(3 * slot + 1), column(3 * slot + 2))
}

fn put(features: &mut [f32], width: usize, slot: usize, rotation: Mat3) {
    for j in 0..3 {
        for axis in 0..3 {
            features[axis * width + 3 * slot + j] = rotation.col(j)[axis];
        }
    }
}

fn gram_schmidt(u: Vec3, v: Vec3) -> Mat3 {
    let unit = |v: Vec3| v / (v.length_squared() + SMALLEST_SQUARE).sqrt();
    let x = unit(u);
    let y = unit(v - x.dot(v) * x);
    Mat3::from_cols(x, y, x.cross(y))
}

/// The rotation half way from `a` to `b`: `a` times the root of `aᵀ · b`, by Rodrigues' formula.
fn half_way(a: Mat3, b: Mat3) -> Mat3 {
    let between = a.transpose() * b;
    let trace = between.x_axis.x + between.y_axis.y + between.z_axis.z;
    let cosine = (0.5 * (trace + 1.0).max(0.0).sqrt()).max(LEAST_COSINE);
    let transposed = between.transpose();
    let turn = (between - transposed) * (0.25 / cosine);
    let bend = (between + transposed - Mat3::IDENTITY * 2.0) * (0.25 / (1.0 + cosine));
    a * (Mat3::IDENTITY + turn + bend)
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    #[test]
    fn half_way_is_the_slerp() {
        for angle in [0.0_f32, 1e-4, 0.3, 1.5, 2.8] {
            let a = Quat::from_euler(glam::EulerRot::XYZ, 0.4, -0.9, 1.3);
            let b = a * Quat::from_axis_angle(Vec3::new(0.6, -0.48, 0.64), angle);
            let found = half_way(Mat3::from_quat(a), Mat3::from_quat(b));
            let expected = Mat3::from_quat(a.slerp(b, 0.5));
            assert!(
                found.abs_diff_eq(expected, 1e-5),
                "{angle}: {found} {expected}"
            );
        }
    }

    #[test]
    fn any_numbers_become_rotations_and_rotations_stay() {
        let rotations = Rotations {
            bone_count: 2,
            halves: vec![[0, 1]],
        };
        let mut features = vec![0.0; 27];
        let code: Vec<f32> = (0..12).map(|i| (1.3 * i as f32).sin() * 3.0).collect();
        rotations.expand(&code, &mut features);
        for slot in 0..3 {
            let r = turn_at(&features, 9, slot);
            assert!((r * r.transpose()).abs_diff_eq(Mat3::IDENTITY, 1e-5) && r.determinant() > 0.0);
        }
        let given = [Mat3::from_rotation_x(0.7), Mat3::from_rotation_z(-1.1)];
        rotations.expand(&rotations.code(&given), &mut features);
        assert!(
            turn_at(&features, 9, 0).abs_diff_eq(given[0], 1e-6)
                && turn_at(&features, 9, 1).abs_diff_eq(given[1], 1e-6)
        );
        rotations.expand(&[0.0; 12], &mut features);
        assert!(features.iter().all(|x| x.is_finite()));
    }
}
