//! What the editor remembers and does: the figures to choose from, their files, the status line.
//! Knows no user interface.

use std::path::{Path, PathBuf};

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::window::FileDragAndDrop;
use stick3d_figure::{Figure, Sketch};

use super::files::{read_sketch, write_sketch};
use super::status_line::StatusLine;
use super::viewport::EditedFigure;
use super::words;
use crate::figure::StickFigure;
use crate::model_asset::StickModel;
use crate::sketch_input::{CanvasArea, SketchCanvas, SketchDrawing};

/// A figure to choose in the editor.
#[derive(Clone)]
pub struct EditorFigure {
    /// What the switch says.
    pub label: String,
    /// Its model.
    pub model: StickModel,
}

impl EditorFigure {
    /// The figure of a model, called as the figure is.
    pub fn new(model: StickModel) -> Self {
        Self {
            label: words::capitalised(&model.figure().name.replace('_', " ")),
            model,
        }
    }

    /// What is drawn.
    pub fn figure(&self) -> &Figure {
        self.model.figure()
    }
}

/// The sketch that the editor begins with.
#[derive(Clone, Debug)]
pub struct FirstSketch {
    /// The index of its figure.
    pub figure: usize,
    /// The sketch.
    pub sketch: Sketch,
    /// Where it is from, and where it is saved to.
    pub file: PathBuf,
}

/// What the user can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    /// Another figure.
    Choose(usize),
    Undo,
    Redo,
    Mirror,
    Clear,
    Save,
    Open,
}

/// One figure with everything that is its own: the drawing with its history, the body, the file.
pub(super) struct Choice {
    /// What it is.
    pub(super) figure: EditorFigure,
    /// Where Save and Open go.
    file: String,
    /// The entity of its canvas.
    canvas: Entity,
    /// The entity of its body.
    body: Entity,
}

/// What the editor remembers.
#[derive(Resource, Default)]
pub(super) struct Session {
    choices: Vec<Choice>,
    active: usize,
    /// What was done last.
    pub(super) status: StatusLine,
    /// Whether a file is being dragged over the window.
    pub(super) is_drop_hovering: bool,
}

impl Session {
    /// The figures to choose from.
    pub(super) fn choices(&self) -> &[Choice] {
        &self.choices
    }

    /// The index of the one that is drawn.
    pub(super) fn active(&self) -> usize {
        self.active
    }

    /// The one that is drawn.
    fn choice(&self) -> Option<&Choice> {
        self.choices.get(self.active)
    }

    /// The entity of the body that is shown.
    pub(super) fn body(&self) -> Option<Entity> {
        self.choice().map(|choice| choice.body)
    }

    /// Where Save and Open go.
    pub(super) fn file(&self) -> Option<&str> {
        self.choice().map(|choice| &*choice.file)
    }

    /// Sets where Save and Open go.
    pub(super) fn set_file(&mut self, file: String) {
        if let Some(choice) = self.choices.get_mut(self.active) {
            choice.file = file;
        }
    }
}

/// What the session begins with.
#[derive(Resource, Clone)]
pub(super) struct Opening {
    pub(super) figures: Vec<EditorFigure>,
    pub(super) first: usize,
    pub(super) sketch: Option<FirstSketch>,
    pub(super) yaw_rad: Option<f32>,
}

/// The part of the editor that works without any screen.
pub(super) struct SessionPlugin(pub(super) Opening);

impl Plugin for SessionPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.0.clone())
            .init_resource::<Session>()
            .add_message::<FileDragAndDrop>()
            .add_systems(Startup, spawn_choices)
            .add_systems(Update, take_dropped_files);
    }
}

fn spawn_choices(
    mut commands: Commands,
    opening: Res<Opening>,
    mut session: ResMut<Session>,
    mut models: ResMut<Assets<StickModel>>,
) {
    session.active = opening.first.min(opening.figures.len().saturating_sub(1));
    for (index, figure) in opening.figures.iter().enumerate() {
        let model = &figure.model;
        let is_shown = index == session.active;
        let edited = EditedFigure::new(
            model.model().metadata().normalisation.extent_m,
            opening.yaw_rad,
            is_shown,
        );
        let body = commands
            .spawn((
                edited.scale(),
                edited,
                StickFigure(models.add(model.clone())),
                Visibility::Hidden,
            ))
            .id();
        let mut drawing = SketchDrawing::new(model.figure().clone());
        let mut file = default_file(figure.figure());
        if let Some(first) = opening.sketch.as_ref().filter(|s| s.figure == index) {
            match drawing.load(&first.sketch) {
                Ok(()) => file = first.file.display().to_string(),
                Err(error) => session.status.problem(error.to_string()),
            }
        }
        let mut canvas = SketchCanvas::new(CanvasArea::rect(Rect::default()), body).with_preview();
        canvas.enabled = is_shown;
        let canvas = commands.spawn((canvas, drawing)).id();
        session.choices.push(Choice {
            figure: figure.clone(),
            file,
            canvas,
            body,
        });
    }
    commands.remove_resource::<Opening>();
}

