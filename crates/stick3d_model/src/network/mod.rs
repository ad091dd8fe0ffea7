//! The three networks as Burn modules ([paper](https://doi.org/10.1016/j.cag.2022.10.004), section 4.2 and figure 2).

mod decoder;
mod encoder2d;
mod encoder3d;
mod mlp;
mod rotations;

pub use decoder::{Decoder, DecoderConfig, FinalModule, LinearFinal, TanhFinal};
pub use encoder2d::{Encoder2d, Encoder2dConfig};
pub use encoder3d::{Encoder3d, Encoder3dConfig};
pub use mlp::{Mlp, MlpConfig, linear_from_weights, linear_to_weights};
pub use rotations::rotation_features;

use burn::tensor::Tensor;

/// Draws a latent from its distribution (the reparameterisation trick, paper figure 2): `mean + exp(log_variance / 2) · noise`.
///
/// # Shapes
/// - all three and the result: `[batch, latent_len]`; `noise` standard normal
#[must_use]
pub fn reparameterize(mean: Tensor<2>, log_variance: Tensor<2>, noise: Tensor<2>) -> Tensor<2> {
    mean + (log_variance * 0.5).exp() * noise
}
