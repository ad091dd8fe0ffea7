//! Choosing among the bodies that a drawing may mean, without a screen.
#![allow(clippy::print_stdout, reason = "a test may say why it skips")]

use stick3d_model::Alternative;

use super::*;
use crate::{Latent, SketchAlternatives};

fn act(app: &mut App, action: Action) {
    at_desk(app, move |desk| desk.act(action));
}

/// The editor with a walking man on its canvas.
fn walking() -> App {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/sketches/walk.json"
    );
    let (figure, sketch) = read_sketch(Path::new(path), &[Figure::human()]).unwrap();
    let mut app = app(Some(FirstSketch {
        figure,
        sketch,
        file: PathBuf::from("walk.json"),
    }));
    app.update();
    app
}

/// Whether the model gives several bodies for the sketch; says so if not.
fn has_several(app: &App) -> bool {
    let count = alternatives(app).as_slice().len();
    if count < 2 {
        println!("skipped: the model gives one body for this sketch");
    }
    count > 1
}

fn alternatives(app: &App) -> &SketchAlternatives {
    app.world().get(active(app).body).unwrap()
}

fn body(app: &App) -> Alternative {
    let shown = alternatives(app).shown().unwrap().clone();
    let latent = &app.world().get::<Latent>(active(app).body).unwrap().0;
    assert_eq!(&shown.latent, latent, "what is told is what is shown");
    shown
}

/// Does something with the pen, and lets a frame pass.
fn pen(app: &mut App, work: impl FnOnce(&mut SketchDrawing)) {
    let canvas = active(app).slots[0].canvas;
    work(&mut app.world_mut().get_mut::<SketchDrawing>(canvas).unwrap());
    app.update();
}

fn place(app: &App, name: &str) -> Vec2 {
    let drawing: &SketchDrawing = app.world().get(active(app).slots[0].canvas).unwrap();
    drawing.sketch().unwrap().points()[Figure::human().joint_index(name).unwrap()]
}

#[test]
fn bodies_are_gone_through_and_undo_brings_them_back() {
    let mut app = walking();
    if !has_several(&app) {
        return;
    }
    let count = alternatives(&app).as_slice().len();
    let first = body(&app);
    assert_eq!(alternatives(&app).chosen(), Some(0));
    let mut seen = vec![first.clone()];
    for index in 1..count {
        act(&mut app, Action::NextAlternative);
        assert_eq!(alternatives(&app).chosen(), Some(index));
        seen.push(body(&app));
    }
    act(&mut app, Action::NextAlternative);
    assert_eq!(body(&app), first, "and round");
    act(&mut app, Action::LastAlternative);
    assert_eq!(alternatives(&app).chosen(), Some(count - 1));
    act(&mut app, Action::Undo);
    for expected in seen.iter().rev() {
        act(&mut app, Action::Undo);
        assert_eq!(&body(&app), expected);
    }
    act(&mut app, Action::Redo);
    assert_eq!(body(&app), seen[1]);
    act(&mut app, Action::Alternative(99));
    assert_eq!(body(&app), seen[1]);
}

#[test]
fn a_choice_survives_a_drag_which_is_one_step() {
    let mut app = walking();
    if !has_several(&app) {
        return;
    }
    act(&mut app, Action::Alternative(1));
    let chosen = body(&app);
    let hand = place(&app, "hand_r");
    pen(&mut app, |drawing| drawing.press(hand, 0.0));
    let mut before = chosen.clone();
    for step in 1..=20 {
        let at = hand + Vec2::new(1.0, 3.0) * step as f32;
        pen(&mut app, |drawing| drawing.move_to(at, 0.0));
        let now = body(&app);
        assert!(now.distance_m(&before) < 0.05, "step {step}");
        before = now;
    }
    pen(&mut app, SketchDrawing::release);
    app.update();
    let dragged = body(&app);
    assert_ne!(dragged, chosen);
    act(&mut app, Action::Undo);
    assert_eq!(body(&app).latent, chosen.latent);
    assert_eq!(place(&app, "hand_r"), hand, "choice and drag are apart");
    act(&mut app, Action::Redo);
    assert_eq!(body(&app).latent, dragged.latent);
    act(&mut app, Action::Undo);
    act(&mut app, Action::Undo);
    assert_eq!(alternatives(&app).chosen(), Some(0));
}

#[test]
fn a_click_on_a_drawn_bone_turns_the_limb_round() {
    let mut app = walking();
    let limbs = Figure::human().limbs();
    let before = body(&app);
    let mut turned = 0;
    for [from, end] in [
        ["knee_r", "foot_r"],
        ["knee_l", "foot_l"],
        ["elbow_r", "hand_r"],
    ] {
        let at = place(&app, from).midpoint(place(&app, end));
        let end = Figure::human().joint_index(end).unwrap();
        let limb = limbs.iter().find(|limb| limb.end() == end).unwrap();
        let choices = alternatives(&app).choices();
        pen(&mut app, |drawing| {
            drawing.press(at, 0.0);
            drawing.release();
        });
        app.update();
        if alternatives(&app).choices() == choices {
            let said = app.world().resource::<Session>().status.clone();
            assert!(said.shown().unwrap().0.starts_with("No body"));
            continue;
        }
        let after = body(&app);
        assert!(before.toward_viewer_m(limb) * after.toward_viewer_m(limb) < 0.0);
        act(&mut app, Action::Undo);
        assert_eq!(body(&app).latent, before.latent);
        turned += 1;
    }
    assert!(turned > 0 || !has_several(&app));
}

#[test]
fn a_key_keeps_its_body_in_the_animation() {
    let mut app = walking();
    if !has_several(&app) {
        return;
    }
    act(&mut app, Action::Alternative(1));
    let chosen = body(&app);
    act(&mut app, Action::Switch(Mode::Animate));
    let choice = active(&app);
    let selected = choice.document.selected();
    assert_eq!(
        choice.performance.latent_of(selected),
        Some(&*chosen.latent)
    );
    act(&mut app, Action::Switch(Mode::Pose));
    assert_eq!(body(&app).latent, chosen.latent);
    act(&mut app, Action::Clear);
    act(&mut app, Action::Undo);
    assert_eq!(body(&app).latent, chosen.latent);
}
