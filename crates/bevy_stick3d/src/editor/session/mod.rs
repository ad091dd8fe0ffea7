//! What the editor remembers: the figures to choose from, what is drawn of each, their files, the status line.
//! Knows no user interface.

mod bodies;
mod desk;
mod export;
mod open;
mod settle;

use std::path::PathBuf;

use bevy::prelude::*;
use bevy::window::FileDragAndDrop;
use stick3d_figure::{Figure, Sketch};
use stick3d_model::latent::{Easing, Interpolation, Repeat};

pub(super) use self::desk::Desk;
use self::export::{Export, finish_export};
pub(super) use self::open::read_clip;
use super::status_line::StatusLine;
use super::timeline::history::Document;
use super::timeline::motion::Performance;
use super::timeline::perform::{Ghost, perform};
use super::timeline::player::Player;
use super::timeline::state::{KeyId, Scene};
use super::viewport::EditedFigure;
use super::words;
use crate::figure::StickFigure;
use crate::model_asset::StickModel;
use crate::schedule::Stick3dSystems;
use crate::sketch_input::{CanvasArea, DrawingOrder, SketchCanvas, SketchDrawing};

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

/// The clip that the editor begins with, in its animation mode.
#[derive(Clone, Debug)]
pub struct FirstClip {
    /// The index of its figure.
    pub figure: usize,
    /// Its keys.
    pub(super) scene: Scene,
    /// Where it is from, and where it is saved to.
    pub file: PathBuf,
    /// When to stand still in it, seconds; it plays when `None`.
    pub at_s: Option<f32>,
}

/// What is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mode {
    /// One body from one drawing.
    #[default]
    Pose,
    /// A motion from several.
    Animate,
}

/// What the user can ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Action {
    /// Another figure.
    Choose(usize),
    /// Poses or motions.
    Switch(Mode),
    Undo,
    Redo,
    Mirror,
    /// Exchanges the left and the right limb of a pair.
    SwapSides,
    /// Takes an unfinished drawing for finished.
    Finish,
    /// In any order, or along the path.
    Order,
    /// Another of the bodies that the drawing may mean.
    Alternative(usize),
    NextAlternative,
    LastAlternative,
    /// Turns the depth of the limb of a joint round.
    Flip(usize),
    Clear,
    Save,
    Open,
    /// Plays or pauses.
    Play,
    /// To a time of the motion, seconds.
    Seek(f32),
    /// So much on, seconds.
    Step(f32),
    /// The next speed.
    Speed,
    /// Looks at a key.
    Select(KeyId),
    /// Drags a key to a time, seconds; the drag ends with [`Action::Drop`].
    Retime(KeyId, f32),
    /// Lets go of a key.
    Drop,
    /// Another key to draw, after the last.
    AddKey,
    /// What the body shows now becomes a key.
    KeyHere,
    /// The selected key goes.
    RemoveKey,
    /// How time passes from a key to the next.
    Ease(KeyId, Easing),
    /// What is between the keys.
    Interpolate(Interpolation),
    /// What comes after the last key.
    Repeat(Repeat),
    /// Shows or hides the bodies of the neighbouring keys.
    Ghosts,
    /// The motion as a file for other programs.
    Export,
}

/// A canvas, and the key that is drawn on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    /// The entity of the canvas.
    pub(super) canvas: Entity,
    /// `None` while it is not used.
    pub(super) key: Option<KeyId>,
}

/// Where Save and Open go.
#[derive(Clone, Debug)]
struct Files {
    sketch: String,
    clip: String,
}

impl Files {
    /// When nothing else is said.
    fn of(figure: &Figure) -> Self {
        Self {
            sketch: format!("{}_sketch.json", figure.name),
            clip: format!("{}.clip.ron", figure.name),
        }
    }

    fn of_mode(&mut self, mode: Mode) -> &mut String {
        match mode {
            Mode::Pose => &mut self.sketch,
            Mode::Animate => &mut self.clip,
        }
    }
}

/// One figure with everything that is its own: the drawings with their history, the motion, the bodies, the files.
pub(super) struct Choice {
    /// What it is.
    pub(super) figure: EditorFigure,
    files: Files,
    /// A canvas for a pose; two, from and to, for a motion.
    pub(super) slots: [Slot; 2],
    /// The entity of its body.
    pub(super) body: Entity,
    /// The bodies of the keys before and after.
    pub(super) ghosts: [Entity; 2],
    /// What was drawn.
    pub(super) document: Document,
    /// When it is.
    pub(super) player: Player,
    /// What is made of what was drawn.
    pub(super) performance: Performance,
    /// How often its body was chosen, as far as the document knows.
    body_choices: u64,
    /// A joint is being dragged.
    is_joint_in_hand: bool,
    /// A key is being dragged in time.
    is_key_in_hand: bool,
}

impl Choice {
    /// Whether what is drawn is about to change further.
    pub(super) fn is_in_hand(&self) -> bool {
        self.is_joint_in_hand || self.is_key_in_hand
    }

    /// The canvas that shows the selected key.
    pub(super) fn selected_canvas(&self) -> Option<Entity> {
        let selected = Some(self.document.selected());
        let slot = self.slots.iter().find(|slot| slot.key == selected);
        slot.map(|slot| slot.canvas)
    }
}

