//! What the pen does to a drawing: strokes, joints in hand, pins by a click.

use bevy::math::Vec2;
use stick3d_figure::edit::{
    Grip, bone_lengths, distance_to_line, nearest_bone, nearest_joint, redrawn,
};
use stick3d_figure::{Drag, Pen, Sketch, Stroke, completes, is_scribble, progress};

use super::drawing::{DrawingChange, DrawingOrder, GRAB_RADIUS, Ink, SketchDrawing};

/// Shorter strokes are slips, canvas units.
const SLIP: f32 = 8.0;
/// A pen that moves less is a click, canvas units.
const CLICK: f32 = 4.0;
/// Ink of a stroke farther than this from all bones belongs to none, canvas units,
const BESIDE: f32 = 45.0;
/// and a stroke with more of it than this share is not read as a part of a finished sketch.
const MAX_BESIDE: f32 = 0.2;
/// At so many places of it that is asked.
const BESIDE_SAMPLES: usize = 32;

/// What the pen is doing.
#[derive(Clone, Debug, Default)]
pub(super) enum PenState {
    #[default]
    Idle,
    Drawing(Stroke),
    Dragging(Held),
}

/// A joint in hand.
#[derive(Clone, Debug)]
pub(super) struct Held {
    drag: Drag,
    pressed_at: Vec2,
    now_at: Vec2,
    /// It was moved: no click.
    is_moved: bool,
    /// The pen's way, for it may have been a stroke.
    way: Stroke,
}

impl Held {
    pub(super) fn joint(&self) -> usize {
        self.drag.joint()
    }
}

impl SketchDrawing {
    /// The pen touches down: takes hold of a joint of a finished sketch, or begins a stroke.
    pub fn press(&mut self, at: Vec2, time_s: f64) {
        let taken = self
            .sketch()
            .and_then(|sketch| Drag::begin(sketch, at, GRAB_RADIUS));
        let mut stroke = Stroke::default();
        let is_begun = stroke.push(at, time_s).is_ok();
        self.pen = match taken {
            Some(drag) => PenState::Dragging(Held {
                drag,
                pressed_at: at,
                now_at: at,
                is_moved: false,
                way: stroke,
            }),
            None if is_begun => PenState::Drawing(stroke),
            None => PenState::Idle,
        };
        self.hovered = self.dragged();
        self.look_at(at);
    }

    /// The pen moves, touching or not. A position that is not finite is left out.
    pub fn move_to(&mut self, at: Vec2, time_s: f64) {
        match &mut self.pen {
            PenState::Idle => {
                let sketch = self.ink.sketch.as_ref();
                self.hovered = sketch.and_then(|sketch| nearest_joint(sketch, at, GRAB_RADIUS));
                self.look_at(at);
            }
            PenState::Drawing(stroke) => {
                if lengthen(stroke, at, time_s) {
                    self.live = None;
                }
            }
            PenState::Dragging(held) => {
                lengthen(&mut held.way, at, time_s);
                held.is_moved |= at.distance(held.pressed_at) > CLICK;
                if held.is_moved && at.is_finite() {
                    held.now_at = at;
                    let drag = held.drag.clone();
                    self.drag_to(&drag, at);
                }
            }
        }
    }

    /// The pointer is elsewhere.
    pub fn leave(&mut self) {
        self.hovered = None;
    }

    /// The pen lifts: a stroke is read, a joint let go, or pinned where it was only clicked.
    pub fn release(&mut self) {
        self.live = None;
        match std::mem::take(&mut self.pen) {
            PenState::Idle => {}
            PenState::Drawing(stroke) => self.finish_stroke(stroke),
            PenState::Dragging(held) if held.is_moved => self.finish_drag(held.way),
            PenState::Dragging(held) => self.toggle_pin(held.joint()),
        }
    }

    /// The pen is gone without lifting: nothing was drawn.
    pub fn cancel(&mut self) {
        self.live = None;
        if let PenState::Dragging(_) = std::mem::take(&mut self.pen) {
            self.put_back();
        }
    }

    /// Whether the stroke that is being drawn went on since [`SketchDrawing::read_pen`].
    pub fn is_pen_unread(&self) -> bool {
        self.ink.sketch.is_none() && self.live.is_none() && self.pen_stroke().is_some()
    }

