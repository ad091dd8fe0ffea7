//! Starting the editor from a command line: its options, the files they name, and what can be wrong with them.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy_egui::EguiPlugin;
use stick3d_figure::Figure;
use stick3d_model::{Model, ModelError};
use thiserror::Error;

use super::PoseEditorPlugin;
use super::files::{SketchFileError, read_sketch};
use super::session::{EditorFigure, FirstClip, FirstSketch, read_clip};
use super::timeline::clip::ClipFileError;
use super::words::known_figures;
use crate::embedded::EMBEDDED_MODELS;
use crate::launch::{Launch, LaunchError};
use crate::sketch_input::DrawingOrder;
use crate::{Stick3dPlugin, StickModel};

/// What the editor is started with.
#[derive(Clone, Debug, Default)]
pub struct EditorOptions {
    /// The figure to begin with. Without it: that of the sketch, else that of the last model, else the first.
    pub figure: Option<String>,
    /// Model files of figures to choose from besides the embedded ones.
    pub models: Vec<PathBuf>,
    /// A sketch file to begin with.
    pub sketch: Option<PathBuf>,
    /// A clip file to begin with, in the animation mode.
    pub clip: Option<PathBuf>,
    /// When to stand still in the clip, seconds. Without it the clip plays; in a picture it stands at its beginning.
    pub at_s: Option<f32>,
    /// From where to look at the body: turned about the vertical, 0 for the side that is drawn.
    pub yaw_rad: Option<f32>,
    /// In which order strokes are expected.
    pub order: DrawingOrder,
    /// Take a picture of the editor without a window, write it here as PNG, and end.
    pub screenshot: Option<PathBuf>,
    /// Size of the window or of the picture, pixels; 1600 by 900 when `None`.
    pub size_px: Option<UVec2>,
}

/// Why the editor ended.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EditorError {
    /// The sketch to begin with cannot be used.
    #[error(transparent)]
    Sketch(#[from] SketchFileError),
    /// The clip to begin with cannot be used.
    #[error("cannot use the clip {path}: {error}")]
    Clip {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        error: ClipFileError,
    },
    /// A model file cannot be used.
    #[error("cannot use the model {path}: {error}")]
    Model {
        /// Which file; the name of a feature for an embedded model.
        path: PathBuf,
        /// What is wrong with it.
        error: String,
    },
    /// The figure to begin with is not among those to choose from.
    #[error(
        "there is no figure \"{name}\" to draw; {suggestion} Use --model FILE for a figure of your own"
    )]
    UnknownFigure {
        /// As asked for.
        name: String,
        /// What was probably meant, a sentence.
        suggestion: String,
    },
    /// The app did not start, or ended early.
    #[error(transparent)]
    Launch(#[from] LaunchError),
}

impl EditorError {
    /// The exit code of the process: 1 for files and everything else, 2 for a figure that is not there,
    /// 3 without a display, 4 without a graphics adapter.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Sketch(_) | Self::Clip { .. } | Self::Model { .. } => 1,
            Self::UnknownFigure { .. } => 2,
            Self::Launch(error) => error.exit_code(),
        }
    }
}

