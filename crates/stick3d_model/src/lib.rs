//! The networks, the model file and the frame-rate decoder of stick3d.
//!
//! Knows [`stick3d_figure`] and Burn. Knows no Bevy, and nothing of how a model is trained.
//!
//! - [`Model`] is everything one trained figure consists of, and what a `.stick3d` file holds.
//! - [`Inference`] runs a model at frame rate: sketch to latent to mesh, on plain arrays, allocating nothing.
//! - [`latent`] has motions: paths through latent space between and beyond keys, standing on the ground.
//! - [`network`] has the same networks as Burn modules, for training and as the reference that tests compare with.
//! - [`export`] writes meshes for other programs.

pub mod architecture;
pub mod color;
pub mod digest;
pub mod export;
pub mod file;
pub mod files;
pub mod final_layer;
pub mod infer;
mod kernels;
pub mod latent;
pub mod metadata;
pub mod model;
pub mod network;
#[cfg(test)]
mod synthetic;
pub mod weights;

pub use architecture::Architecture;
pub use file::ModelError;
pub use final_layer::FinalLayer;
pub use infer::{Alternative, Alternatives, InferError, Inference, JointMark, MarkedSketch};
pub use latent::{LatentKey, LatentPath, Motion};
pub use metadata::Metadata;
pub use model::{Model, ModelParts};
