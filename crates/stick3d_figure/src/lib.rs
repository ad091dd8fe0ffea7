//! What a figure is and what a drawing of it says: figures, strokes, sketches, recognition, meshes.

pub mod edit;
pub mod figure;
pub mod interchange;
pub mod mesh;
mod names;
pub mod preview;
pub mod recognize;
pub mod regressor;
pub mod scribble;
#[cfg(test)]
pub(crate) mod simulate;
pub mod sketch;
pub mod stroke;

pub use edit::{Drag, History};
pub use figure::{Anchor, Figure, FigureError, Joint, Side};
pub use interchange::{Drawing, InterchangeError};
pub use mesh::{MeshError, NormalAdjacency, TriangleMesh};
pub use preview::complete_from_template;
pub use recognize::{Pen, Progress, RecognizeError, progress, recognize};
pub use regressor::{JointRegressor, RegressorError};
pub use scribble::is_scribble;
pub use sketch::{Sketch, SketchError};
pub use stroke::{Stroke, StrokeError, StrokePoint};
