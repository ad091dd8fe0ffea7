//! The interchange file: a drawing as JSON, in one of three forms.
//!
//! ```json
//! {"figure": "human", "joints": {"forehead": [0.0, 1.7], "neck": [0.0, 1.5], "...": []}}
//! {"figure": "human", "path": [[0.0, 1.7], [0.0, 1.5], "... 17 points"]}
//! {"figure": "human", "strokes": [[[400, 80, 0.0], [401, 95, 0.02], "... [x, y, seconds]"], "..."], "y": "down"}
//! ```
//!
//! Any scale; y is up unless `"y": "down"` is given. Times may be left out.

mod parse;
mod write;

use glam::Vec2;
use thiserror::Error;

use crate::figure::Figure;
use crate::recognize::{RecognizeError, recognize_finished};
use crate::sketch::{Sketch, SketchError};
use crate::stroke::{Stroke, StrokeError};

/// Why a file is no drawing.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum InterchangeError {
    /// Not JSON, or a value of the wrong kind.
    #[error("sketch file, line {line}, column {column}: {message}")]
    Syntax {
        /// Counted from 1.
        line: usize,
        /// Counted from 1; 0 when the line is empty.
        column: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// The drawing is of another figure.
    #[error("the sketch file is of figure \"{got}\", but \"{expected}\" is needed")]
    WrongFigure {
        /// The figure it was read for.
        expected: String,
        /// The figure it names.
        got: String,
    },
    /// None, or more than one, of the three forms is there.
    #[error(
        "the sketch file has {count} of \"joints\", \"path\" and \"strokes\"; give exactly one of them"
    )]
    Forms {
        /// How many there are.
        count: usize,
    },
    /// Its points are no drawing of the figure.
    #[error(transparent)]
    Sketch(#[from] SketchError),
    /// A stroke has a bad point.
    #[error("stroke {stroke}: {source}")]
    Stroke {
        /// Counted from 0.
        stroke: usize,
        /// What is wrong with it.
        source: StrokeError,
    },
    /// Its strokes are not the figure's path.
    #[error(transparent)]
    Recognize(#[from] RecognizeError),
    /// There is no number in JSON for what should be written, or too many points.
    #[error("the drawing could not be written: {0}")]
    Write(String),
}

/// What a file holds, y up.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Drawing {
    /// One point per joint.
    Joints(Sketch),
    /// One point per path point.
    Path(Vec<Vec2>),
    /// What the pen did.
    Strokes(Vec<Stroke>),
}

impl Drawing {
    /// Reads a drawing of `figure` from the bytes of a file.
    ///
    /// # Errors
    /// [`InterchangeError`]: what is wrong, and where. Never panics, whatever the bytes.
    pub fn from_json(figure: &Figure, bytes: &[u8]) -> Result<Self, InterchangeError> {
        parse::drawing(figure, bytes)
    }

    /// The drawing as the text of a file, y up, one joint, path point or stroke a line. [`Drawing::from_json`] reads it
    /// back to an equal drawing.
    ///
    /// # Errors
    /// [`InterchangeError::Sketch`] when it is of another figure.
    pub fn to_json(&self, figure: &Figure) -> Result<String, InterchangeError> {
        write::json(figure, self)
    }

    /// The drawing as a sketch: path points are averaged, strokes recognised along the figure's path or, where that is
    /// likelier, in any order ([`recognize_finished`]).
    ///
    /// # Errors
    /// [`InterchangeError::Sketch`], [`InterchangeError::Recognize`].
    pub fn sketch(&self, figure: &Figure) -> Result<Sketch, InterchangeError> {
        match self {
            Self::Joints(sketch) => Ok(Sketch::new(figure, sketch.points().to_vec())?),
            Self::Path(points) => Ok(Sketch::from_path(figure, points)?),
            Self::Strokes(strokes) => Ok(recognize_finished(figure, strokes)?),
        }
    }
}

impl Sketch {
    /// Reads a sketch file of any form; see [`Drawing`].
    ///
    /// # Errors
    /// [`InterchangeError`]: what is wrong, and where.
    pub fn from_json(figure: &Figure, bytes: &[u8]) -> Result<Self, InterchangeError> {
        Drawing::from_json(figure, bytes)?.sketch(figure)
    }

    /// The sketch as the text of a file, joint by joint.
    ///
    /// # Errors
    /// [`InterchangeError::Sketch`] when the sketch is of another figure.
    pub fn to_json(&self, figure: &Figure) -> Result<String, InterchangeError> {
        Drawing::Joints(self.clone()).to_json(figure)
    }
}

/// The figure that a file names, to choose the model for it.
///
/// # Errors
/// [`InterchangeError::Syntax`].
pub fn figure_name(bytes: &[u8]) -> Result<String, InterchangeError> {
    parse::figure_name(bytes)
}
