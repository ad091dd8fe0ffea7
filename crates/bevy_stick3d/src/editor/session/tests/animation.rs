//! The animation mode without a screen.

use stick3d_figure::{Figure, Sketch};
use stick3d_model::latent::{ClipFile, ClipKey, ClipPose, MotionSettings};

use super::*;
use crate::{Grounded, Latent};

/// The template with its first joint moved to the right, in canvas units.
fn points(figure: &Figure, by: f32) -> Vec<Vec2> {
    let mut points = crate::sketch_input::fit_to_canvas(&[&figure.template]).remove(0);
    points[0].x += by;
    points
}

/// Draws on a canvas as a pen does, a stroke per bone along the path, but for the last `left_out` strokes.
fn draw(drawing: &mut SketchDrawing, by: f32, left_out: usize) {
    let figure = drawing.figure().clone();
    let points = points(&figure, by);
    let mut drawn: Vec<[usize; 2]> = vec![];
    for pair in figure.path.windows(2) {
        let bone = [pair[0], pair[1]];
        if !drawn.contains(&bone) && !drawn.contains(&[bone[1], bone[0]]) {
            drawn.push(bone);
        }
    }
    let done = drawing.strokes().len();
    let count = drawn.len() - left_out;
    for (index, [from, to]) in drawn.into_iter().enumerate().take(count).skip(done) {
        let (from, to, start_s) = (points[from], points[to], index as f64);
        drawing.press(from, start_s);
        for step in 1..=12 {
            let at = from.lerp(to, step as f32 / 12.0);
            drawing.move_to(at, start_s + 0.03 * f64::from(step));
        }
        drawing.release();
    }
}

fn slot_drawing(app: &mut App, slot: usize, work: impl FnOnce(&mut SketchDrawing)) {
    let canvas = active(app).slots[slot].canvas;
    work(&mut app.world_mut().get_mut::<SketchDrawing>(canvas).unwrap());
    app.update();
}

fn latent(app: &App) -> Vec<f32> {
    let body = active(app).body;
    app.world().get::<Latent>(body).unwrap().0.clone()
}

fn latent_at(app: &App, time_s: f32) -> Vec<f32> {
    let mut latent = vec![];
    assert!(active(app).performance.sample_into(time_s, &mut latent));
    latent
}

fn act(app: &mut App, action: Action) {
    at_desk(app, move |desk| desk.act(action));
}

fn said(app: &App) -> (String, bool) {
    let status = &app.world().resource::<Session>().status;
    let (text, is_problem) = status.shown().unwrap_or_default();
    (text.to_owned(), is_problem)
}

fn ids(app: &App) -> Vec<KeyId> {
    let keys = active(app).document.scene().keys().iter();
    keys.map(|key| key.id).collect()
}

/// The animation mode with a source and a target, at rest at the source.
fn animated() -> App {
    let mut app = app(None);
    act(&mut app, Action::Switch(Mode::Animate));
    for slot in [0, 1] {
        for left_out in [1, 0] {
            slot_drawing(&mut app, slot, |drawing| {
                draw(drawing, 150.0 * slot as f32, left_out);
            });
        }
    }
    act(&mut app, Action::Seek(0.0));
    app
}

#[test]
fn the_motion_starts_in_the_frame_after_the_last_stroke() {
    let mut app = app(None);
    act(&mut app, Action::Switch(Mode::Animate));
    slot_drawing(&mut app, 0, |drawing| draw(drawing, 0.0, 0));
    assert_eq!(active(&app).document.selected_index(), 1, "now the target");
    assert!(!active(&app).player.is_playing);
    slot_drawing(&mut app, 1, |drawing| draw(drawing, 150.0, 1));
    assert!(active(&app).performance.motion().is_none());
    slot_drawing(&mut app, 1, |drawing| draw(drawing, 150.0, 0));
    assert!(active(&app).player.is_playing);
    assert_eq!(active(&app).player.time_s, 0.0);
    let start = latent(&app);
    assert_eq!(start, latent_at(&app, 0.0));
    app.update();
    assert!((active(&app).player.time_s - FRAME_S).abs() < 1e-5);
    assert_eq!(latent(&app), latent_at(&app, active(&app).player.time_s));
    assert_ne!(latent(&app), start);
    assert!(!app.world().get::<Grounded>(active(&app).body).unwrap().0);
}

