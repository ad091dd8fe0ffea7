//! What can be wrong with a mesh file, and where.

use std::fmt::{self, Display};
use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line of text, counted from 1.
    Line(usize),
    /// A byte, counted from 0.
    Byte(usize),
}

impl Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// What is wrong there.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Fault {
    /// The file begins otherwise than its format does.
    #[error("{format} files begin with {expected}, not with {found:?}")]
    Header {
        /// The format.
        format: &'static str,
        /// How its files begin.
        expected: &'static str,
        /// How this one does.
        found: String,
    },
    /// A kind of file that is not read.
    #[error("{0} is not read; save the mesh again without")]
    Unsupported(String),
    /// A word is not of the kind that belongs there.
    #[error("{found:?} is no {expected}")]
    Word {
        /// What belongs there.
        expected: &'static str,
        /// What stands there.
        found: String,
    },
    /// Something is not there that must be.
    #[error("{0} is missing")]
    Missing(&'static str),
    /// A position is NaN, infinite, or beyond 32-bit numbers.
    #[error("vertex {vertex} is at no finite position")]
    NotFinite {
        /// Its number, counted from 0.
        vertex: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("a face names vertex {named}, but the vertices end with {last}")]
    NoSuchVertex {
        /// As the file has it.
        named: i64,
        /// The last that exists, counted as the format counts.
        last: i64,
    },
    /// A file ends before its end.
    #[error("the file ends with {found} of {expected} {what}")]
    Truncated {
        /// Elements of which kind.
        what: String,
        /// How many there are.
        found: usize,
        /// How many were promised.
        expected: usize,
    },
    /// A count that cannot be true.
    #[error("{count} {what} are promised, more than a file of {bytes} bytes can hold")]
    TooMany {
        /// Elements of which kind.
        what: String,
        /// How many were promised.
        count: u64,
        /// The length of the file.
        bytes: usize,
    },
}

/// What is wrong with a mesh file, and where in it.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{place}: {fault}")]
pub struct ParseError {
    /// Where.
    pub place: Place,
    /// What.
    pub fault: Fault,
}

impl ParseError {
    /// A fault in a line of text.
    pub(super) fn line(line: usize, fault: Fault) -> Self {
        Self {
            place: Place::Line(line),
            fault,
        }
    }
}

/// Why a mesh file could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MeshFileError {
    /// The name says no format.
    #[error("{}: meshes are read from files that end with .off, .ply or .obj", .0.display())]
    Ending(PathBuf),
    /// The file system said no.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: io::Error,
    },
    /// The file is wrong.
    #[error("{}, {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        source: ParseError,
    },
}
