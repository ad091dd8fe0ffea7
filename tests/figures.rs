//! Several figures in one app: each entity is what its model says, and minds its own sketch alone.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

mod support;

use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::prelude::*;
use bevy_stick3d::prelude::*;
use bevy_stick3d::sketch_input::screen_from_canvas;
use bevy_stick3d::{HORSE_MODEL, HUMAN_MODEL, StreamedBody};
use support::{app, bounds, cheer, positions, status, t_pose};

/// The horse as its template stands, with the head moved.
fn horse_with_head_moved(by: Vec2) -> StickSketch {
    let mut points = Figure::horse().template.clone();
    points[Figure::horse().joint_index("forehead").unwrap()] += by;
    StickSketch::new(points)
}

/// The meshes that were written since the last look.
fn modified_meshes(app: &mut App) -> Vec<AssetId<Mesh>> {
    app.world_mut()
        .resource_mut::<Messages<AssetEvent<Mesh>>>()
        .drain()
        .filter_map(|event| match event {
            AssetEvent::Modified { id } => Some(id),
            _ => None,
        })
        .collect()
}

fn mesh_of(app: &App, entity: Entity) -> AssetId<Mesh> {
    let body = app.world().get::<StreamedBody>(entity).unwrap();
    body.mesh().unwrap().id()
}

#[test]
fn a_man_and_a_horse_stand_in_one_scene_and_mind_their_own_sketches() {
    let mut app = app();
    let man = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    let horse = app
        .world_mut()
        .spawn((StickFigure::horse(), horse_with_head_moved(Vec2::ZERO)))
        .id();
    app.update();
    for (entity, vertices) in [(man, 12_500), (horse, 19_248)] {
        assert_eq!(status(&app, entity), FigureStatus::Ready);
        let body = positions(&app, entity).unwrap();
        assert_eq!(body.len(), vertices);
        assert!(body.iter().all(|position| position.is_finite()));
        let (low, _) = bounds(&body);
        assert!(low.y.abs() < 1.0e-5, "stands at y = {}", low.y);
    }
    let size = |entity| {
        let (low, high) = bounds(&positions(&app, entity).unwrap());
        high - low
    };
    assert!(size(horse).x > 1.6, "the horse is {} long", size(horse));
    assert!(size(horse).x > size(horse).z, "and seen from its side");
    assert!(size(man).y > 1.5, "the man is {} high", size(man));

    app.update();
    modified_meshes(&mut app);
    app.world_mut()
        .entity_mut(horse)
        .insert(horse_with_head_moved(vec2(0.05, -0.4)));
    app.update();
    assert_eq!(modified_meshes(&mut app), [mesh_of(&app, horse)]);
    app.world_mut().entity_mut(man).insert(cheer());
    app.update();
    assert_eq!(modified_meshes(&mut app), [mesh_of(&app, man)]);
    app.update();
    assert!(modified_meshes(&mut app).is_empty());
}

#[test]
fn a_sketch_of_the_other_figure_is_refused_and_the_body_stays() {
    let mut app = app();
    let horse = app
        .world_mut()
        .spawn((StickFigure::horse(), horse_with_head_moved(Vec2::ZERO)))
        .id();
    app.update();
    let before = positions(&app, horse);
    app.world_mut().entity_mut(horse).insert(t_pose());
    app.update();
    let problem = status(&app, horse).problem().unwrap().to_owned();
    assert!(
        problem.contains("11") && problem.contains("12"),
        "{problem}"
    );
    assert_eq!(positions(&app, horse), before);
}

#[test]
fn another_handle_makes_another_body() {
    let mut app = app();
    let template = app.world_mut().spawn(StickFigure::horse()).id();
    let figure = app.world_mut().spawn((StickFigure::human(), cheer())).id();
    app.update();
    let man = positions(&app, figure).unwrap();

    // The man's sketch and latent say nothing about a horse: it stands as its template.
    app.world_mut()
        .entity_mut(figure)
        .insert(StickFigure(HORSE_MODEL));
    app.update();
    assert_eq!(positions(&app, figure), positions(&app, template));
    assert!(status(&app, figure).problem().is_some());

    let sketch = horse_with_head_moved(vec2(0.0, -0.3));
    app.world_mut().entity_mut(figure).insert(sketch);
    app.update();
    assert_eq!(status(&app, figure), FigureStatus::Ready);
    assert_ne!(positions(&app, figure), positions(&app, template));

    app.world_mut()
        .entity_mut(figure)
        .insert((StickFigure(HUMAN_MODEL), cheer()));
    app.update();
    assert_eq!(status(&app, figure), FigureStatus::Ready);
    assert_eq!(positions(&app, figure).unwrap(), man);
}

