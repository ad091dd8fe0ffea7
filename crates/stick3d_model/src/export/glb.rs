//! A still mesh as binary glTF 2.0.

use gltf::json;
use gltf::json::mesh::Semantic;
use gltf::json::validation::Checked;

use super::gltf_file::{Attributes, GltfFile};
use super::{ExportError, ExportMesh};

/// One node, one mesh, one primitive, one matt material whose colour is the vertices' own.
pub(super) fn write(mesh: &ExportMesh<'_>) -> Result<Vec<u8>, ExportError> {
    let mut file = GltfFile::default();
    let body = write_mesh(&mut file, mesh);
    let node = file.root.push(json::Node {
        name: Some(mesh.name.to_owned()),
        mesh: Some(body),
        ..Default::default()
    });
    file.scene(vec![node]);
    file.finish().map_err(|e| ExportError::Mesh(e.to_string()))
}

/// The mesh alone, for a node of the caller's.
pub(super) fn write_mesh(file: &mut GltfFile, mesh: &ExportMesh<'_>) -> json::Index<json::Mesh> {
    let attributes = Attributes::from([
        (
            Checked::Valid(Semantic::Positions),
            file.positions(mesh.positions),
        ),
        (
            Checked::Valid(Semantic::Normals),
            file.normals(mesh.normals),
        ),
        (
            Checked::Valid(Semantic::Colors(0)),
            file.colors(mesh.colors),
        ),
    ]);
    let indices = file.triangles(mesh.triangles, mesh.positions.len());
    file.body(mesh.name, attributes, indices)
}
