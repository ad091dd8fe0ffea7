//! Writing a rig's clips as glTF animations.

use glam::{Quat, Vec3};
use gltf::json;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf::json::validation::Checked;
use stick3d_model::export::gltf_file::{GltfFile, Layout};

use super::{Clip, Pose, Rig};

impl Rig {
    /// Adds an animation: rotations of all bones that turn in it, translations of the roots that move.
    ///
    /// Bones are the file's first nodes, in order.
    pub(super) fn write_clip(&self, file: &mut GltfFile, clip: &Clip) {
        let times = Layout::data(Type::Scalar, ComponentType::F32, clip.times_s.len())
            .bounded(&[0.0], &[clip.duration_s()]);
        let input = file.accessor(bytemuck::cast_slice(&clip.times_s), times);
        let mut animation = json::Animation {
            channels: Vec::new(),
            samplers: Vec::new(),
            extensions: None,
            extras: None,
            name: Some(clip.name.clone()),
        };
        let mut add = |file: &mut GltfFile, bone: usize, path, shape, values: &[f32]| {
            let output = file.accessor(
                bytemuck::cast_slice(values),
                Layout::data(shape, ComponentType::F32, clip.times_s.len()),
            );
            animation.samplers.push(Sampler {
                input,
                interpolation: Checked::Valid(Interpolation::Linear),
                output,
                extensions: None,
                extras: None,
            });
            animation.channels.push(Channel {
                sampler: json::Index::new(animation.samplers.len() as u32 - 1),
                target: Target {
                    node: json::Index::new(bone as u32),
                    path: Checked::Valid(path),
                    extensions: None,
                    extras: None,
                },
                extensions: None,
                extras: None,
            });
        };
        for bone in 0..self.skeleton.bones.len() {
            if clip
                .poses
                .iter()
                .any(|pose| pose.rotations[bone] != Quat::IDENTITY)
            {
                let values = self.local_rotations(clip, bone);
                add(file, bone, Property::Rotation, Type::Vec4, &values);
            }
            let root = self.skeleton.bones[bone].parent.is_none();
            if root
                && clip
                    .poses
                    .iter()
                    .any(|pose| pose.root_translation != Vec3::ZERO)
            {
                let head = self.skeleton.bones[bone].head;
                let place = |pose: &Pose| (head + pose.root_translation).to_array();
                let values: Vec<f32> = clip.poses.iter().flat_map(place).collect();
                add(file, bone, Property::Translation, Type::Vec3, &values);
            }
        }
        if !animation.channels.is_empty() {
            file.root.push(animation);
        }
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
