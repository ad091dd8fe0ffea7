//! What is minimised in the autoencoder, and what all losses are made of.

use burn::tensor::{Device, Gradients, Tensor, TensorData};
use stick3d_figure::figure::Figure;
use stick3d_model::network::reparameterize;

use super::networks::Autoencoder;
use super::tape::{Expansion, Tape};
use super::{LossWeights, TrainError};
use crate::dataset::{Batch, Shape};

/// Keeps the square root of a vanishing distance differentiable, square metres (a tenth of a millimetre, squared).
const SMALLEST_SQUARE_M2: f64 = 1e-8;

/// How codes are normalised for the networks: `(code - mean) / scale`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CodeScale {
    /// Mean over turned bodies, `[3][code_columns]`.
    pub(crate) mean: Vec<f32>,
    /// One number for all.
    pub(crate) scale: f32,
}

/// The constant tensors of the losses.
#[derive(Debug, Clone)]
pub(crate) struct Losses {
    pub(super) weights: LossWeights,
    extent_m: f64,
    mean: Tensor<2>,
    scale: f64,
    expansion: Expansion,
    /// `[features, probes + joints + bones]`: some vertices, the joints, and the differences between the ends of the
    /// figure's bones.
    points: Tensor<2>,
    probes: usize,
    joints: usize,
}

/// A batch on the device.
pub(crate) struct Tensors {
    /// Normalised codes, `[batch, 3 · code_columns]`.
    pub(crate) codes: Tensor<2>,
    /// What the codes stand for.
    pub(crate) truth: Points,
    /// `[batch, input_len]`.
    pub(crate) inputs: Tensor<2>,
    /// `[batch, latent_len]`.
    pub(crate) noise: Tensor<2>,
}

/// Points of bodies, `[batch, 3, points]`, metres.
#[derive(Debug, Clone)]
pub(crate) struct Points {
    pub(super) probes: Tensor<3>,
    pub(super) joints: Tensor<3>,
    pub(super) bones: Tensor<3>,
}