/// Where a sketch of a figure is saved when nothing else is said.
fn default_file(figure: &Figure) -> String {
    format!("{}_sketch.json", figure.name)
}

/// The session with its drawings: what carries out what the user asks.
#[derive(SystemParam)]
pub(super) struct Desk<'w, 's> {
    /// What the editor remembers.
    pub(super) session: ResMut<'w, Session>,
    canvases: Query<'w, 's, (&'static mut SketchCanvas, &'static mut SketchDrawing)>,
    figures: Query<'w, 's, &'static mut EditedFigure>,
}

impl Desk<'_, '_> {
    /// What is drawn on.
    pub(super) fn canvas_mut(&mut self) -> Option<Mut<'_, SketchCanvas>> {
        let canvas = self.session.choice()?.canvas;
        self.canvases.get_mut(canvas).ok().map(|(canvas, _)| canvas)
    }

    /// What is drawn.
    pub(super) fn drawing(&self) -> Option<&SketchDrawing> {
        let canvas = self.session.choice()?.canvas;
        self.canvases.get(canvas).ok().map(|(_, drawing)| drawing)
    }

    fn drawing_mut(&mut self) -> Option<Mut<'_, SketchDrawing>> {
        let canvas = self.session.choice()?.canvas;
        self.canvases
            .get_mut(canvas)
            .ok()
            .map(|(_, drawing)| drawing)
    }

    /// The body that is shown, to look at it from elsewhere.
    pub(super) fn edited_mut(&mut self) -> Option<Mut<'_, EditedFigure>> {
        self.figures.get_mut(self.session.body()?).ok()
    }

    /// Does what the user asks.
    pub(super) fn act(&mut self, action: Action) {
        match action {
            Action::Choose(index) => self.choose(index),
            Action::Save => return self.save(),
            Action::Open => {
                if let Some(path) = self.chosen_file() {
                    self.open(&path);
                }
                return;
            }
            Action::Undo | Action::Redo | Action::Clear | Action::Mirror => {
                let Some(mut drawing) = self.drawing_mut() else {
                    return;
                };
                match action {
                    Action::Undo => drawing.undo(),
                    Action::Redo => drawing.redo(),
                    Action::Mirror if !drawing.mirror() => {
                        self.session.status.note("There is nothing to mirror yet");
                        return;
                    }
                    Action::Mirror => {}
                    _ => drawing.clear(),
                }
            }
        }
        self.session.status.clear();
    }

    /// Puts another figure on the desk; the one before keeps what was drawn.
    fn choose(&mut self, index: usize) {
        if index == self.session.active || index >= self.session.choices.len() {
            return;
        }
        self.session.active = index;
        for (other, choice) in self.session.choices.iter().enumerate() {
            let is_shown = other == index;
            if let Ok((mut canvas, mut drawing)) = self.canvases.get_mut(choice.canvas)
                && canvas.enabled != is_shown
            {
                canvas.enabled = is_shown;
                // A pen that is down stays with the figure it drew.
                drawing.cancel();
                drawing.leave();
            }
            if let Ok(mut edited) = self.figures.get_mut(choice.body) {
                edited.is_shown = is_shown;
            }
        }
    }

    fn chosen_file(&self) -> Option<PathBuf> {
        let choice = self.session.choice()?;
        Some(match choice.file.trim() {
            "" => PathBuf::from(default_file(choice.figure.figure())),
            file => PathBuf::from(file),
        })
    }

    fn save(&mut self) {
        let (Some(path), Some(drawing)) = (self.chosen_file(), self.drawing()) else {
            return;
        };
        let Some(sketch) = drawing.sketch() else {
            self.session
                .status
                .note("There is nothing to save until the figure is complete");
            return;
        };
        match write_sketch(&path, drawing.figure(), sketch) {
            Ok(()) => self
                .session
                .status
                .note(format!("Saved {}", path.display())),
            Err(error) => self.session.status.problem(error.to_string()),
        }
    }

    /// Opens a sketch of any of the figures, and puts that figure on the desk.
    pub(super) fn open(&mut self, path: &Path) {
        // Of figures with one name that which is drawn comes first, then the one that was added last.
        let (active, count) = (self.session.active, self.session.choices.len());
        let others = (0..count).rev().filter(|&index| index != active);
        let order: Vec<usize> = std::iter::once(active).chain(others).collect();
        let figures: Vec<&Figure> = order
            .iter()
            .filter_map(|&index| Some(self.session.choices.get(index)?.figure.figure()))
            .collect();
        let opened = read_sketch(path, &figures)
            .map_err(|error| error.to_string())
            .and_then(|(at, sketch)| self.put(order[at], &sketch));
        match opened {
            Ok(()) => {
                self.session.set_file(path.display().to_string());
                let note = format!("Opened {}", path.display());
                self.session.status.note(note);
            }
            Err(problem) => self.session.status.problem(problem),
        }
    }

    /// Puts a sketch on the canvas of a figure, and that on the desk; a sketch that does not fit changes nothing.
    fn put(&mut self, index: usize, sketch: &Sketch) -> Result<(), String> {
        let choice = self.session.choices.get(index);
        if let Some((_, mut drawing)) =
            choice.and_then(|choice| self.canvases.get_mut(choice.canvas).ok())
        {
            drawing.load(sketch).map_err(|error| error.to_string())?;
            self.choose(index);
        }
        Ok(())
    }
}

