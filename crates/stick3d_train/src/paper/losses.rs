//! Equations 1 and 2.

use burn::tensor::Tensor;
use stick3d_model::network::reparameterize;

use super::networks::PaperAutoencoder;
use super::{PaperConfig, PaperKind};
use crate::training::Terms;

/// What an autoencoder's loss yields.
pub(super) struct AutoencoderLoss {
    pub(super) loss: Tensor<1>,
    /// Encoder3D's mean, `[batch, latent_len]`.
    pub(super) mean: Tensor<2>,
    pub(super) terms: Terms,
}

/// Equation 1: `alpha · (mean squared error of the coordinates) + divergence`; for the plain autoencoder the error alone,
/// with the same weight.
///
/// # Shapes
/// - `coordinates`: `[batch, 3 · vertex_count]`, the networks' units
/// - `noise`: `[batch, latent_len]`, standard normal
pub(super) fn autoencoder(
    vae: &PaperAutoencoder,
    config: &PaperConfig,
    coordinates: Tensor<2>,
    noise: Tensor<2>,
) -> AutoencoderLoss {
    let (mean, log_variance) = vae.encoder3d.forward(coordinates.clone());
    let (latent, divergence) = match config.kind {
        PaperKind::Plain => (mean.clone(), None),
        PaperKind::Variational => {
            // Far beyond what training reaches: only a wild first step is kept from overflowing.
            let log_variance = log_variance.clamp(-20.0, 10.0);
            let latent = reparameterize(mean.clone(), log_variance.clone(), noise);
            let divergence =
                (mean.clone().square() + log_variance.clone().exp() - log_variance - 1.0)
                    .sum_dim(1)
                    .mean()
                    * 0.5;
            (latent, Some(divergence))
        }
    };
    let squared = (vae.decode(latent) - coordinates).square().mean();
    let mut loss = squared.clone() * config.alpha;
    // The log rounds to a millionth, which would leave two digits of it.
    let mut terms = vec![("mse_per_mille", squared.detach() * 1e3)];
    if let Some(divergence) = divergence {
        loss = loss + divergence.clone();
        terms.push(("kl", divergence.detach()));
    }
    AutoencoderLoss { loss, mean, terms }
}

/// Equation 2: mean squared difference of the two encoders' means.
pub(super) fn equation_2(of_sketch: Tensor<2>, of_body: Tensor<2>) -> Tensor<1> {
    (of_sketch - of_body).square().mean()
}
