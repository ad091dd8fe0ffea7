//! Why a file is no motion.

use std::path::PathBuf;

use stick3d_figure::interchange::InterchangeError;
use thiserror::Error;

use crate::infer::InferError;
use crate::latent::PathError;

/// Why a clip file could not be read or written, or why it is no motion. Keys are counted from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ClipError {
    /// The file system said no.
    #[error("clip file {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: std::io::Error,
    },
    /// The text is not RON of the expected form.
    #[error("clip file, line {line}, column {column}: {message}")]
    Syntax {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What the parser says.
        message: String,
    },
    /// The clip is of another figure than the model.
    #[error("the clip is of figure \"{found}\", but the model draws \"{expected}\"")]
    OtherFigure {
        /// The model's figure.
        expected: String,
        /// The clip's figure.
        found: String,
    },
    /// A key's sketch file cannot be read.
    #[error("key {key}: sketch file \"{file}\": {source}")]
    SketchFile {
        /// Which key.
        key: usize,
        /// The file, as the clip names it.
        file: String,
        /// What the file system said.
        source: std::io::Error,
    },
    /// A key's sketch is none of the figure.
    #[error("key {key}: {source}")]
    Sketch {
        /// Which key.
        key: usize,
        /// What is wrong with it.
        source: InterchangeError,
    },
    /// A key's sketch has no latent.
    #[error("key {key}: {source}")]
    Encode {
        /// Which key.
        key: usize,
        /// Why.
        source: InferError,
    },
    /// The keys are no path.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The clip could not be written as RON.
    #[error("the clip could not be written: {0}")]
    Write(String),
}
