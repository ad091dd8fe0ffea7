//! The three training stages of the paper (section 4.3), and the model file that comes out.
//!
//! 1. *VAE*: Encoder3D and Decoder, reconstruction plus Kullback-Leibler divergence.
//! 2. *Encoder2D* alone: it learns the mean that the frozen Encoder3D gives (equation 2), and beyond the paper, what
//!    the frozen Decoder makes of its guess.
//! 3. *Joint*: all three together.
//!
//! [`train`] runs them on a rigged body, [`train_meshes`] on registered meshes. It can be stopped at any time and resumed from the checkpoint in its run folder: all random
//! numbers depend on the seed and the step alone, so the result is the same to the last bit.

pub(crate) mod adam;
mod answers;
pub(crate) mod checkpoint;
mod config;
mod drawn_bodies;
mod error;
mod exactness;
mod export;
pub(crate) mod init;
mod log;
mod losses;
mod material;
mod networks;
mod plot;
mod progress;
mod run;
mod sketch_loss;
pub(crate) mod stages;
pub(crate) mod statistics;
mod tape;

pub use config::{HiddenLayers, LossWeights, StageConfig, TrainConfig};
pub use error::TrainError;
pub(crate) use export::INPUT_NORMALISATION;
pub use log::{LossLog, LossRecord};
pub(crate) use losses::Terms;
pub use material::{MeshTrainInput, TrainInput};
pub use progress::{Progress, Quiet, StageName};
pub use run::{Trained, train, train_meshes};

#[cfg(test)]
mod tests;
