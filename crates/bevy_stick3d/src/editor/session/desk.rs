//! The session with its drawings: what carries out what the user asks.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

use super::super::timeline::clip::drawing_beside;
use super::super::timeline::history::Change;
use super::super::timeline::state::KeyId;
use super::super::viewport::EditedFigure;
use super::bodies::Bodies;
use super::settle::{Canvases, look_at_selected};
use super::{Action, Choice, Mode, Session};
use crate::figure::StickFigure;
use crate::inference::{ReadyModel, StickInference};
use crate::sketch_input::{DrawingOrder, Ink, SketchCanvas, SketchDrawing};
use crate::{ChooseAlternative, FlipLimb};

/// The session with its drawings: what carries out what the user asks.
#[derive(SystemParam)]
pub(in super::super) struct Desk<'w, 's> {
    /// What the editor remembers.
    pub(in super::super) session: ResMut<'w, Session>,
    pub(super) canvases: Canvases<'w, 's>,
    pub(super) figures: Query<'w, 's, &'static mut EditedFigure>,
    pub(super) bodies: Bodies<'w, 's>,
    pub(super) choose: MessageWriter<'w, ChooseAlternative>,
    pub(super) flips: MessageWriter<'w, FlipLimb>,
    models: Query<'w, 's, &'static StickFigure>,
    inference: ResMut<'w, StickInference>,
}

/// What there is to see.
impl Desk<'_, '_> {
    /// A canvas of the figure that is drawn.
    pub(in super::super) fn canvas_mut(&mut self, slot: usize) -> Option<Mut<'_, SketchCanvas>> {
        let canvas = self.session.choice()?.slots.get(slot)?.canvas;
        self.canvases.get_mut(canvas).ok().map(|(canvas, _)| canvas)
    }

    /// What is drawn on a canvas, if that is used.
    pub(in super::super) fn drawing_on(&self, slot: usize) -> Option<(KeyId, &SketchDrawing)> {
        let slot = self.session.choice()?.slots.get(slot)?;
        let (_, drawing) = self.canvases.get(slot.canvas).ok()?;
        Some((slot.key?, drawing))
    }

    /// The drawing of the selected key.
    pub(in super::super) fn drawing(&self) -> Option<&SketchDrawing> {
        let canvas = self.session.choice()?.selected_canvas()?;
        self.canvases.get(canvas).ok().map(|(_, drawing)| drawing)
    }

    pub(super) fn drawing_mut(&mut self) -> Option<Mut<'_, SketchDrawing>> {
        let canvas = self.session.choice()?.selected_canvas()?;
        self.canvases
            .get_mut(canvas)
            .ok()
            .map(|(_, drawing)| drawing)
    }

    /// The networks of a body's model, once they are ready.
    pub(super) fn ready_model(&self, body: Entity) -> Option<&ReadyModel> {
        self.inference.get(&self.models.get(body).ok()?.0)
    }

    /// The body that is shown, to look at it from elsewhere.
    pub(in super::super) fn edited_mut(&mut self) -> Option<Mut<'_, EditedFigure>> {
        self.figures.get_mut(self.session.body()?).ok()
    }
}

/// The actions.
impl Desk<'_, '_> {
    /// Does what the user asks.
    pub(in super::super) fn act(&mut self, action: Action) {
        self.settle();
        match action {
            Action::Save => return self.save(),
            Action::Open => return self.open_chosen(),
            _ => {}
        }
        self.session.status.clear();
        match action {
            Action::Choose(index) => self.choose(index),
            Action::Switch(mode) => self.switch(mode),
            Action::Undo | Action::Redo => self.step_in_history(action == Action::Undo),
            Action::Mirror | Action::SwapSides | Action::Finish | Action::Clear => {
                self.change_drawing(action);
            }
            Action::Order => self.change_order(),
            Action::Alternative(_) | Action::NextAlternative | Action::LastAlternative => {
                self.choose_body(action);
            }
            Action::Flip(joint) => self.flip(joint),
            Action::Ghosts => self.session.shows_ghosts ^= true,
            Action::KeyHere => self.key_here(),
            Action::Export => self.export(),
            _ => self.edit_timeline(action),
        }
        self.lay_out(false);
    }

    /// Puts another figure on the desk; the one before keeps what was drawn.
    pub(super) fn choose(&mut self, index: usize) {
        if index == self.session.active || index >= self.session.choices.len() {
            return;
        }
        self.lift_pens();
        self.settle();
        self.session.active = index;
        self.lay_out(true);
    }

    pub(super) fn switch(&mut self, mode: Mode) {
        if mode != self.session.mode {
            self.lift_pens();
            self.settle();
            self.session.mode = mode;
            self.lay_out(true);
        }
    }

