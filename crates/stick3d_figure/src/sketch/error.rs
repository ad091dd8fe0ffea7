//! What can be wrong with the points of a sketch.

use thiserror::Error;

use super::MAX_COORDINATE;
use crate::figure::FigureError;

/// Why points are no drawing of a figure.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SketchError {
    /// The number of points does not fit the figure.
    #[error("{got} points given for {expected} {what} of figure \"{figure}\"; give one for each")]
    Count {
        /// The figure.
        figure: String,
        /// `"joints"` or `"path points"`.
        what: &'static str,
        /// How many are needed.
        expected: usize,
        /// How many came.
        got: usize,
    },
    /// A coordinate is NaN, infinite or huge.
    #[error("{place} is at ({x}, {y}); coordinates must be finite and within ±{MAX_COORDINATE}")]
    Coordinate {
        /// Which point: `joint "neck"`, `path point 3`.
        place: String,
        /// As given.
        x: f32,
        /// As given.
        y: f32,
    },
    /// All joints are at one place, so that the drawing has no size and no direction.
    #[error("all joints coincide at ({x}, {y}); draw the figure with some size")]
    Coincident {
        /// Where.
        x: f32,
        /// Where.
        y: f32,
    },
    /// A joint was given no point.
    #[error("joint \"{name}\" is missing; the drawing of figure \"{figure}\" needs all its joints")]
    Missing {
        /// The figure.
        figure: String,
        /// The first joint without a point.
        name: String,
    },
    /// A joint was given two points.
    #[error("joint \"{name}\" is given twice; give it once")]
    Duplicate {
        /// The joint.
        name: String,
    },
    /// A name is no joint of the figure.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The buffer for the input vector has another length.
    #[error("the input vector of figure \"{figure}\" has {expected} numbers, the buffer {got}")]
    BufferLength {
        /// The figure.
        figure: String,
        /// [`Figure::input_len`](crate::Figure::input_len).
        expected: usize,
        /// The buffer's length.
        got: usize,
    },
}
