//! Writing motions for other programs: binary glTF with morph targets, or a folder of numbered meshes.
//!
//! A motion is sampled into [`Frame`]s, and these are written:
//!
//! ```no_run
//! use stick3d_model::export::animation::{
//!     AnimationMesh, DEFAULT_TOLERANCE_M, FrameSettings, sample_frames, save_glb_animation,
//! };
//! # use stick3d_model::{Inference, Model, Motion};
//! # fn write(model: &Model, motion: &Motion) -> Result<(), Box<dyn std::error::Error>> {
//! # let mut inference = Inference::new(model)?;
//! let frames = sample_frames(motion, FrameSettings::default(), &mut inference)?;
//! let mesh = AnimationMesh::of(model, "walk");
//! let report = save_glb_animation("walk.glb".as_ref(), &mesh, frames, DEFAULT_TOLERANCE_M)?;
//! # let _ = report;
//! # Ok(())
//! # }
//! ```
//!
//! In the glTF, the body of the first frame is the mesh. All others are the mesh plus a few shapes, the morph targets, each
//! with a weight; an animation moves the weights, and the node over the ground. The targets are found by their need: the
//! frame that is farthest from what the targets so far can make gives the next one, until every vertex of every frame is
//! within the tolerance. So their number depends on how rich the motion is, not on how long it takes. All weights are
//! between 0 and 1. Normals follow the same weights. No extension of glTF is needed.

mod frames;
mod glb;
mod reduce;
mod sequence;

use thiserror::Error;

use super::{ExportError, ExportMesh};
use crate::infer::InferError;
use crate::latent::PathError;
use crate::model::Model;

pub use frames::{Frame, FrameSettings, MOST_FRAMES, sample_frames};
pub use glb::{
    AnimationReport, DEFAULT_TOLERANCE_M, GlbAnimation, MOST_TARGETS, glb_animation,
    save_glb_animation,
};
pub use sequence::{frame_name, save_obj_sequence};

/// What all frames of a motion have in common.
#[derive(Debug, Clone, Copy)]
pub struct AnimationMesh<'a> {
    /// What node, mesh and animation are called in the file.
    pub name: &'a str,
    /// One per vertex: linear red, green, blue and coverage, 255 = 1.
    pub colors: &'a [[u8; 4]],
    /// Corners as vertex numbers.
    pub triangles: &'a [[u32; 3]],
}

impl<'a> AnimationMesh<'a> {
    /// The mesh of a model.
    #[must_use]
    pub fn of(model: &'a Model, name: &'a str) -> Self {
        Self {
            name,
            colors: model.colors(),
            triangles: model.triangles(),
        }
    }

    /// The mesh with the body of a frame.
    fn with<'f>(&'f self, frame: &'f Frame) -> ExportMesh<'f> {
        ExportMesh {
            name: self.name,
            positions: &frame.positions,
            normals: &frame.normals,
            colors: self.colors,
            triangles: self.triangles,
        }
    }
}

/// Why a motion was not written. Nothing is left of it then.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AnimationError {
    /// Frames come at no rate.
    #[error("{fps} frames a second are none; give a number above 0, such as 30")]
    FrameRate {
        /// As given.
        fps: f32,
    },
    /// The time after the last key is no time.
    #[error("the clip cannot go on for {past_s} s after its last key; give a number from 0 on")]
    Past {
        /// As given, seconds.
        past_s: f32,
    },
    /// More frames than memory is meant for.
    #[error(
        "{seconds} s at {fps} frames a second are more than {MOST_FRAMES} frames; take fewer of either"
    )]
    TooManyFrames {
        /// How long the clip would take, seconds.
        seconds: f32,
        /// Frames a second.
        fps: f32,
    },
    /// No frame at all.
    #[error("there are no frames to write")]
    NoFrames,
    /// The tolerance cannot be met in single precision, or is NaN.
    #[error("a tolerance of {tolerance_m} m cannot be held; give at least {LEAST_TOLERANCE_M}")]
    Tolerance {
        /// As given, metres.
        tolerance_m: f32,
    },
    /// The motion cannot be sampled.
    #[error(transparent)]
    Path(#[from] PathError),
    /// A frame cannot be decoded.
    #[error(transparent)]
    Infer(#[from] InferError),
    /// A frame is no sound mesh, or the file system said no.
    #[error(transparent)]
    Export(#[from] ExportError),
}

/// The finest tolerance: a hundredth of a millimetre, some roundings above what single precision holds.
const LEAST_TOLERANCE_M: f32 = 1e-5;

#[cfg(test)]
mod tests;
