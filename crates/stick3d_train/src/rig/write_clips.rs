//! Writing a rig's clips as glTF animations.

use glam::{Quat, Vec3};
use gltf::json;
use gltf::json::animation::Property;
use stick3d_model::export::gltf_file::{GltfFile, Track};

use super::{Clip, Pose, Rig};

impl Rig {
    /// Adds an animation: rotations of all bones that turn in it, translations of the roots that move.
    ///
    /// Bones are the file's first nodes, in order.
    pub(super) fn write_clip(&self, file: &mut GltfFile, clip: &Clip) {
        let any = |moves: &dyn Fn(&Pose) -> bool| clip.poses.iter().any(moves);
        let mut tracks = vec![];
        for (index, bone) in self.skeleton.bones.iter().enumerate() {
            let mut add = |property, values| {
                tracks.push(Track {
                    node: json::Index::new(index as u32),
                    property,
                    values,
                });
            };
            if any(&|pose| pose.rotations[index] != Quat::IDENTITY) {
                add(Property::Rotation, self.local_rotations(clip, index));
            }
            if bone.parent.is_none() && any(&|pose| pose.root_translation != Vec3::ZERO) {
                let place = |pose: &Pose| (bone.head + pose.root_translation).to_array();
                add(
                    Property::Translation,
                    clip.poses.iter().flat_map(place).collect(),
                );
            }
        }
        file.animation(&clip.name, &clip.times_s, tracks);
    }

    /// A bone's rotations in its parent, as glTF counts them.
    fn local_rotations(&self, clip: &Clip, bone: usize) -> Vec<f32> {
        let rest = self.skeleton.bones[bone].rest_rotation;
        let above = self.skeleton.bones[bone]
            .parent
            .map_or(Quat::IDENTITY, |parent| {
                self.skeleton.bones[parent].rest_rotation
            });
        clip.poses
            .iter()
            .flat_map(|pose| {
                let local = above.inverse() * pose.rotations[bone] * rest;
                local.normalize().to_array()
            })
            .collect()
    }
}
