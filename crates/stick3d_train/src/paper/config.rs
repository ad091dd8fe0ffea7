//! What a run of the paper's training is made of.

use serde::{Deserialize, Serialize};
use stick3d_model::Architecture;
use stick3d_model::architecture::{LATENT_LEN, NetworkSizes};

use crate::device::ComputeDevice;
use crate::training::TrainError;

/// A set with fewer key meshes than this is as small as the paper's of horses (8, and 72 of the man).
const FEW_MESHES: usize = 24;

/// Which autoencoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PaperKind {
    /// The paper's method: latents are drawn from a distribution that is kept near the standard normal one (figure 2).
    Variational,
    /// Its baseline: the mean is the latent, and nothing is asked of it (figure 4).
    Plain,
}

/// Everything that decides what a run yields, beside the set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PaperConfig {
    /// What all random numbers depend on.
    pub seed: u64,
    /// Which autoencoder.
    pub kind: PaperKind,
    /// Width of every hidden layer.
    pub hidden: usize,
    /// Length of the latent.
    pub latent_len: usize,
    /// Weight of the mean squared error in equation 1.
    pub alpha: f64,
    /// Adam's step, the same from the first to the last.
    pub learning_rate: f64,
    /// Passes over the samples in the three stages: autoencoder, Encoder2D, both.
    pub epochs: [usize; 3],
    /// Samples in a batch.
    pub batch_size: usize,
    /// The natural logarithm of the latents' variance before training.
    pub first_log_variance: f32,
    /// Epochs between two checkpoints.
    pub checkpoint_every: usize,
    /// What to compute on. The last digits of a model depend on it.
    #[serde(skip)]
    pub device: ComputeDevice,
}

impl PaperConfig {
    /// The published recipe for so many key meshes: the rate is 1e-3 for many (the man), 1e-4 for few (the horse; "10^4"
    /// in print). So small a rate needs more steps than batches of 64 of so few samples have: they are 8 there.
    #[must_use]
    pub fn published(key_meshes: usize) -> Self {
        let few = key_meshes < FEW_MESHES;
        Self {
            seed: 1,
            kind: PaperKind::Variational,
            hidden: 512,
            latent_len: LATENT_LEN,
            alpha: 1e5,
            learning_rate: if few { 1e-4 } else { 1e-3 },
            epochs: [300, 300, 200],
            batch_size: if few { 8 } else { 64 },
            first_log_variance: -4.0,
            checkpoint_every: 10,
            device: ComputeDevice::default(),
        }
    }

    /// The same as the plain autoencoder, which the paper trains for 300 epochs; Encoder2D learns its latents afterwards,
    /// and nothing is tuned jointly.
    #[must_use]
    pub fn plain(self) -> Self {
        let [autoencoder, encoder2d, _] = self.epochs;
        Self {
            kind: PaperKind::Plain,
            epochs: [autoencoder, encoder2d, 0],
            ..self
        }
    }

    /// The same with a share of the epochs, one at least where there were any.
    #[must_use]
    pub fn scaled(self, share: f64) -> Self {
        let scaled = |epochs: usize| match epochs {
            0 => 0,
            epochs => ((epochs as f64 * share).round() as usize).max(1),
        };
        Self {
            epochs: self.epochs.map(scaled),
            ..self
        }
    }

    /// The networks.
    #[must_use]
    pub fn architecture(&self) -> Architecture {
        Architecture::Paper {
            hidden: self.hidden,
        }
    }

    /// The widths of the networks, the decoder's last layer counted to its head.
    pub(super) fn sizes(&self, input_len: usize, vertex_count: usize) -> NetworkSizes {
        let mut sizes = self
            .architecture()
            .sizes(input_len, self.latent_len, vertex_count);
        sizes.head.push(3 * vertex_count);
        sizes.relu_after_head = false;
        sizes
    }

    /// Checks that the parts make sense.
    pub(super) fn validate(&self) -> Result<(), TrainError> {
        let fault = |problem: &str| Err(TrainError::Config(problem.to_owned()));
        if self.batch_size == 0 || self.latent_len == 0 || self.hidden == 0 {
            return fault("batch size, latent length and hidden width must be at least 1");
        }
        let positive = |number: f64| number.is_finite() && number > 0.0;
        if !positive(self.learning_rate) || !positive(self.alpha) {
            return fault("learning rate and alpha must be positive");
        }
        if !self.first_log_variance.is_finite() {
            return fault("the first log-variance must be a number");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_recipe_and_its_baseline() {
        let man = PaperConfig::published(72);
        assert_eq!((man.learning_rate, man.epochs), (1e-3, [300, 300, 200]));
        let horse = PaperConfig::published(8);
        assert_eq!((horse.learning_rate, horse.batch_size), (1e-4, 8));
        let sizes = man.sizes(34, 12_500);
        assert_eq!(sizes.head, [256, 512, 512, 37_500]);
        assert_eq!(sizes.encoder3d_trunk, [37_500, 512, 512]);
        let tenth = man.clone().plain().scaled(0.1);
        assert_eq!((tenth.kind, tenth.epochs), (PaperKind::Plain, [30, 30, 0]));
        assert_eq!(man.scaled(1e-6).epochs, [1; 3]);
    }
}
