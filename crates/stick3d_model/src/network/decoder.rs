//! Decoder: from a latent to the vertices of a body (paper section 4.2): a small head, then the final layer.

use burn::config::Config;
use burn::module::Module;
use burn::nn::{Linear, LinearConfig};
use burn::tensor::{Device, Tensor, TensorData};

use super::{Mlp, MlpConfig, linear_from_weights, rotation_features};
use crate::architecture::NetworkSizes;
use crate::final_layer::FinalLayer;
use crate::weights::MlpWeights;

/// Configuration of the [`Decoder`] of the paper: all layers trained, tanh at the end.
#[derive(Config, Debug)]
pub struct DecoderConfig {
    /// Widths of the head: latent, then hidden layers.
    pub head: Vec<usize>,
    /// How many vertices the mesh has.
    pub vertex_count: usize,
    /// The length that an output of 1 means, metres.
    pub extent_m: f64,
}

/// Turns latents into meshes.
#[derive(Module, Debug)]
pub struct Decoder {
    head: Mlp,
    final_layer: FinalModule,
}

/// The final layer as a Burn module.
#[derive(Module, Debug)]
pub enum FinalModule {
    /// Fully connected, then tanh.
    Tanh(TanhFinal),
    /// A fixed matrix, dense or the product of a skinned layer's factors.
    Linear(LinearFinal),
}

/// `extent · tanh(linear)`.
#[derive(Module, Debug)]
pub struct TanhFinal {
    linear: Linear,
    extent_m: f64,
}

/// One fixed matrix for x, y and z.
#[derive(Module, Debug)]
pub struct LinearFinal {
    /// `[rank, vertex_count]`, not trained.
    columns: Tensor<2>,
    /// How many bones turn; 0 where the coefficients are used as they are.
    turning_bones: usize,
    /// Pairs of bones whose half-way rotations are used too.
    halves: Vec<usize>,
}

impl DecoderConfig {
    /// The paper's decoder for given network sizes.
    #[must_use]
    pub fn paper(sizes: &NetworkSizes, vertex_count: usize, extent_m: f64) -> Self {
        Self::new(sizes.head.clone(), vertex_count, extent_m)
    }

    /// Makes the network, initialised by the device's random numbers.
    #[must_use]
    pub fn init(&self, device: &Device) -> Decoder {
        let width = self.head.last().copied().unwrap_or_default();
        let linear = LinearConfig::new(width, 3 * self.vertex_count).init(device);
        Decoder {
            head: MlpConfig::new(self.head.clone())
                .with_relu_after_last(true)
                .init(device),
            final_layer: FinalModule::Tanh(TanhFinal {
                linear,
                extent_m: self.extent_m,
            }),
        }
    }
}

impl Decoder {
    /// The module with given weights.
    #[must_use]
    pub fn from_weights(head: &MlpWeights, final_layer: &FinalLayer, device: &Device) -> Self {
        Self {
            head: Mlp::from_weights(head, device),
            final_layer: FinalModule::from_layer(final_layer, device),
        }
    }

    /// The head alone.
    #[must_use]
    pub fn head(&self) -> &Mlp {
        &self.head
    }

    /// # Shapes
    /// - `latent`: `[batch, latent_len]`
    /// - result: `[batch, vertex_count, 3]`, metres
    #[must_use]
    pub fn forward(&self, latent: Tensor<2>) -> Tensor<3> {
        self.final_layer.forward(self.head.forward(latent))
    }
}

impl FinalModule {
    /// The module of a plain final layer.
    #[must_use]
    pub fn from_layer(layer: &FinalLayer, device: &Device) -> Self {
        if let FinalLayer::Dense(dense) = layer {
            let linear = linear_from_weights(dense.linear(), device);
            return Self::Tanh(TanhFinal {
                linear,
                extent_m: f64::from(dense.extent_m()),
            });
        }
        let matrix = layer.matrix().unwrap_or_default();
        let shape = [layer.vertex_count(), layer.matrix_columns()];
        let columns = Tensor::<2>::from_data(TensorData::new(matrix, shape), device).transpose();
        let (turning_bones, halves) = layer.rotations().map_or((0, vec![]), |rotations| {
            let halves = rotations
                .halves
                .as_flattened()
                .iter()
                .map(|bone| usize::from(*bone))
                .collect();
            (rotations.bone_count, halves)
        });
        Self::Linear(LinearFinal {
            columns,
            turning_bones,
            halves,
        })
    }

    /// # Shapes
    /// - `coefficients`: `[batch, coefficient_len]`
    /// - result: `[batch, vertex_count, 3]`, metres
    #[must_use]
    pub fn forward(&self, coefficients: Tensor<2>) -> Tensor<3> {
        let [batch, len] = coefficients.dims();
        match self {
            Self::Tanh(layer) => {
                let output = layer.linear.forward(coefficients).tanh() * layer.extent_m;
                let [_, coordinates] = output.dims();
                output.reshape([batch, coordinates / 3, 3])
            }
            Self::Linear(layer) => {
                let [_, vertices] = layer.columns.dims();
                let features = match layer.turning_bones {
                    0 => coefficients.reshape([3 * batch, len / 3]),
                    bones => rotation_features(coefficients, bones, &layer.halves),
                };
                let by_axis = features.matmul(layer.columns.clone());
                by_axis.reshape([batch, 3, vertices]).swap_dims(1, 2)
            }
        }
    }
}
