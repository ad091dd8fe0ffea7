//! `stick3d train --paper`: the paper's own networks on its own kind of data.

use std::path::Path;
use std::time::Instant;

use clap::{Args, ValueEnum};
use stick3d_figure::figure::Figure;
use stick3d_train::meshes::MeshSet;
use stick3d_train::paper::{self, Errors, Measured, PaperConfig, PaperSet, Split};
use stick3d_train::pose::{NamedPose, ShippedBody};

use crate::args::{MeshFiles, TrainArguments};
use crate::corpus::Corpus;
use crate::eval::spread;
use crate::failure::{Failure, Outcome};
use crate::progress::Bar;
use crate::train::{as_stored, make_work_folder, say_when, with_metrics};
use crate::{inputs, mesh_set};

/// How many key meshes bodies have that the paper does not know: as many as its man.
const KEY_MESHES: usize = 72;

/// The paper's own system.
#[derive(Debug, Args)]
pub(crate) struct PaperArguments {
    /// Trains the paper's own networks: from all coordinates to all coordinates, on key poses in 21 turns
    #[arg(long)]
    pub(crate) paper: bool,
    /// Its plain autoencoder instead: the mean is the latent, and no divergence
    #[arg(long, requires = "paper")]
    pub(crate) autoencoder: bool,
    /// Width of the hidden layers
    #[arg(long, requires = "paper", default_value_t = 512)]
    pub(crate) hidden: usize,
    /// Length of the latent
    #[arg(long, requires = "paper", default_value_t = 256)]
    pub(crate) latent: usize,
    /// What is kept out of training, to be measured on
    #[arg(long, requires = "paper", value_enum, default_value_t)]
    pub(crate) split: KeptOut,
    /// Share of the paper's 300, 300 and 200 epochs
    #[arg(long, requires = "paper", value_name = "SHARE", default_value_t = 1.0)]
    pub(crate) epochs_scale: f64,
}

/// What is kept out of training.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub(crate) enum KeptOut {
    /// A tenth of the turned meshes
    Random,
    /// A tenth of the key poses, in all turns
    Pose,
    /// Both
    #[default]
    Both,
}

impl From<KeptOut> for Split {
    fn from(kept_out: KeptOut) -> Self {
        match kept_out {
            KeptOut::Random => Self::Random,
            KeptOut::Pose => Self::Pose,
            KeptOut::Both => Self::Both,
        }
    }
}

/// Key meshes, and which of them are kept out of training.
pub(crate) struct Keys {
    pub(crate) set: PaperSet,
    pub(crate) held_out: Vec<String>,
}

impl Keys {
    /// Poses of a rig's library, evenly spread over it. Those held out are ones that the shipped model of the figure, if
    /// there is one, has not seen either.
    pub(crate) fn of_rig(corpus: &Corpus, figure: &Figure, seed: u64) -> Outcome<Self> {
        let shipped = inputs::embedded_model(&figure.name).ok();
        let split = shipped.and_then(|model| corpus.split_of(&model).ok());
        let (trained_on, unseen) = split.unwrap_or_else(|| corpus.split(seed));
        let body = ShippedBody::named(&figure.name);
        let count = body.map_or(KEY_MESHES, |body| body.paper_meshes);
        let kept_out = ((mesh_set::HELD_OUT * count as f32).round() as usize).max(1);
        let mut keys = spread(trained_on.poses, count - kept_out);
        let unseen = spread(unseen.poses, kept_out);
        let held_out = unseen.iter().map(|pose| pose.name.clone()).collect();
        keys.extend(unseen);
        let posed = |key: &NamedPose| (key.name.clone(), corpus.controls.pose(&key.values));
        let poses: Vec<_> = keys.iter().map(posed).collect();
        let set = PaperSet::of_rig(figure, &corpus.rig, &poses).map_err(anyhow::Error::from)?;
        Ok(Self { set, held_out })
    }

    /// The meshes of a folder, and what was read, for people. `figure` names a figure file or a preset; a preset's joints
    /// are found on the pilot.
    pub(crate) fn of_meshes(
        folder: &Path,
        files: &MeshFiles,
        figure: &Path,
        seed: u64,
    ) -> Outcome<(Self, String)> {
        let figure = mesh_set::figure(folder, files, figure)?;
        let (set, said) = mesh_set::read(folder, files, &figure)?;
        Ok((Self::of_mesh_set(&set, &figure, seed)?, said))
    }