    /// Reads the stroke that is being drawn, so that guides can follow the pen. In any order a stroke is read when it
    /// ends, unless those before it follow the sketch path.
    pub fn read_pen(&mut self) {
        if !self.is_pen_unread() {
            return;
        }
        let settled = &self.reading.progress;
        let is_guided = match self.order() {
            DrawingOrder::Guided => true,
            DrawingOrder::Any => self.is_along_path() && !self.ink.strokes.is_empty(),
        };
        let live = match &self.pen {
            PenState::Drawing(stroke) if is_guided => {
                let tip = stroke.points().last().map(|point| point.position_px);
                let mut strokes = self.ink.strokes.clone();
                strokes.push(stroke.clone());
                let mut live = progress(&self.figure, &strokes, Pen::Down);
                // The joint under the pen is still on its way: guides that followed it would flutter.
                for (live, settled) in live.placed.iter_mut().zip(&settled.placed) {
                    let at_tip = live
                        .zip(tip)
                        .is_some_and(|(a, b)| a.distance(b) < GRAB_RADIUS);
                    if settled.is_none() && at_tip {
                        *live = None;
                    }
                }
                live
            }
            _ => settled.clone(),
        };
        self.live = Some(live);
    }

    /// Whether dragged joints move alone, as while a modifier key is held. A joint in hand goes on from where it is.
    pub fn set_free_drag(&mut self, is_free: bool) {
        if self.is_free_drag == is_free {
            return;
        }
        self.is_free_drag = is_free;
        if let (PenState::Dragging(held), Some(sketch)) = (&mut self.pen, &self.ink.sketch) {
            held.drag = held.drag.taken_anew(sketch, held.now_at);
            self.longest.clear();
        }
    }

    /// Moves the joint in hand; a place that makes no sketch leaves it where it is.
    fn drag_to(&mut self, drag: &Drag, at: Vec2) {
        let grip = Grip {
            is_free: self.is_free_drag,
            pins: self.pins(),
            longest: self.longest.clone(),
        };
        if let Ok(moved) = drag.moved(&self.figure, at, &grip)
            && self.ink.sketch.as_ref() != Some(&moved)
        {
            self.show_dragged(moved);
        }
    }

    /// The joint in hand is where it was.
    fn put_back(&mut self) {
        let longest = std::mem::take(&mut self.longest);
        self.show(self.history.present().clone());
        self.longest = longest;
    }

    /// Lets a joint go, unless it turns out that the drawing only looked finished, and that this was one more stroke.
    /// What was foreshortened may become as long again as it was.
    fn finish_drag(&mut self, way: Stroke) {
        if self.is_stroke(&way) {
            self.put_back();
            self.add_stroke(way);
            return;
        }
        let lengths = |sketch: &Sketch| bone_lengths(&self.figure, sketch.points());
        let before = self.history.present().sketch.as_ref().map(lengths);
        self.longest = match before {
            Some(before) if !self.is_free_drag => {
                let known = self.longest.iter().copied().chain(std::iter::repeat(0.0));
                before.iter().zip(known).map(|(a, b)| a.max(b)).collect()
            }
            _ => Vec::new(),
        };
        self.history.push(self.ink.clone());
    }

    fn finish_stroke(&mut self, stroke: Stroke) {
        if stroke.length_px() < SLIP {
            return self.click_limb(&stroke);
        }
        if is_scribble(&stroke, &self.lines()) {
            self.undo();
            return;
        }
        if self.ink.sketch.is_some() {
            self.draw_over(stroke);
            return;
        }
        self.add_stroke(stroke);
    }

    /// One more stroke of the drawing.
    fn add_stroke(&mut self, stroke: Stroke) {
        let mut ink = self.ink.clone();
        let positions = stroke.positions().collect();
        self.changes.push(DrawingChange::StrokeFinished(positions));
        ink.strokes.push(stroke);
        let reading = self.read(&ink.strokes, &ink.exchanged);
        let points: Option<Vec<Vec2>> = reading.progress.placed.iter().copied().collect();
        ink.sketch = points
            .filter(|_| reading.progress.complete)
            .and_then(|points| Sketch::new(&self.figure, points).ok());
        self.step(ink, Some(reading));
    }

    /// Whether the way of a joint in hand was rather a stroke of a drawing that was taken for finished too early: only
    /// before anything else was done to that drawing, and not along the sketch path, where a finished drawing is finished.
    fn is_stroke(&self, way: &Stroke) -> bool {
        let fresh = self.history.present();
        let is_fresh = fresh.pins.is_empty() && !fresh.strokes.is_empty();
        if !is_fresh || self.order() == DrawingOrder::Guided || way.length_px() < SLIP {
            return false;
        }
        // A drawing that was taken for finished by Enter has guessed limbs, which are there to be dragged.
        completes(&self.figure, &fresh.strokes, way)
            && self
                .read(&fresh.strokes, &fresh.exchanged)
                .progress
                .complete
    }

