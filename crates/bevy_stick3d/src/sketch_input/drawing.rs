//! A drawing in the making: strokes, the joints they show, then joints to drag. Knows no pointer and no screen.

use std::collections::BTreeSet;
use std::sync::Arc;

use bevy::prelude::*;
use stick3d_figure::edit::{
    History, limb_pair, mirrored_in_place, nearest_bone, swap_pair, swap_pair_in,
};
use stick3d_figure::{
    Figure, FreeReading, Pen, Progress, Sketch, SketchError, Stroke, progress, read_freely,
};

use super::guide::{fitted, guide, is_enough, usual_scale};
use super::pen::PenState;

/// How near to a joint the pen takes hold of it, canvas units.
pub const GRAB_RADIUS: f32 = 28.0;
/// So many steps can be undone.
const MAX_UNDO: usize = 200;

/// What happened to a drawing since it was last asked.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
pub enum DrawingChange {
    /// A stroke was added; its positions in canvas units.
    StrokeFinished(Vec<Vec2>),
    /// The last stroke was taken back.
    StrokeUndone,
    /// All joints have their place, in canvas units.
    Completed(Vec<Vec2>),
    /// The joints are others than before.
    Redrawn,
    /// A limb of the finished sketch was clicked: its last joint.
    LimbClicked(usize),
}

/// What is on a canvas, in canvas units: what undo brings back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ink {
    /// The finished strokes.
    pub strokes: Vec<Stroke>,
    /// Once all joints have their place.
    pub sketch: Option<Sketch>,
    /// The joints of the sketch that are pinned.
    pub pins: BTreeSet<usize>,
    /// The pairs of limbs that are exchanged, compared with how the strokes are read: the least joint of each.
    pub exchanged: BTreeSet<usize>,
}

impl Ink {
    /// A whole sketch, from elsewhere than from strokes.
    pub fn of_sketch(sketch: Sketch) -> Self {
        Self {
            sketch: Some(sketch),
            ..Self::default()
        }
    }
}

/// In which order strokes are expected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Debug, Default, PartialEq, Hash, Clone)]
pub enum DrawingOrder {
    /// In whatever order, direction and pieces; those along the figure's sketch path are read as well as ever. The
    /// limbs' sides follow a rule (the man faces the viewer; see [`recognize_any`](stick3d_figure::recognize_any)),
    /// and a pair can be exchanged.
    #[default]
    Any,
    /// Along the figure's sketch path, which says which limb is which.
    Guided,
}

/// What was drawn on a canvas, in canvas units with y up. Everything can be undone.
///
/// Written by the pointer (see [`SketchCanvas`](super::SketchCanvas)), and by calling its methods.
#[derive(Component, Clone, Debug, Reflect)]
#[reflect(opaque, Component, Debug, Clone)]
pub struct SketchDrawing {
    pub(super) figure: Arc<Figure>,
    order: DrawingOrder,
    pub(super) history: History<Ink>,
    /// What is shown: the history's present, but for a joint in hand.
    pub(super) ink: Ink,
    /// What the strokes were read as.
    pub(super) reading: FreeReading,
    /// The progress with the stroke that is being drawn, once it was read.
    pub(super) live: Option<Progress>,
    pub(super) pen: PenState,
    pub(super) hovered: Option<usize>,
    /// A joint of the limb that the pointer was over last.
    limb: Option<usize>,
    /// Whether dragged joints move alone.
    pub(super) is_free_drag: bool,
    /// Per bone how long it was before it was foreshortened by dragging; empty where none was.
    pub(super) longest: Vec<f32>,
    pub(super) changes: Vec<DrawingChange>,
}

impl Default for SketchDrawing {
    /// An empty drawing of the man, until [`SketchDrawing::follow`] says otherwise.
    fn default() -> Self {
        Self::new(Figure::human().clone())
    }
}