fn take_dropped_files(mut drops: MessageReader<FileDragAndDrop>, mut desk: Desk) {
    for drop in drops.read() {
        desk.session.is_drop_hovering = matches!(drop, FileDragAndDrop::HoveredFile { .. });
        if let FileDragAndDrop::DroppedFile { path_buf, .. } = drop {
            desk.open(path_buf);
        }
    }
}

#[cfg(test)]
mod tests {
    use bevy::asset::AssetPlugin;
    use bevy::ecs::system::RunSystemOnce;
    use stick3d_model::files::write_atomically;

    use super::*;
    use crate::{EMBEDDED_MODELS, Stick3dPlugin, StickSketch};

    /// The editor without a screen, with all embedded figures.
    fn app(sketch: Option<FirstSketch>) -> App {
        let figures = EMBEDDED_MODELS
            .iter()
            .map(|embedded| EditorFigure::new(embedded.model().unwrap().clone()))
            .collect();
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            AssetPlugin::default(),
            TransformPlugin,
            Stick3dPlugin,
            SessionPlugin(Opening {
                figures,
                first: 0,
                sketch,
                yaw_rad: None,
            }),
        ));
        app.finish();
        app.cleanup();
        app.update();
        app
    }

    /// Does something at the desk, and lets a frame pass.
    fn at_desk<T: Send + Sync + 'static>(
        app: &mut App,
        work: impl Fn(&mut Desk) -> T + Send + Sync + 'static,
    ) -> T {
        let done = app
            .world_mut()
            .run_system_once(move |mut desk: Desk| work(&mut desk))
            .unwrap();
        app.update();
        done
    }

    fn drop_file(app: &mut App, path: &Path) {
        app.world_mut().write_message(FileDragAndDrop::DroppedFile {
            window: Entity::PLACEHOLDER,
            path_buf: path.to_owned(),
        });
        app.update();
    }

    fn active(app: &App) -> &Choice {
        app.world().resource::<Session>().choice().unwrap()
    }

    fn shown(app: &App) -> Option<StickSketch> {
        app.world().get::<StickSketch>(active(app).body).cloned()
    }

    fn sketch_file(folder: &Path, figure: &Figure, stretch: f32) -> PathBuf {
        let mut points = figure.template.clone();
        points[0].y += stretch;
        let sketch = Sketch::new(figure, points).unwrap();
        let path = folder.join(format!("{}.json", figure.name));
        write_sketch(&path, figure, &sketch).unwrap();
        path
    }

    #[test]
    fn a_dropped_sketch_brings_its_figure() {
        let folder = tempfile::tempdir().unwrap();
        let mut app = app(None);
        assert_eq!(shown(&app), None);
        let man = sketch_file(folder.path(), Figure::human(), 0.1);
        drop_file(&mut app, &man);
        assert_eq!(active(&app).figure.figure().name, "human");
        let of_man = shown(&app).unwrap();

        let horse = sketch_file(folder.path(), Figure::horse(), 0.1);
        app.world_mut().write_message(FileDragAndDrop::HoveredFile {
            window: Entity::PLACEHOLDER,
            path_buf: horse.clone(),
        });
        app.update();
        assert!(app.world().resource::<Session>().is_drop_hovering);
        drop_file(&mut app, &horse);
        let session = app.world().resource::<Session>();
        assert!(!session.is_drop_hovering);
        assert_eq!(active(&app).figure.figure().name, "horse");
        assert_eq!(active(&app).file, horse.display().to_string());
        let (said, is_problem) = session.status.shown().unwrap();
        assert!(said.starts_with("Opened") && !is_problem, "{said}");
        assert_eq!(shown(&app).unwrap().points.len(), 12);

        at_desk(&mut app, |desk| desk.act(Action::Choose(0)));
        assert_eq!(shown(&app).unwrap(), of_man);
        assert_eq!(active(&app).file, man.display().to_string());
    }

    #[test]
    fn a_dropped_file_that_is_no_sketch_is_named_and_nothing_is_lost() {
        let folder = tempfile::tempdir().unwrap();
        let mut app = app(None);
        drop_file(&mut app, &sketch_file(folder.path(), Figure::human(), 0.1));
        let before = (shown(&app).unwrap(), active(&app).file.clone());
        let bad = [
            ("text.json", "this is no sketch"),
            ("dragon.json", r#"{"figure": "dragon", "joints": {}}"#),
            (
                "short.json",
                r#"{"figure": "horse", "joints": {"hip": [0, 1]}}"#,
            ),
            ("nan.json", r#"{"figure": "human", "path": [[NaN, 0]]}"#),
        ];
        for (name, text) in bad {
            let path = folder.path().join(name);
            write_atomically(&path, text.as_bytes()).unwrap();
            drop_file(&mut app, &path);
            let status = app.world().resource::<Session>().status.clone();
            let (said, is_problem) = status.shown().unwrap();
            assert!(is_problem && said.contains(name), "{said}");
            assert_eq!((shown(&app).unwrap(), active(&app).file.clone()), before);
            assert_eq!(active(&app).figure.figure().name, "human");
        }
        drop_file(&mut app, &folder.path().join("missing.json"));
        let status = app.world().resource::<Session>().status.clone();
        assert!(status.shown().unwrap().0.contains("missing.json"));
        at_desk(&mut app, |desk| desk.act(Action::Undo));
        assert_eq!(shown(&app), None, "the one step there was can be undone");
    }

    #[test]
    fn each_figure_keeps_its_strokes_its_history_and_its_view() {
        let mut app = app(None);
        at_desk(&mut app, |desk| {
            desk.edited_mut().unwrap().orbit.yaw_rad = 1.0;
            let mut drawing = desk.drawing_mut().unwrap();
            drawing.press(Vec2::new(0.0, 300.0), 0.0);
            drawing.move_to(Vec2::new(0.0, 200.0), 0.1);
            drawing.release();
            drawing.press(Vec2::new(0.0, 200.0), 0.2);
        });
        at_desk(&mut app, |desk| {
            desk.act(Action::Choose(1));
            assert!(desk.drawing().unwrap().strokes().is_empty());
            assert!(!desk.drawing().unwrap().can_undo());
            assert!(desk.canvas_mut().unwrap().enabled);
            assert_ne!(desk.edited_mut().unwrap().orbit.yaw_rad, 1.0);
            desk.act(Action::Choose(99));
        });
        assert_eq!(active(&app).figure.figure().name, "horse");
        at_desk(&mut app, |desk| {
            desk.act(Action::Choose(0));
            let drawing = desk.drawing().unwrap();
            assert_eq!(drawing.strokes().len(), 1);
            assert!(drawing.can_undo() && drawing.pen_stroke().is_none());
            assert_eq!(desk.edited_mut().unwrap().orbit.yaw_rad, 1.0);
        });
        let enabled = app
            .world_mut()
            .query::<&SketchCanvas>()
            .iter(app.world())
            .filter(|canvas| canvas.enabled)
            .count();
        assert_eq!(enabled, 1);
    }

    #[test]
    fn saving_goes_to_a_file_of_the_figure() {
        let folder = tempfile::tempdir().unwrap();
        let first = FirstSketch {
            figure: 1,
            sketch: Sketch::template(Figure::horse()),
            file: folder.path().join("mine.json"),
        };
        let mut app = app(Some(first.clone()));
        assert_eq!(active(&app).file, "human_sketch.json");
        at_desk(&mut app, |desk| {
            desk.act(Action::Choose(1));
            desk.act(Action::Save);
        });
        let (index, saved) = read_sketch(&first.file, &[Figure::human(), Figure::horse()]).unwrap();
        assert_eq!((index, saved.points().len()), (1, 12));
    }
}
