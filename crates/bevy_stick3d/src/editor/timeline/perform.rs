//! Puts the motion on the body, and the neighbouring keys beside it as ghosts.

use bevy::prelude::*;

use super::super::session::{Choice, Mode, Session};
use super::super::viewport::EditedFigure;
use super::motion::Standing;
use crate::figure::{Grounded, Latent, StickFigure};
use crate::inference::StickInference;
use crate::sketch_input::SketchDrawing;

/// A key nearer in time than this to what is shown has no ghost: it would be inside the body, seconds.
const GHOST_APART_S: f32 = 0.03;

/// The body of a neighbouring key.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ghost {
    /// Of the key before.
    Before,
    /// Of the key after.
    After,
}

type Bodies<'w, 's> = Query<
    'w,
    's,
    (
        &'static StickFigure,
        &'static mut EditedFigure,
        &'static mut Latent,
        &'static mut Grounded,
        &'static mut Transform,
    ),
    Without<Ghost>,
>;

type Ghosts<'w, 's> = Query<
    'w,
    's,
    (
        &'static mut Latent,
        &'static mut Grounded,
        &'static mut Transform,
        &'static mut Visibility,
    ),
    With<Ghost>,
>;

/// Lets time pass, and poses the body that is shown.
pub(crate) fn perform(
    mut session: ResMut<Session>,
    mut inference: ResMut<StickInference>,
    time: Res<Time>,
    drawings: Query<&SketchDrawing>,
    mut bodies: Bodies,
    mut ghosts: Ghosts,
    mut sample: Local<Vec<f32>>,
) {
    let shows_ghosts = session.shows_ghosts;
    let (active, mode) = (session.active(), session.mode());
    for (index, choice) in session.choices_mut().iter_mut().enumerate() {
        let Ok((figure, mut edited, mut latent, mut grounded, mut transform)) =
            bodies.get_mut(choice.body)
        else {
            continue;
        };
        let ready = inference.get_mut(&figure.0);
        let (true, Some(ready)) = (index == active && mode == Mode::Animate, ready) else {
            if edited.is_performing {
                edited.is_performing = false;
                stand(Standing::AT_REST, &edited, &mut grounded, &mut transform);
            }
            hide(&mut ghosts, choice);
            continue;
        };
        let is_in_hand = choice.is_in_hand();
        let scene = choice.document.scene();
        choice.performance.follow(scene, ready, is_in_hand);
        if let Some(course) = choice.performance.course() {
            choice.player.advance(time.delta_secs(), &course);
        }
        let clock_s = choice.player.time_s;
        let shown = Shown::of(choice, &drawings);
        edited.is_performing = shown != Shown::Preview;
        let standing = match shown {
            Shown::Motion => choice.performance.standing(clock_s),
            Shown::Key | Shown::Preview => Standing::AT_REST,
        };
        let has_pose = match shown {
            Shown::Motion => choice.performance.sample_into(clock_s, &mut sample),
            Shown::Key => still(choice, &mut sample),
            Shown::Preview => false,
        };
        if has_pose && latent.0 != *sample {
            latent.0.clone_from(&sample);
        }
        stand(standing, &edited, &mut grounded, &mut transform);
        if shows_ghosts && shown == Shown::Motion {
            show_ghosts(choice, &edited, &mut ghosts);
        } else {
            hide(&mut ghosts, choice);
        }
    }
}

/// What the body shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// The motion at the playhead.
    Motion,
    /// A key that is drawn.
    Key,
    /// The unfinished drawing of the selected key, or nothing where nothing is drawn.
    Preview,
}

impl Shown {
    fn of(choice: &Choice, drawings: &Query<&SketchDrawing>) -> Self {
        let document = &choice.document;
        let is_drawn = document
            .scene()
            .key(document.selected())
            .is_some_and(|key| key.sketch().is_some());
        let has_guess = || {
            let drawing = choice
                .selected_canvas()
                .and_then(|id| drawings.get(id).ok());
            drawing.is_some_and(|drawing| drawing.guess().is_some())
        };
        if !is_drawn && !choice.player.is_playing && has_guess() {
            Self::Preview
        } else if choice.performance.course().is_some() {
            Self::Motion
        } else if choice.performance.first_latent().is_some() {
            Self::Key
        } else {
            Self::Preview
        }
    }
}

/// The pose of the selected key, or of the first that is drawn.
fn still(choice: &Choice, sample: &mut Vec<f32>) -> bool {
    let performance = &choice.performance;
    let latent = performance
        .latent_of(choice.document.selected())
        .or(performance.first_latent());
    if let Some(latent) = latent {
        sample.clear();
        sample.extend_from_slice(latent);
    }
    latent.is_some()
}

fn stand(
    standing: Standing,
    edited: &EditedFigure,
    grounded: &mut Mut<Grounded>,
    transform: &mut Mut<Transform>,
) {
    grounded.set_if_neq(Grounded(standing.on_lowest));
    let mut wanted = edited.scale();
    wanted.translation = standing.translation * wanted.scale;
    transform.set_if_neq(wanted);
}

fn show_ghosts(choice: &Choice, edited: &EditedFigure, ghosts: &mut Ghosts) {
    let neighbours = choice
        .performance
        .neighbours(choice.player.time_s, GHOST_APART_S);
    for (ghost, neighbour) in choice.ghosts.into_iter().zip(neighbours) {
        let Ok((mut latent, mut grounded, mut transform, mut visibility)) = ghosts.get_mut(ghost)
        else {
            continue;
        };
        let Some((clock_s, pose)) = neighbour else {
            visibility.set_if_neq(Visibility::Hidden);
            continue;
        };
        visibility.set_if_neq(Visibility::Inherited);
        if latent.0 != pose {
            latent.0.clear();
            latent.0.extend_from_slice(pose);
        }
        let standing = choice.performance.standing(clock_s);
        stand(standing, edited, &mut grounded, &mut transform);
    }
}

fn hide(ghosts: &mut Ghosts, choice: &Choice) {
    for ghost in choice.ghosts {
        if let Ok((.., mut visibility)) = ghosts.get_mut(ghost) {
            visibility.set_if_neq(Visibility::Hidden);
        }
    }
}
