//! What is minimised in the autoencoder, and what all losses are made of.

use burn::tensor::{Device, Tensor, TensorData};
use stick3d_figure::figure::Figure;
use stick3d_model::network::{reparameterize, rotation_features};

use super::networks::Autoencoder;
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
    /// How many bones the codes turn, and the pairs that share a half-way rotation; `None` where codes are features.
    turning: Option<(usize, Vec<usize>)>,
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
        let turning = shape.rotations().map(|rotations| {
            let halves = rotations.halves.as_flattened();
            let halves = halves.iter().map(|bone| usize::from(*bone)).collect();
            (rotations.bone_count, halves)
        });
        Self {
            weights,
            extent_m: f64::from(extent_m),
            mean: Tensor::from_data(mean, device),
            scale: f64::from(scale.scale),
            turning,
            points: Tensor::<2>::from_data(TensorData::new(rows, size), device).transpose(),
            probes,
            joints: figure.joint_count(),
        }
    }

    /// Where normalised codes put the points.
    pub(crate) fn points(&self, codes: Tensor<2>) -> Points {
        let [batch, _] = codes.dims();
        let [_, count] = self.points.dims();
        let features = self.features(codes);
        let all = features
            .matmul(self.points.clone())
            .reshape([batch, 3, count]);
        let bones = count - self.probes - self.joints;
        Points {
            probes: all.clone().narrow(2, 0, self.probes),
            joints: all.clone().narrow(2, self.probes, self.joints),
            bones: all.narrow(2, self.probes + self.joints, bones),
        }
    }

    /// Where normalised codes put the joints, `[batch, 3, joints]`, metres.
    pub(crate) fn joints(&self, codes: Tensor<2>) -> Tensor<3> {
        let [batch, _] = codes.dims();
        let rows = self.points.clone().narrow(1, self.probes, self.joints);
        self.features(codes)
            .matmul(rows)
            .reshape([batch, 3, self.joints])
    }

    /// What points are linear in, `[batch · 3, features]`.
    fn features(&self, codes: Tensor<2>) -> Tensor<2> {
        let [batch, len] = codes.dims();
        let raw = codes * self.scale + self.mean.clone();
        match &self.turning {
            Some((bones, halves)) => rotation_features(raw, *bones, halves),
            None => raw.reshape([3 * batch, len / 3]),
        }
    }

    /// The paper's loss of the autoencoder: `alpha · (mean squared error of the coordinates) + divergence`.
    pub(crate) fn autoencoder(&self, vae: &Autoencoder, batch: &Tensors) -> (Tensor<1>, Terms) {
        let (mean, log_variance) = vae.encoder3d.forward(batch.codes.clone());
        let log_variance = log_variance.clamp(-12.0, 8.0);
        let latent = reparameterize(mean.clone(), log_variance.clone(), batch.noise.clone());
        let codes = vae.head.forward(latent);
        let of_codes = (codes.clone() - batch.codes.clone()).square().mean();
        let error = self.points(codes).probes - batch.truth.probes.clone();
        let squared = error.square().mean() / (self.extent_m * self.extent_m);
        let divergence = (mean.square() + log_variance.clone().exp() - log_variance - 1.0)
            .sum_dim(1)
            .mean()
            * 0.5;
        let loss = (squared.clone() + of_codes.clone() * self.weights.code) * self.weights.alpha
            + divergence.clone();
        (
            loss,
            vec![
                ("mse", squared.detach()),
                ("code", of_codes.detach()),
                ("kl", divergence.detach()),
            ],
        )
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
    ) -> Tensors {
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
        Tensors {
            truth: self.points(codes.clone()),
            codes,
            inputs: tensor(batch.inputs.clone()),
            noise: tensor(noise),
        }
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
