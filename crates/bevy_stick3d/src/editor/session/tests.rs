//! The editor without a screen.

mod animation;
mod bodies;

use std::path::Path;
use std::time::Duration;

use bevy::asset::AssetPlugin;
use bevy::ecs::system::RunSystemOnce;
use bevy::time::TimeUpdateStrategy;
use stick3d_model::files::write_atomically;

use super::super::files::{read_sketch, write_sketch};
use super::*;
use crate::{EMBEDDED_MODELS, Stick3dPlugin, StickSketch};

/// Seconds of a frame.
const FRAME_S: f32 = 1.0 / 60.0;

/// The editor without a screen, with all embedded figures.
fn app(sketch: Option<FirstSketch>) -> App {
    let figures = EMBEDDED_MODELS
        .iter()
        .map(|embedded| EditorFigure::new(embedded.model().unwrap().clone()))
        .collect();
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        AssetPlugin::default(),
        TransformPlugin,
        Stick3dPlugin,
        SessionPlugin(Opening {
            figures,
            first: 0,
            sketch,
            clip: None,
            yaw_rad: None,
            order: DrawingOrder::Any,
        }),
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(
        FRAME_S,
    )));
    app.finish();
    app.cleanup();
    app.update();
    app
}

/// Does something at the desk, and lets a frame pass.
fn at_desk<T: Send + Sync + 'static>(
    app: &mut App,
    work: impl Fn(&mut Desk) -> T + Send + Sync + 'static,
) -> T {
    let done = app
        .world_mut()
        .run_system_once(move |mut desk: Desk| work(&mut desk))
        .unwrap();
    app.update();
    done
}

fn drop_file(app: &mut App, path: &Path) {
    app.world_mut().write_message(FileDragAndDrop::DroppedFile {
        window: Entity::PLACEHOLDER,
        path_buf: path.to_owned(),
    });
    app.update();
}

fn active(app: &App) -> &Choice {
    app.world().resource::<Session>().choice().unwrap()
}

fn shown(app: &App) -> Option<StickSketch> {
    app.world().get::<StickSketch>(active(app).body).cloned()
}

fn sketch_file(folder: &Path, figure: &Figure, stretch: f32) -> PathBuf {
    let mut points = figure.template.clone();
    points[0].y += stretch;
    let sketch = Sketch::new(figure, points).unwrap();
    let path = folder.join(format!("{}.json", figure.name));
    write_sketch(&path, figure, &sketch).unwrap();
    path
}

#[test]
fn a_dropped_sketch_brings_its_figure() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = app(None);
    assert_eq!(shown(&app), None);
    let man = sketch_file(folder.path(), Figure::human(), 0.1);
    drop_file(&mut app, &man);
    assert_eq!(active(&app).figure.figure().name, "human");
    let of_man = shown(&app).unwrap();

    let horse = sketch_file(folder.path(), Figure::horse(), 0.1);
    app.world_mut().write_message(FileDragAndDrop::HoveredFile {
        window: Entity::PLACEHOLDER,
        path_buf: horse.clone(),
    });
    app.update();
    assert!(app.world().resource::<Session>().is_drop_hovering);
    drop_file(&mut app, &horse);
    let session = app.world().resource::<Session>();
    assert!(!session.is_drop_hovering);
    assert_eq!(active(&app).figure.figure().name, "horse");
    assert_eq!(active(&app).files.sketch, horse.display().to_string());
    let (said, is_problem) = session.status.shown().unwrap();
    assert!(said.starts_with("Opened") && !is_problem, "{said}");
    assert_eq!(shown(&app).unwrap().points.len(), 12);

    at_desk(&mut app, |desk| desk.act(Action::Choose(0)));
    assert_eq!(shown(&app).unwrap(), of_man);
    assert_eq!(active(&app).files.sketch, man.display().to_string());
}

#[test]
fn a_dropped_file_that_is_no_sketch_is_named_and_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = app(None);
    drop_file(&mut app, &sketch_file(folder.path(), Figure::human(), 0.1));
    let before = (shown(&app).unwrap(), active(&app).files.sketch.clone());
    let bad = [
        ("text.json", "this is no sketch"),
        ("dragon.json", r#"{"figure": "dragon", "joints": {}}"#),
        (
            "short.json",
            r#"{"figure": "horse", "joints": {"hip": [0, 1]}}"#,
        ),
        ("nan.json", r#"{"figure": "human", "path": [[NaN, 0]]}"#),
    ];
    for (name, text) in bad {
        let path = folder.path().join(name);
        write_atomically(&path, text.as_bytes()).unwrap();
        drop_file(&mut app, &path);
        let status = app.world().resource::<Session>().status.clone();
        let (said, is_problem) = status.shown().unwrap();
        assert!(is_problem && said.contains(name), "{said}");
        assert_eq!(
            (shown(&app).unwrap(), active(&app).files.sketch.clone()),
            before
        );
        assert_eq!(active(&app).figure.figure().name, "human");
    }
    drop_file(&mut app, &folder.path().join("missing.json"));
    let status = app.world().resource::<Session>().status.clone();
    assert!(status.shown().unwrap().0.contains("missing.json"));
    at_desk(&mut app, |desk| desk.act(Action::Undo));
    assert_eq!(shown(&app), None, "the one step there was can be undone");
}

#[test]
fn each_figure_keeps_its_strokes_its_history_and_its_view() {
    let mut app = app(None);
    at_desk(&mut app, |desk| {
        desk.edited_mut().unwrap().orbit.yaw_rad = 1.0;
        let mut drawing = desk.drawing_mut().unwrap();
        drawing.press(Vec2::new(0.0, 300.0), 0.0);
        drawing.move_to(Vec2::new(0.0, 200.0), 0.1);
        drawing.release();
        drawing.press(Vec2::new(0.0, 200.0), 0.2);
    });
    at_desk(&mut app, |desk| {
        desk.act(Action::Choose(1));
        assert!(desk.drawing().unwrap().strokes().is_empty());
        assert!(!desk.drawing().unwrap().can_undo());
        assert!(desk.canvas_mut(0).unwrap().enabled);
        assert_ne!(desk.edited_mut().unwrap().orbit.yaw_rad, 1.0);
        desk.act(Action::Choose(99));
    });
    assert_eq!(active(&app).figure.figure().name, "horse");
    at_desk(&mut app, |desk| {
        desk.act(Action::Choose(0));
        let drawing = desk.drawing().unwrap();
        assert_eq!(drawing.strokes().len(), 1);
        assert!(drawing.can_undo() && drawing.pen_stroke().is_none());
        assert_eq!(desk.edited_mut().unwrap().orbit.yaw_rad, 1.0);
    });
    let enabled = app
        .world_mut()
        .query::<&SketchCanvas>()
        .iter(app.world())
        .filter(|canvas| canvas.enabled)
        .count();
    assert_eq!(enabled, 1);
}

#[test]
fn saving_goes_to_a_file_of_the_figure() {
    let folder = tempfile::tempdir().unwrap();
    let first = FirstSketch {
        figure: 1,
        sketch: Sketch::template(Figure::horse()),
        file: folder.path().join("mine.json"),
    };
    let mut app = app(Some(first.clone()));
    assert_eq!(active(&app).files.sketch, "human_sketch.json");
    at_desk(&mut app, |desk| {
        desk.act(Action::Choose(1));
        desk.act(Action::Save);
    });
    let (index, saved) = read_sketch(&first.file, &[Figure::human(), Figure::horse()]).unwrap();
    assert_eq!((index, saved.points().len()), (1, 12));
}
