//! What a training run is made of.

use serde::{Deserialize, Serialize};
use stick3d_figure::figure::Figure;
use stick3d_model::Architecture;
use stick3d_model::architecture::LATENT_LEN;

use super::TrainError;
use crate::dataset::{Augmentation, BasisConfig, Rotations};
use crate::device::ComputeDevice;
use crate::size::relative_size;

/// Everything that decides what a run yields, beside the rig and the poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrainConfig {
    /// What all random numbers depend on.
    pub seed: u64,
    /// Hidden layers of the networks.
    pub hidden: HiddenLayers,
    /// Length of the latent.
    pub latent_len: usize,
    /// How many latents Encoder2D gives to a sketch.
    #[serde(default = "one")]
    pub hypotheses: usize,
    /// The basis of the meshes.
    pub basis: BasisConfig,
    /// At most how many principal components of the meshes stand in for that basis; figures without a rig need them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub principal_components: Option<usize>,
    /// Bodies drawn from the pose streams.
    pub sampled_bodies: usize,
    /// How often every library pose (and its mirror image) is in the set.
    pub library_repeats: usize,
    /// How bodies are turned.
    pub rotations: Rotations,
    /// How sketches are disturbed.
    pub augmentation: Augmentation,
    /// Bodies in a batch.
    pub batch_size: usize,
    /// The three stages in order.
    pub stages: [StageConfig; 3],
    /// How the terms of the losses are weighed.
    pub loss: LossWeights,
    /// Epochs between two checkpoints.
    pub checkpoint_every: usize,
    /// What to compute on. The last digits of a model depend on it.
    #[serde(skip)]
    pub device: ComputeDevice,
}

fn one() -> usize {
    1
}

/// Widths of the hidden layers of the networks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HiddenLayers {
    /// Encoder3D's.
    pub encoder3d: Vec<usize>,
    /// Those of the decoder's head.
    pub head: Vec<usize>,
    /// Encoder2D's.
    pub encoder2d: Vec<usize>,
}

/// One stage of training.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StageConfig {
    /// Passes over all bodies.
    pub epochs: usize,
    /// Adam's step at the start of the stage; it falls along a half cosine to a hundredth.
    pub learning_rate: f64,
}

/// How the terms of the losses are weighed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LossWeights {
    /// Paper's alpha: weight of the mean squared error over all coordinates in normalised units, against the
    /// Kullback-Leibler divergence (section 4.3: 1e5).
    pub alpha: f64,
    /// Weight of the mean squared error of the normalised codes beside that of the coordinates.
    pub code: f64,
    /// Weight of the whole autoencoder loss in the joint stage.
    pub autoencoder: f64,
    /// Weight of equation 2: squared error between the two encoders, mean over the latent.
    pub latent: f64,
    /// Weight of the mean distance between the vertices of the decoded sketch and of the body, centimetres.
    pub vertices: f64,
    /// Weight of the mean distance between their joints, centimetres.
    pub joints: f64,
    /// Weight of the mean distance between their joints on the sketch plane, centimetres.
    pub reprojection: f64,
    /// Weight of the mean error of the bones' lengths, per cent.
    pub bones: f64,
    /// How many vertices stand for all of them in the vertex distance.
    pub probes: usize,
    /// Weight of the cross entropy between the hypotheses' scores and which of them came nearest.
    #[serde(default)]
    pub score: f64,
}

impl TrainConfig {
    /// The recipe of the shipped models, with the views of `figure`; lengths in it go with the size of its template
    /// ([`relative_size`]), so that a fox of half a metre is learnt as a horse is.
    #[must_use]
    pub fn of(figure: &Figure) -> Self {
        let size = relative_size(figure.template_extent_m());
        let per_length = 1.0 / f64::from(size);
        Self {
            seed: 1,
            hidden: HiddenLayers {
                encoder3d: vec![512, 512],
                head: vec![512, 512],
                encoder2d: vec![1024, 1024, 384],
            },
            latent_len: LATENT_LEN,
            hypotheses: 8,
            basis: BasisConfig {
                helpers: 32,
                poses: 2000,
            },
            principal_components: None,
            sampled_bodies: 80_000,
            library_repeats: 20,
            rotations: Rotations::of(&figure.views),
            augmentation: Augmentation {
                clean_share: 0.5,
                jitter_m: 0.04 * size,
                bone_scale: 0.2,
                missing_share: 0.1,
            },
            batch_size: 128,
            stages: [
                StageConfig {
                    epochs: 4,
                    learning_rate: 1e-3,
                },
                StageConfig {
                    epochs: 6,
                    learning_rate: 1e-3,
                },
                StageConfig {
                    epochs: 32,
                    learning_rate: 1e-3,
                },
            ],
            loss: LossWeights {
                alpha: 1e5,
                code: 0.01,
                autoencoder: 0.02,
                latent: 1.0,
                vertices: per_length,
                joints: 0.5 * per_length,
                reprojection: per_length,
                bones: 0.2,
                probes: 300,
                score: 1.0,
            },
            checkpoint_every: 2,
            device: ComputeDevice::default(),
        }
    }

    /// A recipe for `count` registered meshes of `figure`: as the shipped models', on principal components, with every mesh so often in an
    /// epoch, each time turned otherwise, that the steps are about a third of theirs.
    #[must_use]
    pub fn meshes(figure: &Figure, count: usize, vertex_count: usize) -> Self {
        const BODIES: usize = 16_000;
        const BASIS_BYTES: usize = 16_000_000;
        Self {
            principal_components: Some((BASIS_BYTES / 4 / vertex_count.max(1)).clamp(8, 256)),
            sampled_bodies: 0,
            library_repeats: BODIES.div_ceil(count.max(1)),
            ..Self::of(figure)
        }
    }

    /// Checks that the parts fit together.
    pub(crate) fn validate(&self) -> Result<(), TrainError> {
        let fault = |problem: String| Err(TrainError::Config(problem));
        if self.batch_size == 0 || self.latent_len == 0 || self.hypotheses == 0 {
            return fault("batch size, latent length and hypotheses must be at least 1".to_owned());
        }
        if self
            .stages
            .iter()
            .any(|stage| !(stage.learning_rate.is_finite() && stage.learning_rate > 0.0))
        {
            return fault("every stage needs a positive learning rate".to_owned());
        }
        Ok(())
    }

    /// The networks for codes of `code_columns` vectors.
    pub(crate) fn architecture(&self, code_columns: usize) -> Architecture {
        let HiddenLayers {
            encoder3d,
            head,
            encoder2d,
        } = self.hidden.clone();
        Architecture::Basis {
            rank: code_columns,
            encoder3d,
            head,
            encoder2d,
            hypotheses: self.hypotheses,
        }
    }
}
