//! All numbers of the report.

use std::fmt::Write as _;

use glam::Vec3;
use stick3d_model::Inference;

use super::runs::{Cost, Run, TrainedRun};
use super::{Prepared, ReproduceError};
use crate::evaluate::EvalError;
use crate::paper::{Errors, PaperSet, Sample, Samples, errors, measure, sketched};

/// What is measured on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// Turned meshes whose meshes were learnt from in other turns.
    Random,
    /// Meshes that were learnt from in no turn.
    Pose,
}

impl Part {
    pub(super) const ALL: [Self; 2] = [Self::Random, Self::Pose];

    pub(super) fn label(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Pose => "pose",
        }
    }

    fn of(self, samples: &Samples) -> &[Sample] {
        match self {
            Self::Random => &samples.random,
            Self::Pose => &samples.pose,
        }
    }
}

/// The errors of one model, one way, on one part.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub(super) subject: String,
    /// "VAE", "AE", "what ships", "nearest neighbour".
    pub(super) label: String,
    /// 0 where there is no latent.
    pub(super) latent_len: usize,
    pub(super) part: Part,
    /// Whether from the mesh; else from the sketch.
    pub(super) from_mesh: bool,
    pub(super) errors: Errors,
}

/// What training a model took.
#[derive(Debug, Clone)]
pub(super) struct Training {
    pub(super) id: String,
    pub(super) epochs: [usize; 3],
    pub(super) cost: Cost,
}

/// All rows so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Results {
    pub(super) rows: Vec<Row>,
    pub(super) trainings: Vec<Training>,
}

/// What the shipped model is called in tables.
pub(super) const SHIPPED: &str = "what ships";
/// And the baseline.
pub(super) const NEAREST: &str = "nearest neighbour";

impl Results {
    /// Those of what needs no training: the shipped model, and the training sample with the closest sketch.
    pub(super) fn of_baselines(prepared: &[Prepared<'_>]) -> Result<Self, ReproduceError> {
        let mut results = Self::default();
        for prepared in prepared {
            let set = &prepared.subject.set;
            for part in Part::ALL {
                let samples = part.of(&prepared.samples);
                if samples.is_empty() {
                    continue;
                }
                let row = |label: &str, latent_len, errors| Row {
                    subject: prepared.subject.name.clone(),
                    label: label.to_owned(),
                    latent_len,
                    part,
                    from_mesh: false,
                    errors,
                };
                if let Some(shipped) = &prepared.shipped {
                    let found = errors(set, samples, shipped, |shipped, sample| {
                        prepared.of_shipped(shipped, sample)
                    })?;
                    results.rows.push(row(SHIPPED, shipped.latent_len(), found));
                }
                let inputs = prepared.inputs()?;
                let found = errors(set, samples, &(), |(), sample| {
                    nearest(set, &prepared.samples.train, &inputs, sample)
                })?;
                results.rows.push(row(NEAREST, 0, found));
            }
        }
        Ok(results)
    }

    /// Measures a model and adds its rows.
    pub(super) fn add(
        &mut self,
        run: &Run,
        trained: &TrainedRun,
        prepared: &Prepared<'_>,
    ) -> Result<(), ReproduceError> {
        self.trainings.push(Training {
            id: run.id.clone(),
            epochs: run.config.epochs,
            cost: trained.cost,
        });
        for part in Part::ALL {
            let samples = part.of(&prepared.samples);
            if samples.is_empty() {
                continue;
            }
            let measured = measure(&trained.model, &prepared.subject.set, samples)?;
            for (from_mesh, errors) in [(true, measured.mesh), (false, measured.sketch)] {
                self.rows.push(Row {
                    subject: prepared.subject.name.clone(),
                    label: run.label(),
                    latent_len: run.config.latent_len,
                    part,
                    from_mesh,
                    errors,
                });
            }
        }
        Ok(())
    }

    /// The rows as CSV.
    pub(super) fn to_csv(&self) -> String {
        let mut csv = "subject,model,latent,split,from,cases,vertex_mean_cm,vertex_std_cm,vertex_p95_cm,\
                       vertex_mean_normalised,vertex_std_normalised,squared_error_mean,squared_error_std,\
                       mpjpe_mm,pa_mpjpe_mm,reprojection_cm,bone_length_percent,bone_length_p95_percent\n"
            .to_owned();
        for row in &self.rows {
            let (errors, metrics) = (&row.errors, &row.errors.metrics);
            let numbers = [
                metrics.vertex_mean_cm,
                metrics.vertex_std_cm,
                metrics.vertex_p95_cm,
                metrics.vertex_mean_normalised,
                errors.vertex_std_normalised,
                errors.squared_mean,
                errors.squared_std,
                metrics.mpjpe_mm,
                metrics.pa_mpjpe_mm,
                metrics.reprojection_cm,
                metrics.bone_length_percent,
                metrics.bone_length_p95_percent,
            ];
            // Writing into a String cannot fail.
            let _ = writeln!(
                csv,
                "{},{},{},{},{},{},{}",
                row.subject,
                row.label,
                row.latent_len,
                row.part.label(),
                if row.from_mesh { "mesh" } else { "sketch" },
                metrics.cases,
                numbers.map(|number| format!("{number:.6}")).join(",")
            );
        }
        csv
    }
}

impl Prepared<'_> {
    /// The input vectors of the training samples.
    fn inputs(&self) -> Result<Vec<Vec<f32>>, EvalError> {
        let set = &self.subject.set;
        let inputs = self.samples.train.iter().map(|s| set.input_vector(*s));
        Ok(inputs.collect::<Result<_, _>>()?)
    }

    /// The mesh that the shipped model makes of a sample's sketch, on the vertices that the set has.
    pub(super) fn of_shipped(
        &self,
        shipped: &mut Inference,
        sample: Sample,
    ) -> Result<Vec<Vec3>, EvalError> {
        let mesh = sketched(shipped, &self.subject.set, sample)?;
        Ok(self.kept(&mesh))
    }

    /// The vertices that the set has, of all.
    pub(super) fn kept(&self, mesh: &[Vec3]) -> Vec<Vec3> {
        match &self.subject.set.kept {
            None => mesh.to_vec(),
            Some(kept) => kept.iter().map(|v| mesh[*v as usize]).collect(),
        }
    }
}

/// The training sample whose sketch is closest.
fn nearest(
    set: &PaperSet,
    train: &[Sample],
    inputs: &[Vec<f32>],
    sample: Sample,
) -> Result<Vec<Vec3>, EvalError> {
    let wanted = set.input_vector(sample)?;
    let distance = |input: &[f32]| -> f32 {
        let differences = input.iter().zip(&wanted).map(|(a, b)| (a - b).powi(2));
        differences.sum()
    };
    let closest = train
        .iter()
        .zip(inputs)
        .min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
    let (closest, _) = closest.ok_or(EvalError::NoLibrary)?;
    Ok(set.vertices(*closest))
}