    /// What was changed is shown: where it is not to be seen in a pose, in the animation mode.
    fn step_in_history(&mut self, is_back: bool) {
        self.lift_pens();
        let Some(choice) = self.session.choice_mut() else {
            return;
        };
        let document = &mut choice.document;
        let change = if is_back {
            document.undo()
        } else {
            document.redo()
        };
        choice.is_key_in_hand = false;
        look_at_selected(choice);
        choice.recall_body(&mut self.bodies);
        self.lay_out(false);
        if change == Some(Change::Timeline) {
            self.switch(Mode::Animate);
        }
    }

    fn change_drawing(&mut self, action: Action) {
        let Some(mut drawing) = self.drawing_mut() else {
            return;
        };
        let problem = match action {
            Action::Clear => {
                drawing.clear();
                None
            }
            Action::SwapSides => {
                (!drawing.swap_sides()).then_some("Point at an arm or a leg, then press X")
            }
            Action::Finish => {
                (!drawing.finish()).then_some("Draw the torso first, then press Enter")
            }
            _ => (!drawing.mirror()).then_some("There is nothing to mirror yet"),
        };
        if let Some(problem) = problem {
            self.session.status.note(problem);
        }
        self.settle();
    }

    /// From any order to the guided one and back, for all drawings.
    fn change_order(&mut self) {
        let order = match self.session.order {
            DrawingOrder::Any => DrawingOrder::Guided,
            DrawingOrder::Guided => DrawingOrder::Any,
        };
        self.session.order = order;
        for (mut canvas, mut drawing) in &mut self.canvases {
            canvas.order = order;
            drawing.set_order(order);
        }
        self.session.status.note(match order {
            DrawingOrder::Any => "Strokes are read in any order",
            DrawingOrder::Guided => "Strokes are read in the order that is shown",
        });
    }

    fn edit_timeline(&mut self, action: Action) {
        let Some(choice) = self.session.choice_mut() else {
            return;
        };
        let document = &mut choice.document;
        match action {
            Action::Play => match choice.performance.course() {
                Some(course) => choice.player.toggle(&course),
                None => self.session.status.note("Draw a source and a target first"),
            },
            Action::Seek(time_s) => choice.player.seek(time_s),
            Action::Step(by_s) => {
                if let Some(course) = choice.performance.course() {
                    let now_s = course.folded(choice.player.time_s);
                    choice.player.seek((now_s + by_s).max(course.start_s));
                }
            }
            Action::Speed => choice.player.next_speed(),
            Action::Select(id) => {
                document.select(id);
                choice.player.is_playing = false;
                look_at_selected(choice);
            }
            Action::Retime(id, time_s) => {
                document.select(id);
                document.scene_mut().retime(id, time_s);
                choice.is_key_in_hand = true;
                look_at_selected(choice);
            }
            Action::Drop => {
                choice.is_key_in_hand = false;
                document.commit();
            }
            Action::AddKey => match document.scene_mut().add_last() {
                Some(id) => {
                    document.commit();
                    document.select(id);
                    choice.player.is_playing = false;
                }
                None => self
                    .session
                    .status
                    .note("The timeline has no room for another key"),
            },
            Action::RemoveKey => document.remove_selected(),
            Action::Ease(id, easing) => {
                document.scene_mut().set_easing(id, easing);
                document.commit();
            }
            Action::Interpolate(interpolation) => {
                document.scene_mut().set_interpolation(interpolation);
                document.commit();
            }
            Action::Repeat(repeat) => {
                document.scene_mut().set_repeat(repeat);
                document.commit();
            }
            _ => {}
        }
    }

    /// What the body shows now becomes a key, to be drawn further.
    fn key_here(&mut self) {
        let Some(choice) = self.session.choice() else {
            return;
        };
        let figure = self.models.get(choice.body).ok();
        let made = figure
            .and_then(|figure| self.inference.get_mut(&figure.0))
            .ok_or_else(|| "The model is not ready yet".to_owned())
            .and_then(|ready| key_of_present(choice, ready));
        let (time_s, ink) = match made {
            Ok(made) => made,
            Err(problem) => return self.session.status.note(problem),
        };
        let Some(choice) = self.session.choice_mut() else {
            return;
        };
        match choice.document.scene_mut().insert(time_s, ink) {
            Some(id) => {
                choice.document.commit();
                choice.document.select(id);
                choice.player.seek(time_s);
            }
            None => self.session.status.note("There is a key here already"),
        }
    }
}

/// The time of the playhead, and the drawing of the body there.
fn key_of_present(choice: &Choice, ready: &mut ReadyModel) -> Result<(f32, Ink), String> {
    let (performance, scene) = (&choice.performance, choice.document.scene());
    let (Some(course), Some((_, beside))) = (performance.course(), scene.complete().next()) else {
        return Err("Draw a source and a target first".to_owned());
    };
    let time_s = course.folded(choice.player.time_s);
    let mut latent = vec![];
    performance.sample_into(time_s, &mut latent);
    let sketch =
        drawing_beside(&mut ready.inference, &latent, beside).map_err(|error| error.to_string())?;
    Ok((time_s, Ink::of_sketch(sketch)))
}