    /// A slip of the pen on a bone of a finished sketch is a click on its limb.
    fn click_limb(&mut self, slip: &Stroke) {
        let (Some(sketch), Some(at)) = (&self.ink.sketch, slip.positions().next()) else {
            return;
        };
        let bone = nearest_bone(&self.figure, sketch.points(), at, GRAB_RADIUS);
        if let Some(limb) = bone.and_then(|bone| self.figure.limb_of_bone(self.figure.bones[bone]))
        {
            self.changes.push(DrawingChange::LimbClicked(limb.end()));
        }
    }

    /// A stroke over a finished sketch: the rest of a limb that looked finished, or a limb drawn anew. Other strokes
    /// change nothing.
    fn draw_over(&mut self, stroke: Stroke) {
        let Some(sketch) = &self.ink.sketch else {
            return;
        };
        let positions = stroke.positions().collect();
        let ink = self.read_with(&stroke).or_else(|| {
            let sketch = redrawn(&self.figure, sketch, &stroke)?;
            Some(Ink {
                strokes: Vec::new(),
                sketch: Some(sketch),
                ..self.ink.clone()
            })
        });
        if let Some(ink) = ink {
            self.changes.push(DrawingChange::StrokeFinished(positions));
            self.step(ink, None);
        }
    }

    /// The finished sketch that its strokes show together with one more, if that lies on its bones.
    fn read_with(&self, stroke: &Stroke) -> Option<Ink> {
        if self.ink.strokes.is_empty() {
            return None;
        }
        let mut ink = self.ink.clone();
        ink.strokes.push(stroke.clone());
        let progress = self.read(&ink.strokes, &ink.exchanged).progress;
        let points: Option<Vec<Vec2>> = progress.placed.iter().copied().collect();
        let sketch = Sketch::new(&self.figure, points.filter(|_| progress.complete)?).ok()?;
        let beside = beside(&self.figure.bones, sketch.points(), stroke);
        (beside <= MAX_BESIDE).then_some(())?;
        ink.sketch = Some(sketch);
        Some(ink)
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

/// Adds a place to a stroke. Says whether it became longer.
fn lengthen(stroke: &mut Stroke, at: Vec2, time_s: f64) -> bool {
    let moved = stroke
        .points()
        .last()
        .is_none_or(|last| last.position_px.distance_squared(at) > 0.25);
    moved && stroke.push(at, time_s).is_ok()
}

/// The share of a stroke that is far from all bones.
fn beside(bones: &[[usize; 2]], points: &[Vec2], stroke: &Stroke) -> f32 {
    let samples = stroke.resampled(BESIDE_SAMPLES);
    let is_beside = |at: Vec2| {
        let mut lines = bones.iter().map(|&[a, b]| [points[a], points[b]]);
        lines.all(|[a, b]| distance_to_line(at, a, b) > BESIDE)
    };
    let count = samples
        .iter()
        .filter(|sample| is_beside(sample.position_px));
    count.count() as f32 / samples.len().max(1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use stick3d_figure::Figure;

    fn loaded() -> SketchDrawing {
        let mut drawing = SketchDrawing::default();
        drawing.load(&Sketch::template(Figure::human())).unwrap();
        drawing
    }

    fn at(drawing: &SketchDrawing, name: &str) -> (usize, Vec2) {
        let joint = Figure::human().joint_index(name).unwrap();
        (joint, drawing.sketch().unwrap().points()[joint])
    }

    fn drag(drawing: &mut SketchDrawing, from: Vec2, to: Vec2) {
        drawing.press(from, 0.0);
        for step in 1..=10 {
            drawing.move_to(from.lerp(to, step as f32 / 10.0), 0.0);
        }
        drawing.release();
    }

    fn stroke(drawing: &mut SketchDrawing, line: &[Vec2]) {
        drawing.press(line[0], 0.0);
        for two in line.windows(2) {
            for step in 1..=20 {
                drawing.move_to(two[0].lerp(two[1], step as f32 / 20.0), 0.0);
            }
        }
        drawing.release();
    }

    #[test]
    fn a_drag_is_one_step_and_can_be_given_up() {
        let mut drawing = loaded();
        let before = drawing.sketch().unwrap().clone();
        let (joint, hand) = at(&drawing, "hand_r");
        let up = hand + Vec2::new(10.0, 60.0);
        drawing.press(hand + Vec2::ONE, 0.0);
        assert_eq!(drawing.dragged(), Some(joint));
        for step in 1..=9 {
            drawing.move_to(hand.lerp(up, step as f32 / 9.0) + Vec2::ONE, 0.0);
        }
        drawing.move_to(Vec2::NAN, 0.0);
        assert!(at(&drawing, "hand_r").1.distance(up) < 1.0);
        drawing.cancel();
        assert_eq!(drawing.sketch(), Some(&before));
        drag(&mut drawing, hand, up);
        drawing.undo();
        assert_eq!(drawing.sketch(), Some(&before));
        drawing.redo();
        assert_ne!(drawing.sketch(), Some(&before));
    }

    #[test]
    fn a_click_pins_and_a_pinned_joint_stays() {
        let mut drawing = loaded();
        let (joint, foot) = at(&drawing, "foot_l");
        let click = |drawing: &mut SketchDrawing| {
            drawing.press(foot, 0.0);
            drawing.move_to(foot + Vec2::ONE, 0.0);
            drawing.release();
        };
        click(&mut drawing);
        assert!(drawing.pins()[joint]);
        let (root, hips) = at(&drawing, "abdomen");
        drag(&mut drawing, hips, hips - Vec2::Y * 80.0);
        assert_eq!(at(&drawing, "foot_l").1, foot);
        assert!(at(&drawing, "foot_r").1.y < foot.y - 60.0);
        assert!(drawing.sketch().unwrap().points()[root].y < hips.y - 60.0);
        drawing.undo();
        assert!(drawing.pins()[joint] && drawing.sketch().is_some());
        drawing.undo();
        assert!(!drawing.pins()[joint], "a pin is a step of its own");
        drawing.redo();
        click(&mut drawing);
        assert!(!drawing.pins()[joint]);
        click(&mut drawing);
        assert!(drawing.mirror());
        let other = Figure::human().mirror_of(joint);
        assert!(drawing.pins()[other] && !drawing.pins()[joint]);
    }

    #[test]
    fn a_click_on_a_bone_tells_its_limb() {
        let mut drawing = loaded();
        let ((_, elbow), (hand, end)) = (at(&drawing, "elbow_r"), at(&drawing, "hand_r"));
        let before = drawing.sketch().unwrap().clone();
        let mut click = |at: Vec2| {
            drawing.take_changes();
            drawing.press(at, 0.0);
            drawing.move_to(at + Vec2::ONE, 0.0);
            drawing.release();
            drawing.take_changes()
        };
        let forearm = elbow.midpoint(end);
        assert_eq!(click(forearm), [DrawingChange::LimbClicked(hand)]);
        assert_eq!(click(Vec2::new(-450.0, 0.0)), [], "beside the figure");
        assert_eq!(drawing.sketch(), Some(&before));
        assert!(drawing.pins().iter().all(|is_pinned| !is_pinned));
    }

    #[test]
    fn a_free_drag_stretches_and_another_does_not() {
        let mut drawing = loaded();
        let (_, hand) = at(&drawing, "hand_l");
        let far = hand + Vec2::new(300.0, 0.0);
        let neck = at(&drawing, "neck").1;
        drag(&mut drawing, hand, far);
        assert!(at(&drawing, "hand_l").1.distance(far) > 50.0);
        let reach = at(&drawing, "hand_l").1.distance(neck);
        drawing.undo();
        drawing.set_free_drag(true);
        drag(&mut drawing, hand, far);
        assert!(at(&drawing, "hand_l").1.distance(far) < 1.0);
        assert!(far.distance(neck) > reach);
    }

    #[test]
    fn a_limb_that_was_pushed_together_comes_out_again() {
        let mut drawing = loaded();
        let (_, hand) = at(&drawing, "hand_l");
        let neck = at(&drawing, "neck").1;
        let length = |drawing: &SketchDrawing| -> f32 {
            let points = drawing.sketch().unwrap().points();
            bone_lengths(Figure::human(), points).iter().sum()
        };
        let before = length(&drawing);
        drag(&mut drawing, hand, neck + Vec2::new(35.0, -10.0));
        assert!(length(&drawing) < 0.95 * before);
        let (_, near) = at(&drawing, "hand_l");
        drag(&mut drawing, near, neck + Vec2::new(400.0, -100.0));
        assert!((length(&drawing) - before).abs() < 0.01 * before);
    }

    #[test]
    fn a_limb_is_drawn_anew_and_other_strokes_change_nothing() {
        let mut drawing = loaded();
        let before = drawing.sketch().unwrap().clone();
        stroke(
            &mut drawing,
            &[Vec2::new(400.0, 450.0), Vec2::new(440.0, 300.0)],
        );
        assert_eq!(drawing.sketch(), Some(&before));
        let (_, neck) = at(&drawing, "neck");
        // Beside the joint, which would be taken.
        let shoulder = neck + Vec2::new(30.0, 5.0);
        let arm = [
            shoulder,
            neck + Vec2::new(150.0, 40.0),
            neck + Vec2::new(170.0, 200.0),
        ];
        stroke(&mut drawing, &arm);
        assert!(at(&drawing, "hand_l").1.distance(arm[2]) < 10.0);
        drawing.undo();
        assert_eq!(drawing.sketch(), Some(&before));
    }
}
