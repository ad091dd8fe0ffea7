//! Writing a rig as a binary glTF that other software opens.

use std::borrow::Cow;

use glam::{Mat4, Vec3};
use gltf::binary::{Glb, Header};
use gltf::json;
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::Target;
use gltf::json::mesh::Semantic;
use gltf::json::validation::{Checked, USize64};
use stick3d_figure::mesh::NormalAdjacency;

use super::{Rig, RigError};

impl Rig {
    /// The rig as a `.glb`: one mesh, one primitive, one skin, one material.
    ///
    /// Attributes: `POSITION`, `NORMAL`, `COLOR_0` (normalised bytes, linear), `JOINTS_0`/`WEIGHTS_0`
    /// and, where a vertex follows more than four bones, `JOINTS_1`/`WEIGHTS_1` (normalised 16-bit
    /// weights). The same rig gives the same bytes.
    ///
    /// # Errors
    /// [`RigError::Inconsistent`] for a rig that [`Rig::validate`] refuses.
    pub fn to_glb(&self) -> Result<Vec<u8>, RigError> {
        self.validate()?;
        let mut file = File::default();
        file.root.asset.copyright.clone_from(&self.copyright);
        file.root.asset.generator = Some("stick3d".into());
        let mesh = self.write_mesh(&mut file)?;
        self.write_scene(&mut file, mesh);
        file.finish()
    }

    fn write_mesh(&self, file: &mut File) -> Result<json::Index<json::Mesh>, RigError> {
        let mut attributes = std::collections::BTreeMap::new();
        let mut set = |semantic, accessor| attributes.insert(Checked::Valid(semantic), accessor);
        set(Semantic::Positions, self.write_positions(file));
        set(Semantic::Normals, self.write_normals(file)?);
        let colors = self.colors.concat();
        let bytes = Layout::attribute(Type::Vec4, ComponentType::U8, self.colors.len());
        set(
            Semantic::Colors(0),
            file.accessor(&colors, bytes.normalized()),
        );
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
        let indices = self.write_indices(file);
        let material = file.root.push(cloth_material());
        let primitive = json::mesh::Primitive {
            attributes,
            extensions: None,
            extras: None,
            indices: Some(indices),
            material: Some(material),
            mode: Checked::Valid(json::mesh::Mode::Triangles),
            targets: None,
        };
        Ok(file.root.push(json::Mesh {
            extensions: None,
            extras: None,
            name: Some(self.name.clone()),
            primitives: vec![primitive],
            weights: None,
        }))
    }

    fn write_positions(&self, file: &mut File) -> json::Index<json::Accessor> {
        let points = &self.mesh.positions;
        let bytes: Vec<[f32; 3]> = points.iter().map(Vec3::to_array).collect();
        let low = points.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let mut layout = Layout::attribute(Type::Vec3, ComponentType::F32, points.len());
        layout.bounds = Some((low, high));
        file.accessor(bytemuck::cast_slice(&bytes), layout)
    }

    fn write_normals(&self, file: &mut File) -> Result<json::Index<json::Accessor>, RigError> {
        let positions: Vec<[f32; 3]> = self.mesh.positions.iter().map(Vec3::to_array).collect();
        let mut normals = vec![[0.0; 3]; positions.len()];
        NormalAdjacency::new(&self.mesh.triangles, positions.len())
            .map_err(|fault| RigError::Inconsistent {
                what: fault.to_string(),
            })?
            .vertex_normals(&positions, &mut normals);
        let layout = Layout::attribute(Type::Vec3, ComponentType::F32, normals.len());
        Ok(file.accessor(bytemuck::cast_slice(&normals), layout))
    }

