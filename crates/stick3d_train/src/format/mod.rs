//! Reading triangle meshes that other programs wrote: OFF, PLY and OBJ as they are found in the wild.
//!
//! Positions keep the file's unit and axes, vertices their order. Polygons are cut into fans of triangles; normals,
//! texture coordinates and the colours of faces are passed over. Every count is held against the size of the file before
//! memory is taken for it.

mod error;
mod obj;
mod off;
mod ply;
mod ply_header;
mod text;

use std::path::{Path, PathBuf};

pub use error::{Fault, MeshFileError, ParseError, Place};
pub(crate) use obj::{Record, each_record};
use stick3d_figure::TriangleMesh;

/// What a mesh file holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FileMesh {
    /// Finite positions in the file's unit and axes; triangles may be none.
    pub mesh: TriangleMesh,
    /// One colour per vertex where the file has any: linear red, green, blue and coverage, 255 = 1.
    pub colors: Option<Vec<[u8; 4]>>,
}

/// The formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SourceFormat {
    /// Object file format, text: `OFF`, `NOFF`, `COFF`, `CNOFF`, `STOFF` and their like.
    Off,
    /// Stanford PLY: ASCII, binary of either byte order.
    Ply,
    /// Wavefront OBJ.
    Obj,
}

impl SourceFormat {
    /// The format that a file's name ends with, in any case; `None` for other files.
    #[must_use]
    pub fn of_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "off" | "noff" | "coff" => Some(Self::Off),
            "ply" => Some(Self::Ply),
            "obj" => Some(Self::Obj),
            _ => None,
        }
    }

    /// The mesh that the bytes of a file say.
    ///
    /// # Errors
    /// [`ParseError`] with the line or byte at fault.
    pub fn parse(self, bytes: &[u8]) -> Result<FileMesh, ParseError> {
        match self {
            Self::Off => off::parse(bytes),
            Self::Ply => ply::parse(bytes),
            Self::Obj => obj::parse(bytes),
        }
    }
}

/// Reads a mesh file in the format its name ends with.
///
/// # Errors
/// [`MeshFileError`], which names the file.
pub fn read_mesh(path: &Path) -> Result<FileMesh, MeshFileError> {
    let named = || -> PathBuf { path.to_owned() };
    let format = SourceFormat::of_path(path).ok_or_else(|| MeshFileError::Ending(named()))?;
    let bytes = std::fs::read(path).map_err(|source| MeshFileError::Io {
        path: named(),
        source,
    })?;
    format.parse(&bytes).map_err(|source| MeshFileError::Parse {
        path: named(),
        source,
    })
}

/// The triangles of a polygon, all at its first corner; none for fewer than three corners.
fn fan(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let Some((first, rest)) = corners.split_first() {
        triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
    }
}

/// A position as it is kept, if that is finite.
fn position(numbers: [f64; 3], vertex: usize) -> Result<glam::Vec3, Fault> {
    let position = glam::Vec3::from_array(numbers.map(|number| number as f32));
    if position.is_finite() {
        return Ok(position);
    }
    Err(Fault::NotFinite { vertex })
}

#[cfg(test)]
mod tests;