impl SketchDrawing {
    /// An empty drawing of a figure.
    pub fn new(figure: impl Into<Arc<Figure>>) -> Self {
        let figure = figure.into();
        Self {
            reading: along_path(&figure, &[]),
            figure,
            order: DrawingOrder::default(),
            history: History::new(Ink::default(), MAX_UNDO),
            ink: Ink::default(),
            live: None,
            pen: PenState::Idle,
            hovered: None,
            limb: None,
            is_free_drag: false,
            longest: Vec::new(),
            changes: Vec::new(),
        }
    }

    /// What is drawn.
    pub fn figure(&self) -> &Figure {
        &self.figure
    }

    /// The finished strokes.
    pub fn strokes(&self) -> &[Stroke] {
        &self.ink.strokes
    }

    /// What is on the canvas, a joint in hand where it is now.
    pub fn ink(&self) -> &Ink {
        &self.ink
    }

    /// In which order strokes are expected.
    pub fn order(&self) -> DrawingOrder {
        self.order
    }

    /// Sets in which order strokes are expected. What is drawn already is read anew.
    pub fn set_order(&mut self, order: DrawingOrder) {
        if self.order == order {
            return;
        }
        self.order = order;
        if self.ink.sketch.is_none() && !self.ink.strokes.is_empty() {
            self.show(self.ink.clone());
        }
    }

    /// Whether the strokes so far follow the figure's sketch path, as far as can be told.
    pub fn is_along_path(&self) -> bool {
        self.reading.along_path
    }

    /// The joints that are pinned, in their order.
    pub fn pinned(&self) -> impl Iterator<Item = usize> + '_ {
        self.ink.pins.iter().copied()
    }

    /// Per joint whether it is pinned: it stays where it is when others are dragged, and the body has it there.
    pub fn pins(&self) -> Vec<bool> {
        let joints = 0..self.figure.joint_count();
        joints.map(|joint| self.ink.pins.contains(&joint)).collect()
    }

    /// Whether dragged joints move alone, their bones becoming as long as need be.
    pub fn is_free_drag(&self) -> bool {
        self.is_free_drag
    }

    /// The stroke that is being drawn.
    pub fn pen_stroke(&self) -> Option<&Stroke> {
        match &self.pen {
            PenState::Drawing(stroke) => Some(stroke),
            _ => None,
        }
    }

    /// Where the joints are as far as they are known, in the order of the figure's joints.
    pub fn joints(&self) -> &[Option<Vec2>] {
        &self.reading.progress.placed
    }

    /// How far the drawing has come, the stroke that is being drawn included.
    pub fn live_progress(&self) -> &Progress {
        self.live.as_ref().unwrap_or(&self.reading.progress)
    }

    /// The sketch, once every joint has its place.
    pub fn sketch(&self) -> Option<&Sketch> {
        self.ink.sketch.as_ref()
    }

    /// The unfinished sketch with its missing limbs guessed, once the middle of the body is drawn.
    pub fn guess(&self) -> Option<Vec<Vec2>> {
        let is_known = self.reading.is_sure && is_enough(&self.figure, self.joints());
        is_known.then(|| guide(&self.figure, self.joints()))
    }

    /// Where all joints should come to be: the known ones where they are, the others as the template has them.
    pub fn guide(&self) -> Vec<Vec2> {
        guide(&self.figure, &self.live_progress().placed)
    }

    /// The next joint to draw that has no place yet, with the joint from which its bone comes.
    pub fn next_bone(&self) -> Option<(Option<usize>, usize)> {
        let placed = &self.live_progress().placed;
        let path = &self.figure.path;
        let index = path
            .iter()
            .position(|&joint| placed.get(joint).is_some_and(Option::is_none))?;
        Some((index.checked_sub(1).map(|before| path[before]), path[index]))
    }

    /// The joint under the pointer, once joints can be dragged.
    pub fn hovered(&self) -> Option<usize> {
        self.hovered
    }

    /// The joint that is being dragged.
    pub fn dragged(&self) -> Option<usize> {
        match &self.pen {
            PenState::Dragging(held) => Some(held.joint()),
            _ => None,
        }
    }

    /// Whether there is something to undo.
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Whether there is something to redo.
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// What happened since this was last called.
    pub fn take_changes(&mut self) -> Vec<DrawingChange> {
        std::mem::take(&mut self.changes)
    }
}

