//! Why bytes are no model.

use std::path::PathBuf;

use stick3d_figure::regressor::RegressorError;
use thiserror::Error;

use crate::final_layer::FinalLayerError;

/// Why a model could not be read, written or put together.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The file system said no.
    #[error("model file {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: std::io::Error,
    },
    /// There are no bytes.
    #[error("the model file is empty; fetch it again, or train a model with `stick3d train`")]
    Empty,
    /// The file ends before its arrays do.
    #[error(
        "the model file is cut off: it has {found} bytes, its header promises {expected}; fetch it again"
    )]
    Truncated {
        /// How many bytes the header promises.
        expected: u64,
        /// How many there are.
        found: u64,
    },
    /// Not safetensors at all.
    #[error("not a model file: it is no valid safetensors file ({0}); expected a .stick3d file")]
    NotSafetensors(String),
    /// Safetensors, but not ours.
    #[error(
        "a safetensors file, but no stick3d model: it has no `stick3d` metadata; expected a .stick3d file"
    )]
    Foreign,
    /// Made by a later version.
    #[error(
        "the model file has format version {found}, this program reads up to {supported}; update stick3d"
    )]
    NewerVersion {
        /// What the file has.
        found: u32,
        /// The newest this program reads.
        supported: u32,
    },
    /// The bytes are not those that were written.
    #[error("the model file is damaged: its checksum does not match; fetch it again")]
    Checksum,
    /// The metadata is not what it should be.
    #[error("the model file's metadata is invalid: {0}")]
    Metadata(String),
    /// An array is missing.
    #[error("the model file lacks the array `{name}`")]
    MissingArray {
        /// Its name.
        name: String,
    },
    /// An array has another type or shape than it should.
    #[error("the model file's array `{name}` is {found}, expected {expected}")]
    Array {
        /// Its name.
        name: String,
        /// Type and shape it should have.
        expected: String,
        /// Type and shape it has.
        found: String,
    },
    /// An array has NaN or infinity in it.
    #[error("the model file's array `{name}` has a number that is not finite at index {index}")]
    NotFinite {
        /// Its name.
        name: String,
        /// Where.
        index: usize,
    },
    /// The mesh is wired differently.
    #[error(
        "the model is for another mesh: topology {found}, expected {expected}; use a model of the same figure"
    )]
    WrongTopology {
        /// The hash wanted.
        expected: String,
        /// The hash of the mesh at hand.
        found: String,
    },
    /// A triangle names a vertex that does not exist.
    #[error("a triangle of the model names vertex {index}, but there are {vertex_count}")]
    TriangleOutOfRange {
        /// The vertex it names.
        index: u32,
        /// How many there are.
        vertex_count: usize,
    },
    /// A network speaks another latent.
    #[error("a network of the model has a latent of {found} numbers, the model says {expected}")]
    WrongLatentLength {
        /// What the metadata says.
        expected: usize,
        /// What the network has.
        found: usize,
    },
    /// A network's layers are not those of the architecture.
    #[error("{part} has layers of widths {found:?}, the model's architecture says {expected:?}")]
    Architecture {
        /// Which network.
        part: &'static str,
        /// Widths the architecture gives.
        expected: Vec<usize>,
        /// Widths it has.
        found: Vec<usize>,
    },
    /// A part has another number of something than it should.
    #[error("the model has {found} {what}, expected {expected}")]
    Count {
        /// Of what.
        what: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The joint regressor is none.
    #[error("the model's joint regressor is invalid: {0}")]
    Regressor(#[from] RegressorError),
    /// The final layer's arrays do not fit together.
    #[error(transparent)]
    FinalLayer(#[from] FinalLayerError),
    /// Serialising failed.
    #[error("cannot write the model: {0}")]
    Write(String),
}
