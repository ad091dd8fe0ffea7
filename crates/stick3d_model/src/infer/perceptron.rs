//! A perceptron with the memory that running it needs.

use crate::kernels;
use crate::weights::MlpWeights;

/// A perceptron with the memory for its layers.
#[derive(Debug, Clone)]
pub(super) struct Perceptron {
    weights: MlpWeights,
    values: Vec<Vec<f32>>,
}

impl Perceptron {
    pub(super) fn new(weights: &MlpWeights) -> Self {
        let values = weights
            .layers
            .iter()
            .map(|layer| vec![0.0; layer.output_len])
            .collect();
        Self {
            weights: weights.clone(),
            values,
        }
    }

    /// The output for `input`; empty when there is no layer.
    pub(super) fn run(&mut self, input: &[f32]) -> &[f32] {
        for (index, layer) in self.weights.layers.iter().enumerate() {
            let (before, after) = self.values.split_at_mut(index);
            let value = before.last().map_or(input, Vec::as_slice);
            let output = after[0].as_mut_slice();
            output.copy_from_slice(&layer.bias);
            kernels::accumulate(value, &layer.weight, output);
            if self.weights.has_relu_after(index) {
                output.iter_mut().for_each(|x| *x = x.max(0.0));
            }
        }
        self.output()
    }

    /// What the last run gave.
    pub(super) fn output(&self) -> &[f32] {
        self.values.last().map_or(&[], Vec::as_slice)
    }

    /// What layer `index` gave in the last run, after its ReLU.
    pub(super) fn value(&self, index: usize) -> &[f32] {
        &self.values[index]
    }

    pub(super) fn weights(&self) -> &MlpWeights {
        &self.weights
    }
}
