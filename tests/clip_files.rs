//! Clip files are loaded with their sketches, loaded anew when they change, and named when they are wrong.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

mod support;

use std::path::Path;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy_stick3d::HUMAN_MODEL;
use bevy_stick3d::animation::StartedClip;
use bevy_stick3d::model_data::files::write_atomically;
use bevy_stick3d::prelude::*;
use support::{add_clip, app, app_with, cheer, positions, status, t_pose};

/// A clip file of the man with these keys.
fn clip_text(keys: &str) -> String {
    format!("Clip(figure: \"human\", extrapolation: Hold, keys: [{keys}])")
}

/// A sketch as the clip file writes it.
fn joints(sketch: &StickSketch) -> String {
    let names = Figure::human().joints.iter().map(|joint| &joint.name);
    let points: Vec<String> = names
        .zip(&sketch.points)
        .map(|(name, at)| format!("\"{name}\": ({:?}, {:?})", at.x, at.y))
        .collect();
    format!("Joints({{{}}})", points.join(", "))
}

/// Two keys: arms out, arms up.
fn two_keys() -> String {
    let (a, b) = (joints(&t_pose()), joints(&cheer()));
    format!("(time_s: 0.0, pose: {a}), (time_s: 0.5, pose: {b})")
}

/// Updates until something is so; loading goes on in another thread.
fn update_until(app: &mut App, what: &str, mut is_so: impl FnMut(&mut App) -> bool) {
    let start = Instant::now();
    loop {
        app.update();
        if is_so(app) {
            return;
        }
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "{what} never came"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn plays(app: &App, figure: Entity) -> bool {
    app.world()
        .get::<StartedClip>(figure)
        .unwrap()
        .node()
        .is_some()
}

/// A man who is to play a clip file of a folder.
fn spawn_player(app: &mut App, file: &str) -> Entity {
    let clip = app.world().resource::<AssetServer>().load(file.to_owned());
    app.world_mut()
        .spawn((StickFigure::human(), PlayStickClip(clip)))
        .id()
}

#[test]
fn sketch_files_count_from_the_clips_folder_and_a_change_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        write_atomically(&path, text.as_bytes()).unwrap();
    };
    let sketch_json = |sketch: &StickSketch| {
        let sketch = sketch.to_sketch(Figure::human()).unwrap();
        sketch.to_json(Figure::human()).unwrap()
    };
    write("sketches/out.json", &sketch_json(&t_pose()));
    write("clips/up.json", &sketch_json(&cheer()));
    let keys = "(time_s: 0.0, pose: Sketch(\"../sketches/out.json\")), (time_s: 0.5, pose: Sketch(\"up.json\"))";
    write("clips/raise.clip.ron", &clip_text(keys));

    let mut app = app_with(folder.path(), |_| {});
    let man = spawn_player(&mut app, "clips/raise.clip.ron");
    update_until(&mut app, "the clip", |app| plays(app, man));
    let drawn = app.world_mut().spawn((StickFigure::human(), cheer())).id();
    for _ in 0..35 {
        app.update();
    }
    assert_eq!(positions(&app, man), positions(&app, drawn));
    let animations: Vec<AssetId<AnimationClip>> = app
        .world()
        .resource::<Assets<AnimationClip>>()
        .ids()
        .collect();

    // A sketch file changes, and with it the clip that names it.
    write("clips/up.json", &sketch_json(&t_pose()));
    let before = positions(&app, man);
    app.world()
        .resource::<AssetServer>()
        .reload("clips/raise.clip.ron");
    update_until(&mut app, "the new clip", |app| {
        positions(app, man) != before
    });
    let level = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    app.update();
    assert_eq!(positions(&app, man), positions(&app, level));
    let same: Vec<AssetId<AnimationClip>> = app
        .world()
        .resource::<Assets<AnimationClip>>()
        .ids()
        .collect();
    assert_eq!(animations, same, "built anew under the same handle");

    // A clip that breaks keeps playing as it was, and says so until it is mended.
    write("clips/raise.clip.ron", "Clip(");
    app.world()
        .resource::<AssetServer>()
        .reload("clips/raise.clip.ron");
    update_until(&mut app, "the problem", |app| {
        status(app, man).problem().is_some()
    });
    let problem = status(&app, man).problem().unwrap().to_owned();
    assert!(
        problem.contains("raise.clip.ron") && problem.contains("line 1"),
        "{problem}"
    );
    assert_eq!(positions(&app, man), positions(&app, level));
    write("clips/raise.clip.ron", &clip_text(&two_keys()));
    app.world()
        .resource::<AssetServer>()
        .reload("clips/raise.clip.ron");
    update_until(&mut app, "the mended clip", |app| {
        status(app, man) == FigureStatus::Ready
    });
    app.update();
    assert_eq!(positions(&app, man), positions(&app, drawn));
    assert!(app.world().resource::<Stick3dStatus>().is_ok());
}

