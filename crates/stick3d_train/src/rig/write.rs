//! Writing a rig as a binary glTF that other software opens.

use glam::{Mat4, Vec3};
use gltf::json;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::Semantic;
use gltf::json::validation::Checked;
use stick3d_model::export::gltf_file::{Attributes, GltfFile, Layout};

use super::{Rig, RigError};

impl Rig {
    /// The rig as a `.glb`: one mesh, one primitive, one skin, one material.
    ///
    /// Attributes: `POSITION`, `NORMAL`, `COLOR_0` (normalised bytes, linear), `JOINTS_0`/`WEIGHTS_0`
    /// and, where a vertex follows more than four bones, `JOINTS_1`/`WEIGHTS_1` (normalised 16-bit
    /// weights). Clips become animations. The same rig gives the same bytes.
    ///
    /// # Errors
    /// [`RigError::Inconsistent`] for a rig that [`Rig::validate`] refuses.
    pub fn to_glb(&self) -> Result<Vec<u8>, RigError> {
        self.validate()?;
        let mut file = GltfFile::default();
        file.root.asset.copyright.clone_from(&self.copyright);
        let mesh = self.write_mesh(&mut file)?;
        self.write_scene(&mut file, mesh);
        for clip in &self.clips {
            self.write_clip(&mut file, clip);
        }
        Ok(file.finish()?)
    }

    fn write_mesh(&self, file: &mut GltfFile) -> Result<json::Index<json::Mesh>, RigError> {
        let mut attributes = Attributes::new();
        let mut set = |semantic, accessor| attributes.insert(Checked::Valid(semantic), accessor);
        let arrays = |points: &[Vec3]| points.iter().map(Vec3::to_array).collect::<Vec<_>>();
        let positions = &self.mesh.positions;
        let normals = self.vertex_normals(positions)?;
        set(Semantic::Positions, file.positions(&arrays(positions)));
        set(Semantic::Normals, file.normals(&arrays(&normals)));
        set(Semantic::Colors(0), file.colors(&self.colors));
        let most = self.influences.iter().map(Vec::len).max().unwrap_or(0);
        for group in 0..most.div_ceil(4) {
            let (joints, weights) = self.influence_group(group);
            let set_index = group as u32;
            let count = self.influences.len();
            let of_bytes = Layout::attribute(Type::Vec4, ComponentType::U8, count);
            let of_words = Layout::attribute(Type::Vec4, ComponentType::U16, count);
            let joints = if self.skeleton.bones.len() <= 256 {
                let narrow: Vec<u8> = joints.iter().map(|&joint| joint as u8).collect();
                file.accessor(&narrow, of_bytes)
            } else {
                file.accessor(bytemuck::cast_slice(&joints), of_words.clone())
            };
            set(Semantic::Joints(set_index), joints);
            let weights = file.accessor(bytemuck::cast_slice(&weights), of_words.normalized());
            set(Semantic::Weights(set_index), weights);
        }
        let indices = file.triangles(&self.mesh.triangles, positions.len());
        Ok(file.body(&self.name, attributes, indices))
    }

    /// The bones and 16-bit weights of the `group`-th four influences of every vertex.
    fn influence_group(&self, group: usize) -> (Vec<u16>, Vec<u16>) {
        let mut joints = Vec::with_capacity(self.influences.len() * 4);
        let mut weights = Vec::with_capacity(self.influences.len() * 4);
        for list in &self.influences {
            let words = weights_as_words(list);
            let padding = std::iter::repeat((0, 0));
            let pairs = list.iter().map(|&(bone, _)| bone).zip(words).chain(padding);
            for (bone, word) in pairs.skip(group * 4).take(4) {
                // glTF wants bone 0 where the weight is 0.
                joints.push(if word == 0 { 0 } else { bone });
                weights.push(word);
            }
        }
        (joints, weights)
    }

    fn write_scene(&self, file: &mut GltfFile, mesh: json::Index<json::Mesh>) {
        let bones = &self.skeleton.bones;
        let globals: Vec<Mat4> = bones
            .iter()
            .map(|bone| Mat4::from_rotation_translation(bone.rest_rotation, bone.head))
            .collect();
        let inverse: Vec<[f32; 16]> = globals
            .iter()
            .map(|global| global.inverse().to_cols_array())
            .collect();
        let layout = Layout::data(Type::Mat4, ComponentType::F32, bones.len());
        let inverse_bind_matrices = Some(file.accessor(bytemuck::cast_slice(&inverse), layout));

        // Nodes 0.. are the bones, in order; then the skinned mesh, which hangs at the scene's root.
        let node = |index: usize| json::Index::new(index as u32);
        for (index, bone) in bones.iter().enumerate() {
            let children: Vec<_> = (0..bones.len())
                .filter(|&c| bones[c].parent == Some(index))
                .map(node)
                .collect();
            let (translation, rotation) = match bone.parent.map(|parent| &bones[parent]) {
                Some(parent) => {
                    let back = parent.rest_rotation.inverse();
                    (
                        back * (bone.head - parent.head),
                        (back * bone.rest_rotation).normalize(),
                    )
                }
                None => (bone.head, bone.rest_rotation),
            };
            file.root.push(json::Node {
                name: Some(bone.name.clone()),
                children: (!children.is_empty()).then_some(children),
                translation: Some(translation.to_array()),
                rotation: Some(json::scene::UnitQuaternion(rotation.to_array())),
                ..Default::default()
            });
        }
        let roots: Vec<_> = (0..bones.len())
            .filter(|&bone| bones[bone].parent.is_none())
            .map(node)
            .collect();
        let skin = file.root.push(json::Skin {
            extensions: None,
            extras: None,
            inverse_bind_matrices,
            joints: (0..bones.len()).map(node).collect(),
            name: Some(self.name.clone()),
            skeleton: (roots.len() == 1).then(|| roots[0]),
        });
        let body = file.root.push(json::Node {
            name: Some(self.name.clone()),
            mesh: Some(mesh),
            skin: Some(skin),
            ..Default::default()
        });
        file.scene(roots.into_iter().chain([body]).collect());
    }
}

/// Weights as 16-bit fractions that sum to exactly 65,535: rounded down, the rest by largest remainder.
fn weights_as_words(list: &[(u16, f32)]) -> Vec<u16> {
    let sum: f64 = list.iter().map(|&(_, weight)| f64::from(weight)).sum();
    let full = f64::from(u16::MAX);
    let exact: Vec<f64> = list
        .iter()
        .map(|&(_, w)| f64::from(w) / sum * full)
        .collect();
    let mut words: Vec<u16> = exact.iter().map(|value| *value as u16).collect();
    let missing = u32::from(u16::MAX) - words.iter().map(|&word| u32::from(word)).sum::<u32>();
    let mut order: Vec<usize> = (0..list.len()).collect();
    order.sort_by(|&a, &b| exact[b].fract().total_cmp(&exact[a].fract()));
    for &slot in order.iter().cycle().take(missing as usize) {
        words[slot] += 1;
    }
    words
}
