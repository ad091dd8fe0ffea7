//! `stick3d train`: from a rig and its poses to a model file.

use std::time::Instant;

use anyhow::Context as _;
use serde::Serialize;
use stick3d_figure::figure::Figure;
use stick3d_model::Model;
use stick3d_train::evaluate::{EvalConfig, Report};
use stick3d_train::training::{self, TrainConfig, TrainInput, Trained};

use crate::args::TrainArguments;
use crate::corpus::Corpus;
use crate::failure::{Failure, Outcome};
use crate::progress::Bar;
use crate::{eval, inputs, mesh_set, paper, recipe};

/// What `--quick` divides bodies and epochs by.
const QUICK: usize = 10;

/// Runs `stick3d train`.
pub(crate) fn run(arguments: &TrainArguments) -> Outcome {
    let start = Instant::now();
    if arguments.paper.paper {
        return paper::train(arguments);
    }
    let figure = match &arguments.figure {
        Some(path) => inputs::figure(path)?,
        None => Figure::human().clone(),
    };
    if let Some(folder) = &arguments.set.meshes {
        return mesh_set::train(arguments, folder, &figure);
    }
    let corpus = Corpus::read(&arguments.body, Some(&figure))?;
    corpus.said.iter().for_each(|line| println!("{line}"));
    let config = config(arguments, &figure)?;
    let (trained_on, held_out) = corpus.split(config.seed);
    let streams = |number: u64| corpus.stream(&trained_on, config.seed.rotate_left(32) ^ number);
    let input = TrainInput {
        figure: &figure,
        rig: &corpus.rig,
        library: &corpus.poses_both_ways(&trained_on),
        streams: &streams,
        held_out_poses: held_out
            .poses
            .iter()
            .map(|pose| pose.name.clone())
            .collect(),
    };
    make_work_folder(arguments)?;
    let bar = Bar::new();
    let trained = training::train(
        &input,
        &config,
        Some(&arguments.work_dir),
        !arguments.fresh,
        &bar,
    )
    .map_err(anyhow::Error::from)?;
    finish(arguments, &trained, &bar, |model| {
        eval::measure(model, &corpus, &EvalConfig::default(), &bar)
    })?;
    say_when(arguments, start);
    Ok(())
}

/// Makes the folder for checkpoints and logs.
pub(crate) fn make_work_folder(arguments: &TrainArguments) -> Outcome {
    std::fs::create_dir_all(&arguments.work_dir)
        .with_context(|| format!("cannot make the folder {}", arguments.work_dir.display()))
        .map_err(Failure::output)
}

/// Measures a trained model, writes it and prints the table.
pub(crate) fn finish(
    arguments: &TrainArguments,
    trained: &Trained,
    bar: &Bar,
    measure: impl FnOnce(&Model) -> Outcome<Report>,
) -> Outcome {
    let model = as_stored(&trained.model)?;
    let report = measure(&model)?;
    bar.clear();
    with_metrics(model, &report)?
        .save(&arguments.out)
        .map_err(Failure::output)?;
    println!("{}", eval::table(&report));
    Ok(())
}

/// Says where the model is and how long it took.
pub(crate) fn say_when(arguments: &TrainArguments, start: Instant) {
    println!(
        "{} in {:.0} s",
        arguments.out.display(),
        start.elapsed().as_secs_f64()
    );
}

/// The model as it comes back from its file, where numbers are rounded: what is measured is what ships.
pub(crate) fn as_stored(model: &Model) -> Outcome<Model> {
    model
        .to_bytes()
        .and_then(|bytes| Model::from_bytes(&bytes))
        .map_err(Failure::model)
}

/// The model with its measures beside what the trainer noted already.
pub(crate) fn with_metrics(model: Model, report: &impl Serialize) -> Outcome<Model> {
    let mut parts = model.into_parts();
    let report = serde_json::to_value(report).map_err(anyhow::Error::from)?;
    match parts.metadata.metrics.as_object_mut() {
        Some(noted) => drop(noted.insert("evaluation".to_owned(), report)),
        None => parts.metadata.metrics = report,
    }
    Model::new(parts).map_err(Failure::model)
}

fn config(arguments: &TrainArguments, figure: &Figure) -> Outcome<TrainConfig> {
    quicker(arguments, TrainConfig::of(figure))
}

/// A recipe with the seed, the haste and the changes that were asked for.
pub(crate) fn quicker(arguments: &TrainArguments, recipe: TrainConfig) -> Outcome<TrainConfig> {
    let mut config = TrainConfig {
        seed: arguments.run.seed,
        ..recipe
    };
    if arguments.quick {
        config.sampled_bodies /= QUICK;
        config.basis.poses /= QUICK;
        for stage in &mut config.stages {
            stage.epochs = stage.epochs.div_ceil(QUICK);
        }
    }
    let config = recipe::changed(config, &arguments.changes)?;
    Ok(TrainConfig {
        device: arguments.run.device.clone(),
        ..config
    })
}