/// Runs the editor until its window is closed or its picture is taken.
///
/// # Errors
/// [`EditorError`]: one sentence for the user, and an exit code.
pub fn run(options: &EditorOptions) -> Result<(), EditorError> {
    let figures = figures_to_draw(&options.models)?;
    let sketch = match &options.sketch {
        Some(path) => {
            // A figure of one's own comes before an embedded one of the same name.
            let known: Vec<&Figure> = figures.iter().rev().map(EditorFigure::figure).collect();
            let (from_last, sketch) = read_sketch(path, &known)?;
            Some(FirstSketch {
                figure: figures.len() - 1 - from_last,
                sketch,
                file: path.clone(),
            })
        }
        None => None,
    };
    let clip = match &options.clip {
        Some(path) => Some(first_clip(path, options, &figures)?),
        None => None,
    };
    let asked = match &options.figure {
        Some(name) => Some(figure_called(name, &figures)?),
        None => None,
    };
    let own = (!options.models.is_empty()).then(|| figures.len() - 1);
    let first = asked
        .or(clip.as_ref().map(|clip| clip.figure))
        .or(sketch.as_ref().map(|sketch| sketch.figure))
        .or(own)
        .unwrap_or(0);
    let launch = Launch {
        title: "stick3d pose editor".to_owned(),
        size_px: options.size_px.unwrap_or(Launch::default().size_px),
        screenshot: options.screenshot.clone(),
        ..Launch::default()
    };
    launch.run(|app| {
        app.add_plugins((
            EguiPlugin::default(),
            Stick3dPlugin,
            PoseEditorPlugin {
                figures,
                first,
                sketch,
                clip,
                yaw_rad: options.yaw_rad,
                order: options.order,
                is_picture: options.screenshot.is_some(),
            },
        ));
    })?;
    Ok(())
}

/// The clip to begin with. A figure of one's own comes before an embedded one of the same name.
fn first_clip(
    path: &Path,
    options: &EditorOptions,
    figures: &[EditorFigure],
) -> Result<FirstClip, EditorError> {
    let known: Vec<&EditorFigure> = figures.iter().rev().collect();
    let (from_last, scene) = read_clip(path, &known).map_err(|error| EditorError::Clip {
        path: path.to_owned(),
        error,
    })?;
    Ok(FirstClip {
        figure: figures.len() - 1 - from_last,
        scene,
        file: path.to_owned(),
        at_s: options.at_s.or(options.screenshot.as_ref().map(|_| 0.0)),
    })
}

/// The embedded figures, then those of the model files.
fn figures_to_draw(models: &[PathBuf]) -> Result<Vec<EditorFigure>, EditorError> {
    let unusable = |path: &Path, error: &ModelError| EditorError::Model {
        path: path.to_owned(),
        error: error.to_string(),
    };
    let mut figures = Vec::new();
    for embedded in &EMBEDDED_MODELS {
        let model = embedded
            .model()
            .map_err(|error| unusable(Path::new("that is embedded"), error))?;
        figures.push(EditorFigure::new(model.clone()));
    }
    for path in models {
        let model = Model::load(path).map_err(|error| unusable(path, &error))?;
        let mut figure = EditorFigure::new(StickModel::new(model));
        if figures.iter().any(|other| other.label == figure.label)
            && let Some(stem) = path.file_stem()
        {
            figure.label = stem.to_string_lossy().into_owned();
        }
        figures.push(figure);
    }
    Ok(figures)
}

fn figure_called(name: &str, figures: &[EditorFigure]) -> Result<usize, EditorError> {
    figures
        .iter()
        .rposition(|figure| figure.figure().name == name)
        .ok_or_else(|| EditorError::UnknownFigure {
            name: name.to_owned(),
            suggestion: known_figures(name, figures.iter().map(EditorFigure::figure)),
        })
}

#[cfg(test)]
mod tests {
    use stick3d_model::files::write_atomically;

    use super::*;

    #[test]
    fn an_unknown_figure_is_answered_with_the_nearest() {
        let figures = figures_to_draw(&[]).unwrap();
        assert_eq!(figure_called("human", &figures).unwrap(), 0);
        let error = figure_called("humn", &figures).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("mean \"human\"?"), "{error}");
        let error = figure_called("xyz", &figures).unwrap_err().to_string();
        assert!(
            error.contains("human") && error.contains("--model"),
            "{error}"
        );
    }

    #[test]
    fn a_bad_model_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fox.stick3d");
        write_atomically(&path, b"no model").unwrap();
        let error = figures_to_draw(std::slice::from_ref(&path)).err().unwrap();
        assert_eq!(error.exit_code(), 1);
        assert!(error.to_string().contains("fox.stick3d"), "{error}");
    }
}
