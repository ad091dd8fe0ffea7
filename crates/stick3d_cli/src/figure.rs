//! `stick3d figure`: figure files for bodies of one's own.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use stick3d_figure::{Anchor, Figure};
use stick3d_model::files::write_atomically;
use stick3d_train::format::read_mesh;
use stick3d_train::guess::{self, Guess};
use stick3d_train::landmark::Preset;
use stick3d_train::meshes::UpAxis;
use stick3d_train::rig::{RigFile, Weld};

use crate::args::{FigureCommand, FigureInitArguments};
use crate::failure::{Failure, Outcome};

/// Where a figure goes if nothing else is said.
const DEFAULT_OUT: &str = "figure.ron";

/// Runs `stick3d figure`.
pub(crate) fn run(command: &FigureCommand) -> Outcome {
    match command {
        FigureCommand::Init(arguments) => init(arguments),
    }
}

fn init(arguments: &FigureInitArguments) -> Outcome {
    let out = out(arguments)?;
    match (&arguments.rig, &arguments.mesh, arguments.preset) {
        (Some(rig), _, _) => from_rig(rig, arguments.name.as_deref(), &out),
        (None, Some(mesh), Some(preset)) => from_mesh(mesh, preset, arguments.up.into(), &out),
        _ => Err(Failure::input(anyhow!(
            "name a rig, or a mesh and a preset"
        ))),
    }
}

/// Where to write. A file that nobody named is not written over: people edit figures by hand.
fn out(arguments: &FigureInitArguments) -> Outcome<PathBuf> {
    match &arguments.out {
        Some(out) => Ok(out.clone()),
        None if Path::new(DEFAULT_OUT).exists() => Err(Failure::output(anyhow!(
            "{DEFAULT_OUT} is there already; name another file with --out, or the same to write over it"
        ))),
        None => Ok(PathBuf::from(DEFAULT_OUT)),
    }
}

/// Writes a figure whose joints are guessed from a rig.
fn from_rig(path: &Path, name: Option<&str>, out: &Path) -> Outcome {
    let input = |error: anyhow::Error| {
        Failure::input(error).context(format!("cannot guess the joints of {}", path.display()))
    };
    let file = RigFile::read(path, Weld::default()).map_err(|error| input(error.into()))?;
    let stem = path.file_stem().map(|stem| stem.to_string_lossy());
    let name = name.map_or_else(|| stem.unwrap_or_default().into_owned(), str::to_owned);
    let guess = guess::guess(&file.rig, &name).map_err(|error| input(error.into()))?;
    for line in file.report.lines().iter().chain(&guess.notes) {
        eprintln!("note: {line}");
    }
    write(&guess.figure, out)?;
    println!(
        "{}: {} joints of {name}, which faces {} in its file",
        out.display(),
        guess.figure.joint_count(),
        guess::direction(guess.forward)
    );
    for joint in &guess.figure.joints {
        println!("  {:<10} {}", joint.name, in_words(&joint.anchor));
    }
    complete(&guess, out)
}

/// Whether all joints were guessed; if not, which are left to do.
fn complete(guess: &Guess, out: &Path) -> Outcome {
    if guess.faults.is_empty() {
        return Ok(());
    }
    let faults: Vec<String> = guess.faults.iter().map(ToString::to_string).collect();
    Err(Failure::input(anyhow!(
        "{} is written, but {} of its {} joints are left to you:\n  {}",
        out.display(),
        faults.len(),
        guess.figure.joint_count(),
        faults.join("\n  ")
    )))
}

fn in_words(anchor: &Anchor) -> String {
    match anchor {
        Anchor::Bones(names) => format!("bone {}", names.join(" and ")),
        Anchor::Vertices(vertices) if vertices.is_empty() => "not guessed".to_owned(),
        Anchor::Vertices(vertices) => format!("{} vertices of the surface", vertices.len()),
    }
}

/// Writes a figure whose joints are found on a mesh.
fn from_mesh(mesh: &Path, preset: Preset, up: UpAxis, out: &Path) -> Outcome {
    let mut file = read_mesh(mesh).map_err(Failure::input)?;
    up.turn(&mut file.mesh.positions);
    let figure = preset.figure(&file.mesh).map_err(|error| {
        Failure::input(error).context(format!("cannot find joints on {}", mesh.display()))
    })?;
    write(&figure, out)?;
    println!(
        "{}: {} joints of {}, found on {}; look at them before training (`stick3d train --meshes`)",
        out.display(),
        figure.joint_count(),
        figure.name,
        mesh.display()
    );
    Ok(())
}

fn write(figure: &Figure, out: &Path) -> Outcome {
    let text = figure.to_ron().map_err(Failure::input)?;
    write_atomically(out, text.as_bytes()).map_err(Failure::output)
}