/// Limbs and pins.
impl SketchDrawing {
    /// Remembers the limb at a place, if there is one.
    pub(super) fn look_at(&mut self, at: Vec2) {
        if self.ink == Ink::default() {
            return;
        }
        let points = self.guide();
        let bone = nearest_bone(&self.figure, &points, at, GRAB_RADIUS);
        let joints = bone.map_or(vec![], |bone| self.figure.bones[bone].to_vec());
        let mut near = self.hovered.into_iter().chain(joints);
        if let Some(joint) = near.find(|&joint| limb_pair(&self.figure, joint).is_some()) {
            self.limb = Some(joint);
        }
    }

    /// A joint of the limb that the pointer was over last.
    pub fn limb(&self) -> Option<usize> {
        self.limb
    }

    /// Exchanges the left and the right limb of the pair that the pointer was over last. Says whether there was one.
    pub fn swap_sides(&mut self) -> bool {
        let Some(joint) = self.limb.filter(|_| self.ink != Ink::default()) else {
            return false;
        };
        let Some(pair) = limb_pair(&self.figure, joint) else {
            return false;
        };
        let mut ink = self.ink.clone();
        let least = pair.iter().flatten().copied().min().unwrap_or(joint);
        if !ink.exchanged.remove(&least) {
            ink.exchanged.insert(least);
        }
        if let Some(sketch) = &mut ink.sketch {
            swap_pair(&self.figure, sketch, joint);
            let mut pins = self.pins();
            swap_pair_in(&self.figure, &mut pins, joint);
            ink.pins = pinned(&pins);
        }
        self.step(ink, None);
        true
    }

    /// Pins a joint of a finished sketch, or lets it go.
    pub fn toggle_pin(&mut self, joint: usize) {
        if self.ink.sketch.is_none() || joint >= self.figure.joint_count() {
            return;
        }
        let mut ink = self.ink.clone();
        if !ink.pins.remove(&joint) {
            ink.pins.insert(joint);
        }
        let longest = std::mem::take(&mut self.longest);
        self.step(ink, None);
        self.longest = longest;
    }
}

fn pinned(pins: &[bool]) -> BTreeSet<usize> {
    (0..pins.len()).filter(|&joint| pins[joint]).collect()
}

/// Strokes read along the sketch path alone.
fn along_path(figure: &Figure, strokes: &[Stroke]) -> FreeReading {
    FreeReading {
        progress: progress(figure, strokes, Pen::Up),
        along_path: true,
        is_sure: true,
    }
}

/// Changes as a whole.
impl SketchDrawing {
    /// Takes back the last change.
    pub fn undo(&mut self) {
        if let Some(ink) = self.history.undo().cloned() {
            if self.ink.strokes.len() > ink.strokes.len() {
                self.changes.push(DrawingChange::StrokeUndone);
            }
            self.show(ink);
        }
    }

    /// Does again what was undone last.
    pub fn redo(&mut self) {
        if let Some(ink) = self.history.redo().cloned() {
            self.show(ink);
        }
    }

    /// Takes an unfinished drawing for finished: what is not there is as in [`SketchDrawing::guess`]. Says whether enough
    /// was drawn.
    pub fn finish(&mut self) -> bool {
        if self.ink.sketch.is_some() {
            return true;
        }
        let Some(Ok(sketch)) = self.guess().map(|points| Sketch::new(&self.figure, points)) else {
            return false;
        };
        let ink = Ink {
            sketch: Some(sketch),
            ..self.ink.clone()
        };
        self.step(ink, None);
        true
    }

