//! Moving the surface with the bones: dual quaternions, and linear blending to compare with.
//!
//! Dual quaternion skinning: Kavan, Collins, Zara, O'Sullivan, "Geometric Skinning with Approximate
//! Dual Quaternion Blending", ACM Transactions on Graphics 27 (2008), algorithm 1 with the sign
//! test of section 4.1 made against the vertex's strongest bone.

use glam::{Quat, Vec3, Vec4};

use super::{Pose, Rig};

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
        let motions: Vec<DualQuat> = self
            .rigid_motions(pose)
            .map(|(turn, shift)| DualQuat::new(turn, shift))
            .collect();
        out.clear();
        out.extend(
            self.mesh
                .positions
                .iter()
                .zip(&self.influences)
                .map(|(&point, list)| {
                    let mut strongest = Vec4::ZERO;
                    let mut blend = DualQuat {
                        real: Vec4::ZERO,
                        dual: Vec4::ZERO,
                    };
                    for (rank, &(bone, weight)) in list.iter().enumerate() {
                        let motion = motions[bone as usize];
                        if rank == 0 {
                            strongest = motion.real;
                        }
                        // q and -q are one rotation; blending must take the short way round.
                        let weight = if motion.real.dot(strongest) < 0.0 {
                            -weight
                        } else {
                            weight
                        };
                        blend.real += motion.real * weight;
                        blend.dual += motion.dual * weight;
                    }
                    blend.apply(point)
                }),
        );
    }

    /// Writes the posed vertices of linear blend skinning into `out`: what [`Rig::skin`] is measured against.
    pub fn skin_linear(&self, pose: &Pose, out: &mut Vec<Vec3>) {
        let motions: Vec<(Quat, Vec3)> = self.rigid_motions(pose).collect();
        out.clear();
        out.extend(
            self.mesh
                .positions
                .iter()
                .zip(&self.influences)
                .map(|(&point, list)| {
                    list.iter().fold(Vec3::ZERO, |sum, &(bone, weight)| {
                        let (turn, shift) = motions[bone as usize];
                        sum + weight * (turn * point + shift)
                    })
                }),
        );
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
