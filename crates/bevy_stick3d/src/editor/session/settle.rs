//! Between the pens and the documents: what was drawn is taken in, and what is looked at is laid out.

use bevy::prelude::*;

use super::super::timeline::state::{KeyId, Scene};
use super::{Choice, Desk, Mode};
use crate::sketch_input::{Ink, SketchCanvas, SketchDrawing};

pub(super) type Canvases<'w, 's> =
    Query<'w, 's, (&'static mut SketchCanvas, &'static mut SketchDrawing)>;

impl Desk<'_, '_> {
    /// Takes what was drawn since into the document.
    pub(in super::super) fn settle(&mut self) {
        let mode = self.session.mode;
        let Some(choice) = self.session.choice_mut() else {
            return;
        };
        let taken = take_ink(choice, &self.canvases);
        if taken.completed && mode == Mode::Animate {
            if choice.document.scene().can_move() {
                choice.player.start();
            } else if let Some(next) = first_blank(choice.document.scene()) {
                choice.document.select(next);
            }
        }
        if taken.needs_layout || taken.completed {
            self.lay_out(false);
        }
    }

    /// Puts the keys that are looked at on the canvases. `is_anew`: also those that are there.
    pub(super) fn lay_out(&mut self, is_anew: bool) {
        let (active, mode) = (self.session.active, self.session.mode);
        for (index, choice) in self.session.choices.iter_mut().enumerate() {
            let is_shown = index == active;
            if is_shown || is_anew {
                let is_other = lay_out_choice(choice, mode, is_shown, is_anew, &mut self.canvases);
                if is_other {
                    choice.recall_body(&mut self.bodies);
                }
            }
            if let Ok(mut edited) = self.figures.get_mut(choice.body)
                && edited.is_shown != is_shown
            {
                edited.is_shown = is_shown;
            }
        }
    }

    /// A pen that is down stays with what it drew.
    pub(super) fn lift_pens(&mut self) {
        let Some(choice) = self.session.choice() else {
            return;
        };
        for slot in choice.slots {
            if let Ok((_, mut drawing)) = self.canvases.get_mut(slot.canvas) {
                drawing.cancel();
                drawing.leave();
            }
        }
    }
}

/// What the pens did.
#[derive(Clone, Copy, Debug, Default)]
struct Taken {
    /// A drawing has become complete.
    completed: bool,
    /// Another key is looked at.
    needs_layout: bool,
}

fn take_ink(choice: &mut Choice, canvases: &Canvases) -> Taken {
    let mut taken = Taken::default();
    let mut changed = false;
    let mut taken_back = false;
    choice.is_joint_in_hand = false;
    for slot in choice.slots {
        let (Some(id), Ok((_, drawing))) = (slot.key, canvases.get(slot.canvas)) else {
            continue;
        };
        let is_dragging = drawing.dragged().is_some();
        choice.is_joint_in_hand |= is_dragging;
        if is_dragging || drawing.pen_stroke().is_some() {
            taken.needs_layout |= choice.document.selected() != id;
            choice.document.select(id);
            look_at_selected(choice);
        }
        let document = &mut choice.document;
        let Some(key) = document.scene().key(id) else {
            continue;
        };
        if key.ink == *drawing.ink() {
            continue;
        }
        let is_complete = drawing.sketch().is_some();
        taken.completed |= is_complete && key.sketch().is_none();
        taken_back |= drawing.strokes().len() < key.ink.strokes.len();
        changed = true;
        document.scene_mut().set_ink(id, drawing.ink().clone());
        if !is_complete {
            choice.player.is_playing = false;
        }
    }
    // A drag is one step, when it ends.
    let document = &mut choice.document;
    match (choice.is_joint_in_hand || choice.is_key_in_hand, taken_back) {
        (true, _) => {}
        (false, true) if changed => document.commit_taken_back(),
        (false, _) => document.commit(),
    }
    taken
}

/// A motion that stands still shows the selected key.
pub(super) fn look_at_selected(choice: &mut Choice) {
    let document = &choice.document;
    if let Some(key) = document.scene().key(document.selected())
        && key.sketch().is_some()
        && !choice.player.is_playing
    {
        choice.player.seek(key.time_s);
    }
}

fn first_blank(scene: &Scene) -> Option<KeyId> {
    let mut keys = scene.keys().iter();
    keys.find(|key| key.sketch().is_none()).map(|key| key.id)
}

/// The keys on the canvases: two neighbours, of which one is selected. Those that are there stay while they can.
fn keys_to_show(choice: &Choice, mode: Mode) -> [Option<KeyId>; 2] {
    let document = &choice.document;
    let keys = document.scene().keys();
    if mode == Mode::Pose {
        return [Some(document.selected()), None];
    }
    let shown = choice.slots.map(|slot| slot.key);
    let places = shown.map(|key| document.scene().index_of(key?));
    if let [Some(from), Some(to)] = places
        && to == from + 1
        && shown.contains(&Some(document.selected()))
    {
        return shown;
    }
    let to = document.selected_index().max(1);
    [keys.get(to - 1), keys.get(to)].map(|key| key.map(|key| key.id))
}

/// Says whether the body follows another drawing now.
fn lay_out_choice(
    choice: &mut Choice,
    mode: Mode,
    is_shown: bool,
    is_anew: bool,
    canvases: &mut Canvases,
) -> bool {
    let mut is_other_body = is_anew;
    let keys = keys_to_show(choice, mode);
    let document = &choice.document;
    for (slot, key) in choice.slots.iter_mut().zip(keys) {
        let Ok((mut canvas, mut drawing)) = canvases.get_mut(slot.canvas) else {
            continue;
        };
        let is_enabled = is_shown && key.is_some();
        if canvas.enabled != is_enabled {
            canvas.enabled = is_enabled;
        }
        let figure = (key == Some(document.selected())).then_some(choice.body);
        let poses_now = figure.is_some() && canvas.figure != figure;
        if canvas.figure != figure {
            canvas.figure = figure;
        }
        let is_other = slot.key != key;
        is_other_body |= poses_now || (is_other && figure.is_some());
        slot.key = key;
        let ink = key.and_then(|id| document.scene().key(id));
        let ink = ink.map_or(Ink::default(), |key| key.ink.clone());
        if is_other || is_anew || *drawing.ink() != ink {
            drawing.put_ink(ink);
        } else if poses_now && drawing.pen_stroke().is_none() && drawing.dragged().is_none() {
            // What it shows is told again, now to the body.
            drawing.put_ink(ink);
        }
    }
    is_other_body
}
