//! Encoder3D: from a body to the distribution of its latent (paper section 4.2).

use burn::config::Config;
use burn::module::Module;
use burn::nn::{Linear, LinearConfig};
use burn::tensor::{Device, Tensor};

use super::{Mlp, MlpConfig, linear_from_weights, linear_to_weights};
use crate::weights::Encoder3dWeights;

/// Configuration of an [`Encoder3d`].
#[derive(Config, Debug)]
pub struct Encoder3dConfig {
    /// Widths: the body's numbers, then hidden layers; at least two.
    pub trunk: Vec<usize>,
    /// Length of the latent.
    pub latent_len: usize,
}

/// The encoding half of the variational autoencoder.
#[derive(Module, Debug)]
pub struct Encoder3d {
    trunk: Mlp,
    mean: Linear,
    log_variance: Linear,
}

impl Encoder3dConfig {
    /// Makes the network, initialised by the device's random numbers.
    #[must_use]
    pub fn init(&self, device: &Device) -> Encoder3d {
        let trunk = MlpConfig::new(self.trunk.clone())
            .with_relu_after_last(true)
            .init(device);
        let width = self.trunk.last().copied().unwrap_or_default();
        Encoder3d {
            trunk,
            mean: LinearConfig::new(width, self.latent_len).init(device),
            log_variance: LinearConfig::new(width, self.latent_len).init(device),
        }
    }
}

impl Encoder3d {
    /// The module with given weights.
    #[must_use]
    pub fn from_weights(weights: &Encoder3dWeights, device: &Device) -> Self {
        Self {
            trunk: Mlp::from_weights(&weights.trunk, device),
            mean: linear_from_weights(&weights.mean, device),
            log_variance: linear_from_weights(&weights.log_variance, device),
        }
    }

    /// The weights on plain arrays; `None` when the device fails to hand them out.
    #[must_use]
    pub fn to_weights(&self) -> Option<Encoder3dWeights> {
        Some(Encoder3dWeights {
            trunk: self.trunk.to_weights()?,
            mean: linear_to_weights(&self.mean)?,
            log_variance: linear_to_weights(&self.log_variance)?,
        })
    }

    /// The mean and the natural logarithm of the variance of the latent.
    ///
    /// # Shapes
    /// - `body`: `[batch, first width]`: all coordinates (paper) or the coefficients of the basis
    /// - results: `[batch, latent_len]` each
    #[must_use]
    pub fn forward(&self, body: Tensor<2>) -> (Tensor<2>, Tensor<2>) {
        let hidden = self.trunk.forward(body);
        (
            self.mean.forward(hidden.clone()),
            self.log_variance.forward(hidden),
        )
    }
}
