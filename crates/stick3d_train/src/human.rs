//! Training and measuring the shipped human: its rig, its poses, and which of them are left out.

use std::path::Path;

use rand::Rng as _;
use stick3d_figure::figure::Figure;
use stick3d_model::{Model, ModelError};
use thiserror::Error;

use crate::dataset::{PoseStream, random};
use crate::evaluate::{EvalConfig, EvalError, EvalInput, Report, evaluate};
use crate::pose::{
    Controls, HUMAN_CONTROLS, HUMAN_POSES, PoseError, PoseLibrary, PoseSampler, SampleKind,
};
use crate::rig::{Pose, Rig, RigError};
use crate::training::{Progress, TrainConfig, TrainError, TrainInput, Trained, train};

/// The rigged body, `assets/rigs/human.glb`.
pub const HUMAN_RIG: &[u8] = include_bytes!("../../../assets/rigs/human.glb");

/// Which library poses are left out of training: the same for every run, so that all models can be compared.
const SPLIT_SEED: u64 = 2022;

/// Share of the library poses that are left out of training.
const HELD_OUT_SHARE: f32 = 0.1;

/// Everything that the human is trained from.
#[derive(Debug, Clone)]
pub struct HumanData {
    /// The body.
    pub rig: Rig,
    /// Its degrees of freedom.
    pub controls: Controls,
    /// Library poses to train on.
    pub library: PoseLibrary,
    /// Library poses left out.
    pub held_out: PoseLibrary,
}

/// Why the human's data could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum HumanDataError {
    /// The rig.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// Controls or poses.
    #[error(transparent)]
    Pose(#[from] PoseError),
}

/// Why a trained model could not be measured or given its measures.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// Measuring failed.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// The model does not take its measures.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The measures cannot be serialised.
    #[error("the measures cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl HumanData {
    /// The data of this repository, which the crate embeds.
    ///
    /// # Errors
    /// [`HumanDataError`], when an asset was edited and does not fit the others any more.
    pub fn embedded() -> Result<Self, HumanDataError> {
        let rig = Rig::from_glb(HUMAN_RIG)?;
        let controls = Controls::from_ron(HUMAN_CONTROLS, &rig)?;
        let all = PoseLibrary::from_ron(HUMAN_POSES, &controls)?;
        let (library, held_out) = all.split(SPLIT_SEED, HELD_OUT_SHARE);
        Ok(Self {
            rig,
            controls,
            library,
            held_out,
        })
    }

    /// Trains a model; see [`train`].
    ///
    /// # Errors
    /// [`TrainError`].
    pub fn train(
        &self,
        config: &TrainConfig,
        run_folder: Option<&Path>,
        resume: bool,
        progress: &dyn Progress,
    ) -> Result<Trained, TrainError> {
        let upright = self.poses(&self.library);
        let mirrored = upright.iter().map(|pose| self.controls.mirror_pose(pose));
        let library: Vec<Pose> = upright.iter().cloned().chain(mirrored).collect();
        let streams = |number: u64| self.stream(config.seed, "training poses", number);
        let input = TrainInput {
            figure: Figure::human(),
            rig: &self.rig,
            library: &library,
            streams: &streams,
            held_out_poses: self
                .held_out
                .poses
                .iter()
                .map(|pose| pose.name.clone())
                .collect(),
        };
        train(&input, config, run_folder, resume, progress)
    }

    /// Measures a model; see [`evaluate`].
    ///
    /// # Errors
    /// [`EvalError`].
    pub fn evaluate(
        &self,
        model: &Model,
        config: &EvalConfig,
        progress: &dyn Progress,
    ) -> Result<Report, EvalError> {
        let library = self.poses(&self.library);
        let held_out = self.poses(&self.held_out);
        let stream = self.stream(config.seed, "test poses", 0);
        evaluate(
            model,
            EvalInput {
                rig: &self.rig,
                library: &library,
                held_out: &held_out,
                stream,
            },
            config,
            progress,
        )
    }

    /// Measures a model and writes the measures into its metadata.
    ///
    /// # Errors
    /// [`MeasureError`].
    pub fn with_metrics(
        &self,
        model: Model,
        config: &EvalConfig,
        progress: &dyn Progress,
    ) -> Result<(Model, Report), MeasureError> {
        let report = self.evaluate(&model, config, progress)?;
        let mut parts = model.into_parts();
        let evaluation = serde_json::to_value(&report)?;
        match parts.metadata.metrics.as_object_mut() {
            Some(metrics) => drop(metrics.insert("evaluation".to_owned(), evaluation)),
            None => parts.metadata.metrics = serde_json::json!({ "evaluation": evaluation }),
        }
        Ok((Model::new(parts)?, report))
    }

    /// Sampled poses: two natural ones for each free one. Held-out poses of the library are not among their sources.
    fn stream(&self, seed: u64, purpose: &str, number: u64) -> PoseStream<'_> {
        let seed = random(seed, purpose, number).random();
        let mut sampler = PoseSampler::new(&self.rig, &self.controls, &self.library, seed);
        Box::new(std::iter::repeat_with(move || {
            sampler.sample(SampleKind::Mixed)
        }))
    }

    fn poses(&self, library: &PoseLibrary) -> Vec<Pose> {
        library
            .poses
            .iter()
            .map(|pose| self.controls.pose(&pose.values))
            .collect()
    }
}