    /// Takes everything off the canvas.
    pub fn clear(&mut self) {
        if self.ink != Ink::default() {
            self.step(Ink::default(), None);
        }
        self.pen = PenState::Idle;
        self.live = None;
    }

    /// Swaps the sides of a finished sketch, as in a mirror. Says whether there was one.
    pub fn mirror(&mut self) -> bool {
        let Some(sketch) = &self.ink.sketch else {
            return false;
        };
        let sketch = mirrored_in_place(&self.figure, sketch);
        let mirrored = |joint: &usize| self.figure.mirror_of(*joint);
        let ink = Ink {
            pins: self.ink.pins.iter().map(mirrored).collect(),
            ..Ink::of_sketch(sketch)
        };
        self.step(ink, None);
        true
    }

    /// Makes it a drawing of `figure`: what was drawn of another one is gone, with its history.
    pub fn follow(&mut self, figure: &Arc<Figure>) {
        if Arc::ptr_eq(&self.figure, figure) {
            return;
        }
        if self.figure == *figure {
            self.figure = figure.clone();
            return;
        }
        let was_blank = self.ink == Ink::default();
        let changes = self.take_changes();
        *self = Self {
            changes,
            order: self.order,
            is_free_drag: self.is_free_drag,
            ..Self::new(figure.clone())
        };
        if !was_blank {
            self.changes.push(DrawingChange::Redrawn);
        }
    }

    /// Whether it is a drawing of this very figure.
    pub(super) fn follows(&self, figure: &Arc<Figure>) -> bool {
        Arc::ptr_eq(&self.figure, figure)
    }

    /// Puts a sketch of any scale on the canvas, in the middle.
    ///
    /// # Errors
    /// As [`Sketch::new`], when it is of another figure.
    pub fn load(&mut self, sketch: &Sketch) -> Result<(), SketchError> {
        let sketch = Sketch::new(&self.figure, fitted(sketch.points()))?;
        self.pen = PenState::Idle;
        self.step(Ink::of_sketch(sketch), None);
        Ok(())
    }

    /// Puts other ink on the canvas, as one lays another sheet: its strokes can be taken back, the sheet before cannot.
    pub fn put_ink(&mut self, ink: Ink) {
        self.history = History::new(Ink::default(), MAX_UNDO);
        for count in 1..ink.strokes.len() {
            self.history.push(Ink {
                strokes: ink.strokes[..count].to_vec(),
                exchanged: ink.exchanged.clone(),
                ..Ink::default()
            });
        }
        self.history.push(ink.clone());
        self.pen = PenState::Idle;
        self.show(ink);
    }

    /// Goes one step on, which can be undone. `reading` is what the strokes show, where that is known already.
    pub(super) fn step(&mut self, ink: Ink, reading: Option<FreeReading>) {
        if let (None, Some(sketch)) = (&self.ink.sketch, &ink.sketch) {
            self.changes
                .push(DrawingChange::Completed(sketch.points().to_vec()));
        }
        self.history.push(ink.clone());
        self.show_as(ink, reading);
    }

    pub(super) fn show(&mut self, ink: Ink) {
        self.show_as(ink, None);
    }

    fn show_as(&mut self, ink: Ink, reading: Option<FreeReading>) {
        self.hovered = None;
        self.longest.clear();
        self.live = None;
        self.reading = match (&ink.sketch, reading) {
            (Some(sketch), _) => of_sketch(sketch),
            (None, Some(reading)) => reading,
            (None, None) => self.read(&ink.strokes, &ink.exchanged),
        };
        self.ink = ink;
        self.changes.push(DrawingChange::Redrawn);
    }

    /// Puts the sketch of a joint in hand in place of the one before, without a step.
    pub(super) fn show_dragged(&mut self, sketch: Sketch) {
        self.reading = of_sketch(&sketch);
        // What was drawn is no longer what is meant.
        self.ink.strokes.clear();
        self.ink.sketch = Some(sketch);
        self.changes.push(DrawingChange::Redrawn);
    }

