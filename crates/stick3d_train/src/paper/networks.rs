//! The paper's networks in training: Burn modules from coordinates to coordinates.
//!
//! They stand apart from those of the shipped models, which may change: these are as published.

use burn::module::Module;
use burn::tensor::{Device, Tensor};
use stick3d_model::network::{Encoder2d, Encoder3d, Mlp};
use stick3d_model::weights::{Encoder3dWeights, LinearWeights, MlpWeights};

use super::PaperConfig;
use crate::training::TrainError;
use crate::training::checkpoint::NamedArrays;
use crate::training::init::initial_weights;

/// All three networks.
#[derive(Module, Debug)]
pub(super) struct PaperNetworks {
    pub(super) vae: PaperAutoencoder,
    pub(super) encoder2d: Encoder2d,
}

/// Encoder3D and Decoder.
#[derive(Module, Debug)]
pub(super) struct PaperAutoencoder {
    pub(super) encoder3d: Encoder3d,
    /// Latent to what the tanh makes coordinates of.
    pub(super) decoder: Mlp,
}

/// The same on plain arrays.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PaperWeights {
    pub(super) encoder3d: Encoder3dWeights,
    pub(super) decoder: MlpWeights,
    pub(super) encoder2d: MlpWeights,
}

impl PaperWeights {
    /// Weights before training.
    pub(super) fn initial(config: &PaperConfig, input_len: usize, vertex_count: usize) -> Self {
        let sizes = config.sizes(input_len, vertex_count);
        let (mut encoder3d, decoder, encoder2d) = initial_weights(&sizes, config.seed);
        encoder3d.log_variance.bias.fill(config.first_log_variance);
        Self {
            encoder3d,
            decoder,
            encoder2d,
        }
    }
}

impl NamedArrays for PaperWeights {
    fn arrays(&mut self) -> Vec<(String, &mut Vec<f32>)> {
        let Encoder3dWeights {
            trunk,
            mean,
            log_variance,
        } = &mut self.encoder3d;
        let mut layers = numbered("encoder3d.trunk", &mut trunk.layers);
        layers.push(("encoder3d.mean".to_owned(), mean));
        layers.push(("encoder3d.log_variance".to_owned(), log_variance));
        layers.extend(numbered("decoder", &mut self.decoder.layers));
        layers.extend(numbered("encoder2d", &mut self.encoder2d.layers));
        layers
            .into_iter()
            .flat_map(|(name, layer)| {
                [
                    (format!("{name}.weight"), &mut layer.weight),
                    (format!("{name}.bias"), &mut layer.bias),
                ]
            })
            .collect()
    }
}

fn numbered<'a>(
    name: &'static str,
    layers: &'a mut [LinearWeights],
) -> Vec<(String, &'a mut LinearWeights)> {
    let layers = layers.iter_mut().enumerate();
    layers
        .map(|(i, layer)| (format!("{name}.{i}"), layer))
        .collect()
}

impl PaperNetworks {
    pub(super) fn new(weights: &PaperWeights, device: &Device) -> Self {
        Self {
            vae: PaperAutoencoder {
                encoder3d: Encoder3d::from_weights(&weights.encoder3d, device),
                decoder: Mlp::from_weights(&weights.decoder, device),
            },
            encoder2d: Encoder2d::from_weights(&weights.encoder2d, device),
        }
    }

    pub(super) fn to_weights(&self) -> Result<PaperWeights, TrainError> {
        let read = || {
            Some(PaperWeights {
                encoder3d: self.vae.encoder3d.to_weights()?,
                decoder: self.vae.decoder.to_weights()?,
                encoder2d: self.encoder2d.to_weights()?,
            })
        };
        read().ok_or_else(|| TrainError::Backend("the weights cannot be read back".to_owned()))
    }
}

impl PaperAutoencoder {
    /// # Shapes
    /// - `latent`: `[batch, latent_len]`
    /// - result: `[batch, 3 · vertex_count]`, between -1 and 1
    pub(super) fn decode(&self, latent: Tensor<2>) -> Tensor<2> {
        self.decoder.forward(latent).tanh()
    }
}
