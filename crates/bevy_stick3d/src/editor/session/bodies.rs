//! Between the bodies that drawings may mean and the documents: which is shown is part of what can be undone.

use bevy::prelude::*;

use super::super::timeline::state::ChosenBody;
use super::{Action, Choice, Desk, Mode, Session};
use crate::{ChooseAlternative, FlipLimb, SketchAlternatives};

pub(super) type Bodies<'w, 's> = Query<'w, 's, &'static mut SketchAlternatives>;

impl Desk<'_, '_> {
    /// The bodies that the selected drawing may mean, once it is complete.
    pub(in super::super) fn alternatives(&self) -> Option<&SketchAlternatives> {
        let choice = self.session.choice()?;
        choice.selected_sketch()?;
        let alternatives = self.bodies.get(choice.body).ok()?;
        alternatives.shown().map(|_| alternatives)
    }

    /// Asks for another body of the selected drawing.
    pub(super) fn choose_body(&mut self, action: Action) {
        let (Some(alternatives), Some(figure)) = (self.alternatives(), self.session.body()) else {
            return;
        };
        let count = alternatives.as_slice().len().max(1);
        let index = match (action, alternatives.chosen()) {
            (Action::Alternative(index), _) => index,
            (Action::NextAlternative, Some(index)) => (index + 1) % count,
            (Action::LastAlternative, Some(index)) => (index + count - 1) % count,
            _ => 0,
        };
        self.choose.write(ChooseAlternative { figure, index });
    }

    /// Asks for the body with a limb's depth the other way round.
    pub(super) fn flip(&mut self, joint: usize) {
        if let Some(figure) = self
            .session
            .body()
            .filter(|_| self.alternatives().is_some())
        {
            self.flips.write(FlipLimb { figure, joint });
        }
    }

    /// Takes the body that is shown of the selected drawing into the document: a step where the user chose it.
    fn settle_body(&mut self, is_flip_asked: bool) {
        let mode = self.session.mode;
        let Some(choice) = self.session.choice_mut() else {
            return;
        };
        let Ok(alternatives) = self.bodies.get(choice.body) else {
            return;
        };
        let is_chosen = alternatives.choices() != choice.body_choices;
        choice.body_choices = alternatives.choices();
        let (Some(shown), Some(_)) = (alternatives.shown(), choice.selected_sketch()) else {
            return;
        };
        if alternatives.has_wish() {
            return;
        }
        let is_first = alternatives.chosen() == Some(0);
        let body = (!is_first).then_some(&*shown.latent);
        let (document, is_in_hand) = (&mut choice.document, choice.is_joint_in_hand);
        let selected = document.selected();
        let before = document
            .scene()
            .key(selected)
            .and_then(|key| key.body.as_deref());
        if before != body {
            let body = body.map(ChosenBody::from);
            document.scene_mut().set_body(selected, body);
            match (is_chosen, is_in_hand) {
                (true, _) => document.commit(),
                (false, true) => {}
                (false, false) => document.amend(),
            }
        }
        if is_flip_asked && !is_chosen && mode == Mode::Pose {
            self.session
                .status
                .note("No body has that limb the other way round");
        }
    }
}

impl Choice {
    fn selected_sketch(&self) -> Option<&stick3d_figure::Sketch> {
        let document = &self.document;
        document.scene().key(document.selected())?.sketch()
    }

    /// The drawing that the body follows is another: the body is shown that was chosen for it.
    pub(super) fn recall_body(&self, bodies: &mut Bodies) {
        let key = self.document.scene().key(self.document.selected());
        let (Some(key), Ok(mut alternatives)) = (key, bodies.get_mut(self.body)) else {
            return;
        };
        match &key.body {
            Some(latent) => alternatives.take_body(latent),
            None => alternatives.take_first(),
        }
    }
}

/// Whether a limb of the body was to be turned round.
pub(super) fn is_flip_asked(session: Res<Session>, mut flips: MessageReader<FlipLimb>) -> bool {
    let body = session.body();
    flips
        .read()
        .filter(|flip| Some(flip.figure) == body)
        .count()
        > 0
}

/// What was chosen becomes part of the document. Runs after drawings were encoded.
pub(super) fn settle_bodies(In(is_flip_asked): In<bool>, mut desk: Desk) {
    desk.settle_body(is_flip_asked);
}