#[test]
fn a_latent_that_comes_with_the_model_is_kept() {
    let mut app = app();
    let horse = app
        .world_mut()
        .spawn((StickFigure::horse(), horse_with_head_moved(vec2(0.0, -0.3))))
        .id();
    let figure = app.world_mut().spawn(StickFigure::human()).id();
    app.update();
    let latent = app.world().get::<Latent>(horse).unwrap().clone();
    app.world_mut()
        .entity_mut(figure)
        .insert((StickFigure::horse(), latent));
    app.update();
    assert_eq!(positions(&app, figure), positions(&app, horse));
}

#[test]
fn a_canvas_draws_the_figure_of_its_model() {
    let area = Rect::new(0.0, 0.0, 800.0, 800.0);
    let mut app = app();
    let horse = app.world_mut().spawn(StickFigure::horse()).id();
    let canvas = app
        .world_mut()
        .spawn(SketchCanvas::new(CanvasArea::rect(area), horse))
        .id();
    app.update();
    let drawing = app.world().get::<SketchDrawing>(canvas).unwrap();
    assert_eq!(drawing.figure().name, Figure::horse().name);

    // One line along the whole path, through the faint figure.
    let guide = drawing.guide();
    let path: Vec<Vec2> = drawing.figure().path.iter().map(|&j| guide[j]).collect();
    let send = |app: &mut App, at: Vec2, action: PointerAction| {
        let target = bevy::camera::NormalizedRenderTarget::None {
            width: 800,
            height: 800,
        };
        let location = Location {
            target,
            position: screen_from_canvas(area, at),
        };
        app.world_mut()
            .write_message(PointerInput::new(PointerId::Mouse, location, action));
    };
    send(
        &mut app,
        path[0],
        PointerAction::Press(PointerButton::Primary),
    );
    for bone in path.windows(2) {
        for step in 1..=10 {
            let at = bone[0].lerp(bone[1], step as f32 / 10.0);
            send(&mut app, at, PointerAction::Move { delta: Vec2::ZERO });
        }
        app.update();
    }
    let end = *path.last().unwrap();
    send(
        &mut app,
        end,
        PointerAction::Release(PointerButton::Primary),
    );
    app.update();
    let sketch = app.world().get::<StickSketch>(horse).unwrap();
    assert_eq!(sketch.points.len(), 12);
    for (joint, (drawn, meant)) in sketch.points.iter().zip(&guide).enumerate() {
        let name = &Figure::horse().joints[joint].name;
        assert!(drawn.distance(*meant) < 30.0, "{name}: {drawn} for {meant}");
    }
    assert_eq!(status(&app, horse), FigureStatus::Ready);
}

#[test]
fn a_canvas_waits_for_the_model_of_its_figure() {
    let area = Rect::new(0.0, 0.0, 800.0, 800.0);
    let mut app = app();
    let model: Handle<StickModel> = app
        .world()
        .resource::<AssetServer>()
        .load("missing.stick3d");
    let figure = app.world_mut().spawn(StickFigure(model)).id();
    let canvas = app
        .world_mut()
        .spawn(SketchCanvas::new(CanvasArea::rect(area), figure))
        .id();
    app.update();
    let location = Location {
        target: bevy::camera::NormalizedRenderTarget::None {
            width: 800,
            height: 800,
        },
        position: vec2(400.0, 400.0),
    };
    app.world_mut().write_message(PointerInput::new(
        PointerId::Mouse,
        location,
        PointerAction::Press(PointerButton::Primary),
    ));
    app.update();
    let drawing = app.world().get::<SketchDrawing>(canvas).unwrap();
    assert!(drawing.pen_stroke().is_none());
}