    fn write_indices(&self, file: &mut File) -> json::Index<json::Accessor> {
        let indices = self.mesh.triangles.as_flattened();
        let mut layout = Layout::attribute(Type::Scalar, ComponentType::U32, indices.len());
        layout.target = Some(Target::ElementArrayBuffer);
        // 65,535 is left out: some graphics interfaces read it as "start a new strip".
        if self.mesh.positions.len() < usize::from(u16::MAX) {
            layout.component = ComponentType::U16;
            let narrow: Vec<u16> = indices.iter().map(|&index| index as u16).collect();
            return file.accessor(bytemuck::cast_slice(&narrow), layout);
        }
        file.accessor(bytemuck::cast_slice(indices), layout)
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

    fn write_scene(&self, file: &mut File, mesh: json::Index<json::Mesh>) {
        let bones = &self.skeleton.bones;
        let globals: Vec<Mat4> = bones
            .iter()
            .map(|bone| Mat4::from_rotation_translation(bone.rest_rotation, bone.head))
            .collect();
        let inverse: Vec<[f32; 16]> = globals
            .iter()
            .map(|global| global.inverse().to_cols_array())
            .collect();
        let mut layout = Layout::attribute(Type::Mat4, ComponentType::F32, bones.len());
        layout.target = None;
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
        let scene = file.root.push(json::Scene {
            extensions: None,
            extras: None,
            name: None,
            nodes: roots.into_iter().chain([body]).collect(),
        });
        file.root.scene = Some(scene);
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

/// A matt, one-sided material; its colour is the vertices' own.
fn cloth_material() -> json::Material {
    use json::material::{PbrMetallicRoughness, StrengthFactor};
    json::Material {
        name: Some("body".into()),
        double_sided: false,
        pbr_metallic_roughness: PbrMetallicRoughness {
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(0.8),
            ..Default::default()
        },
        ..Default::default()
    }
}

/// How an accessor reads its bytes.
#[derive(Clone)]
struct Layout {
    shape: Type,
    component: ComponentType,
    count: usize,
    target: Option<Target>,
    normalized: bool,
    bounds: Option<(Vec3, Vec3)>,
}

impl Layout {
    fn attribute(shape: Type, component: ComponentType, count: usize) -> Self {
        let target = Some(Target::ArrayBuffer);
        Self {
            shape,
            component,
            count,
            target,
            normalized: false,
            bounds: None,
        }
    }

    fn normalized(mut self) -> Self {
        self.normalized = true;
        self
    }
}

/// The two chunks of the file while they grow.
#[derive(Default)]
struct File {
    root: json::Root,
    bytes: Vec<u8>,
}

impl File {
    /// Appends `bytes`, aligned to four, with a view of their own and an accessor on it.
    fn accessor(&mut self, bytes: &[u8], layout: Layout) -> json::Index<json::Accessor> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = self.root.push(json::buffer::View {
            buffer: json::Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.bytes.len())),
            byte_stride: None,
            extensions: None,
            extras: None,
            name: None,
            target: layout.target.map(Checked::Valid),
        });
        self.bytes.extend_from_slice(bytes);
        let corner = |point: Vec3| json::Value::from(point.to_array().to_vec());
        self.root.push(json::Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(layout.count),
            component_type: Checked::Valid(GenericComponentType(layout.component)),
            extensions: None,
            extras: None,
            type_: Checked::Valid(layout.shape),
            min: layout.bounds.map(|(low, _)| corner(low)),
            max: layout.bounds.map(|(_, high)| corner(high)),
            name: None,
            normalized: layout.normalized,
            sparse: None,
        })
    }

    fn finish(mut self) -> Result<Vec<u8>, RigError> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.root.push(json::Buffer {
            byte_length: USize64::from(self.bytes.len()),
            extensions: None,
            extras: None,
            name: None,
            uri: None,
        });
        let description = json::serialize::to_vec(&self.root)?;
        let header = Header {
            magic: *b"glTF",
            version: 2,
            length: 0,
        };
        let glb = Glb {
            header,
            json: Cow::Owned(description),
            bin: Some(Cow::Owned(self.bytes)),
        };
        Ok(glb.to_vec()?)
    }
}
