//! From control values to bone rotations, and onto the ground.

use glam::{Quat, Vec3};

use super::controls::{Controls, PoseValues, Swing};
use super::spec::Lateral;
use crate::rig::{Pose, Rig};

/// Where every bone stands: (whole rotation against the rest, head).
pub type BoneTransforms = Vec<(Quat, Vec3)>;

impl Controls {
    /// The pose that these values stand for, with the body's parts on the ground (or `lift_m` above).
    ///
    /// The ground is found with the rigid parts, within millimetres and at no cost; where the very
    /// lowest vertex matters, use [`Controls::pose_on_ground`].
    pub fn pose(&self, values: &PoseValues) -> Pose {
        let mut pose = self.rotations(values);
        let transforms = self.skeleton.bone_transforms(&pose);
        pose.root_translation.y = values.lift_m - self.body().lowest_m(&transforms);
        pose
    }

    /// As [`Controls::pose`], with the lowest vertex of the skinned mesh exactly at `lift_m`.
    pub fn pose_on_ground(&self, values: &PoseValues, rig: &Rig) -> Pose {
        let mut pose = self.rotations(values);
        let mut vertices = Vec::new();
        rig.skin(&pose, &mut vertices);
        let lowest = vertices.iter().map(|v| v.y).fold(f32::INFINITY, f32::min);
        pose.root_translation.y = values.lift_m - lowest;
        pose
    }

    /// Where the bones stand in a pose.
    pub fn transforms(&self, pose: &Pose) -> BoneTransforms {
        self.skeleton.bone_transforms(pose)
    }

    /// The mirror image of any pose of the rig, bones exchanged by name.
    #[must_use]
    pub fn mirror_pose(&self, pose: &Pose) -> Pose {
        let rotations = self.skeleton.bones.iter().enumerate().map(|(bone, _)| {
            self.lateral
                .mirror_turn(pose.rotations[self.mirrored_bone(bone)])
        });
        Pose {
            rotations: rotations.collect(),
            root_translation: self.lateral.mirror(pose.root_translation),
        }
    }

    fn mirrored_bone(&self, bone: usize) -> usize {
        let name = super::spec::mirrored_name(&self.skeleton.bones[bone].name);
        self.skeleton
            .bones
            .iter()
            .position(|other| other.name == name)
            .unwrap_or(bone)
    }

    /// The pose's rotations, not yet moved onto the ground.
    pub(super) fn rotations(&self, values: &PoseValues) -> Pose {
        let bones = &self.skeleton.bones;
        let mut stance: Vec<Quat> = Vec::with_capacity(bones.len());
        let mut pose = Pose::rest(bones.len());
        for (bone, parent) in bones.iter().map(|bone| bone.parent).enumerate() {
            let mut local = self.local(bone, values);
            for swing in &self.swings {
                if swing.girdle == bone {
                    local *= swing.girdle_rotation(values, self.lateral);
                } else if swing.bone == bone {
                    // The limb's direction counts from the trunk, whatever the girdle does.
                    let trunk = stance_of(&stance, bones[swing.girdle].parent);
                    let above = stance_of(&stance, parent);
                    local = above.inverse() * trunk * swing.rotation(values, self.lateral) * local;
                }
            }
            stance.push(stance_of(&stance, parent) * local);
            let above = parent.map_or(Quat::IDENTITY, |p| self.neutral[p]);
            pose.rotations[bone] = (above.inverse() * local * self.neutral[bone]).normalize();
        }
        pose
    }

    fn local(&self, bone: usize, values: &PoseValues) -> Quat {
        self.turns[bone].iter().fold(Quat::IDENTITY, |q, turn| {
            let angle = values.degrees[turn.control] * turn.share;
            q * Quat::from_axis_angle(turn.axis, angle.to_radians())
        })
    }
}

fn stance_of(stance: &[Quat], bone: Option<usize>) -> Quat {
    bone.map_or(Quat::IDENTITY, |bone| stance[bone])
}

impl Swing {
    fn angles(&self, values: &PoseValues) -> (f32, f32, f32) {
        let at = |i: usize| values.degrees[self.plane + i].to_radians();
        (at(0), at(1), at(2))
    }

    /// The limb against the trunk: the shortest swing out of the hanging position, after a twist.
    fn rotation(&self, values: &PoseValues, lateral: Lateral) -> Quat {
        let (plane, raise, twist) = self.angles(values);
        let axis = lateral.facing(Vec3::new(-plane.sin(), 0.0, self.side * plane.cos()));
        Quat::from_axis_angle(axis, raise) * Quat::from_rotation_y(-self.side * twist)
    }

    /// How the girdle follows: up with the raise, forward or back with the reach.
    fn girdle_rotation(&self, values: &PoseValues, lateral: Lateral) -> Quat {
        let (plane, raise, _) = self.angles(values);
        let from = self.spec.girdle_from.to_radians();
        // Smooth at the onset: a hyperbola between nothing and the full share.
        let above = raise - from;
        let above = 0.5 * (above + (above * above + 0.04).sqrt());
        let forward = self.spec.girdle_forward.to_radians() * raise.sin() * plane.sin();
        Quat::from_rotation_y(-self.side * forward)
            * Quat::from_axis_angle(
                lateral.facing(Vec3::Z),
                self.side * self.spec.girdle_up * above,
            )
    }
}
