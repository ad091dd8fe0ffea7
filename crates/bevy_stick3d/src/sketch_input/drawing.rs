//! A drawing in the making: strokes, the joints they show, then joints to drag. Knows no pointer and no screen.

use std::sync::Arc;

use bevy::prelude::*;
use stick3d_figure::edit::{Drag, History, mirrored_in_place, nearest_joint};
use stick3d_figure::{Figure, Pen, Progress, Sketch, SketchError, Stroke, is_scribble, progress};

use super::guide::{fitted, guide, is_enough};

/// How near to a joint the pen takes hold of it, canvas units.
pub const GRAB_RADIUS: f32 = 28.0;
/// Shorter strokes are slips, canvas units.
const SLIP: f32 = 8.0;
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
}

/// What is on a canvas, in canvas units: what undo brings back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ink {
    /// The finished strokes.
    pub strokes: Vec<Stroke>,
    /// Once all joints have their place.
    pub sketch: Option<Sketch>,
}

/// What the pen is doing.
#[derive(Clone, Debug, Default)]
enum PenState {
    #[default]
    Idle,
    Drawing(Stroke),
    Dragging(Drag),
}

/// What was drawn on a canvas, in canvas units with y up. Everything can be undone.
///
/// Written by the pointer (see [`SketchCanvas`](super::SketchCanvas)), and by calling its methods.
#[derive(Component, Clone, Debug, Reflect)]
#[reflect(opaque, Component, Debug, Clone)]
pub struct SketchDrawing {
    figure: Arc<Figure>,
    history: History<Ink>,
    /// What is shown: the history's present, but for a joint in hand.
    ink: Ink,
    progress: Progress,
    /// The progress with the stroke that is being drawn, once it was read.
    live: Option<Progress>,
    pen: PenState,
    hovered: Option<usize>,
    changes: Vec<DrawingChange>,
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
            progress: progress(&figure, &[], Pen::Up),
            figure,
            history: History::new(Ink::default(), MAX_UNDO),
            ink: Ink::default(),
            live: None,
            pen: PenState::Idle,
            hovered: None,
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

    /// The stroke that is being drawn.
    pub fn pen_stroke(&self) -> Option<&Stroke> {
        match &self.pen {
            PenState::Drawing(stroke) => Some(stroke),
            _ => None,
        }
    }

    /// Where the joints are as far as they are known, in the order of the figure's joints.
    pub fn joints(&self) -> &[Option<Vec2>] {
        &self.progress.placed
    }

    /// How far the drawing has come, the stroke that is being drawn included.
    pub fn live_progress(&self) -> &Progress {
        self.live.as_ref().unwrap_or(&self.progress)
    }

    /// The sketch, once every joint has its place.
    pub fn sketch(&self) -> Option<&Sketch> {
        self.ink.sketch.as_ref()
    }

