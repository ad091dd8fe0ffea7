//! What a figure is and what a drawing of it says: figures, strokes, sketches, recognition, meshes.

pub mod figure;
pub mod mesh;
mod names;
pub mod recognize;
pub mod regressor;
#[cfg(test)]
pub(crate) mod simulate;
pub mod sketch;
pub mod stroke;

pub use figure::{Anchor, Figure, FigureError, Joint, Side};
pub use mesh::{MeshError, NormalAdjacency, TriangleMesh};
pub use recognize::{Pen, Progress, RecognizeError, progress, recognize};
pub use regressor::{JointRegressor, RegressorError};
pub use sketch::{Sketch, SketchError};
pub use stroke::{Stroke, StrokeError, StrokePoint};
