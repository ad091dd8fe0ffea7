//! `stick3d animate`: from sketches or a clip file to a moving body.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use stick3d_figure::sketch::Sketch;
use stick3d_model::export::animation::{
    AnimationError, AnimationMesh, AnimationReport, DEFAULT_TOLERANCE_M, Frame, FrameSettings,
    sample_frames, save_glb_animation, save_obj_sequence,
};
use stick3d_model::export::{ExportError, MeshFormat};
use stick3d_model::files::require_no_files;
use stick3d_model::latent::{
    ClipError, ClipFile, ClipKey, ClipPose, DEFAULT_LEAST_TRUST, Easing, Extrapolation,
    Interpolation, MotionSettings, PathError, Repeat,
};
use stick3d_model::{Inference, Model};

use crate::args::{AfterKeys, AnimateArguments, BetweenKeys, BeyondKeys, ClipFormat, Switch};
use crate::failure::{Failure, Outcome};
use crate::inputs;
use crate::pictures::save_png_sequence;

/// Runs `stick3d animate`.
pub(crate) fn run(arguments: &AnimateArguments) -> Outcome {
    require_output(arguments)?;
    let (model, mut clip) = match &arguments.clip {
        Some(path) => clip_file(path, arguments)?,
        None => clip_of_sketches(arguments)?,
    };
    arguments.apply_to(&mut clip);
    let mut inference = Inference::new(&model).map_err(Failure::model)?;
    let unusable = |failure: Failure| match &arguments.clip {
        Some(path) => failure.context(format!("cannot use {}", path.display())),
        None => failure,
    };
    // Sketches of the command line are in the clip already.
    let beside = ClipFile::beside(arguments.clip.as_deref().unwrap_or(Path::new("")));
    let motion = clip.motion(&mut inference, beside);
    let motion = motion.map_err(|error| unusable(Failure::input(error)))?;
    let settings = FrameSettings {
        fps: arguments.fps,
        past_s: arguments.past,
    };
    let frames = sample_frames(&motion, settings, &mut inference).map_err(failed)?;
    write(arguments, &model, frames)
}

/// Finds an output that cannot be written before any work is done.
fn require_output(arguments: &AnimateArguments) -> Outcome {
    let out = &arguments.out;
    match arguments.format {
        ClipFormat::Glb => match MeshFormat::of_path(out) {
            Ok(MeshFormat::Glb) => Ok(()),
            _ => Err(Failure::output(anyhow!(
                "cannot write {}: end its name with .glb, or say --format",
                out.display()
            ))),
        },
        ClipFormat::ObjSequence | ClipFormat::PngSequence => {
            require_no_files(out).map_err(Failure::output)
        }
    }
}

/// The clip of a file, and the model that plays it.
fn clip_file(path: &Path, arguments: &AnimateArguments) -> Outcome<(Model, ClipFile)> {
    let unusable = |failure: Failure| failure.context(format!("cannot use {}", path.display()));
    let clip = ClipFile::load(path).map_err(|error| match error {
        ClipError::Io { .. } => Failure::input(error),
        other => unusable(Failure::input(other)),
    })?;
    let model = match &arguments.model {
        Some(path) => inputs::model(Some(path))?,
        None => inputs::embedded_model(&clip.figure).map_err(unusable)?,
    };
    Ok((model, clip))
}

