//! What is minimised.

use burn::tensor::{Device, Tensor, TensorData};
use stick3d_figure::figure::Figure;
use stick3d_model::network::reparameterize;

use super::networks::{Autoencoder, Networks};
use super::{LossWeights, TrainError};
use crate::dataset::{Batch, SkinBasis};

/// Keeps the square root of a vanishing distance differentiable, square metres (a tenth of a millimetre, squared).
const SMALLEST_SQUARE_M2: f64 = 1e-8;

/// How coefficients are normalised for the networks: `code = (coefficient - mean) / scale`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CodeScale {
    /// Mean over turned bodies, `[3][rank]`, metres.
    pub(crate) mean: Vec<f32>,
    /// One number for all, so that distances between codes stay distances between meshes; metres.
    pub(crate) scale: f32,
}

/// The constant tensors of the losses.
#[derive(Debug, Clone)]
pub(crate) struct Losses {
    weights: LossWeights,
    scale_m: f64,
    extent_m: f64,
    /// `[rank, probes]`: coefficients to some vertices.
    probes: Tensor<2>,
    /// `[rank, joints]`.
    joints: Tensor<2>,
    /// `[rank, bones]`: coefficients to the differences between the ends of the figure's bones.
    bones: Tensor<2>,
    /// `[3, bones]`: the same of the mean coefficients, metres.
    mean_bones: Tensor<3>,
}

/// A batch on the device.
pub(crate) struct Tensors {
    /// Normalised coefficients, `[batch, 3·rank]`.
    pub(crate) codes: Tensor<2>,
    /// `[batch, input_len]`.
    pub(crate) inputs: Tensor<2>,
    /// `[batch, latent_len]`.
    pub(crate) noise: Tensor<2>,
    /// `[batch, bones]`, metres.
    pub(crate) bone_lengths: Tensor<2>,
}

