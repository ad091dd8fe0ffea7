//! Sketch files: reading and writing, with messages fit for the status line.

use std::path::{Path, PathBuf};

use stick3d_figure::{Figure, Sketch};
use stick3d_model::files::write_atomically;
use thiserror::Error;

/// A sketch file is small; anything larger was not meant.
const MAX_BYTES: u64 = 4_000_000;

/// Why a sketch file could not be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SketchFileError {
    /// It could not be read.
    #[error("cannot read {path}: {error}")]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// It is far too large.
    #[error("{path} has {bytes} bytes; a sketch file has at most {MAX_BYTES}")]
    TooLarge {
        /// Which file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// It was read, and is no sketch.
    #[error("{path} is no sketch: {message}")]
    Content {
        /// Which file.
        path: PathBuf,
        /// What is wrong, and where.
        message: String,
    },
    /// It could not be written; what was there before is still there.
    #[error("the sketch was not saved: {error}")]
    Write {
        /// Which file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
}

/// Reads a sketch of the man.
///
/// # Errors
/// [`SketchFileError`], which names the file and what is wrong with it.
pub fn read_sketch(path: &Path) -> Result<Sketch, SketchFileError> {
    let unreadable = |error| SketchFileError::Read {
        path: path.to_owned(),
        error,
    };
    let bytes = std::fs::metadata(path).map_err(unreadable)?.len();
    if bytes > MAX_BYTES {
        return Err(SketchFileError::TooLarge {
            path: path.to_owned(),
            bytes,
        });
    }
    let content = std::fs::read(path).map_err(unreadable)?;
    Sketch::from_json(Figure::human(), &content).map_err(|error| SketchFileError::Content {
        path: path.to_owned(),
        message: error.to_string(),
    })
}

/// Writes a sketch; a file that was there is replaced whole or not at all.
///
/// # Errors
/// [`SketchFileError::Write`].
pub fn write_sketch(path: &Path, figure: &Figure, sketch: &Sketch) -> Result<(), SketchFileError> {
    let unwritable = |error| SketchFileError::Write {
        path: path.to_owned(),
        error,
    };
    let text = sketch
        .to_json(figure)
        .map_err(|error| unwritable(std::io::Error::other(error.to_string())))?;
    write_atomically(path, text.as_bytes()).map_err(unwritable)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_saved_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sketch.json");
        let sketch = Sketch::template(Figure::human());
        write_sketch(&path, Figure::human(), &sketch).unwrap();
        assert_eq!(read_sketch(&path).unwrap(), sketch);
    }

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("missing.json");
        let message = read_sketch(&missing).unwrap_err().to_string();
        assert!(message.contains("missing.json"), "{message}");
        let sketch = Sketch::template(Figure::human());
        let nowhere = folder.path().join("no/such/folder/sketch.json");
        let message = write_sketch(&nowhere, Figure::human(), &sketch)
            .unwrap_err()
            .to_string();
        assert!(message.contains("no/such/folder"), "{message}");
        let text = folder.path().join("text.json");
        write_atomically(&text, b"this is no sketch").unwrap();
        let message = read_sketch(&text).unwrap_err().to_string();
        assert!(message.contains("text.json is no sketch"), "{message}");
    }
}