/// What the editor remembers.
#[derive(Resource, Default)]
pub(super) struct Session {
    choices: Vec<Choice>,
    active: usize,
    mode: Mode,
    /// In which order strokes are expected.
    order: DrawingOrder,
    /// Whether the bodies of the neighbouring keys are shown.
    pub(super) shows_ghosts: bool,
    /// A motion that is being written.
    export: Option<Export>,
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

    /// The same, to let time pass.
    pub(super) fn choices_mut(&mut self) -> &mut [Choice] {
        &mut self.choices
    }

    /// The index of the one that is drawn.
    pub(super) fn active(&self) -> usize {
        self.active
    }

    /// What is made.
    pub(super) fn mode(&self) -> Mode {
        self.mode
    }

    /// In which order strokes are expected.
    pub(super) fn order(&self) -> DrawingOrder {
        self.order
    }

    /// The one that is drawn.
    pub(super) fn choice(&self) -> Option<&Choice> {
        self.choices.get(self.active)
    }

    fn choice_mut(&mut self) -> Option<&mut Choice> {
        self.choices.get_mut(self.active)
    }

    /// The entity of the body that is shown.
    pub(super) fn body(&self) -> Option<Entity> {
        self.choice().map(|choice| choice.body)
    }

    /// Where Save and Open go.
    pub(super) fn file(&self) -> Option<&str> {
        let files = &self.choice()?.files;
        Some(match self.mode {
            Mode::Pose => &files.sketch,
            Mode::Animate => &files.clip,
        })
    }

    /// Sets where Save and Open go.
    pub(super) fn set_file(&mut self, file: String) {
        let mode = self.mode;
        if let Some(choice) = self.choice_mut() {
            *choice.files.of_mode(mode) = file;
        }
    }
}

/// What the session begins with.
#[derive(Resource, Clone)]
pub(super) struct Opening {
    pub(super) figures: Vec<EditorFigure>,
    pub(super) first: usize,
    pub(super) sketch: Option<FirstSketch>,
    pub(super) clip: Option<FirstClip>,
    pub(super) yaw_rad: Option<f32>,
    pub(super) order: DrawingOrder,
}

/// What pens did becomes part of the documents.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct SettleDrawings;

/// The part of the editor that works without any screen.
pub(super) struct SessionPlugin(pub(super) Opening);

impl Plugin for SessionPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.0.clone())
            .init_resource::<Session>()
            .add_message::<FileDragAndDrop>()
            .add_systems(Startup, (spawn_choices, lay_out).chain())
            .add_systems(Update, (take_dropped_files, finish_export))
            .add_systems(
                PostUpdate,
                (
                    settle_drawings
                        .in_set(SettleDrawings)
                        .before(Stick3dSystems::Tell),
                    (bodies::is_flip_asked.pipe(bodies::settle_bodies), perform)
                        .chain()
                        .after(Stick3dSystems::Encode)
                        .before(Stick3dSystems::Decode),
                ),
            );
    }
}

fn spawn_choices(
    mut commands: Commands,
    opening: Res<Opening>,
    mut session: ResMut<Session>,
    mut models: ResMut<Assets<StickModel>>,
) {
    session.active = opening.first.min(opening.figures.len().saturating_sub(1));
    session.shows_ghosts = true;
    session.order = opening.order;
    for (index, figure) in opening.figures.iter().enumerate() {
        let model = models.add(figure.model.clone());
        let edited = EditedFigure::new(
            figure.model.model().metadata().normalisation.extent_m,
            opening.yaw_rad,
            index == session.active,
        );
        let scale = edited.scale();
        let ghosts = [Ghost::Before, Ghost::After].map(|ghost| {
            let body = (ghost, scale, StickFigure(model.clone()), Visibility::Hidden);
            commands.spawn(body).id()
        });
        let body = (scale, edited, StickFigure(model), Visibility::Hidden);
        let body = commands.spawn(body).id();
        let slots = [(); 2].map(|()| {
            let mut canvas =
                SketchCanvas::new(CanvasArea::rect(Rect::default()), body).with_preview();
            canvas.enabled = false;
            canvas.order = opening.order;
            let drawing = SketchDrawing::new(figure.model.figure().clone());
            Slot {
                canvas: commands.spawn((canvas, drawing)).id(),
                key: None,
            }
        });
        let mut choice = Choice {
            files: Files::of(figure.figure()),
            figure: figure.clone(),
            slots,
            body,
            ghosts,
            document: Document::default(),
            player: Player::default(),
            performance: Performance::default(),
            body_choices: 0,
            is_joint_in_hand: false,
            is_key_in_hand: false,
        };
        if let Some(first) = opening.sketch.as_ref().filter(|s| s.figure == index)
            && let Err(error) = open::begin_with_sketch(&mut choice, first)
        {
            session.status.problem(error.to_string());
        }
        if let Some(first) = opening.clip.as_ref().filter(|clip| clip.figure == index) {
            open::begin_with_clip(&mut choice, first);
            session.mode = Mode::Animate;
        }
        session.choices.push(choice);
    }
    commands.remove_resource::<Opening>();
}

fn lay_out(mut desk: Desk) {
    desk.lay_out(true);
}

fn settle_drawings(mut desk: Desk) {
    desk.settle();
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
mod tests;
