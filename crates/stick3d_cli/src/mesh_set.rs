//! Registered meshes as training and evaluation take them.

use std::path::Path;
use std::time::Instant;

use stick3d_figure::figure::Figure;
use stick3d_model::Model;
use stick3d_train::evaluate::{EvalConfig, EvalError, Report, evaluate_meshes};
use stick3d_train::landmark::Preset;
use stick3d_train::meshes::{MeshSet, MeshSetOptions, UpAxis};
use stick3d_train::placement::Placement;
use stick3d_train::training::{self, MeshTrainInput, TrainConfig};

use crate::args::{MeshFiles, TrainArguments, Up};
use crate::failure::{Failure, Outcome};
use crate::inputs;
use crate::progress::Bar;
use crate::train::{finish, make_work_folder, quicker, say_when};

/// Which share of the meshes is kept out of training, for the evaluation.
pub(crate) const HELD_OUT: f32 = 0.1;

/// Below this share of the template's height over width, the meshes probably lie on their side.
const LYING: f32 = 0.4;

impl From<Up> for UpAxis {
    fn from(up: Up) -> Self {
        match up {
            Up::Y => Self::Y,
            Up::Z => Self::Z,
        }
    }
}

/// Runs `stick3d train --meshes`.
pub(crate) fn train(arguments: &TrainArguments, folder: &Path, figure: &Figure) -> Outcome {
    let start = Instant::now();
    let (set, said) = read(folder, &arguments.set, figure)?;
    println!("{said}");
    let recipe = TrainConfig::meshes(figure, set.meshes.len(), set.vertex_count());
    let config = quicker(arguments, recipe)?;
    let input = MeshTrainInput {
        figure,
        set: &set,
        held_out: set.held_out(config.seed, HELD_OUT),
    };
    make_work_folder(arguments)?;
    let bar = Bar::new();
    let trained = training::train_meshes(
        &input,
        &config,
        Some(&arguments.work_dir),
        !arguments.fresh,
        &bar,
    )
    .map_err(anyhow::Error::from)?;
    finish(arguments, &trained, &bar, |model| {
        measure(model, &set, &EvalConfig::default(), &bar)
    })?;
    say_when(arguments, start);
    Ok(())
}

/// Measures a model on the meshes of a folder that it did not learn from.
pub(crate) fn measure_folder(
    model: &Model,
    folder: &Path,
    files: &MeshFiles,
    config: &EvalConfig,
    bar: &Bar,
) -> Outcome<Report> {
    let (set, said) = read(folder, files, model.figure())?;
    // Standard output is the report's.
    eprintln!("{said}");
    measure(model, &set, config, bar)
}

fn measure(model: &Model, set: &MeshSet, config: &EvalConfig, bar: &Bar) -> Outcome<Report> {
    evaluate_meshes(model, set, config, bar).map_err(|error| match error {
        EvalError::NoHeldOut { .. } => Failure::input(error),
        other => Failure::model(other),
    })
}

/// The figure of a file; or, where there is no such file, that of a preset, its joints found on the pilot of a folder.
pub(crate) fn figure(folder: &Path, files: &MeshFiles, name: &Path) -> Outcome<Figure> {
    let preset = Preset::ALL
        .into_iter()
        .find(|preset| name == Path::new(preset.name()));
    match preset.filter(|_| !name.exists()) {
        None => inputs::figure(name),
        Some(preset) => {
            let pilot = MeshSet::read(folder, &options(files))
                .map_err(Failure::input)?
                .pilot_mesh();
            preset.figure(&pilot).map_err(|error| {
                Failure::input(error).context(format!(
                    "cannot find joints on the meshes of {}",
                    folder.display()
                ))
            })
        }
    }
}

fn options(files: &MeshFiles) -> MeshSetOptions {
    MeshSetOptions {
        pilot: files.pilot.clone(),
        skip_mismatched: files.skip_mismatched,
        up: files.up.into(),
    }
}

/// Reads a set and brings it to the figure's size and heading; also what was done to it, for people.
pub(crate) fn read(
    folder: &Path,
    files: &MeshFiles,
    figure: &Figure,
) -> Outcome<(MeshSet, String)> {
    let mut set = MeshSet::read(folder, &options(files)).map_err(Failure::input)?;
    let placement = set.place(figure, files.scale).map_err(Failure::input)?;
    let said = report(&set, &placement, files.scale);
    Ok((set, said))
}

fn report(set: &MeshSet, placement: &Placement, scale: Option<f32>) -> String {
    let size = match (scale, placement.scale) {
        (None, 1.0) => "their units taken as metres".to_owned(),
        (None, scale) => format!("scaled by {scale:.6} to the size of the figure's template"),
        (Some(scale), _) => format!("scaled by {scale}"),
    };
    let pilot = &set.meshes[set.pilot].name;
    let degenerate = set.pilot_mesh().edge_report().degenerate_triangles;
    let mut lines: Vec<String> = set
        .skipped
        .iter()
        .map(|mesh| format!("left out: {} has {} vertices", mesh.name, mesh.vertex_count))
        .collect();
    lines.push(format!(
        "{} meshes of {} vertices, {size}, turned by {:.0}° about the upright",
        set.meshes.len(),
        set.vertex_count(),
        placement.yaw_deg
    ));
    lines.push(format!(
        "{} triangles from {pilot}, {degenerate} degenerate ones kept",
        set.triangles.len()
    ));
    if placement.upright < LYING {
        lines.push("the meshes seem to lie on their side: try --up z (or --up y)".to_owned());
    }
    lines.join("\n")
}
