//! A spawned sketch is a body in the same frame, and unchanged figures are left alone.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

mod support;

use bevy::camera::primitives::Aabb;
use bevy::prelude::*;
use bevy_stick3d::StreamedBody;
use bevy_stick3d::prelude::*;
use support::{app, bounds, cheer, joint, normals, positions, status, t_pose, writes_in};

#[test]
fn a_sketch_is_a_body_in_the_same_frame() {
    let mut app = app();
    let man = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    app.update();

    assert_eq!(status(&app, man), FigureStatus::Ready);
    let body = positions(&app, man).expect("a mesh after one update");
    assert_eq!(body.len(), 12_500);
    assert!(body.iter().all(|position| position.is_finite()));
    let normals = normals(&app, man).unwrap();
    assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1.0e-2));
    let (low, high) = bounds(&body);
    assert!(low.y.abs() < 1.0e-5, "stands at y = {}", low.y);
    assert!((1.5..2.1).contains(&high.y), "{} m tall", high.y);
    assert!(
        (1.3..2.2).contains(&(high.x - low.x)),
        "arms span {} m",
        high.x - low.x
    );
    let aabb = app.world().get::<Aabb>(man).unwrap();
    assert!(Vec3::from(aabb.min()).distance(low) < 1.0e-4);
    assert!(Vec3::from(aabb.max()).distance(high) < 1.0e-4);
}

#[test]
fn the_body_has_the_pose_that_was_drawn() {
    let mut app = app();
    let man = app.world_mut().spawn((StickFigure::human(), cheer())).id();
    app.update();
    let (_, up) = bounds(&positions(&app, man).unwrap());
    app.world_mut().entity_mut(man).insert(t_pose());
    app.update();
    let (_, level) = bounds(&positions(&app, man).unwrap());
    assert!(
        up.y > level.y + 0.15,
        "hands up: {} m, level: {} m",
        up.y,
        level.y
    );

    // One arm up: the raised hand is on the side it was drawn on.
    let mut one_up = t_pose();
    one_up.points[joint("elbow_l")] = cheer().points[joint("elbow_l")];
    one_up.points[joint("hand_l")] = cheer().points[joint("hand_l")];
    app.world_mut().entity_mut(man).insert(one_up);
    app.update();
    let body = positions(&app, man).unwrap();
    let highest = body.iter().max_by(|a, b| a.y.total_cmp(&b.y)).unwrap();
    assert!(highest.x > 0.1, "the left hand is at x = {}", highest.x);
}

#[test]
fn a_latent_change_is_shown_in_the_same_frame() {
    let mut app = app();
    let raised = app.world_mut().spawn((StickFigure::human(), cheer())).id();
    let man = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    app.update();
    let latent = app.world().get::<Latent>(raised).unwrap().clone();
    assert!(!latent.0.is_empty());
    *app.world_mut().get_mut::<Latent>(man).unwrap() = latent;
    app.update();
    assert_eq!(positions(&app, man), positions(&app, raised));
}

#[test]
fn a_figure_without_a_sketch_stands_as_its_template() {
    let mut app = app();
    let plain = app.world_mut().spawn(StickFigure::human()).id();
    let template = StickSketch::new(Figure::human().template.clone());
    let drawn = app.world_mut().spawn((StickFigure::human(), template)).id();
    app.update();
    assert_eq!(positions(&app, plain), positions(&app, drawn));
    assert_eq!(status(&app, plain), FigureStatus::Ready);
}

#[test]
fn grounding_can_be_turned_off() {
    let mut app = app();
    let man = app
        .world_mut()
        .spawn((StickFigure::human(), t_pose(), Grounded(false)))
        .id();
    app.update();
    let (low, _) = bounds(&positions(&app, man).unwrap());
    assert!(low.y < -0.5, "feet at {}", low.y);
    app.world_mut().entity_mut(man).insert(Grounded(true));
    app.update();
    let (low, _) = bounds(&positions(&app, man).unwrap());
    assert!(low.y.abs() < 1.0e-5);
}

#[test]
fn unchanged_figures_are_not_touched() {
    let mut app = app();
    let men: Vec<Entity> = (0..3)
        .map(|_| app.world_mut().spawn((StickFigure::human(), t_pose())).id())
        .collect();
    app.update();
    app.update();
    assert_eq!(writes_in(&mut app, 5), 0);

    let mesh = app
        .world()
        .get::<StreamedBody>(men[1])
        .unwrap()
        .mesh()
        .unwrap()
        .id();
    app.world_mut().entity_mut(men[1]).insert(cheer());
    app.update();
    let events: Vec<AssetEvent<Mesh>> = app
        .world_mut()
        .resource_mut::<Messages<AssetEvent<Mesh>>>()
        .drain()
        .collect();
    assert_eq!(
        events,
        [AssetEvent::Modified { id: mesh }],
        "one mesh, written in place"
    );
}

#[test]
fn the_mesh_goes_with_its_figure() {
    let mut app = app();
    let man = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    app.update();
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 1);
    app.world_mut().despawn(man);
    app.update();
    app.update();
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 0);
}
