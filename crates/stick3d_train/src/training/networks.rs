//! The networks in training: Burn modules that speak normalised codes.

use burn::module::Module;
use burn::tensor::Device;
use stick3d_model::network::{Encoder2d, Encoder3d, Mlp};
use stick3d_model::weights::{Encoder3dWeights, MlpWeights};

use super::TrainError;

/// All three networks, the decoder without its fixed final layer.
#[derive(Module, Debug)]
pub(crate) struct Networks {
    pub(crate) vae: Autoencoder,
    pub(crate) encoder2d: Encoder2d,
}

/// Encoder3D and the decoder's head.
#[derive(Module, Debug)]
pub(crate) struct Autoencoder {
    pub(crate) encoder3d: Encoder3d,
    pub(crate) head: Mlp,
}

/// The same on plain arrays.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NetworkWeights {
    pub(crate) encoder3d: Encoder3dWeights,
    pub(crate) head: MlpWeights,
    pub(crate) encoder2d: MlpWeights,
}

impl Networks {
    pub(crate) fn new(weights: &NetworkWeights, device: &Device) -> Self {
        Self {
            vae: Autoencoder {
                encoder3d: Encoder3d::from_weights(&weights.encoder3d, device),
                head: Mlp::from_weights(&weights.head, device),
            },
            encoder2d: Encoder2d::from_weights(&weights.encoder2d, device),
        }
    }

    pub(crate) fn to_weights(&self) -> Result<NetworkWeights, TrainError> {
        let read = || {
            Some(NetworkWeights {
                encoder3d: self.vae.encoder3d.to_weights()?,
                head: self.vae.head.to_weights()?,
                encoder2d: self.encoder2d.to_weights()?,
            })
        };
        read().ok_or_else(|| TrainError::Backend("the weights cannot be read back".to_owned()))
    }
}

impl NetworkWeights {
    /// Every array with a name, in a fixed order.
    pub(crate) fn arrays(&mut self) -> Vec<(String, &mut Vec<f32>)> {
        let Encoder3dWeights {
            trunk,
            mean,
            log_variance,
        } = &mut self.encoder3d;
        let layers = trunk
            .layers
            .iter_mut()
            .enumerate()
            .map(|(i, layer)| (format!("encoder3d.trunk.{i}"), layer))
            .chain([
                ("encoder3d.mean".to_owned(), mean),
                ("encoder3d.log_variance".to_owned(), log_variance),
            ])
            .chain(
                self.head
                    .layers
                    .iter_mut()
                    .enumerate()
                    .map(|(i, layer)| (format!("head.{i}"), layer)),
            )
            .chain(
                self.encoder2d
                    .layers
                    .iter_mut()
                    .enumerate()
                    .map(|(i, layer)| (format!("encoder2d.{i}"), layer)),
            );
        layers
            .flat_map(|(name, layer)| {
                [
                    (format!("{name}.weight"), &mut layer.weight),
                    (format!("{name}.bias"), &mut layer.bias),
                ]
            })
            .collect()
    }
}
