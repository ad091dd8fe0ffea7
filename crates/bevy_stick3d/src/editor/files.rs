//! Sketch files: reading and writing, with messages fit for the status line.

use std::path::{Path, PathBuf};

use stick3d_figure::interchange::figure_name;
use stick3d_figure::{Figure, InterchangeError, Sketch};
use stick3d_model::files::write_atomically;
use thiserror::Error;

use super::words::known_figures;

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
    /// It is a sketch of a figure that is not there.
    #[error(
        "{path} is a sketch of figure \"{name}\", which is not here; {suggestion} Start the editor with --model FILE for a figure of your own"
    )]
    UnknownFigure {
        /// Which file.
        path: PathBuf,
        /// The figure that it names.
        name: String,
        /// What was probably meant, a sentence.
        suggestion: String,
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

/// Reads a sketch of one of these figures: which one, and the sketch. Of figures with one name it is the first.
///
/// # Errors
/// [`SketchFileError`], which names the file and what is wrong with it.
pub fn read_sketch(path: &Path, figures: &[&Figure]) -> Result<(usize, Sketch), SketchFileError> {
    let unreadable = |error| SketchFileError::Read {
        path: path.to_owned(),
        error,
    };
    let no_sketch = |error: InterchangeError| SketchFileError::Content {
        path: path.to_owned(),
        message: error.to_string(),
    };
    let bytes = std::fs::metadata(path).map_err(unreadable)?.len();
    if bytes > MAX_BYTES {
        return Err(SketchFileError::TooLarge {
            path: path.to_owned(),
            bytes,
        });
    }
    let content = std::fs::read(path).map_err(unreadable)?;
    let name = figure_name(&content).map_err(no_sketch)?;
    let index = figures
        .iter()
        .position(|figure| figure.name == name)
        .ok_or_else(|| SketchFileError::UnknownFigure {
            path: path.to_owned(),
            suggestion: known_figures(&name, figures.iter().copied()),
            name: name.chars().take(64).collect(),
        })?;
    let sketch = Sketch::from_json(figures[index], &content).map_err(no_sketch)?;
    Ok((index, sketch))
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
        assert_eq!(read_sketch(&path, &[Figure::human()]).unwrap(), (0, sketch));
    }

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("missing.json");
        let refusal = |path: &Path| {
            let refused = read_sketch(path, &[Figure::human()]);
            refused.unwrap_err().to_string()
        };
        let message = refusal(&missing);
        assert!(message.contains("missing.json"), "{message}");
        let sketch = Sketch::template(Figure::human());
        let nowhere = folder.path().join("no/such/folder/sketch.json");
        let message = write_sketch(&nowhere, Figure::human(), &sketch)
            .unwrap_err()
            .to_string();
        assert!(message.contains("no/such/folder"), "{message}");
        let text = folder.path().join("text.json");
        write_atomically(&text, b"this is no sketch").unwrap();
        let message = refusal(&text);
        assert!(message.contains("text.json is no sketch"), "{message}");
        let foreign = folder.path().join("ape.json");
        write_atomically(&foreign, br#"{"figure": "hunam", "joints": {}}"#).unwrap();
        let message = refusal(&foreign);
        assert!(
            message.contains("ape.json") && message.contains("mean \"human\"?"),
            "{message}"
        );
    }
}