    /// The unfinished sketch with its missing limbs guessed, once the middle of the body is drawn.
    pub fn guess(&self) -> Option<Vec<Vec2>> {
        is_enough(&self.figure, self.joints()).then(|| guide(&self.figure, self.joints()))
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
            PenState::Dragging(drag) => Some(drag.joint()),
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

/// The pen.
impl SketchDrawing {
    /// The pen touches down: takes hold of a joint of a finished sketch, or begins a stroke.
    pub fn press(&mut self, at: Vec2, time_s: f64) {
        let taken = self
            .sketch()
            .and_then(|sketch| Drag::begin(sketch, at, GRAB_RADIUS));
        let mut stroke = Stroke::default();
        self.pen = match taken {
            Some(drag) => PenState::Dragging(drag),
            None if stroke.push(at, time_s).is_ok() => PenState::Drawing(stroke),
            None => PenState::Idle,
        };
        self.hovered = self.dragged();
    }

    /// The pen moves, touching or not. A position that is not finite is left out.
    pub fn move_to(&mut self, at: Vec2, time_s: f64) {
        match &mut self.pen {
            PenState::Idle => {
                self.hovered = self
                    .ink
                    .sketch
                    .as_ref()
                    .and_then(|sketch| nearest_joint(sketch, at, GRAB_RADIUS));
            }
            PenState::Drawing(stroke) => {
                let moved = stroke
                    .points()
                    .last()
                    .is_none_or(|last| last.position_px.distance_squared(at) > 0.25);
                if moved && stroke.push(at, time_s).is_ok() {
                    self.live = None;
                }
            }
            PenState::Dragging(drag) => {
                let drag = *drag;
                self.drag_to(drag, at);
            }
        }
    }

    /// The pointer is elsewhere.
    pub fn leave(&mut self) {
        self.hovered = None;
    }

    /// The pen lifts: a stroke is read, or a joint let go.
    pub fn release(&mut self) {
        self.live = None;
        match std::mem::take(&mut self.pen) {
            PenState::Idle => {}
            PenState::Drawing(stroke) => self.finish_stroke(stroke),
            PenState::Dragging(_) => self.history.push(self.ink.clone()),
        }
    }

    /// The pen is gone without lifting: nothing was drawn.
    pub fn cancel(&mut self) {
        self.live = None;
        if let PenState::Dragging(_) = std::mem::take(&mut self.pen) {
            self.show(self.history.present().clone());
        }
    }

    /// Whether the stroke that is being drawn went on since [`SketchDrawing::read_pen`].
    pub fn is_pen_unread(&self) -> bool {
        self.ink.sketch.is_none() && self.live.is_none() && self.pen_stroke().is_some()
    }

    /// Reads the stroke that is being drawn, so that guides can follow the pen.
    pub fn read_pen(&mut self) {
        if self.is_pen_unread()
            && let PenState::Drawing(stroke) = &self.pen
        {
            let tip = stroke.points().last().map(|point| point.position_px);
            let mut strokes = self.ink.strokes.clone();
            strokes.push(stroke.clone());
            let mut live = progress(&self.figure, &strokes, Pen::Down);
            // The joint under the pen is still on its way: guides that followed it would flutter.
            for (live, settled) in live.placed.iter_mut().zip(&self.progress.placed) {
                let at_tip = live
                    .zip(tip)
                    .is_some_and(|(a, b)| a.distance(b) < GRAB_RADIUS);
                if settled.is_none() && at_tip {
                    *live = None;
                }
            }
            self.live = Some(live);
        }
    }

    /// Moves the joint in hand; a place that makes no sketch leaves it where it is.
    fn drag_to(&mut self, drag: Drag, at: Vec2) {
        let Some(sketch) = &self.ink.sketch else {
            return;
        };
        let mut moved = sketch.clone();
        if drag.move_to(&self.figure, &mut moved, at).is_ok() && moved != *sketch {
            self.ink = Ink {
                // What was drawn is no longer what is meant.
                strokes: Vec::new(),
                sketch: Some(moved),
            };
            self.read();
            self.changes.push(DrawingChange::Redrawn);
        }
    }

    fn finish_stroke(&mut self, stroke: Stroke) {
        if stroke.length_px() < SLIP {
            return;
        }
        if is_scribble(&stroke, &self.lines()) {
            self.undo();
            return;
        }
        if self.ink.sketch.is_some() {
            // A finished sketch is changed by its joints.
            return;
        }
        self.changes
            .push(DrawingChange::StrokeFinished(stroke.positions().collect()));
        let mut strokes = self.ink.strokes.clone();
        strokes.push(stroke);
        let reading = progress(&self.figure, &strokes, Pen::Up);
        let points: Option<Vec<Vec2>> = reading.placed.iter().copied().collect();
        let sketch = points
            .filter(|_| reading.complete)
            .and_then(|points| Sketch::new(&self.figure, points).ok());
        self.step(Ink { strokes, sketch });
    }

    /// What is on the canvas to scribble over: the strokes, or the bones of a sketch that came without.
    fn lines(&self) -> Vec<Stroke> {
        if !self.ink.strokes.is_empty() {
            return self.ink.strokes.clone();
        }
        let points = self.sketch().map_or(&[][..], Sketch::points);
        self.figure
            .bones
            .iter()
            .filter_map(|&[a, b]| Stroke::from_positions([*points.get(a)?, *points.get(b)?]).ok())
            .collect()
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

    /// Takes everything off the canvas.
    pub fn clear(&mut self) {
        if self.ink != Ink::default() {
            self.step(Ink::default());
        }
        self.pen = PenState::Idle;
        self.live = None;
    }

    /// Swaps the sides of a finished sketch, as in a mirror. Says whether there was one.
    pub fn mirror(&mut self) -> bool {
        let Some(sketch) = &self.ink.sketch else {
            return false;
        };
        let sketch = Some(mirrored_in_place(&self.figure, sketch));
        self.step(Ink {
            strokes: Vec::new(),
            sketch,
        });
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
        self.step(Ink {
            strokes: Vec::new(),
            sketch: Some(sketch),
        });
        Ok(())
    }

    /// Puts other ink on the canvas, as one lays another sheet: its strokes can be taken back, the sheet before cannot.
    pub fn put_ink(&mut self, ink: Ink) {
        self.history = History::new(Ink::default(), MAX_UNDO);
        for count in 1..ink.strokes.len() {
            self.history.push(Ink {
                strokes: ink.strokes[..count].to_vec(),
                sketch: None,
            });
        }
        self.history.push(ink.clone());
        self.pen = PenState::Idle;
        self.show(ink);
    }

    /// Goes one step on, which can be undone.
    fn step(&mut self, ink: Ink) {
        if let (None, Some(sketch)) = (&self.ink.sketch, &ink.sketch) {
            self.changes
                .push(DrawingChange::Completed(sketch.points().to_vec()));
        }
        self.history.push(ink.clone());
        self.show(ink);
    }

    fn show(&mut self, ink: Ink) {
        self.ink = ink;
        self.hovered = None;
        self.read();
        self.changes.push(DrawingChange::Redrawn);
    }

    /// Works out where the joints are.
    fn read(&mut self) {
        self.live = None;
        self.progress = match &self.ink.sketch {
            Some(sketch) => Progress {
                placed: sketch.points().iter().copied().map(Some).collect(),
                from_joint: None,
                next_joint: None,
                fraction: 1.0,
                complete: true,
            },
            None => progress(&self.figure, &self.ink.strokes, Pen::Up),
        };
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
    fn a_drag_is_one_step_and_can_be_given_up() {
        let mut drawing = loaded();
        let before = drawing.sketch().unwrap().clone();
        let hand = before.points()[3];
        drawing.press(hand + Vec2::ONE, 0.0);
        assert_eq!(drawing.dragged(), Some(3));
        for step in 1..9 {
            drawing.move_to(hand + Vec2::ONE * (1.0 + step as f32), 0.0);
        }
        drawing.move_to(Vec2::NAN, 0.0);
        assert_eq!(
            drawing.sketch().unwrap().points()[3],
            hand + Vec2::splat(8.0)
        );
        drawing.cancel();
        assert_eq!(drawing.sketch(), Some(&before));
        drawing.press(hand, 0.0);
        drawing.move_to(hand + Vec2::X * 50.0, 0.0);
        drawing.release();
        drawing.undo();
        assert_eq!(drawing.sketch(), Some(&before));
        drawing.redo();
        assert_ne!(drawing.sketch(), Some(&before));
    }

    #[test]
    fn another_sheet_has_its_own_strokes_to_take_back() {
        let mut drawing = loaded();
        let line = |y| Stroke::from_positions([Vec2::new(0.0, y), Vec2::new(60.0, y)]).unwrap();
        let ink = Ink {
            strokes: vec![line(0.0), line(50.0)],
            sketch: None,
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