#[test]
fn once_it_runs_past_the_last_key_and_stops() {
    let mut app = animated();
    let end_s = active(&app).performance.course().unwrap().end_s;
    assert!(end_s > 1.0, "there is something beyond the last key");
    act(&mut app, Action::Seek(end_s - 0.05));
    act(&mut app, Action::Play);
    for _ in 0..10 {
        app.update();
    }
    let choice = active(&app);
    assert_eq!(
        (choice.player.time_s, choice.player.is_playing),
        (end_s, false)
    );
    assert!(choice.performance.motion().unwrap().is_beyond(end_s));
}

#[test]
fn scrubbing_shows_the_time_and_nothing_more_moves() {
    let mut app = animated();
    act(&mut app, Action::Seek(0.5));
    assert_eq!(latent(&app), latent_at(&app, 0.5));
    let body = active(&app).body;
    let changed = |app: &App| {
        let entity = app.world().entity(body);
        entity.get_change_ticks::<Latent>().unwrap().changed
    };
    let before = changed(&app);
    for _ in 0..3 {
        app.update();
    }
    assert_eq!(changed(&app), before);
    assert_eq!(active(&app).player.time_s, 0.5);
}

#[test]
fn a_loop_begins_anew() {
    let mut app = animated();
    act(&mut app, Action::Repeat(Repeat::Loop { closing_s: None }));
    let course = active(&app).performance.course().unwrap();
    assert!(
        (course.end_s - 2.0).abs() < 1e-5,
        "the way back takes as long"
    );
    act(&mut app, Action::Seek(course.end_s - 0.02));
    act(&mut app, Action::Play);
    for _ in 0..6 {
        app.update();
    }
    let clock_s = active(&app).player.time_s;
    assert!(clock_s > course.end_s && active(&app).player.is_playing);
    assert!(course.folded(clock_s) < 0.2);
    assert_eq!(latent(&app), latent_at(&app, clock_s));
}

#[test]
fn undo_covers_the_drawings_and_the_timeline() {
    let mut app = animated();
    let [source, target] = ids(&app)[..] else {
        panic!("two keys");
    };
    let scene = |app: &App| active(app).document.scene().clone();
    let drawn = scene(&app);
    for time_s in [1.2, 1.7, 2.5] {
        act(&mut app, Action::Retime(target, time_s));
    }
    act(&mut app, Action::Drop);
    let retimed = scene(&app);
    assert_eq!(retimed.keys()[1].time_s, 2.5);
    act(&mut app, Action::Ease(source, Easing::InOut));
    act(&mut app, Action::AddKey);
    act(&mut app, Action::RemoveKey);
    act(&mut app, Action::Undo);
    act(&mut app, Action::Undo);
    act(&mut app, Action::Undo);
    assert_eq!(scene(&app), retimed);
    act(&mut app, Action::Undo);
    assert_eq!(scene(&app), drawn, "one drag is one step");
    act(&mut app, Action::Undo);
    assert!(!scene(&app).can_move(), "the last stroke of the target");
    assert!(active(&app).performance.motion().is_none());
    let slot = active(&app).slots[1];
    let drawing = app.world().get::<SketchDrawing>(slot.canvas).unwrap();
    assert!(drawing.sketch().is_none() && !drawing.strokes().is_empty());
    act(&mut app, Action::Redo);
    assert_eq!(scene(&app), drawn);
}

