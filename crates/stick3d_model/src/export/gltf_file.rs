//! A binary glTF 2.0 file while it grows: meshes, rigs, motions and clips are all written through it.

use std::borrow::Cow;
use std::collections::BTreeMap;

use gltf::binary::{Glb, Header};
use gltf::json;
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::animation::{Channel, Interpolation, Property, Sampler};
use gltf::json::buffer::Target;
use gltf::json::mesh::Semantic;
use gltf::json::validation::{Checked, USize64};

/// The attributes of a primitive, or of one of its morph targets.
pub type Attributes = BTreeMap<Checked<Semantic>, json::Index<json::Accessor>>;

/// How an accessor reads its bytes.
#[derive(Debug, Clone)]
pub struct Layout {
    shape: Type,
    component: ComponentType,
    count: usize,
    target: Option<Target>,
    normalized: bool,
    bounds: Option<(Vec<f32>, Vec<f32>)>,
}

impl Layout {
    /// One element per vertex.
    #[must_use]
    pub fn attribute(shape: Type, component: ComponentType, count: usize) -> Self {
        Self {
            target: Some(Target::ArrayBuffer),
            ..Self::data(shape, component, count)
        }
    }

    /// Numbers that no vertex shader reads: matrices of a skin, keys of an animation.
    #[must_use]
    pub fn data(shape: Type, component: ComponentType, count: usize) -> Self {
        Self {
            shape,
            component,
            count,
            target: None,
            normalized: false,
            bounds: None,
        }
    }

    /// Integers that stand for fractions of their type's largest value.
    #[must_use]
    pub fn normalized(mut self) -> Self {
        self.normalized = true;
        self
    }

    /// States the smallest and largest element, component by component, as glTF asks for positions and times.
    #[must_use]
    pub fn bounded(mut self, low: &[f32], high: &[f32]) -> Self {
        self.bounds = Some((low.to_vec(), high.to_vec()));
        self
    }
}

/// How one property of a node changes in an animation.
#[derive(Debug, Clone)]
pub struct Track {
    /// Whose.
    pub node: json::Index<json::Node>,
    /// Which.
    pub property: Property,
    /// Its values one after the other, those of the first time first.
    pub values: Vec<f32>,
}

/// The two chunks of the file: a description, and one buffer of bytes. The same calls give the same bytes.
#[derive(Debug)]
pub struct GltfFile {
    /// The description; whatever the methods here do not write is pushed on it directly.
    pub root: json::Root,
    bytes: Vec<u8>,
}

impl Default for GltfFile {
    fn default() -> Self {
        let mut root = json::Root::default();
        root.asset.generator = Some("stick3d".to_owned());
        Self {
            root,
            bytes: Vec::new(),
        }
    }
}

