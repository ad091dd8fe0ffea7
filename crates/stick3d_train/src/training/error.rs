//! Why training did not end with a model.

use std::path::PathBuf;

use stick3d_figure::sketch::SketchError;
use stick3d_model::{InferError, ModelError};
use thiserror::Error;

use crate::dataset::BasisError;
use crate::device::DeviceError;
use crate::meshes::MeshSetError;
use crate::rig::RigError;

/// Why training did not end with a model.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TrainError {
    /// The configuration contradicts itself.
    #[error("the training configuration is wrong: {0}")]
    Config(String),
    /// The rig does not fit the figure.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The mesh set does not fit the figure.
    #[error(transparent)]
    Meshes(#[from] MeshSetError),
    /// The meshes have no basis.
    #[error(transparent)]
    Basis(#[from] BasisError),
    /// A body gave a sketch that says nothing.
    #[error("a training body has no sketch: {0}")]
    Sketch(#[from] SketchError),
    /// The trained networks give no bodies.
    #[error(transparent)]
    Infer(#[from] InferError),
    /// The loss is no number any more.
    #[error("the loss of stage {stage} is {loss} after epoch {epoch}; lower the learning rate")]
    Diverged {
        /// Name of the stage.
        stage: &'static str,
        /// Number of the epoch, from 0.
        epoch: usize,
        /// The loss.
        loss: f64,
    },
    /// There is no such device.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The device failed.
    #[error("the tensor backend failed: {0}")]
    Backend(String),
    /// The checkpoint is not of this run.
    #[error("{} is no checkpoint of this run ({problem}); remove it, or train without resuming", path.display())]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The file system said no.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: std::io::Error,
    },
    /// The loss plot could not be drawn.
    #[error("cannot draw the loss plot: {0}")]
    Plot(String),
    /// The trained parts make no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The caller asked to stop; a checkpoint is written.
    #[error("stopped after {epochs} epochs; resume from the checkpoint to go on")]
    Stopped {
        /// Epochs run over all stages.
        epochs: usize,
    },
}
