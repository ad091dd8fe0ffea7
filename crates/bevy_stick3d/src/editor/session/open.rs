//! Saving and opening sketches and clips.

use std::path::{Path, PathBuf};

use stick3d_figure::{Figure, Sketch, SketchError};
use stick3d_model::latent::ClipFile;

use super::super::files::{read_sketch, write_sketch};
use super::super::timeline::clip::{ClipFileError, clip_of_scene, scene_of_clip};
use super::super::timeline::history::Document;
use super::super::timeline::state::Scene;
use super::super::words::known_figures;
use super::{Choice, Desk, EditorFigure, Files, FirstClip, FirstSketch, Mode};
use crate::sketch_input::{Ink, fit_to_canvas};

/// Whether a file is a clip, by its name.
fn is_clip(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("ron"))
}

/// Reads a clip of one of these figures: which one, and its timeline. Of figures with one name it is the first.
///
/// # Errors
/// [`ClipFileError`].
pub(in super::super) fn read_clip(
    path: &Path,
    figures: &[&EditorFigure],
) -> Result<(usize, Scene), ClipFileError> {
    let clip = ClipFile::load(path)?;
    let known = || figures.iter().map(|figure| figure.figure());
    let Some(at) = known().position(|figure| figure.name == clip.figure) else {
        return Err(ClipFileError::UnknownFigure {
            suggestion: known_figures(&clip.figure, known()),
            name: clip.figure,
        });
    };
    Ok((at, scene_of_clip(&clip, path, figures[at].model.model())?))
}

/// A figure that begins with a sketch.
///
/// # Errors
/// [`SketchError`] when it is of another figure.
pub(super) fn begin_with_sketch(
    choice: &mut Choice,
    first: &FirstSketch,
) -> Result<(), SketchError> {
    let ink = Ink::of_sketch(fitted(choice.figure.figure(), &first.sketch)?);
    let selected = choice.document.selected();
    choice.document.scene_mut().set_ink(selected, ink);
    choice.document.commit();
    choice.files.sketch = first.file.display().to_string();
    Ok(())
}

fn fitted(figure: &Figure, sketch: &Sketch) -> Result<Sketch, SketchError> {
    let fitted = fit_to_canvas(&[sketch.points()]);
    Sketch::new(figure, fitted.into_iter().flatten().collect())
}

/// A figure that begins with a clip.
pub(super) fn begin_with_clip(choice: &mut Choice, first: &FirstClip) {
    choice.document = Document::new(first.scene.clone());
    choice.files.clip = first.file.display().to_string();
    match first.at_s {
        Some(at_s) => choice.player.seek(at_s),
        None => choice.player.start(),
    }
}

impl Desk<'_, '_> {
    fn chosen_file(&self) -> Option<PathBuf> {
        let choice = self.session.choice()?;
        Some(match self.session.file()?.trim() {
            "" => {
                let mut usual = Files::of(choice.figure.figure());
                PathBuf::from(std::mem::take(usual.of_mode(self.session.mode)))
            }
            file => PathBuf::from(file),
        })
    }

    pub(super) fn save(&mut self) {
        let Some(path) = self.chosen_file() else {
            return;
        };
        let saved = match self.session.mode {
            Mode::Pose => self.save_sketch(&path),
            Mode::Animate => self.save_clip(&path),
        };
        let status = &mut self.session.status;
        match saved {
            None => {}
            Some(Ok(())) => status.note(format!("Saved {}", path.display())),
            Some(Err(problem)) => status.problem(problem),
        }
    }

    /// `None` where there is nothing to save.
    fn save_sketch(&mut self, path: &Path) -> Option<Result<(), String>> {
        let drawing = self.drawing()?;
        let Some(sketch) = drawing.sketch() else {
            self.session
                .status
                .note("There is nothing to save until the figure is complete");
            return None;
        };
        let written = write_sketch(path, drawing.figure(), sketch);
        Some(written.map_err(|error| error.to_string()))
    }

    /// `None` where there is nothing to save.
    fn save_clip(&mut self, path: &Path) -> Option<Result<(), String>> {
        let choice = self.session.choice()?;
        let scene = choice.document.scene();
        if !scene.can_move() {
            self.session
                .status
                .note("There is no clip to save until two keys are drawn");
            return None;
        }
        let clip = clip_of_scene(choice.figure.figure(), scene);
        let saved = clip.save(path);
        Some(saved.map_err(|error| format!("the clip was not saved: {error}")))
    }

    pub(super) fn open_chosen(&mut self) {
        if let Some(path) = self.chosen_file() {
            self.open(&path);
        }
    }

    /// Opens a sketch or a clip of any of the figures, and puts that figure on the desk.
    pub(in super::super) fn open(&mut self, path: &Path) {
        self.settle();
        let opened = if is_clip(path) {
            self.open_clip(path)
        } else {
            self.open_sketch(path)
        };
        let status = &mut self.session.status;
        match opened {
            Ok(()) => status.note(format!("Opened {}", path.display())),
            Err(problem) => status.problem(problem),
        }
    }

    /// The figures in the order in which files choose among those with one name: first that which is drawn, then the
    /// one that was added last.
    fn preference(&self) -> Vec<usize> {
        let (active, count) = (self.session.active, self.session.choices.len());
        let others = (0..count).rev().filter(|&index| index != active);
        std::iter::once(active).chain(others).collect()
    }

    fn preferred(&self, order: &[usize]) -> Vec<&EditorFigure> {
        let choices = &self.session.choices;
        order
            .iter()
            .filter_map(|&index| Some(&choices.get(index)?.figure))
            .collect()
    }

    /// Puts a sketch on the canvas of its figure; one that does not fit changes nothing.
    fn open_sketch(&mut self, path: &Path) -> Result<(), String> {
        let order = self.preference();
        let figures: Vec<&Figure> = self
            .preferred(&order)
            .into_iter()
            .map(EditorFigure::figure)
            .collect();
        let (at, sketch) = read_sketch(path, &figures).map_err(|error| error.to_string())?;
        self.choose(order[at]);
        if let Some(mut drawing) = self.drawing_mut() {
            drawing.load(&sketch).map_err(|error| error.to_string())?;
        }
        self.settle();
        if let Some(choice) = self.session.choice_mut() {
            choice.files.sketch = path.display().to_string();
        }
        Ok(())
    }

    /// Puts a clip in place of the timeline of its figure; one that is none changes nothing.
    fn open_clip(&mut self, path: &Path) -> Result<(), String> {
        let order = self.preference();
        let figures = self.preferred(&order);
        let read = read_clip(path, &figures);
        let (at, scene) = read.map_err(|error| error.to_string())?;
        self.choose(order[at]);
        self.switch(Mode::Animate);
        if let Some(choice) = self.session.choice_mut() {
            choice.document.replace(scene);
            choice.player.start();
            choice.files.clip = path.display().to_string();
        }
        self.lay_out(false);
        Ok(())
    }
}