/// Terms of one loss, for the log: name and value, unweighted.
pub(crate) type Terms = Vec<(&'static str, Tensor<1>)>;

impl Losses {
    pub(crate) fn new(
        figure: &Figure,
        basis: &SkinBasis,
        scale: &CodeScale,
        extent_m: f32,
        weights: LossWeights,
        device: &Device,
    ) -> Self {
        let rank = basis.rank();
        let matrix = basis.layer().matrix().unwrap_or_default();
        let vertices = matrix.len() / rank;
        let probes = weights.probes.clamp(1, vertices);
        let probe_rows: Vec<f32> = (0..probes)
            .flat_map(|i| &matrix[(i * vertices / probes) * rank..][..rank])
            .copied()
            .collect();
        let joint_rows = basis.joint_rows();
        let bone_rows: Vec<f32> = figure
            .bones
            .iter()
            .flat_map(|&[a, b]| (0..rank).map(move |j| joint_rows[b * rank + j] - joint_rows[a * rank + j]))
            .collect();
        let columns = |rows: &[f32], count: usize| {
            Tensor::<2>::from_data(TensorData::new(rows.to_vec(), [count, rank]), device).transpose()
        };
        let bones = columns(&bone_rows, figure.bones.len());
        let mean = Tensor::<2>::from_data(TensorData::new(scale.mean.clone(), [3, rank]), device);
        Self {
            weights,
            scale_m: f64::from(scale.scale),
            extent_m: f64::from(extent_m),
            probes: columns(&probe_rows, probes),
            joints: columns(joint_rows, figure.joint_count()),
            mean_bones: mean.matmul(bones.clone()).unsqueeze::<3>(),
            bones,
        }
    }

    /// The paper's loss of the autoencoder: `alpha · (mean squared error of the coordinates) + divergence`.
    pub(crate) fn autoencoder(&self, vae: &Autoencoder, batch: &Tensors) -> (Tensor<1>, Terms) {
        let (mean, log_variance) = vae.encoder3d.forward(batch.codes.clone());
        let log_variance = log_variance.clamp(-12.0, 8.0);
        let latent = reparameterize(mean.clone(), log_variance.clone(), batch.noise.clone());
        let error = vae.head.forward(latent) - batch.codes.clone();
        // Mean over the batch of |a - b|², which is three times the mean squared error of a coordinate.
        let metres_squared = error.square().sum_dim(1).mean() * (self.scale_m * self.scale_m);
        let squared = metres_squared / (3.0 * self.extent_m * self.extent_m);
        let divergence =
            (mean.square() + log_variance.clone().exp() - log_variance - 1.0).sum_dim(1).mean() * 0.5;
        let loss = squared.clone() * self.weights.alpha + divergence.clone();
        (loss, vec![("mse", squared.detach()), ("kl", divergence.detach())])
    }

    /// Equation 2, and how far the body decoded from the sketch is from the body drawn.
    pub(crate) fn sketch(
        &self,
        networks: &Networks,
        target_mean: Tensor<2>,
        batch: &Tensors,
    ) -> (Tensor<1>, Terms) {
        let latent = networks.encoder2d.forward(batch.inputs.clone());
        let equation_2 = (latent.clone() - target_mean).square().mean();
        let codes = networks.vae.head.forward(latent);
        let [len, width] = codes.dims();
        let by_axis = |codes: Tensor<2>| codes.reshape([3 * len, width / 3]);
        let difference = by_axis(codes.clone() - batch.codes.clone());

        let vertices = self.distance_cm(difference.clone().matmul(self.probes.clone()), len);
        let joint_difference = difference.matmul(self.joints.clone());
        let joints = self.distance_cm(joint_difference.clone(), len);
        let reprojection = self.flat_distance_cm(joint_difference, len);
        let bones = self.bone_error_percent(by_axis(codes), batch);
        let LossWeights { latent, vertices: v, joints: j, reprojection: r, bones: b, .. } = self.weights;
        let loss = equation_2.clone() * latent
            + vertices.clone() * v
            + joints.clone() * j
            + reprojection.clone() * r
            + bones.clone() * b;
        let terms = vec![
            ("latent", equation_2.detach()),
            ("vertices_cm", vertices.detach()),
            ("joints_cm", joints.detach()),
            ("reprojection_cm", reprojection.detach()),
            ("bones_percent", bones.detach()),
        ];
        (loss, terms)
    }

    /// The weight of the autoencoder's loss beside the sketch's.
    pub(crate) fn autoencoder_weight(&self) -> f64 {
        self.weights.autoencoder
    }

    /// Mean length of differences `[3·batch, points]` (normalised), centimetres.
    fn distance_cm(&self, difference: Tensor<2>, len: usize) -> Tensor<1> {
        self.length_m(difference, len).mean() * 100.0
    }

    fn length_m(&self, difference: Tensor<2>, len: usize) -> Tensor<3> {
        let [_, points] = difference.dims();
        let squares = difference.square().reshape([len, 3, points]).sum_dim(1);
        (squares * (self.scale_m * self.scale_m) + SMALLEST_SQUARE_M2).sqrt()
    }

    /// The same on the sketch plane.
    fn flat_distance_cm(&self, difference: Tensor<2>, len: usize) -> Tensor<1> {
        let [_, points] = difference.dims();
        let flat = difference.square().reshape([len, 3, points]).narrow(1, 0, 2).sum_dim(1);
        (flat * (self.scale_m * self.scale_m) + SMALLEST_SQUARE_M2).sqrt().mean() * 100.0
    }

    fn bone_error_percent(&self, codes_by_axis: Tensor<2>, batch: &Tensors) -> Tensor<1> {
        let [len, bones] = batch.bone_lengths.dims();
        let turned = codes_by_axis.matmul(self.bones.clone()).reshape([len, 3, bones]) * self.scale_m;
        let vectors = turned + self.mean_bones.clone();
        let lengths = (vectors.square().sum_dim(1) + SMALLEST_SQUARE_M2).sqrt().reshape([len, bones]);
        ((lengths - batch.bone_lengths.clone()).abs() / batch.bone_lengths.clone()).mean() * 100.0
    }
}

impl Tensors {
    /// Brings a batch to the device.
    pub(crate) fn new(batch: &Batch, noise: Vec<f32>, scale: &CodeScale, device: &Device) -> Self {
        let width = scale.mean.len();
        let recip = scale.scale.recip();
        let codes: Vec<f32> = batch
            .coefficients
            .chunks_exact(width)
            .flat_map(|body| body.iter().zip(&scale.mean).map(|(a, mean)| (a - mean) * recip))
            .collect();
        let tensor = |numbers: Vec<f32>| {
            let shape = [batch.len, numbers.len() / batch.len.max(1)];
            Tensor::<2>::from_data(TensorData::new(numbers, shape), device)
        };
        Self {
            codes: tensor(codes),
            inputs: tensor(batch.inputs.clone()),
            noise: tensor(noise),
            bone_lengths: tensor(batch.bone_lengths.clone()),
        }
    }
}

/// The values of terms; `None` when the device fails to hand them out.
pub(crate) fn values(terms: Terms) -> Result<Vec<(&'static str, f64)>, TrainError> {
    terms
        .into_iter()
        .map(|(name, term)| {
            let data = term.try_into_data().map_err(|e| TrainError::Backend(format!("{e:?}")))?;
            let value = data.as_slice::<f32>().ok().and_then(|s| s.first().copied());
            value.map(|v| (name, f64::from(v))).ok_or_else(|| TrainError::Backend(format!("no number for {name}")))
        })
        .collect()
}
