//! First weights, from the seed alone.

use rand::Rng;
use stick3d_model::architecture::NetworkSizes;
use stick3d_model::weights::{Encoder3dWeights, LinearWeights, MlpWeights};

use crate::dataset::random;

/// Weights before training (He et al., "Delving deep into rectifiers", uniform): variance 2 / inputs before a ReLU,
/// 1 / inputs before an output.
pub(crate) fn initial_weights(
    sizes: &NetworkSizes,
    seed: u64,
) -> (Encoder3dWeights, MlpWeights, MlpWeights) {
    let trunk_width = sizes.encoder3d_trunk.last().copied().unwrap_or(0);
    let mut rng = random(seed, "weights", 0);
    let encoder3d = Encoder3dWeights {
        trunk: mlp(&sizes.encoder3d_trunk, true, &mut rng),
        mean: linear(trunk_width, sizes.latent_len, 1.0, &mut rng),
        log_variance: linear(trunk_width, sizes.latent_len, 0.01, &mut rng),
    };
    let head = mlp(&sizes.head, sizes.relu_after_head, &mut rng);
    let encoder2d = mlp(&sizes.encoder2d, false, &mut rng);
    (encoder3d, head, encoder2d)
}

fn mlp(widths: &[usize], relu_after_last: bool, rng: &mut impl Rng) -> MlpWeights {
    let mut weights = MlpWeights::zeros(widths, relu_after_last);
    for index in 0..weights.layers.len() {
        let variance = if weights.has_relu_after(index) {
            2.0
        } else {
            1.0
        };
        let layer = &mut weights.layers[index];
        *layer = linear(layer.input_len, layer.output_len, variance, rng);
    }
    weights
}

fn linear(input_len: usize, output_len: usize, variance: f32, rng: &mut impl Rng) -> LinearWeights {
    let mut layer = LinearWeights::zeros(input_len, output_len);
    let limit = (3.0 * variance / input_len as f32).sqrt();
    for weight in &mut layer.weight {
        *weight = limit * (2.0 * rng.random::<f32>() - 1.0);
    }
    layer
}
