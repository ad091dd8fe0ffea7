//! Moving the surface with the bones.
//!
//! Three ways, from the simplest: linear blending, which collapses joints; dual quaternions (Kavan,
//! Collins, Zara, O'Sullivan, "Geometric Skinning with Approximate Dual Quaternion Blending", ACM
//! Transactions on Graphics 27, 2008), which keep their volume but swell raised shoulders; and
//! optimised centres of rotation (Le, Hodgins, 2016), which do neither and are what [`Rig::skin`] uses.

use glam::{Quat, Vec3, Vec4};

use super::{Pose, Rig};

/// How the motions of a vertex' bones are blended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Skinning {
    /// The weighted mean of the bones' images of the vertex.
    Linear,
    /// The weighted mean of the bones' motions as dual quaternions.
    DualQuaternion,
    /// The weighted mean of the bones' rotations, about the vertex' own centre of rotation.
    CenterOfRotation,
}

/// A rigid motion as a unit dual quaternion: `real` the rotation, `dual` half translation times it.
#[derive(Debug, Clone, Copy)]
struct DualQuat {
    real: Vec4,
    dual: Vec4,
}

impl DualQuat {
    /// The motion `x -> rotation * x + translation`.
    fn new(rotation: Quat, translation: Vec3) -> Self {
        let half = Quat::from_xyzw(translation.x, translation.y, translation.z, 0.0) * rotation;
        Self {
            real: Vec4::from(rotation),
            dual: Vec4::from(half) * 0.5,
        }
    }

    /// The image of a point; the dual quaternion need not be normalised.
    fn apply(&self, point: Vec3) -> Vec3 {
        let scale = self.real.length().max(f32::MIN_POSITIVE).recip();
        let (real, dual) = (self.real * scale, self.dual * scale);
        let (axis, dual_axis) = (real.truncate(), dual.truncate());
        let turned = point + 2.0 * axis.cross(axis.cross(point) + real.w * point);
        turned + 2.0 * (real.w * dual_axis - dual.w * axis + axis.cross(dual_axis))
    }
}

impl Rig {
    /// Where a pose brings every bone: (whole rotation against the rest, posed head), see [`Pose`].
    pub fn bone_transforms(&self, pose: &Pose) -> Vec<(Quat, Vec3)> {
        self.skeleton.bone_transforms(pose)
    }

    /// Writes the posed vertices into `out` (model space, metres), keeping the limbs' volume.
    ///
    /// `out` is resized to the number of vertices; called again with the same vector it allocates
    /// nothing but a few bytes per bone.
    pub fn skin(&self, pose: &Pose, out: &mut Vec<Vec3>) {
        self.skin_with(Skinning::CenterOfRotation, pose, out);
    }

    /// [`Rig::skin`] by a method of the caller's choice, to compare them.
    pub fn skin_with(&self, method: Skinning, pose: &Pose, out: &mut Vec<Vec3>) {
        let motions: Vec<(Quat, Vec3)> = self.rigid_motions(pose).collect();
        let blended = |index: usize| -> Vec3 {
            let (point, list) = (self.mesh.positions[index], &self.influences[index]);
            match method {
                Skinning::Linear => linear(&motions, list, point),
                Skinning::DualQuaternion => dual_quaternion(&motions, list, point),
                Skinning::CenterOfRotation => {
                    let center = self.centers[index];
                    let turn = mean_rotation(&motions, list);
                    linear(&motions, list, center) + turn * (point - center)
                }
            }
        };
        out.clear();
        out.extend((0..self.mesh.positions.len()).map(blended));
    }

    /// Per bone the motion `x -> turn * x + shift` from rest to pose.
    fn rigid_motions(&self, pose: &Pose) -> impl Iterator<Item = (Quat, Vec3)> {
        let posed = self.skeleton.bone_transforms(pose);
        posed
            .into_iter()
            .zip(&self.skeleton.bones)
            .map(|((turn, head), bone)| (turn, head - turn * bone.head))
    }
}

fn linear(motions: &[(Quat, Vec3)], list: &[(u16, f32)], point: Vec3) -> Vec3 {
    list.iter().fold(Vec3::ZERO, |sum, &(bone, weight)| {
        let (turn, shift) = motions[usize::from(bone)];
        sum + weight * (turn * point + shift)
    })
}

/// The weight of a rotation in a blend: q and -q are one rotation, and the blend takes the short way
/// round, seen from the strongest bone.
fn signed(weight: f32, turn: Quat, strongest: Quat) -> f32 {
    if turn.dot(strongest) < 0.0 {
        -weight
    } else {
        weight
    }
}

fn mean_rotation(motions: &[(Quat, Vec3)], list: &[(u16, f32)]) -> Quat {
    let strongest = list
        .first()
        .map_or(Quat::IDENTITY, |&(bone, _)| motions[usize::from(bone)].0);
    let sum = list.iter().fold(Vec4::ZERO, |sum, &(bone, weight)| {
        let turn = motions[usize::from(bone)].0;
        sum + Vec4::from(turn) * signed(weight, turn, strongest)
    });
    Quat::from_vec4(sum.normalize_or(Vec4::from(strongest)))
}

fn dual_quaternion(motions: &[(Quat, Vec3)], list: &[(u16, f32)], point: Vec3) -> Vec3 {
    let strongest = list
        .first()
        .map_or(Quat::IDENTITY, |&(bone, _)| motions[usize::from(bone)].0);
    let mut blend = DualQuat {
        real: Vec4::ZERO,
        dual: Vec4::ZERO,
    };
    for &(bone, weight) in list {
        let (turn, shift) = motions[usize::from(bone)];
        let (motion, weight) = (DualQuat::new(turn, shift), signed(weight, turn, strongest));
        blend.real += motion.real * weight;
        blend.dual += motion.dual * weight;
    }
    blend.apply(point)
}
