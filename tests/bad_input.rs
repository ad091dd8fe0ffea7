//! Bad sketches, latents and model files leave the app running, and are named.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

mod support;

use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy_stick3d::prelude::*;
use support::{app, positions, status, t_pose};

#[test]
fn a_nan_in_a_sketch_is_refused_and_the_body_stays() {
    let mut app = app();
    let man = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    app.update();
    let before = positions(&app, man);

    let mut bad = t_pose();
    bad.points[1].x = f32::NAN;
    app.world_mut().entity_mut(man).insert(bad);
    app.update();
    let FigureStatus::Failed(message) = status(&app, man) else {
        panic!("a NaN passed");
    };
    assert!(
        message.contains("neck") && message.contains("NaN"),
        "{message}"
    );
    assert_eq!(positions(&app, man), before);

    for bad in [
        StickSketch::default(),
        StickSketch::new(vec![Vec2::ONE; 11]),
        StickSketch::new(vec![Vec2::splat(1.0e30); 11]),
        StickSketch::new(vec![Vec2::ONE; 12]),
    ] {
        app.world_mut().entity_mut(man).insert(bad);
        app.update();
        assert!(status(&app, man).problem().is_some());
        assert_eq!(positions(&app, man), before);
    }

    app.world_mut().entity_mut(man).insert(t_pose());
    app.update();
    assert_eq!(status(&app, man), FigureStatus::Ready);
}

#[test]
fn a_figure_spawned_with_a_bad_sketch_stands_and_says_why() {
    let mut app = app();
    let bad = StickSketch::new(vec![Vec2::NAN; 11]);
    let man = app.world_mut().spawn((StickFigure::human(), bad)).id();
    app.update();
    app.update();
    assert!(status(&app, man).problem().is_some());
    assert!(positions(&app, man).unwrap().iter().all(|p| p.is_finite()));
}

#[test]
fn a_bad_latent_is_refused_and_the_body_stays() {
    let mut app = app();
    let man = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    app.update();
    let before = positions(&app, man);
    let good = app.world().get::<Latent>(man).unwrap().clone();

    let mut nan = good.clone();
    nan.0[7] = f32::NAN;
    for (bad, word) in [(nan, "number 7"), (Latent(vec![0.0; 3]), "3 numbers")] {
        *app.world_mut().get_mut::<Latent>(man).unwrap() = bad;
        app.update();
        let message = status(&app, man).problem().unwrap().to_owned();
        assert!(message.contains(word), "{message}");
        assert_eq!(positions(&app, man), before);
    }
    *app.world_mut().get_mut::<Latent>(man).unwrap() = good;
    app.update();
    assert_eq!(status(&app, man), FigureStatus::Ready);
}

/// Updates until the status of a figure is `Failed`; loading goes on in another thread.
fn wait_for_failure(app: &mut App, figure: Entity) -> String {
    let start = Instant::now();
    loop {
        app.update();
        if let Some(problem) = status(app, figure).problem() {
            return problem.to_owned();
        }
        assert!(start.elapsed() < Duration::from_secs(60), "no failure came");
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn model_files_that_are_none_are_named_and_the_app_goes_on() {
    for name in ["missing.stick3d", "empty.stick3d", "text.stick3d"] {
        let mut app = app();
        let model: Handle<StickModel> = app.world().resource::<AssetServer>().load(name);
        let broken = app
            .world_mut()
            .spawn((StickFigure(model.clone()), t_pose()))
            .id();
        let whole = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
        let problem = wait_for_failure(&mut app, broken);
        assert!(problem.contains(name), "{problem}");
        let problems = app.world().resource::<Stick3dStatus>();
        assert!(!problems.is_ok());
        assert_eq!(problems.problem(&model), Some(problem.as_str()));
        assert!(positions(&app, broken).is_none());
        assert_eq!(status(&app, whole), FigureStatus::Ready);
    }
}
