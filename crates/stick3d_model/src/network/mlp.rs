//! A multilayer perceptron: fully connected layers with a ReLU between them.

use burn::config::Config;
use burn::module::{Module, Param};
use burn::nn::{Linear, LinearConfig};
use burn::tensor::{Device, Tensor, TensorData, activation::relu};

use crate::weights::{LinearWeights, MlpWeights};

/// Configuration of an [`Mlp`].
#[derive(Config, Debug)]
pub struct MlpConfig {
    /// Widths from input to output; at least two.
    pub widths: Vec<usize>,
    /// Whether the last layer is followed by a ReLU too.
    #[config(default = false)]
    pub relu_after_last: bool,
}

/// Fully connected layers with a ReLU between them.
#[derive(Module, Debug)]
pub struct Mlp {
    layers: Vec<Linear>,
    relu_after_last: bool,
}

impl MlpConfig {
    /// Makes the layers, initialised by the device's random numbers.
    #[must_use]
    pub fn init(&self, device: &Device) -> Mlp {
        let layers = self
            .widths
            .windows(2)
            .map(|w| LinearConfig::new(w[0], w[1]).init(device))
            .collect();
        Mlp {
            layers,
            relu_after_last: self.relu_after_last,
        }
    }
}

impl Mlp {
    /// The module with given weights.
    #[must_use]
    pub fn from_weights(weights: &MlpWeights, device: &Device) -> Self {
        let layers = weights
            .layers
            .iter()
            .map(|layer| linear_from_weights(layer, device))
            .collect();
        Self {
            layers,
            relu_after_last: weights.relu_after_last,
        }
    }

    /// The weights on plain arrays; `None` when the device fails to hand them out.
    #[must_use]
    pub fn to_weights(&self) -> Option<MlpWeights> {
        let layers = self
            .layers
            .iter()
            .map(linear_to_weights)
            .collect::<Option<Vec<_>>>()?;
        Some(MlpWeights {
            layers,
            relu_after_last: self.relu_after_last,
        })
    }

    /// Runs the layers.
    ///
    /// # Shapes
    /// - `input`: `[batch, first width]`
    /// - result: `[batch, last width]`
    #[must_use]
    pub fn forward(&self, input: Tensor<2>) -> Tensor<2> {
        let count = self.layers.len();
        self.layers
            .iter()
            .enumerate()
            .fold(input, |value, (index, layer)| {
                let value = layer.forward(value);
                if index + 1 < count || self.relu_after_last {
                    relu(value)
                } else {
                    value
                }
            })
    }
}

/// Burn's layer with given weights.
#[must_use]
pub fn linear_from_weights(weights: &LinearWeights, device: &Device) -> Linear {
    let shape = [weights.input_len, weights.output_len];
    Linear {
        weight: Param::from_data(TensorData::new(weights.weight.clone(), shape), device),
        bias: Some(Param::from_data(
            TensorData::new(weights.bias.clone(), [weights.output_len]),
            device,
        )),
    }
}

/// The weights of Burn's layer on plain arrays; `None` when the device fails to hand them out.
#[must_use]
pub fn linear_to_weights(linear: &Linear) -> Option<LinearWeights> {
    let [input_len, output_len] = linear.weight.val().dims();
    let numbers = |data: TensorData| data.try_to_vec::<f32>().ok();
    let bias = match &linear.bias {
        Some(bias) => numbers(bias.val().try_into_data().ok()?)?,
        None => vec![0.0; output_len],
    };
    let weight = numbers(linear.weight.val().try_into_data().ok()?)?;
    Some(LinearWeights {
        input_len,
        output_len,
        weight,
        bias,
    })
}
