//! A still mesh as binary glTF 2.0.

use std::borrow::Cow;
use std::collections::BTreeMap;

use gltf::binary::{Glb, Header};
use gltf::json;
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::Target;
use gltf::json::mesh::Semantic;
use gltf::json::validation::{Checked, USize64};

use super::{ExportError, ExportMesh};

/// One node, one mesh, one primitive, one matt material whose colour is the vertices' own.
pub(super) fn write(mesh: &ExportMesh<'_>) -> Result<Vec<u8>, ExportError> {
    let mut file = File::default();
    file.root.asset.generator = Some("stick3d".to_owned());
    let count = mesh.positions.len();
    let mut positions = accessor(Type::Vec3, ComponentType::F32, count);
    let (low, high) = bounds(mesh.positions);
    positions.min = Some(json::Value::from(low.to_vec()));
    positions.max = Some(json::Value::from(high.to_vec()));
    let mut colors = accessor(Type::Vec4, ComponentType::U8, count);
    colors.normalized = true;
    let indices = accessor(Type::Scalar, ComponentType::U32, 3 * mesh.triangles.len());
    let normals = accessor(Type::Vec3, ComponentType::F32, count);

    let per_vertex = Target::ArrayBuffer;
    let attributes = BTreeMap::from([
        (
            Checked::Valid(Semantic::Positions),
            file.push(bytemuck::cast_slice(mesh.positions), per_vertex, positions),
        ),
        (
            Checked::Valid(Semantic::Normals),
            file.push(bytemuck::cast_slice(mesh.normals), per_vertex, normals),
        ),
        (
            Checked::Valid(Semantic::Colors(0)),
            file.push(mesh.colors.as_flattened(), per_vertex, colors),
        ),
    ]);
    let corners = bytemuck::cast_slice(mesh.triangles.as_flattened());
    let indices = file.push(corners, Target::ElementArrayBuffer, indices);
    file.scene(mesh.name, attributes, indices);
    file.finish()
}

fn bounds(positions: &[[f32; 3]]) -> ([f32; 3], [f32; 3]) {
    let first = positions.first().copied().unwrap_or_default();
    positions.iter().fold((first, first), |(low, high), p| {
        let fold =
            |a: [f32; 3], f: fn(f32, f32) -> f32| [f(a[0], p[0]), f(a[1], p[1]), f(a[2], p[2])];
        (fold(low, f32::min), fold(high, f32::max))
    })
}

fn accessor(shape: Type, component: ComponentType, count: usize) -> json::Accessor {
    json::Accessor {
        buffer_view: None,
        byte_offset: None,
        count: USize64::from(count),
        component_type: Checked::Valid(GenericComponentType(component)),
        extensions: None,
        extras: None,
        type_: Checked::Valid(shape),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    }
}

/// The two chunks of the file while they grow.
#[derive(Default)]
struct File {
    root: json::Root,
    bytes: Vec<u8>,
}

impl File {
    /// Appends bytes with a view of their own and an accessor on it. All arrays here are multiples of four bytes long,
    /// so that each begins aligned.
    fn push(
        &mut self,
        bytes: &[u8],
        target: Target,
        accessor: json::Accessor,
    ) -> json::Index<json::Accessor> {
        let view = self.root.push(json::buffer::View {
            buffer: json::Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.bytes.len())),
            byte_stride: None,
            extensions: None,
            extras: None,
            name: None,
            target: Some(Checked::Valid(target)),
        });
        self.bytes.extend_from_slice(bytes);
        self.root.push(json::Accessor {
            buffer_view: Some(view),
            ..accessor
        })
    }

    fn scene(
        &mut self,
        name: &str,
        attributes: BTreeMap<Checked<Semantic>, json::Index<json::Accessor>>,
        indices: json::Index<json::Accessor>,
    ) {
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
        let mesh = self.root.push(json::Mesh {
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
        });
        let node = self.root.push(json::Node {
            name: Some(name.to_owned()),
            mesh: Some(mesh),
            ..Default::default()
        });
        let scene = self.root.push(json::Scene {
            extensions: None,
            extras: None,
            name: None,
            nodes: vec![node],
        });
        self.root.scene = Some(scene);
    }

    fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        self.root.push(json::Buffer {
            byte_length: USize64::from(self.bytes.len()),
            extensions: None,
            extras: None,
            name: None,
            uri: None,
        });
        let mut text =
            json::serialize::to_vec(&self.root).map_err(|e| ExportError::Mesh(e.to_string()))?;
        text.resize(text.len().next_multiple_of(4), b' ');
        let header = Header {
            magic: *b"glTF",
            version: 2,
            length: 0,
        };
        let glb = Glb {
            header,
            json: Cow::Owned(text),
            bin: Some(Cow::Owned(self.bytes)),
        };
        glb.to_vec().map_err(|e| ExportError::Mesh(e.to_string()))
    }
}