#[test]
fn a_step_that_a_pose_does_not_show_brings_the_timeline_back() {
    let mut app = animated();
    let target = ids(&app)[1];
    act(&mut app, Action::Retime(target, 2.0));
    act(&mut app, Action::Drop);
    act(&mut app, Action::Switch(Mode::Pose));
    act(&mut app, Action::Undo);
    assert_eq!(app.world().resource::<Session>().mode(), Mode::Animate);
    assert_eq!(active(&app).document.scene().keys()[1].time_s, 1.0);
}

#[test]
fn the_motion_follows_a_dragged_joint() {
    let mut app = animated();
    let target = ids(&app)[1];
    act(&mut app, Action::Select(target));
    assert_eq!(active(&app).player.time_s, 1.0);
    let before = latent(&app);
    let joint = points(Figure::human(), 150.0)[3];
    slot_drawing(&mut app, 1, |drawing| {
        drawing.press(joint, 0.0);
        drawing.move_to(joint + Vec2::new(-80.0, 160.0), 0.1);
    });
    let dragged = latent(&app);
    assert_ne!(dragged, before);
    assert!(
        active(&app).performance.motion().is_none(),
        "not while in hand"
    );
    assert!(!active(&app).document.can_redo());
    slot_drawing(&mut app, 1, SketchDrawing::release);
    assert!(active(&app).performance.motion().is_some());
    assert_eq!(latent(&app), dragged);
    act(&mut app, Action::Undo);
    assert_eq!(latent(&app), before);
}

#[test]
fn a_pose_of_the_motion_becomes_a_key() {
    let mut app = animated();
    act(&mut app, Action::KeyHere);
    assert!(said(&app).0.contains("already"), "{}", said(&app).0);
    act(&mut app, Action::Seek(0.5));
    act(&mut app, Action::KeyHere);
    let choice = active(&app);
    assert_eq!(choice.document.selected_index(), 1);
    let scene = choice.document.scene();
    assert_eq!(scene.keys().len(), 3);
    let sketch = scene.keys()[1].sketch().unwrap();
    let size = |sketch: &Sketch| sketch.scale(Figure::human());
    let ratio = size(sketch) / size(scene.keys()[0].sketch().unwrap());
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    act(&mut app, Action::RemoveKey);
    assert_eq!(ids(&app).len(), 2);
}

#[test]
fn a_pose_is_a_pose_again() {
    let mut app = animated();
    act(&mut app, Action::Seek(0.6));
    let moving = latent(&app);
    act(&mut app, Action::Switch(Mode::Pose));
    app.update();
    let body = active(&app).body;
    assert_ne!(latent(&app), moving);
    assert!(app.world().get::<Grounded>(body).unwrap().0);
    let place = app.world().get::<Transform>(body).unwrap().translation;
    assert_eq!(place, Vec3::ZERO);
    assert_eq!(shown(&app).unwrap().points.len(), 11);
}

#[test]
fn a_saved_clip_is_the_same_when_it_is_dropped_on_the_window() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lean.clip.ron");
    let mut app = animated();
    let source = ids(&app)[0];
    act(&mut app, Action::Ease(source, Easing::Out));
    let file = path.display().to_string();
    at_desk(&mut app, move |desk| desk.session.set_file(file.clone()));
    act(&mut app, Action::Save);
    assert!(said(&app).0.starts_with("Saved"), "{}", said(&app).0);
    let saved = active(&app).document.scene().complete().count();

    let mut other = super::app(None);
    act(&mut other, Action::Choose(1));
    drop_file(&mut other, &path);
    assert!(said(&other).0.starts_with("Opened"), "{}", said(&other).0);
    assert_eq!(active(&other).figure.figure().name, "human");
    assert_eq!(other.world().resource::<Session>().mode(), Mode::Animate);
    assert_eq!(active(&other).document.scene().keys().len(), saved);
    let [a, b] = [&app, &other].map(|app| active(app).document.scene().keys());
    for (a, b) in a.iter().zip(b) {
        assert_eq!(
            (a.time_s, a.easing, a.sketch()),
            (b.time_s, b.easing, b.sketch())
        );
    }
    assert!(active(&other).player.is_playing);
    act(&mut other, Action::Undo);
    assert!(!active(&other).document.scene().can_move());
}

