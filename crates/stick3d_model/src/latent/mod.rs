//! Motions: paths through latent space, from keys that were sketched.
//!
//! - [`LatentPath`] goes through [`LatentKey`]s, straight or curved, once, round and round or back and forth.
//! - [`Trust`] says how far a latent is to be trusted to be a body.
//! - [`Motion`] adds to a path what is beyond its keys, bounded by trust, and where the figure stands.
//! - [`ClipFile`] is a motion as a file, `*.clip.ron`.
//!
//! ```
//! use stick3d_figure::Sketch;
//! use stick3d_model::latent::{Easing, MotionSettings};
//! use stick3d_model::{Inference, LatentKey, Model, Motion};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let bytes = include_bytes!("../../../../assets/models/human.stick3d");
//! let model = Model::from_bytes(bytes)?;
//! let mut inference = Inference::new(&model)?;
//! let mut key = |sketch: &[u8], time_s: f32| -> Result<LatentKey, Box<dyn std::error::Error>> {
//!     let sketch = Sketch::from_json(model.figure(), sketch)?;
//!     let mut latent = vec![0.0; inference.latent_len()];
//!     inference.encode(&sketch, &mut latent)?;
//!     Ok(LatentKey { latent, time_s, easing: Easing::Linear })
//! };
//! # let standing = include_bytes!("../../../../assets/sketches/standing.json");
//! # let wave = include_bytes!("../../../../assets/sketches/wave.json");
//! let keys = [key(standing, 0.0)?, key(wave, 0.8)?];
//! let motion = Motion::new(&keys, MotionSettings::default(), &mut inference)?;
//!
//! let mut latent = vec![0.0; motion.path().latent_len()];
//! motion.sample_into(0.9, &mut latent)?; // a little past the last key
//! assert!(motion.is_beyond(0.9) && motion.trust(0.9) > 0.0);
//! assert!(motion.root_translation(0.9).is_some_and(|root| root.y > 0.5));
//! # Ok(())
//! # }
//! ```

mod clip;
mod course;
mod easing;
mod error;
mod extrapolation;
mod grounding;
mod motion;
mod path;
mod statistics;
mod trust;

pub use clip::{ClipError, ClipFile, ClipKey, ClipPose};
pub use course::Repeat;
pub use easing::Easing;
pub use error::PathError;
pub use extrapolation::{DEFAULT_LEAST_TRUST, Extrapolation};
pub use grounding::feet;
pub use motion::{Motion, MotionSettings};
pub use path::{Interpolation, LatentKey, LatentPath};
pub use statistics::TrainingStatistics;
pub use trust::Trust;
pub(crate) use trust::{LongestEdges, Probe};
