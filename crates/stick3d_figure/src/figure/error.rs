//! What can be wrong with a figure.

use thiserror::Error;

/// Why a figure could not be read, checked or searched.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FigureError {
    /// The text is not RON of the expected form.
    #[error("figure file, line {line}, column {column}: {message}")]
    Syntax {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What the parser says.
        message: String,
    },
    /// The figure could not be written.
    #[error("figure could not be written as RON: {0}")]
    Write(String),
    /// A name is no joint of the figure.
    #[error("figure \"{figure}\" has no joint \"{name}\"; {suggestion}")]
    UnknownJoint {
        /// The figure that was searched.
        figure: String,
        /// The name that was asked for.
        name: String,
        /// What was probably meant.
        suggestion: String,
    },
    /// Two joints have one name.
    #[error("figure \"{figure}\" has two joints called \"{name}\"; joint names must differ")]
    DuplicateJoint {
        /// The figure.
        figure: String,
        /// The name that occurs twice.
        name: String,
    },
    /// A joint of one side has no partner on the other.
    #[error(
        "figure \"{figure}\": joint \"{name}\" is on one side, but no joint \"{expected}\" is on the other; add it, or say `mirror: Some(\"...\")`"
    )]
    NoMirror {
        /// The figure.
        figure: String,
        /// The joint without a partner.
        name: String,
        /// The name that was looked for.
        expected: String,
    },
    /// The parts of the figure do not fit together.
    #[error("figure \"{figure}\": {message}")]
    Inconsistent {
        /// The figure.
        figure: String,
        /// What is wrong, where, and what to do.
        message: String,
    },
}
