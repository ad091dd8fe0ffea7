//! What can be wrong with a set of meshes.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::format::MeshFileError;

/// Why a set of meshes could not be read or used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MeshSetError {
    /// The folder cannot be listed.
    #[error("cannot list the folder {}: {source}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the file system said.
        source: io::Error,
    },
    /// There is nothing in it.
    #[error("{} holds no mesh: no file ends with .off, .ply or .obj", folder.display())]
    Empty {
        /// The folder.
        folder: PathBuf,
    },
    /// A file is wrong.
    #[error(transparent)]
    File(#[from] MeshFileError),
    /// A mesh is not of the set.
    #[error(
        "{} has {found} vertices, but {like} and the set have {expected}; remove it, or leave such meshes out with --skip-mismatched",
        file.display()
    )]
    Mismatch {
        /// The file.
        file: PathBuf,
        /// How many vertices it has.
        found: usize,
        /// How many are needed.
        expected: usize,
        /// A mesh that has as many.
        like: String,
    },
    /// One mesh is no set.
    #[error("{} holds {found} mesh of the same vertex count; two at least are needed: one to learn from, one to measure on", folder.display())]
    TooFew {
        /// The folder.
        folder: PathBuf,
        /// How many there are.
        found: usize,
    },
    /// The pilot is none of the meshes.
    #[error("the set has no mesh called `{name}`; did you mean `{nearest}`?")]
    UnknownPilot {
        /// As named.
        name: String,
        /// The mesh whose name is most like it.
        nearest: String,
    },
    /// The pilot has only vertices.
    #[error("{} has no faces; name another pilot, which gives the set its triangles", file.display())]
    NoTriangles {
        /// The pilot's file.
        file: PathBuf,
    },
    /// The pilot has no size.
    #[error("all vertices of {} are at one place", file.display())]
    Flat {
        /// The pilot's file.
        file: PathBuf,
    },
    /// A joint of the figure cannot be found on the meshes.
    #[error(
        "joint `{joint}` of the figure `{figure}` cannot be placed on the meshes: {why}; give it a list of vertices (`stick3d figure init --mesh` finds them)"
    )]
    Joint {
        /// The figure.
        figure: String,
        /// Its joint.
        joint: String,
        /// What is wrong.
        why: String,
    },
    /// A scale that is none.
    #[error("the scale is {0}; a positive number is needed")]
    Scale(f32),
    /// The figure's joints lie in one point on the pilot, or its template does.
    #[error(
        "the figure's joints are all at one place on the pilot mesh; are its vertices those of this set?"
    )]
    NoSize,
}