#[test]
fn a_clip_that_is_none_is_named_and_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = animated();
    let before = active(&app).document.scene().clone();
    let pose = || ClipPose::of_sketch(Figure::human(), &Sketch::template(Figure::human()));
    let clip = |figure: &str, times: &[f32]| {
        let mut clip = ClipFile::new(figure, MotionSettings::default());
        clip.keys = times
            .iter()
            .map(|time_s| ClipKey {
                time_s: *time_s,
                easing: Easing::Linear,
                pose: pose(),
            })
            .collect();
        clip.to_ron().unwrap()
    };
    let bad = [
        ("one.clip.ron", clip("human", &[0.0]), "at least two keys"),
        ("equal.clip.ron", clip("human", &[1.0, 1.0]), "both at 1 s"),
        (
            "order.clip.ron",
            clip("human", &[1.0, 0.5]),
            "sort the keys",
        ),
        ("horse.clip.ron", clip("horse", &[0.0, 1.0]), "key 1"),
        (
            "other.clip.ron",
            clip("hunam", &[0.0, 1.0]),
            "mean \"human\"?",
        ),
        ("text.clip.ron", "no clip".to_owned(), "line 1"),
    ];
    for (name, text, expected) in bad {
        let path = folder.path().join(name);
        write_atomically(&path, text.as_bytes()).unwrap();
        drop_file(&mut app, &path);
        let (text, is_problem) = said(&app);
        assert!(is_problem && text.contains(expected), "{name}: {text}");
        assert_eq!(active(&app).document.scene(), &before);
        assert_eq!(active(&app).figure.figure().name, "human");
    }
    act(&mut app, Action::Play);
    assert!(active(&app).player.is_playing, "it goes on");
}

#[test]
fn the_horse_moves_too() {
    let mut app = app(None);
    act(&mut app, Action::Choose(1));
    act(&mut app, Action::Switch(Mode::Animate));
    for slot in [0, 1] {
        slot_drawing(&mut app, slot, |drawing| {
            draw(drawing, 80.0 * slot as f32, 0);
        });
    }
    assert!(active(&app).player.is_playing);
    let ghosts = active(&app).ghosts;
    act(&mut app, Action::Seek(0.5));
    let is_shown =
        |app: &App| ghosts.map(|ghost| app.world().get(ghost) == Some(&Visibility::Inherited));
    assert_eq!(is_shown(&app), [true, true]);
    act(&mut app, Action::Seek(0.0));
    assert_eq!(is_shown(&app), [false, true], "none inside the body");
    act(&mut app, Action::Ghosts);
    assert_eq!(is_shown(&app), [false, false]);
}

#[test]
fn a_motion_is_written_while_the_editor_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = animated();
    let target = ids(&app)[1];
    act(&mut app, Action::Retime(target, 0.2));
    act(&mut app, Action::Drop);
    let file = folder.path().join("lean.clip.ron").display().to_string();
    at_desk(&mut app, move |desk| desk.session.set_file(file.clone()));
    act(&mut app, Action::Export);
    // It may be written already: it is written beside the app.
    let begun = said(&app).0;
    let is_begun = ["Writing", "Exported"].map(|word| begun.starts_with(word));
    assert!(is_begun.contains(&true), "{begun}");
    for _ in 0..6000 {
        app.update();
        if said(&app).0.starts_with("Exported") {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(said(&app).0.contains("lean.glb"), "{}", said(&app).0);
    let bytes = std::fs::read(folder.path().join("lean.glb")).unwrap();
    assert_eq!(&bytes[..4], b"glTF");

    let nowhere = folder.path().join("no/such/folder/x.clip.ron");
    let file = nowhere.display().to_string();
    at_desk(&mut app, move |desk| desk.session.set_file(file.clone()));
    act(&mut app, Action::Export);
    for _ in 0..6000 {
        app.update();
        if said(&app).1 {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(said(&app).0.contains("was not written"), "{}", said(&app).0);
}
