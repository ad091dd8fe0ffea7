//! A playing figure that nobody sees is not decoded, and is there when somebody looks.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

mod support;

use std::path::Path;

use bevy::camera::CameraProjectionPlugin;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::VisibilityPlugin;
use bevy::prelude::*;
use bevy_stick3d::StreamedBody;
use bevy_stick3d::animation::DecodeOutOfSight;
use bevy_stick3d::prelude::*;
use support::{add_clip, app_with, cheer, positions, t_pose, writes_in};

/// An app that finds out what its camera sees, a man who raises and lowers his arms before it, and the camera.
fn scene(bundle: impl Bundle) -> (App, Entity, Entity) {
    let mut app = app_with(Path::new("assets"), |app| {
        app.init_asset::<Mesh>()
            .init_asset::<bevy::mesh::skinning::SkinnedMeshInverseBindposes>()
            .add_plugins((VisibilityPlugin, CameraProjectionPlugin));
    });
    let clip = StickClip::builder(Figure::human())
        .sketch(0.0, t_pose())
        .sketch(0.5, cheer())
        .repeat(Repeat::PingPong)
        .build()
        .unwrap();
    let clip = add_clip(&mut app, clip);
    let man = app
        .world_mut()
        .spawn((StickFigure::human(), PlayStickClip(clip), bundle))
        .id();
    let camera = app
        .world_mut()
        .spawn((Camera3d::default(), looking(Vec3::ZERO)))
        .id();
    for _ in 0..4 {
        app.update();
    }
    (app, man, camera)
}

fn looking(at: Vec3) -> Transform {
    Transform::from_xyz(0.0, 1.0, 5.0).looking_at(at.with_y(1.0), Vec3::Y)
}

fn look(app: &mut App, camera: Entity, at: Vec3) {
    *app.world_mut().get_mut::<Transform>(camera).unwrap() = looking(at);
}

/// Whether the mesh is that of the latent.
fn is_up_to_date(app: &mut App, man: Entity) -> bool {
    let latent = app.world().get::<Latent>(man).unwrap().clone();
    let shown = positions(app, man).unwrap();
    // Fresh, and so decoded whether seen or not.
    let other = app.world_mut().spawn((StickFigure::human(), latent)).id();
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    app.update();
    let expected = positions(app, other).unwrap();
    app.world_mut().despawn(other);
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    shown == expected
}

#[test]
fn out_of_sight_nothing_is_decoded_and_in_sight_all_is() {
    let (mut app, man, camera) = scene(());
    assert_eq!(writes_in(&mut app, 5), 5, "in sight");
    look(&mut app, camera, Vec3::new(0.0, 0.0, 20.0));
    app.update();
    app.update();
    assert_eq!(writes_in(&mut app, 20), 0, "behind the camera");
    assert!(app.world().get::<StreamedBody>(man).unwrap().is_stale());
    assert!(!is_up_to_date(&mut app, man));

    look(&mut app, camera, Vec3::ZERO);
    app.update();
    app.update();
    assert!(
        is_up_to_date(&mut app, man),
        "one frame after it came into sight"
    );
    assert_eq!(writes_in(&mut app, 5), 5);
}

#[test]
fn who_stops_out_of_sight_is_shown_as_he_stopped() {
    let (mut app, man, camera) = scene(());
    look(&mut app, camera, Vec3::new(0.0, 0.0, 20.0));
    for _ in 0..10 {
        app.update();
    }
    app.world_mut()
        .get_mut::<AnimationPlayer>(man)
        .unwrap()
        .pause_all();
    for _ in 0..3 {
        app.update();
    }
    look(&mut app, camera, Vec3::ZERO);
    app.update();
    app.update();
    assert!(is_up_to_date(&mut app, man));
    assert_eq!(writes_in(&mut app, 5), 0);
}

#[test]
fn an_arm_that_would_reach_into_sight_is_found() {
    // At the edge of the picture, so that only a body that is stretched out is in it.
    let (mut app, man, camera) = scene(());
    look(&mut app, camera, Vec3::new(0.0, 0.0, 20.0));
    for _ in 0..5 {
        app.update();
    }
    let out_of_sight = *app.world().get::<Aabb>(man).unwrap();
    assert!(
        out_of_sight.half_extents.min_element() > 1.0,
        "{out_of_sight:?}"
    );
    look(&mut app, camera, Vec3::ZERO);
    app.update();
    app.update();
    let seen = *app.world().get::<Aabb>(man).unwrap();
    assert!(seen.half_extents.z < 0.6, "its own box again: {seen:?}");
}

#[test]
fn a_figure_can_be_decoded_unseen() {
    let (mut app, man, camera) = scene(DecodeOutOfSight);
    look(&mut app, camera, Vec3::new(0.0, 0.0, 20.0));
    app.update();
    app.update();
    assert_eq!(writes_in(&mut app, 5), 5);
    assert!(is_up_to_date(&mut app, man));
}

#[test]
fn a_drawing_is_decoded_unseen() {
    let (mut app, _, camera) = scene(());
    look(&mut app, camera, Vec3::new(0.0, 0.0, 20.0));
    let man = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    app.update();
    app.update();
    app.world_mut().entity_mut(man).insert(cheer());
    app.update();
    assert!(is_up_to_date(&mut app, man));
}
