//! How far models' meshes are from samples that they did not learn from: the measure of the paper's tables 1 and 2.

use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use stick3d_figure::figure::Figure;
use stick3d_model::{Inference, Model};

use super::{PaperSet, Sample};
use crate::dataset::rounded;
use crate::evaluate::{Collector, EvalError, Metrics};

/// Errors over some samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Distances in centimetres and normalised units, joints, bones.
    pub metrics: Metrics,
    /// Standard deviation of a vertex' distance, normalised units.
    pub vertex_std_normalised: f64,
    /// A vertex' squared error, mean over its three coordinates, normalised units: mean over vertices.
    pub squared_mean: f64,
    /// Its standard deviation over vertices.
    pub squared_std: f64,
}

/// A model's errors both ways.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// From meshes, through Encoder3D: the paper's "reconstruction".
    pub mesh: Errors,
    /// From sketches, through Encoder2D: what the system is for.
    pub sketch: Errors,
}

/// Gathers samples for [`Errors`].
#[derive(Debug, Clone, Default)]
pub(crate) struct ErrorCollector {
    collector: Collector,
    vertices: usize,
    squares: f64,
    fourth_powers: f64,
}

impl ErrorCollector {
    /// Adds a mesh and its joints, and the true ones; metres.
    pub(crate) fn add(
        &mut self,
        figure: &Figure,
        found: (&[Vec3], &[Vec3]),
        truth: (&[Vec3], &[Vec3]),
    ) {
        for (a, b) in found.0.iter().zip(truth.0) {
            let square = f64::from(a.distance_squared(*b));
            self.squares += square;
            self.fourth_powers += square * square;
        }
        self.vertices += truth.0.len();
        self.collector.add(figure, found, truth);
    }

    /// The errors; `extent_m` is the unit of the normalised ones.
    pub(crate) fn errors(&self, extent_m: f32) -> Errors {
        let metrics = self.collector.metrics(extent_m);
        let (count, extent) = (self.vertices.max(1) as f64, f64::from(extent_m));
        let unit = 3.0 * extent * extent;
        let mean = self.squares / count / unit;
        let variance = (self.fourth_powers / count / (unit * unit) - mean * mean).max(0.0);
        Errors {
            metrics,
            vertex_std_normalised: rounded(metrics.vertex_std_cm / 100.0 / extent),
            // As small as a millionth: not to be rounded to one.
            squared_mean: mean,
            squared_std: variance.sqrt(),
        }
    }
}

/// Measures a model of the paper's architecture on samples of its set.
///
/// # Errors
/// [`EvalError`] when the model is for another mesh.
pub fn measure(model: &Model, set: &PaperSet, samples: &[Sample]) -> Result<Measured, EvalError> {
    model.require_topology(&set.topology_hash())?;
    let inference = Inference::new(model)?;
    Ok(Measured {
        mesh: errors(set, samples, &inference, |inference, sample| {
            reconstructed(model, inference, set, sample)
        })?,
        sketch: errors(set, samples, &inference, |inference, sample| {
            sketched(inference, set, sample)
        })?,
    })
}

/// The errors of meshes that `find` makes of samples, several at once, each with networks of its own.
pub(crate) fn errors<N: Clone + Sync>(
    set: &PaperSet,
    samples: &[Sample],
    networks: &N,
    find: impl Fn(&mut N, Sample) -> Result<Vec<Vec3>, EvalError> + Sync,
) -> Result<Errors, EvalError> {
    // Networks are large: one copy for each core.
    let share = samples.len().div_ceil(rayon::current_num_threads()).max(1);
    let found: Vec<Vec<Vec<Vec3>>> = samples
        .par_chunks(share)
        .map(|samples| {
            let mut networks = networks.clone();
            let found = samples.iter().map(|sample| find(&mut networks, *sample));
            found.collect::<Result<_, _>>()
        })
        .collect::<Result<_, EvalError>>()?;
    let mut collector = ErrorCollector::default();
    for (sample, mesh) in samples.iter().zip(found.iter().flatten()) {
        let joints = set.regressor.joints(mesh);
        let truth = (&*set.vertices(*sample), &*set.joints(*sample));
        collector.add(&set.figure, (mesh, &joints), truth);
    }
    Ok(collector.errors(set.extent_m))
}

/// The mesh that a model of the paper's architecture makes of a sample's mesh: its mean latent, decoded; metres.
///
/// # Errors
/// [`EvalError`] when the networks give no mesh.
pub fn reconstructed(
    model: &Model,
    inference: &mut Inference,
    set: &PaperSet,
    sample: Sample,
) -> Result<Vec<Vec3>, EvalError> {
    let vertices = set.vertices(sample);
    let coordinates: Vec<f32> = vertices.iter().flat_map(|p| p.to_array()).collect();
    let (latent, _) = model.encoder3d().forward(&coordinates);
    decoded(inference, &latent)
}

/// The mesh that a model makes of a sample's sketch, metres.
///
/// # Errors
/// [`EvalError`] when the networks give no mesh.
pub fn sketched(
    inference: &mut Inference,
    set: &PaperSet,
    sample: Sample,
) -> Result<Vec<Vec3>, EvalError> {
    let mut latent = vec![0.0; inference.latent_len()];
    inference.encode(&set.sketch(sample)?, &mut latent)?;
    decoded(inference, &latent)
}

/// The mesh of a latent, metres.
pub(crate) fn decoded(inference: &mut Inference, latent: &[f32]) -> Result<Vec<Vec3>, EvalError> {
    let mut positions = vec![[0.0; 3]; inference.vertex_count()];
    inference.decode_positions(latent, &mut positions)?;
    Ok(positions.into_iter().map(Vec3::from).collect())
}