/// Terms of one loss, for the log: name and value, unweighted.
pub(crate) type Terms = Vec<(&'static str, Tensor<1>)>;

/// A loss in the two parts that are differentiated one after the other, see [`Tape`].
pub(crate) struct Loss {
    /// What depends on the features alone.
    pub(super) of_points: Tensor<1>,
    /// What depends on the networks' outputs.
    pub(super) of_codes: Tensor<1>,
}

impl Loss {
    /// The whole of it, not to be differentiated.
    pub(super) fn value(&self) -> Tensor<1> {
        self.of_points.clone().detach() + self.of_codes.clone().detach()
    }

    /// This one and `weight` times another.
    pub(super) fn plus(self, other: Self, weight: f64) -> Self {
        Self {
            of_points: self.of_points + other.of_points * weight,
            of_codes: self.of_codes + other.of_codes * weight,
        }
    }
}

impl Losses {
    pub(crate) fn new(
        figure: &Figure,
        shape: &Shape,
        scale: &CodeScale,
        extent_m: f32,
        weights: LossWeights,
        device: &Device,
    ) -> Self {
        let columns = shape.feature_columns();
        let (matrix, joint_rows) = (shape.matrix(), shape.joint_rows());
        let vertices = matrix.len() / columns;
        let probes = weights.probes.clamp(1, vertices);
        let mut rows: Vec<f32> = vec![];
        for probe in 0..probes {
            rows.extend(&matrix[probe * vertices / probes * columns..][..columns]);
        }
        rows.extend(joint_rows);
        for &[a, b] in &figure.bones {
            rows.extend(
                (0..columns).map(|j| joint_rows[b * columns + j] - joint_rows[a * columns + j]),
            );
        }
        let size = [rows.len() / columns, columns];
        let mean = TensorData::new(scale.mean.clone(), [1, scale.mean.len()]);
        Self {
            weights,
            extent_m: f64::from(extent_m),
            mean: Tensor::from_data(mean, device),
            scale: f64::from(scale.scale),
            expansion: Expansion::new(shape.rotations()),
            points: Tensor::<2>::from_data(TensorData::new(rows, size), device).transpose(),
            probes,
            joints: figure.joint_count(),
        }
    }

    /// Where normalised codes put the points. With a tape they can be differentiated.
    pub(crate) fn points(
        &self,
        codes: Tensor<2>,
        tape: Option<&mut Tape>,
    ) -> Result<Points, TrainError> {
        let [batch, _] = codes.dims();
        let [_, count] = self.points.dims();
        let features = self.features(codes, tape)?;
        let all = features
            .matmul(self.points.clone())
            .reshape([batch, 3, count]);
        let bones = count - self.probes - self.joints;
        Ok(Points {
            probes: all.clone().narrow(2, 0, self.probes),
            joints: all.clone().narrow(2, self.probes, self.joints),
            bones: all.narrow(2, self.probes + self.joints, bones),
        })
    }

    /// Where normalised codes put the joints, `[batch, 3, joints]`, metres. Not to be differentiated.
    pub(crate) fn joints(&self, codes: Tensor<2>) -> Result<Tensor<3>, TrainError> {
        let [batch, _] = codes.dims();
        let rows = self.points.clone().narrow(1, self.probes, self.joints);
        let all = self.features(codes, None)?.matmul(rows);
        Ok(all.reshape([batch, 3, self.joints]))
    }

    /// What points are linear in, `[batch · 3, features]`.
    fn features(&self, codes: Tensor<2>, tape: Option<&mut Tape>) -> Result<Tensor<2>, TrainError> {
        let raw = codes * self.scale + self.mean.clone();
        self.expansion.features(raw, tape)
    }

    /// The derivative of a loss by all networks.
    pub(crate) fn backward(&self, loss: Loss, tape: Tape) -> Result<Gradients, TrainError> {
        let device = loss.of_codes.device();
        let of_features = loss.of_points.backward();
        let carried = self.expansion.carry_on(tape, &of_features, &device)?;
        Ok((loss.of_codes + carried).backward())
    }

    /// The paper's loss of the autoencoder: `alpha · (mean squared error of the coordinates) + divergence`.
    pub(crate) fn autoencoder(
        &self,
        vae: &Autoencoder,
        batch: &Tensors,
        tape: &mut Tape,
    ) -> Result<(Loss, Terms), TrainError> {
        let (mean, log_variance) = vae.encoder3d.forward(batch.codes.clone());
        let log_variance = log_variance.clamp(-12.0, 8.0);
        let latent = reparameterize(mean.clone(), log_variance.clone(), batch.noise.clone());
        let codes = vae.head.forward(latent);
        let of_codes = (codes.clone() - batch.codes.clone()).square().mean();
        let error = self.points(codes, Some(tape))?.probes - batch.truth.probes.clone();
        let squared = error.square().mean() / (self.extent_m * self.extent_m);
        let divergence = (mean.square() + log_variance.clone().exp() - log_variance - 1.0)
            .sum_dim(1)
            .mean()
            * 0.5;
        let LossWeights { alpha, code, .. } = self.weights;
        let loss = Loss {
            of_points: squared.clone() * alpha,
            of_codes: of_codes.clone() * (code * alpha) + divergence.clone(),
        };
        let terms = vec![
            ("mse", squared.detach()),
            ("code", of_codes.detach()),
            ("kl", divergence.detach()),
        ];
        Ok((loss, terms))
    }

    /// The weight of the autoencoder's loss beside the sketch's.
    pub(crate) fn autoencoder_weight(&self) -> f64 {
        self.weights.autoencoder
    }

    /// Brings a batch to the device.
    pub(crate) fn tensors(
        &self,
        batch: &Batch,
        noise: Vec<f32>,
        scale: &CodeScale,
        device: &Device,
    ) -> Result<Tensors, TrainError> {
        let width = scale.mean.len();
        let recip = scale.scale.recip();
        let codes: Vec<f32> = batch
            .codes
            .chunks_exact(width)
            .flat_map(|body| {
                body.iter()
                    .zip(&scale.mean)
                    .map(|(a, mean)| (a - mean) * recip)
            })
            .collect();
        let tensor = |numbers: Vec<f32>| {
            let shape = [batch.len, numbers.len() / batch.len.max(1)];
            Tensor::<2>::from_data(TensorData::new(numbers, shape), device)
        };
        let codes = tensor(codes);
        Ok(Tensors {
            truth: self.points(codes.clone(), None)?,
            codes,
            inputs: tensor(batch.inputs.clone()),
            noise: tensor(noise),
        })
    }
}

/// Lengths of vectors along dimension 1.
pub(super) fn length(vectors: Tensor<3>) -> Tensor<3> {
    (vectors.square().sum_dim(1) + SMALLEST_SQUARE_M2).sqrt()
}

/// The values of terms; `None` when the device fails to hand them out.
pub(crate) fn values(terms: Terms) -> Result<Vec<(&'static str, f64)>, TrainError> {
    terms
        .into_iter()
        .map(|(name, term)| {
            let data = term
                .try_into_data()
                .map_err(|e| TrainError::Backend(format!("{e:?}")))?;
            let value = data.as_slice::<f32>().ok().and_then(|s| s.first().copied());
            value
                .map(|v| (name, f64::from(v)))
                .ok_or_else(|| TrainError::Backend(format!("no number for {name}")))
        })
        .collect()
}