    /// Whether these are as many as the paper's published tables are about, those of its man.
    pub(crate) fn is_many(&self) -> bool {
        self.set.meshes.len() > KEY_MESHES / 2
    }

    fn of_mesh_set(set: &MeshSet, figure: &Figure, seed: u64) -> Outcome<Self> {
        Ok(Self {
            held_out: set.held_out(seed, mesh_set::HELD_OUT),
            set: PaperSet::of_meshes(figure, set).map_err(Failure::input)?,
        })
    }
}

/// Runs `stick3d train --paper`.
pub(crate) fn train(arguments: &TrainArguments) -> Outcome {
    let start = Instant::now();
    let Keys { set, held_out } = keys(arguments)?;
    let config = config(arguments, set.meshes.len())?;
    let samples = set
        .samples(arguments.paper.split.into(), &held_out, config.seed)
        .map_err(anyhow::Error::from)?;
    println!(
        "{} key meshes in {} turns: {} to learn from, {} and {} turns of unseen poses to measure on",
        set.meshes.len(),
        set.turns.len(),
        samples.train.len(),
        samples.random.len(),
        samples.pose.len()
    );
    make_work_folder(arguments)?;
    let bar = Bar::new();
    let folder = Some(arguments.work_dir.as_path());
    let trained = paper::train_paper(&set, &samples, &config, folder, !arguments.fresh, &bar)
        .map_err(anyhow::Error::from)?;
    let model = as_stored(&trained.model)?;
    let mut measured = vec![];
    for (name, part) in [("random", &samples.random), ("pose", &samples.pose)] {
        if !part.is_empty() {
            let errors = paper::measure(&model, &set, part).map_err(Failure::model)?;
            measured.push((name, errors));
        }
    }
    bar.clear();
    let noted: serde_json::Map<_, _> = measured
        .iter()
        .map(|(name, errors)| Ok(((*name).to_owned(), serde_json::to_value(errors)?)))
        .collect::<Result<_, serde_json::Error>>()
        .map_err(anyhow::Error::from)?;
    with_metrics(model, &noted)?
        .save(&arguments.out)
        .map_err(Failure::output)?;
    measured.iter().for_each(|(name, errors)| say(name, errors));
    say_when(arguments, start);
    Ok(())
}

fn keys(arguments: &TrainArguments) -> Outcome<Keys> {
    if let (Some(folder), Some(figure)) = (&arguments.set.meshes, &arguments.figure) {
        let (keys, said) = Keys::of_meshes(folder, &arguments.set, figure, arguments.run.seed)?;
        println!("{said}");
        return Ok(keys);
    }
    let figure = match &arguments.figure {
        Some(path) => inputs::figure(path)?,
        None => Figure::human().clone(),
    };
    let corpus = Corpus::read(&arguments.body, Some(&figure))?;
    corpus.said.iter().for_each(|line| println!("{line}"));
    Keys::of_rig(&corpus, &figure, arguments.run.seed)
}

fn config(arguments: &TrainArguments, key_meshes: usize) -> Outcome<PaperConfig> {
    let TrainArguments { run, paper, .. } = arguments;
    let scale = paper.epochs_scale;
    if !(scale.is_finite() && scale > 0.0) {
        return Err(Failure::usage(anyhow::anyhow!(
            "--epochs-scale is {scale}; give a number above 0"
        )));
    }
    let published = PaperConfig {
        seed: run.seed,
        device: run.device.clone(),
        hidden: paper.hidden,
        latent_len: paper.latent,
        ..PaperConfig::published(key_meshes)
    };
    let config = match paper.autoencoder {
        true => published.plain(),
        false => published,
    };
    Ok(config.scaled(if arguments.quick { 0.1 * scale } else { scale }))
}

fn say(split: &str, measured: &Measured) {
    let line = |way: &str, errors: &Errors| {
        println!(
            "{split:6} {way:11} {:6.2} cm a vertex (std {:.2}), squared error {:.3} per mille (std {:.3}), MPJPE {:.1} mm, bones off by {:.1} %",
            errors.metrics.vertex_mean_cm,
            errors.metrics.vertex_std_cm,
            1e3 * errors.squared_mean,
            1e3 * errors.squared_std,
            errors.metrics.mpjpe_mm,
            errors.metrics.bone_length_percent,
        );
    };
    line("from mesh", &measured.mesh);
    line("from sketch", &measured.sketch);
}
