//! Writing meshes for other programs: binary glTF, OBJ, PLY, OFF; and [motions](animation).
//!
//! All have metres, +y up, and the triangles' order of corners counter-clockwise seen from outside.

pub mod animation;
mod glb;
pub mod gltf_file;
mod text;

use std::path::Path;

use thiserror::Error;

use crate::files::write_atomically;

/// A mesh to be written. All slices are borrowed; per-vertex ones have one entry per position.
#[derive(Debug, Clone, Copy)]
pub struct ExportMesh<'a> {
    /// What the mesh is called in the file.
    pub name: &'a str,
    /// Metres.
    pub positions: &'a [[f32; 3]],
    /// Unit vectors.
    pub normals: &'a [[f32; 3]],
    /// Linear red, green, blue and coverage, 255 = 1, as glTF has them.
    pub colors: &'a [[u8; 4]],
    /// Corners as vertex numbers.
    pub triangles: &'a [[u32; 3]],
}

/// A file format for meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Binary glTF 2.0: positions, normals, colours.
    Glb,
    /// Wavefront OBJ: positions, normals.
    Obj,
    /// Stanford PLY, ASCII: positions, normals, colours.
    Ply,
    /// Object file format: positions.
    Off,
}

/// Why a mesh was not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The file's name does not say which format.
    #[error(
        "cannot tell the format of {name:?} from its name; end it with .glb, .obj, .ply or .off"
    )]
    UnknownFormat {
        /// The name.
        name: String,
    },
    /// The mesh is not sound.
    #[error("the mesh cannot be written: {0}")]
    Mesh(String),
    /// The file system said no.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

impl MeshFormat {
    /// The format that a file's name ends with, in any case.
    ///
    /// # Errors
    /// [`ExportError::UnknownFormat`].
    pub fn of_path(path: &Path) -> Result<Self, ExportError> {
        let extension = path
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("glb") => Ok(Self::Glb),
            Some("obj") => Ok(Self::Obj),
            Some("ply") => Ok(Self::Ply),
            Some("off") => Ok(Self::Off),
            _ => Err(ExportError::UnknownFormat {
                name: path.display().to_string(),
            }),
        }
    }
}

/// The bytes of a mesh file. The same mesh gives the same bytes.
///
/// # Errors
/// [`ExportError::Mesh`] when slices differ in length, a number is not finite or a triangle names a vertex that does not exist.
pub fn mesh_bytes(mesh: &ExportMesh<'_>, format: MeshFormat) -> Result<Vec<u8>, ExportError> {
    check(mesh)?;
    match format {
        MeshFormat::Glb => glb::write(mesh),
        MeshFormat::Obj => Ok(text::obj(mesh).into_bytes()),
        MeshFormat::Ply => Ok(text::ply(mesh).into_bytes()),
        MeshFormat::Off => Ok(text::off(mesh).into_bytes()),
    }
}

/// Writes a mesh file in the format its name ends with: to a temporary file beside it, then renamed.
///
/// # Errors
/// [`ExportError`]; what stood at `path` before is then untouched.
pub fn save_mesh(mesh: &ExportMesh<'_>, path: &Path) -> Result<(), ExportError> {
    let format = MeshFormat::of_path(path)?;
    Ok(write_atomically(path, &mesh_bytes(mesh, format)?)?)
}

fn check(mesh: &ExportMesh<'_>) -> Result<(), ExportError> {
    let count = mesh.positions.len();
    let fault = |what: String| Err(ExportError::Mesh(what));
    if mesh.normals.len() != count || mesh.colors.len() != count {
        let (normals, colors) = (mesh.normals.len(), mesh.colors.len());
        return fault(format!(
            "{count} positions, {normals} normals and {colors} colours; the numbers must agree"
        ));
    }
    if mesh.triangles.is_empty() {
        return fault("it has no triangles".to_owned());
    }
    if let Some(corner) = mesh
        .triangles
        .as_flattened()
        .iter()
        .find(|corner| **corner as usize >= count)
    {
        return fault(format!(
            "a triangle names vertex {corner}, there are {count}"
        ));
    }
    let finite = |list: &[[f32; 3]]| list.as_flattened().iter().all(|x| x.is_finite());
    if !finite(mesh.positions) || !finite(mesh.normals) {
        return fault("a position or normal is not finite".to_owned());
    }
    Ok(())
}

#[cfg(test)]
mod tests;
