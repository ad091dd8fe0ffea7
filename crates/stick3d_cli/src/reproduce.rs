//! `stick3d reproduce`: the paper's tables and figures by one command.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use stick3d_figure::figure::Figure;
use stick3d_figure::names::nearest;
use stick3d_model::Model;
use stick3d_train::pose::SHIPPED;
use stick3d_train::reproduce::{self, ReproduceConfig, ReproduceError, Subject};

use crate::args::{BodyFiles, MeshFiles, RunArguments};
use crate::corpus::Corpus;
use crate::failure::{Failure, Outcome};
use crate::inputs;
use crate::paper::Keys;
use crate::progress::Bar;

/// What `--quick` makes of epochs, vertices and widths that were not given.
const QUICK: (f64, usize, usize) = (0.1, 800, 256);
/// Without it.
const PUBLISHED: (f64, usize) = (1.0, 512);

#[derive(Debug, Args)]
#[command(mut_arg("meshes", |meshes| meshes.requires("figure")))]
#[command(mut_arg("rig", |rig| rig.requires("figure")))]
pub(crate) struct ReproduceArguments {
    /// Where the report goes; models that are there already are not trained again
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    pub(crate) out: PathBuf,
    /// A tenth of the epochs, small meshes and networks: some minutes
    #[arg(long)]
    pub(crate) quick: bool,
    /// Share of the paper's 300, 300 and 200 epochs [default: 1, or 0.1 with --quick]
    #[arg(long, value_name = "SHARE")]
    pub(crate) epochs_scale: Option<f64>,
    /// About how many vertices the meshes are brought to [default: all, or 800 with --quick]
    #[arg(long, value_name = "COUNT")]
    pub(crate) vertices: Option<usize>,
    /// Width of the hidden layers [default: 512, or 256 with --quick]
    #[arg(long)]
    pub(crate) hidden: Option<usize>,
    /// Seed and device
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Only these of the shipped bodies; all of them without it
    #[arg(long, value_name = "NAME", conflicts_with_all = ["meshes", "rig"])]
    pub(crate) only: Vec<String>,
    /// Or a rig of one's own
    #[command(flatten)]
    pub(crate) body: BodyFiles,
    /// Or meshes of one's own
    #[command(flatten)]
    pub(crate) set: MeshFiles,
    /// The figure file of the meshes or the rig, or for meshes a preset: scape, tosca-horse
    #[arg(long, value_name = "FILE|PRESET")]
    pub(crate) figure: Option<PathBuf>,
}

/// Runs `stick3d reproduce`.
pub(crate) fn run(arguments: &ReproduceArguments) -> Outcome {
    let start = Instant::now();
    let config = config(arguments)?;
    let mut subjects = subjects(arguments)?;
    let vertices = arguments.vertices.or(arguments.quick.then_some(QUICK.1));
    if let Some(vertices) = vertices {
        for subject in &mut subjects {
            subject.set = subject.set.coarsened(vertices);
        }
    }
    let bar = Bar::new();
    reproduce::reproduce(&subjects, &config, &arguments.out, &bar).map_err(
        |error| match error {
            ReproduceError::Io { .. } | ReproduceError::Picture(_) => Failure::output(error),
            ReproduceError::Model(_) => Failure::model(error),
            other => Failure::from(anyhow::Error::from(other)),
        },
    )?;
    bar.clear();
    println!(
        "{} in {:.0} s",
        arguments.out.join("report.md").display(),
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

fn config(arguments: &ReproduceArguments) -> Outcome<ReproduceConfig> {
    let (share, hidden) = match arguments.quick {
        true => (QUICK.0, QUICK.2),
        false => PUBLISHED,
    };
    let epochs_share = arguments.epochs_scale.unwrap_or(share);
    if !(epochs_share.is_finite() && epochs_share > 0.0) {
        return Err(Failure::usage(anyhow::anyhow!(
            "--epochs-scale is {epochs_share}; give a number above 0"
        )));
    }
    let words: Vec<String> = std::env::args().skip(1).collect();
    Ok(ReproduceConfig {
        seed: arguments.run.seed,
        epochs_share,
        hidden: arguments.hidden.unwrap_or(hidden),
        device: arguments.run.device.clone(),
        command: format!("stick3d {}", words.join(" ")),
    })
}

fn subjects(arguments: &ReproduceArguments) -> Outcome<Vec<Subject>> {
    if let (Some(folder), Some(figure)) = (&arguments.set.meshes, &arguments.figure) {
        let (keys, said) = Keys::of_meshes(folder, &arguments.set, figure, arguments.run.seed)?;
        println!("{said}");
        return Ok(vec![subject(keys, None)]);
    }
    if let (Some(_), Some(figure)) = (&arguments.body.rig, &arguments.figure) {
        let figure = inputs::figure(figure)?;
        let corpus = Corpus::read(&arguments.body, Some(&figure))?;
        corpus.said.iter().for_each(|line| println!("{line}"));
        return Ok(vec![subject(
            Keys::of_rig(&corpus, &figure, arguments.run.seed)?,
            None,
        )]);
    }
    let known = || SHIPPED.iter().map(|body| body.name);
    if let Some(unknown) = arguments
        .only
        .iter()
        .find(|name| !known().any(|k| k == **name))
    {
        return Err(Failure::usage(anyhow::anyhow!(
            "no body \"{unknown}\" ships; did you mean \"{}\"?",
            nearest(unknown, known()).unwrap_or_default()
        )));
    }
    let wanted = |name: &str| arguments.only.is_empty() || arguments.only.iter().any(|b| b == name);
    Figure::shipped()
        .into_iter()
        .filter(|figure| wanted(&figure.name))
        .map(|figure| shipped(figure, arguments.run.seed))
        .collect()
}

/// A shipped body with the model that ships for it.
fn shipped(figure: &Figure, seed: u64) -> Outcome<Subject> {
    let name = &figure.name;
    let files = BodyFiles {
        rig: Some(format!("assets/rigs/{name}.glb").into()),
        controls: Some(format!("assets/rigs/{name}.controls.ron").into()),
        poses: Some(format!("assets/poses/{name}.ron").into()),
        clip_poses: None,
    };
    let corpus = Corpus::read(&files, Some(figure))?;
    let keys = Keys::of_rig(&corpus, figure, seed)?;
    Ok(subject(keys, Some(inputs::embedded_model(name)?)))
}

fn subject(keys: Keys, shipped: Option<Model>) -> Subject {
    Subject {
        name: keys.set.figure.name.clone(),
        published: keys.is_many(),
        set: keys.set,
        held_out: keys.held_out,
        shipped,
    }
}