/// The clip of the sketches on the command line, evenly spread, and the model that plays it.
fn clip_of_sketches(arguments: &AnimateArguments) -> Outcome<(Model, ClipFile)> {
    let files = &arguments.sketch;
    if files.len() < 2 {
        let found = files.len();
        return Err(Failure::usage(PathError::TooFewKeys { found }));
    }
    let seconds = arguments.seconds.unwrap_or(1.0);
    let unusable = |file: &PathBuf, failure: Failure| {
        failure.context(format!("cannot use {}", file.display()))
    };
    let bytes = files.iter().map(|file| inputs::bytes(file));
    let bytes = bytes.collect::<Outcome<Vec<_>>>()?;
    let model = match &arguments.model {
        Some(path) => inputs::model(Some(path))?,
        None => inputs::embedded_model_of_sketch(&bytes[0])
            .map_err(|failure| unusable(&files[0], failure))?,
    };
    let figure = model.figure();
    let mut clip = ClipFile::new(&figure.name, MotionSettings::default());
    for (index, (file, bytes)) in files.iter().zip(&bytes).enumerate() {
        let sketch = Sketch::from_json(figure, bytes)
            .map_err(|error| unusable(file, Failure::input(error)))?;
        clip.keys.push(ClipKey {
            time_s: seconds * index as f32 / (files.len() - 1) as f32,
            easing: Easing::Linear,
            pose: ClipPose::of_sketch(figure, &sketch),
        });
    }
    Ok((model, clip))
}

impl AnimateArguments {
    /// What was said on the command line holds, whatever a clip file says.
    fn apply_to(&self, clip: &mut ClipFile) {
        if let Some(between) = self.interpolation {
            clip.interpolation = match between {
                BetweenKeys::Linear => Interpolation::Linear,
                BetweenKeys::Cubic => Interpolation::Cubic,
            };
        }
        if let Some(after) = self.repeat {
            clip.repeat = match after {
                AfterKeys::Once => Repeat::Once,
                AfterKeys::Loop => Repeat::Loop { closing_s: None },
                AfterKeys::PingPong => Repeat::PingPong,
            };
        }
        if let Some(beyond) = self.extrapolation {
            let least_trust = DEFAULT_LEAST_TRUST;
            clip.extrapolation = match beyond {
                BeyondKeys::Bounded => Extrapolation::Bounded { least_trust },
                BeyondKeys::PingPong => Extrapolation::PingPong { least_trust },
                BeyondKeys::Unbounded => Extrapolation::Unbounded,
                BeyondKeys::Hold => Extrapolation::Hold,
            };
        }
        if let Some(switch) = self.grounded {
            clip.grounded = switch == Switch::On;
        }
    }
}

/// Writes the frames, and says what was written.
fn write(arguments: &AnimateArguments, model: &Model, frames: Vec<Frame>) -> Outcome {
    let out = &arguments.out;
    let name = out.file_stem().map(|stem| stem.to_string_lossy());
    let mesh = AnimationMesh::of(model, name.as_deref().unwrap_or(&model.figure().name));
    let count = frames.len();
    match arguments.format {
        ClipFormat::Glb => {
            let report = save_glb_animation(out, &mesh, frames, DEFAULT_TOLERANCE_M);
            println!("{}: {}", out.display(), told(&report.map_err(failed)?));
        }
        ClipFormat::ObjSequence => {
            save_obj_sequence(out, &mesh, frames).map_err(failed)?;
            println!("{}: {count} meshes", out.display());
        }
        ClipFormat::PngSequence => {
            save_png_sequence(out, model, frames)?;
            println!("{}: {count} pictures", out.display());
        }
    }
    Ok(())
}

/// What is in a glTF, in one line.
fn told(report: &AnimationReport) -> String {
    let AnimationReport {
        frame_count,
        target_count,
        duration_s,
        worst_m,
        byte_count,
    } = *report;
    let more = if worst_m > DEFAULT_TOLERANCE_M {
        ": more than asked for, no mesh may have more targets"
    } else {
        ""
    };
    format!(
        "{duration_s:.2} s, {frame_count} frames of {target_count} morph targets within {:.2} mm{more}; {:.1} MB",
        1e3 * worst_m,
        1e-6 * byte_count as f64
    )
}

/// Sorts by exit code why a motion was not written.
fn failed(error: AnimationError) -> Failure {
    match error {
        AnimationError::FrameRate { .. }
        | AnimationError::Past { .. }
        | AnimationError::TooManyFrames { .. } => Failure::usage(error),
        AnimationError::Export(ExportError::Mesh(_)) => Failure::model(error),
        AnimationError::Export(_) => Failure::output(error),
        other => Failure::input(other),
    }
}
