//! Trained numbers on plain arrays: what the file stores, and what both Burn modules and the frame-rate code are made of.

use half::f16;

/// One fully connected layer, `output = input · weight + bias`.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearWeights {
    /// Length of the input.
    pub input_len: usize,
    /// Length of the output.
    pub output_len: usize,
    /// `[input_len][output_len]`, the order Burn's `Linear` stores.
    pub weight: Vec<f32>,
    /// `[output_len]`.
    pub bias: Vec<f32>,
}

/// A multilayer perceptron: fully connected layers with a ReLU between them.
#[derive(Debug, Clone, PartialEq)]
pub struct MlpWeights {
    /// The layers from input to output; each one's `input_len` is the `output_len` of the one before.
    pub layers: Vec<LinearWeights>,
    /// Whether the last layer is followed by a ReLU too.
    pub relu_after_last: bool,
}

/// The weights of Encoder3D: a shared trunk and two output layers.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoder3dWeights {
    /// All hidden layers, each followed by a ReLU.
    pub trunk: MlpWeights,
    /// Trunk output to the mean of the latent distribution.
    pub mean: LinearWeights,
    /// Trunk output to the natural logarithm of its variance.
    pub log_variance: LinearWeights,
}

impl LinearWeights {
    /// A layer of zeros.
    #[must_use]
    pub fn zeros(input_len: usize, output_len: usize) -> Self {
        Self {
            input_len,
            output_len,
            weight: vec![0.0; input_len * output_len],
            bias: vec![0.0; output_len],
        }
    }

    /// Whether the arrays have the lengths that the sizes promise.
    #[must_use]
    pub fn is_consistent(&self) -> bool {
        self.weight.len() == self.input_len * self.output_len && self.bias.len() == self.output_len
    }

    /// Rounds every weight to the nearest half-precision number, as storing it in a model file does.
    /// Biases stay in single precision.
    pub fn round_to_half(&mut self) {
        for weight in &mut self.weight {
            *weight = f16::from_f32(*weight).to_f32();
        }
    }

    /// `output = input · weight + bias`, the plain reference.
    ///
    /// # Shapes
    /// - `input`: `[input_len]`
    /// - result: `[output_len]`
    #[must_use]
    pub fn forward(&self, input: &[f32]) -> Vec<f32> {
        let mut output = self.bias.clone();
        for (value, row) in input
            .iter()
            .zip(self.weight.chunks_exact(self.output_len.max(1)))
        {
            for (out, weight) in output.iter_mut().zip(row) {
                *out += value * weight;
            }
        }
        output
    }
}

impl MlpWeights {
    /// A perceptron of zeros with the given widths, from input to output.
    #[must_use]
    pub fn zeros(widths: &[usize], relu_after_last: bool) -> Self {
        let layers = widths
            .windows(2)
            .map(|pair| LinearWeights::zeros(pair[0], pair[1]))
            .collect();
        Self {
            layers,
            relu_after_last,
        }
    }

    /// The widths from input to output; empty when there is no layer.
    #[must_use]
    pub fn widths(&self) -> Vec<usize> {
        let first = self.layers.first().map(|layer| layer.input_len);
        first
            .into_iter()
            .chain(self.layers.iter().map(|layer| layer.output_len))
            .collect()
    }

    /// Whether layer `index` is followed by a ReLU.
    #[must_use]
    pub fn has_relu_after(&self, index: usize) -> bool {
        index + 1 < self.layers.len() || self.relu_after_last
    }

    /// Rounds all weights to half precision; see [`LinearWeights::round_to_half`].
    pub fn round_to_half(&mut self) {
        self.layers
            .iter_mut()
            .for_each(LinearWeights::round_to_half);
    }

    /// Runs the perceptron, the plain reference.
    #[must_use]
    pub fn forward(&self, input: &[f32]) -> Vec<f32> {
        let mut value = input.to_vec();
        for (index, layer) in self.layers.iter().enumerate() {
            value = layer.forward(&value);
            if self.has_relu_after(index) {
                value.iter_mut().for_each(|x| *x = x.max(0.0));
            }
        }
        value
    }
}

impl Encoder3dWeights {
    /// Rounds all weights to half precision; see [`LinearWeights::round_to_half`].
    pub fn round_to_half(&mut self) {
        self.trunk.round_to_half();
        self.mean.round_to_half();
        self.log_variance.round_to_half();
    }

    /// The mean and the log-variance of the latent of `input`, the plain reference.
    #[must_use]
    pub fn forward(&self, input: &[f32]) -> (Vec<f32>, Vec<f32>) {
        let hidden = self.trunk.forward(input);
        (
            self.mean.forward(&hidden),
            self.log_variance.forward(&hidden),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forward_is_the_matrix_product() {
        let layer = LinearWeights {
            input_len: 2,
            output_len: 3,
            weight: vec![1.0, 2.0, 3.0, 10.0, 20.0, 30.0],
            bias: vec![0.5, 0.0, -0.5],
        };
        assert_eq!(layer.forward(&[2.0, -1.0]), [-7.5, -16.0, -24.5]);
        let mlp = MlpWeights {
            layers: vec![layer],
            relu_after_last: true,
        };
        assert_eq!(mlp.forward(&[1.0, 0.0]), [1.5, 2.0, 2.5]);
        assert_eq!(mlp.forward(&[-1.0, 0.0]), [0.0, 0.0, 0.0]);
        assert_eq!(mlp.widths(), [2, 3]);
    }

    #[test]
    fn rounding_to_half_happens_once() {
        let mut layer = LinearWeights::zeros(1, 2);
        layer.weight = vec![0.1, 1.0 / 3.0];
        layer.round_to_half();
        let once = layer.clone();
        layer.round_to_half();
        assert_eq!(layer, once);
        assert_ne!(once.weight[0], 0.1);
    }
}
