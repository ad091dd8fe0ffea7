//! What a figure is and what a drawing of it says: figures, strokes, sketches, recognition, meshes.

pub mod figure;
pub mod mesh;
mod names;
pub mod regressor;
pub mod sketch;

pub use figure::{Anchor, Figure, FigureError, Joint, Side};
pub use mesh::{MeshError, NormalAdjacency, TriangleMesh};
pub use regressor::{JointRegressor, RegressorError};
pub use sketch::{Sketch, SketchError};
