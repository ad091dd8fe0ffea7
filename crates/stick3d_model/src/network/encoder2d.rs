//! Encoder2D: from a sketch's input vector to the latent (paper section 4.2).

use burn::config::Config;
use burn::module::Module;
use burn::tensor::{Device, Tensor};

use super::{Mlp, MlpConfig};
use crate::weights::MlpWeights;

/// Configuration of an [`Encoder2d`].
#[derive(Config, Debug)]
pub struct Encoder2dConfig {
    /// Widths: input vector, hidden layers, latent.
    pub widths: Vec<usize>,
}

/// Predicts the mean of the latent that Encoder3D gives to the drawn body.
#[derive(Module, Debug)]
pub struct Encoder2d {
    mlp: Mlp,
}

impl Encoder2dConfig {
    /// Makes the network, initialised by the device's random numbers.
    #[must_use]
    pub fn init(&self, device: &Device) -> Encoder2d {
        Encoder2d {
            mlp: MlpConfig::new(self.widths.clone()).init(device),
        }
    }
}

impl Encoder2d {
    /// The module with given weights.
    #[must_use]
    pub fn from_weights(weights: &MlpWeights, device: &Device) -> Self {
        Self {
            mlp: Mlp::from_weights(weights, device),
        }
    }

    /// The weights on plain arrays; `None` when the device fails to hand them out.
    #[must_use]
    pub fn to_weights(&self) -> Option<MlpWeights> {
        self.mlp.to_weights()
    }

    /// # Shapes
    /// - `sketch`: `[batch, input_len]`, as `Sketch::input_vector` gives it
    /// - result: `[batch, latent_len]`
    #[must_use]
    pub fn forward(&self, sketch: Tensor<2>) -> Tensor<2> {
        self.mlp.forward(sketch)
    }
}