impl GltfFile {
    /// Appends `bytes`, aligned to four, with a view of their own and an accessor on it.
    pub fn accessor(&mut self, bytes: &[u8], layout: Layout) -> json::Index<json::Accessor> {
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
        let (min, max) = layout.bounds.unzip();
        self.root.push(json::Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(layout.count),
            component_type: Checked::Valid(GenericComponentType(layout.component)),
            extensions: None,
            extras: None,
            type_: Checked::Valid(layout.shape),
            min: min.map(json::Value::from),
            max: max.map(json::Value::from),
            name: None,
            normalized: layout.normalized,
            sparse: None,
        })
    }

    /// Positions, or differences of positions, with their bounds; metres.
    pub fn positions(&mut self, positions: &[[f32; 3]]) -> json::Index<json::Accessor> {
        let (low, high) = bounds(positions);
        let layout = Layout::attribute(Type::Vec3, ComponentType::F32, positions.len());
        self.accessor(bytemuck::cast_slice(positions), layout.bounded(&low, &high))
    }

    /// Normals, or differences of normals.
    pub fn normals(&mut self, normals: &[[f32; 3]]) -> json::Index<json::Accessor> {
        let layout = Layout::attribute(Type::Vec3, ComponentType::F32, normals.len());
        self.accessor(bytemuck::cast_slice(normals), layout)
    }

    /// Linear colours with coverage, a byte each.
    pub fn colors(&mut self, colors: &[[u8; 4]]) -> json::Index<json::Accessor> {
        let layout = Layout::attribute(Type::Vec4, ComponentType::U8, colors.len());
        self.accessor(colors.as_flattened(), layout.normalized())
    }

    /// Triangles of a mesh of `vertex_count` vertices, in 16 bits a corner where that is enough.
    pub fn triangles(
        &mut self,
        triangles: &[[u32; 3]],
        vertex_count: usize,
    ) -> json::Index<json::Accessor> {
        let corners = triangles.as_flattened();
        let of = |component| Layout {
            target: Some(Target::ElementArrayBuffer),
            ..Layout::data(Type::Scalar, component, corners.len())
        };
        // 65,535 is left out: some graphics interfaces read it as "start a new strip".
        if vertex_count < usize::from(u16::MAX) {
            let narrow: Vec<u16> = corners.iter().map(|&corner| corner as u16).collect();
            return self.accessor(bytemuck::cast_slice(&narrow), of(ComponentType::U16));
        }
        self.accessor(bytemuck::cast_slice(corners), of(ComponentType::U32))
    }

    /// A mesh of one primitive with a matt, one-sided material whose colour is the vertices' own.
    pub fn body(
        &mut self,
        name: &str,
        attributes: Attributes,
        indices: json::Index<json::Accessor>,
    ) -> json::Index<json::Mesh> {
        use json::material::{PbrMetallicRoughness, StrengthFactor};
        let material = self.root.push(json::Material {
            name: Some("body".to_owned()),
            pbr_metallic_roughness: PbrMetallicRoughness {
                metallic_factor: StrengthFactor(0.0),
                roughness_factor: StrengthFactor(0.8),
                ..Default::default()
            },
            ..Default::default()
        });
        self.root.push(json::Mesh {
            extensions: None,
            extras: None,
            name: Some(name.to_owned()),
            primitives: vec![json::mesh::Primitive {
                attributes,
                extensions: None,
                extras: None,
                indices: Some(indices),
                material: Some(material),
                mode: Checked::Valid(json::mesh::Mode::Triangles),
                targets: None,
            }],
            weights: None,
        })
    }

    /// Gives a mesh of one primitive its morph targets, which viewers that know names show by name. All weigh nothing
    /// until a node or an animation says otherwise.
    pub fn morph(
        &mut self,
        mesh: json::Index<json::Mesh>,
        targets: Vec<json::mesh::MorphTarget>,
        names: &[String],
    ) {
        let mesh = &mut self.root.meshes[mesh.value()];
        mesh.weights = Some(vec![0.0; targets.len()]);
        mesh.extras = json::serialize::to_string(&BTreeMap::from([("targetNames", names)]))
            .and_then(json::extras::RawValue::from_string)
            .ok();
        for primitive in &mut mesh.primitives {
            primitive.targets = Some(targets.clone());
        }
    }

    /// An animation, straight between the times (seconds, rising, the first 0). One without tracks is not written: glTF
    /// knows none.
    pub fn animation(&mut self, name: &str, times_s: &[f32], tracks: Vec<Track>) {
        if tracks.is_empty() {
            return;
        }
        let end_s = times_s.last().copied().unwrap_or(0.0);
        let layout = Layout::data(Type::Scalar, ComponentType::F32, times_s.len());
        let input = self.accessor(
            bytemuck::cast_slice(times_s),
            layout.bounded(&[0.0], &[end_s]),
        );
        let mut animation = json::Animation {
            channels: Vec::new(),
            samplers: Vec::new(),
            extensions: None,
            extras: None,
            name: Some(name.to_owned()),
        };
        for track in tracks {
            let (shape, width) = match track.property {
                Property::Translation | Property::Scale => (Type::Vec3, 3),
                Property::Rotation => (Type::Vec4, 4),
                Property::MorphTargetWeights => (Type::Scalar, 1),
            };
            let layout = Layout::data(shape, ComponentType::F32, track.values.len() / width);
            let output = self.accessor(bytemuck::cast_slice(&track.values), layout);
            animation.samplers.push(Sampler {
                input,
                interpolation: Checked::Valid(Interpolation::Linear),
                output,
                extensions: None,
                extras: None,
            });
            animation.channels.push(Channel {
                sampler: json::Index::new(animation.samplers.len() as u32 - 1),
                target: json::animation::Target {
                    node: track.node,
                    path: Checked::Valid(track.property),
                    extensions: None,
                    extras: None,
                },
                extensions: None,
                extras: None,
            });
        }
        self.root.push(animation);
    }

    /// Makes `nodes` the roots of the scene that viewers show.
    pub fn scene(&mut self, nodes: Vec<json::Index<json::Node>>) {
        let scene = self.root.push(json::Scene {
            extensions: None,
            extras: None,
            name: None,
            nodes,
        });
        self.root.scene = Some(scene);
    }

    /// The whole file.
    ///
    /// # Errors
    /// [`gltf::Error`] when the description cannot be serialised.
    pub fn finish(mut self) -> Result<Vec<u8>, gltf::Error> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.root.push(json::Buffer {
            byte_length: USize64::from(self.bytes.len()),
            extensions: None,
            extras: None,
            name: None,
            uri: None,
        });
        let description = json::serialize::to_vec(&self.root).map_err(gltf::Error::Deserialize)?;
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
        glb.to_vec()
    }
}

/// The lowest and highest corner; zero for no positions.
fn bounds(positions: &[[f32; 3]]) -> ([f32; 3], [f32; 3]) {
    let first = positions.first().copied().unwrap_or_default();
    positions.iter().fold((first, first), |(low, high), p| {
        let fold =
            |a: [f32; 3], f: fn(f32, f32) -> f32| [f(a[0], p[0]), f(a[1], p[1]), f(a[2], p[2])];
        (fold(low, f32::min), fold(high, f32::max))
    })
}
