//! A motion as a folder of numbered meshes.

use std::path::Path;

use super::{AnimationError, AnimationMesh, Frame};
use crate::export::{ExportError, MeshFormat, mesh_bytes};
use crate::files::write_folder_atomically;

/// Writes every frame as an OBJ file, `frame_0001.obj` and so on, into a new folder, bodies where the motion moves them to:
/// into a temporary folder beside it, then renamed.
///
/// # Errors
/// [`AnimationError::NoFrames`]; [`AnimationError::Export`] when a frame is no sound mesh, when the folder exists and holds
/// anything, or when the file system says no. Nothing is left of the frames then.
pub fn save_obj_sequence(
    folder: &Path,
    mesh: &AnimationMesh<'_>,
    mut frames: Vec<Frame>,
) -> Result<(), AnimationError> {
    if frames.is_empty() {
        return Err(AnimationError::NoFrames);
    }
    let files = (1..).zip(&mut frames).map(|(number, frame)| {
        frame.apply_root();
        let bytes = mesh_bytes(&mesh.with(frame), MeshFormat::Obj)?;
        Ok::<_, ExportError>((frame_name(number, "obj"), bytes))
    });
    Ok(write_folder_atomically(folder, files)?)
}

/// The name of a frame's file; counted from 1.
#[must_use]
pub fn frame_name(number: usize, ending: &str) -> String {
    format!("frame_{number:04}.{ending}")
}