#[test]
fn bad_clip_files_are_named_and_the_app_goes_on() {
    let (a, b) = (joints(&t_pose()), joints(&cheer()));
    let numbers = |count: usize, last: &str| {
        let zeros = vec!["0.0"; count - 1].join(", ");
        format!("Latent([{zeros}, {last}])")
    };
    let horse = StickSketch::new(Figure::horse().template.clone());
    let horse_keys = {
        let names = Figure::horse().joints.iter().map(|joint| &joint.name);
        let points: Vec<String> = names
            .zip(&horse.points)
            .map(|(name, at)| format!("\"{name}\": ({:?}, {:?})", at.x, at.y))
            .collect();
        format!("Joints({{{}}})", points.join(", "))
    };
    let two = |first: &str, second: &str| {
        format!("(time_s: 0.0, pose: {first}), (time_s: 0.5, pose: {second})")
    };
    let cases: [(&str, String, &[&str]); 11] = [
        (
            "one_key",
            clip_text(&format!("(time_s: 0.0, pose: {a})")),
            &["at least two keys"],
        ),
        ("no_keys", clip_text(""), &["at least two keys"]),
        (
            "equal_times",
            clip_text(&format!(
                "(time_s: 0.5, pose: {a}), (time_s: 0.5, pose: {b})"
            )),
            &["keys 1 and 2", "0.5"],
        ),
        (
            "out_of_order",
            clip_text(&format!(
                "(time_s: 0.5, pose: {a}), (time_s: 0.1, pose: {b})"
            )),
            &["key 2", "0.1"],
        ),
        (
            "nan_time",
            clip_text(&format!(
                "(time_s: NaN, pose: {a}), (time_s: 0.1, pose: {b})"
            )),
            &["key 1", "NaN"],
        ),
        ("horses_key", clip_text(&two(&a, &horse_keys)), &["key 2"]),
        (
            "horse",
            clip_text(&two(&a, &b)).replace("human", "horse"),
            &["\"horse\"", "\"human\""],
        ),
        (
            "unicorn",
            clip_text(&two(&a, &b)).replace("human", "unicorn"),
            &["\"unicorn\""],
        ),
        (
            "short_latent",
            clip_text(&two(&numbers(3, "1.0"), &numbers(3, "0.5"))),
            &["3 numbers", "256"],
        ),
        (
            "nan_latent",
            clip_text(&two(&numbers(256, "1.0"), &numbers(256, "NaN"))),
            &["key 2", "finite"],
        ),
        (
            "missing_sketch",
            clip_text(&two(&a, "Sketch(\"nowhere.json\")")),
            &["nowhere.json"],
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (name, text, _) in &cases {
        let path = folder.path().join(format!("{name}.clip.ron"));
        write_atomically(&path, text.as_bytes()).unwrap();
    }
    let mut app = app_with(folder.path(), |_| {});
    let whole = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    for (name, _, words) in &cases {
        let file = format!("{name}.clip.ron");
        let man = spawn_player(&mut app, &file);
        update_until(&mut app, name, |app| status(app, man).problem().is_some());
        let problem = status(&app, man).problem().unwrap().to_owned();
        for word in words.iter().chain(&[file.as_str()]) {
            assert!(problem.contains(word), "{name}: {problem}");
        }
        let clip = app.world().get::<PlayStickClip>(man).unwrap().0.clone();
        let told = app.world().resource::<Stick3dStatus>();
        assert_eq!(told.problem(&clip), Some(problem.as_str()));
        app.update();
        let body = positions(&app, man).expect("he stands as his template does");
        assert!(body.iter().all(|position| position.is_finite()));
        assert!(!plays(&app, man));
        assert_eq!(status(&app, whole), FigureStatus::Ready);
        app.world_mut().despawn(man);
    }
}

#[test]
fn a_clip_that_is_not_there_is_named_also_for_who_asks_late() {
    let mut app = app();
    let early = spawn_player(&mut app, "nowhere.clip.ron");
    update_until(&mut app, "the problem", |app| {
        status(app, early).problem().is_some()
    });
    let late = {
        let clip = app.world().get::<PlayStickClip>(early).unwrap().clone();
        app.world_mut().spawn((StickFigure::human(), clip)).id()
    };
    app.update();
    for man in [early, late] {
        let problem = status(&app, man).problem().unwrap().to_owned();
        assert!(problem.contains("nowhere.clip.ron"), "{problem}");
    }
    // A clip that works makes up for it.
    let clip = StickClip::builder(Figure::human())
        .sketch(0.0, t_pose())
        .sketch(0.5, cheer())
        .build()
        .unwrap();
    let clip = add_clip(&mut app, clip);
    app.world_mut().entity_mut(late).insert(PlayStickClip(clip));
    app.update();
    assert_eq!(status(&app, late), FigureStatus::Ready);
}

#[test]
fn a_clip_waits_for_its_model_and_is_built_for_every_model_anew() {
    let mut app = app();
    let clip = StickClip::builder(Figure::human())
        .sketch(0.0, t_pose())
        .sketch(0.5, cheer())
        .build()
        .unwrap();
    let clip = add_clip(&mut app, clip);
    let missing: Handle<StickModel> = app
        .world()
        .resource::<AssetServer>()
        .load("missing.stick3d");
    let man = app
        .world_mut()
        .spawn((StickFigure(missing.clone()), PlayStickClip(clip.clone())))
        .id();
    update_until(&mut app, "the problem", |app| {
        status(app, man).problem().is_some()
    });
    let problem = status(&app, man).problem().unwrap().to_owned();
    assert!(
        problem.contains("missing.stick3d"),
        "the model is at fault: {problem}"
    );

    app.world_mut().entity_mut(man).insert(StickFigure::human());
    app.update();
    assert_eq!(status(&app, man), FigureStatus::Ready);
    assert!(plays(&app, man));
    app.world_mut().entity_mut(man).insert(StickFigure::horse());
    app.update();
    let problem = status(&app, man).problem().unwrap().to_owned();
    assert!(
        problem.contains("\"human\"") && problem.contains("\"horse\""),
        "{problem}"
    );
    let clips = app.world().resource::<StickClips>();
    assert!(clips.curve(&clip, &HUMAN_MODEL).is_some());
}

#[test]
fn a_key_of_another_figure_is_refused_by_the_builder() {
    let error = StickClip::builder(Figure::human())
        .sketch(0.0, t_pose())
        .sketch(0.5, StickSketch::new(Figure::horse().template.clone()))
        .build()
        .unwrap_err();
    assert_eq!(error.key, 2);
    assert!(error.to_string().contains("\"human\""), "{error}");
}

#[test]
fn the_shipped_clips_are_played_by_their_figures() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    let mut files: Vec<String> = std::fs::read_dir(assets.join("clips"))
        .unwrap()
        .map(|entry| format!("clips/{}", entry.unwrap().file_name().display()))
        .collect();
    files.sort();
    assert!(files.len() >= 2, "{files:?}");
    let mut app = app_with(&assets, |_| {});
    for file in files {
        let model = if file.contains("horse") {
            StickFigure::horse()
        } else {
            StickFigure::human()
        };
        let clip = app.world().resource::<AssetServer>().load(file.clone());
        let figure = app.world_mut().spawn((model, PlayStickClip(clip))).id();
        update_until(&mut app, &file, |app| {
            assert_eq!(status(app, figure).problem(), None, "{file}");
            plays(app, figure)
        });
        for _ in 0..90 {
            app.update();
        }
        let place = app.world().get::<Transform>(figure).unwrap().translation;
        assert!(place.length() > 0.8, "{file} comes {place}");
        app.world_mut().despawn(figure);
    }
}
