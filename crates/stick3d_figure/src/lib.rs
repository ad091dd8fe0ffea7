//! What a figure is and what a drawing of it says: figures, strokes, sketches, recognition, meshes.
//!
//! The ground floor of stick3d. It knows neither Bevy nor Burn, opens no files and draws nothing; it holds what all
//! other crates speak about:
//!
//! - A [`Figure`] is data: joints with sides, the *sketch path* in which they are drawn, bones, a template.
//!   [`Figure::human`] is built in, [`Figure::from_ron`] reads your own.
//! - [`Stroke`]s are what a pen did, in canvas pixels with times. Screens have y down, everything here has y up:
//!   [`stroke::flip_y`] is for the edge where pointer positions come in.
//! - [`recognize()`] turns strokes that follow the path into a [`Sketch`]; [`progress()`] says, while they are drawn, how
//!   far they are; [`recognize_any`] reads strokes in any order, direction and pieces; [`complete_from_template`] guesses the rest; [`is_scribble`] tells a wish to undo from a limb.
//! - A [`Sketch`] is one point per joint. [`Sketch::input_vector`] is what the networks read. [`edit`] drags, mirrors
//!   and undoes, [`interchange`] reads and writes the JSON files.
//! - [`TriangleMesh`] and its checks, [`NormalAdjacency`] for normals at frame rate, [`JointRegressor`] from a mesh
//!   back to joints.
//!
//! Axes: right-handed, +x right, +y up, +z toward the viewer. A man who faces the viewer has his right at negative x.
//!
//! ```
//! use stick3d_figure::{Figure, Pen, Stroke, progress, recognize};
//! use glam::Vec2;
//!
//! let human = Figure::human();
//! // A stroke per limb, here straight through the template's joints: head, arms, torso, legs.
//! let limbs = [
//!     &["forehead", "neck"][..], &["neck", "elbow_r", "hand_r"], &["neck", "elbow_l", "hand_l"],
//!     &["neck", "abdomen"], &["abdomen", "knee_r", "foot_r"], &["abdomen", "knee_l", "foot_l"],
//! ];
//! let mut strokes = Vec::new();
//! for limb in limbs {
//!     let mut corners = Vec::new();
//!     for name in limb {
//!         corners.push(human.template[human.joint_index(name)?] * 250.0 + Vec2::new(300.0, 50.0));
//!     }
//!     strokes.push(Stroke::from_positions(corners)?);
//! }
//!
//! let half_way = progress(human, &strokes[..3], Pen::Up);
//! assert_eq!(half_way.next_joint, Some(human.joint_index("abdomen")?));
//!
//! let sketch = recognize(human, &strokes)?;
//! assert_eq!(sketch.input_vector(human)?.len(), 34);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod edit;
pub mod figure;
pub mod interchange;
pub mod mesh;
pub mod names;
pub mod preview;
pub mod recognize;
pub mod regressor;
pub mod scribble;
#[cfg(any(test, feature = "simulate"))]
pub mod simulate;
pub mod sketch;
pub mod stroke;

pub use edit::{Drag, Grip, History};
pub use figure::{Anchor, Figure, FigureError, Joint, Side};
pub use interchange::{Drawing, InterchangeError};
pub use mesh::{MeshError, NormalAdjacency, TriangleMesh};
pub use preview::complete_from_template;
pub use recognize::any_order::{AnyOrder, recognize_any};
pub use recognize::{
    FreeReading, Pen, Progress, RecognizeError, completes, progress, read_freely, recognize,
    recognize_finished,
};
pub use regressor::{JointRegressor, RegressorError};
pub use scribble::is_scribble;
pub use sketch::{Sketch, SketchError};
pub use stroke::{Stroke, StrokeError, StrokePoint};