    /// Works out what strokes show.
    pub(super) fn read(&self, strokes: &[Stroke], exchanged: &BTreeSet<usize>) -> FreeReading {
        let mut reading = match self.order {
            DrawingOrder::Any => read_freely(&self.figure, strokes, usual_scale(&self.figure)),
            DrawingOrder::Guided => along_path(&self.figure, strokes),
        };
        for &joint in exchanged {
            swap_pair_in(&self.figure, &mut reading.progress.placed, joint);
        }
        reading
    }
}

/// A finished sketch shows all its joints.
fn of_sketch(sketch: &Sketch) -> FreeReading {
    FreeReading {
        progress: Progress {
            placed: sketch.points().iter().copied().map(Some).collect(),
            from_joint: None,
            next_joint: None,
            fraction: 1.0,
            complete: true,
        },
        along_path: false,
        is_sure: true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loaded() -> SketchDrawing {
        let mut drawing = SketchDrawing::default();
        drawing.load(&Sketch::template(Figure::human())).unwrap();
        drawing
    }

    #[test]
    fn another_sheet_has_its_own_strokes_to_take_back() {
        let mut drawing = loaded();
        let line = |y| Stroke::from_positions([Vec2::new(0.0, y), Vec2::new(60.0, y)]).unwrap();
        let ink = Ink {
            strokes: vec![line(0.0), line(50.0)],
            ..Ink::default()
        };
        drawing.put_ink(ink.clone());
        assert_eq!(drawing.ink(), &ink);
        drawing.undo();
        assert_eq!(drawing.strokes(), &ink.strokes[..1]);
        drawing.undo();
        assert_eq!(drawing.ink(), &Ink::default());
        assert!(!drawing.can_undo(), "the sheet before is gone");
    }

    #[test]
    fn completion_is_told_once() {
        let mut drawing = loaded();
        let told = |drawing: &mut SketchDrawing| {
            let changes = drawing.take_changes();
            changes
                .iter()
                .filter(|change| matches!(change, DrawingChange::Completed(_)))
                .count()
        };
        assert_eq!(told(&mut drawing), 1);
        assert!(drawing.mirror());
        assert_eq!(told(&mut drawing), 0);
        drawing.clear();
        assert!(!drawing.mirror());
        assert!(drawing.sketch().is_none());
        drawing.undo();
        assert!(drawing.sketch().is_some());
    }

    #[test]
    fn another_figure_is_a_blank_sheet_and_the_same_one_is_not() {
        let mut drawing = loaded();
        drawing.take_changes();
        drawing.follow(&Arc::new(Figure::human().clone()));
        assert!(drawing.sketch().is_some() && drawing.can_undo());
        assert_eq!(drawing.take_changes(), []);

        let mut other = Figure::human().clone();
        other.name = "ape".to_owned();
        let other = Arc::new(other);
        drawing.follow(&other);
        assert!(drawing.sketch().is_none() && !drawing.can_undo());
        assert_eq!(drawing.figure().name, "ape");
        assert_eq!(drawing.take_changes(), [DrawingChange::Redrawn]);
        drawing.follow(&Arc::new(Figure::human().clone()));
        assert_eq!(drawing.take_changes(), [], "a blank sheet stays one");
    }

    #[test]
    fn strokes_beside_a_finished_sketch_change_nothing() {
        let mut drawing = loaded();
        let before = drawing.sketch().unwrap().clone();
        drawing.press(Vec2::new(450.0, 450.0), 0.0);
        drawing.move_to(Vec2::new(490.0, 300.0), 0.1);
        drawing.release();
        assert_eq!(drawing.sketch(), Some(&before));
        assert!(drawing.strokes().is_empty());
    }

    #[test]
    fn the_next_bone_is_the_first_unplaced_joint_of_the_path() {
        let human = Figure::human();
        let drawing = SketchDrawing::default();
        assert_eq!(drawing.next_bone(), Some((None, human.path[0])));
        assert_eq!(loaded().next_bone(), None);
    }
}
