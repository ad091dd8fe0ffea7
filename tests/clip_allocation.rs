//! A frame of a playing figure allocates nothing: curve, blend, root motion, decoding and the mesh. Nor does one in which a
//! sketch stays as it is.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

#[path = "support/counting.rs"]
mod counting;

use bevy::app::{AnimationSystems, TaskPoolPlugin};
use bevy::asset::AssetEventSystems;
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_stick3d::HUMAN_MODEL;
use bevy_stick3d::prelude::*;
use counting::allocations_so_far;

/// How many allocations there were between the start of animation and the hand-over of assets.
#[derive(Resource, Default)]
struct Counted {
    before: usize,
    sum: usize,
}

/// An app that does all its work on this thread.
fn app() -> App {
    let mut app = App::new();
    let one_thread = TaskPoolPlugin {
        task_pool_options: TaskPoolOptions::with_num_threads(1),
    };
    app.add_plugins((
        MinimalPlugins.set(one_thread),
        AssetPlugin::default(),
        TransformPlugin,
        Stick3dPlugin,
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(
        std::time::Duration::from_micros(16_667),
    ));
    let start = |mut counted: ResMut<Counted>| counted.before = allocations_so_far();
    let stop = |mut counted: ResMut<Counted>| {
        counted.sum += allocations_so_far() - counted.before;
    };
    app.init_resource::<Counted>().add_systems(
        PostUpdate,
        (
            start.before(AnimationSystems),
            stop.after(Stick3dSystems::Dress).before(AssetEventSystems),
        ),
    );
    app.finish();
    app.cleanup();
    let mut schedules = app.world_mut().resource_mut::<Schedules>();
    for (_, schedule) in schedules.iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
    app
}

fn pose(lift: f32) -> StickSketch {
    let mut points = Figure::human().template.clone();
    for name in ["hand_r", "hand_l"] {
        points[Figure::human().joint_index(name).unwrap()].y += lift;
    }
    StickSketch::new(points)
}

/// A man who plays two clips that a graph blends.
fn spawn_player(app: &mut App) -> Entity {
    let clips = [0.3, 0.6].map(|lift| {
        let clip = StickClip::builder(Figure::human())
            .sketch(0.0, pose(0.0))
            .sketch(0.4, pose(lift))
            .repeat(Repeat::PingPong)
            .build();
        app.world_mut()
            .resource_mut::<Assets<StickClip>>()
            .add(clip.unwrap())
    });
    let (graph, nodes) = app
        .world_mut()
        .resource_scope(|world, mut stick: Mut<StickClips>| {
            let animations = world.resource::<Assets<AnimationClip>>();
            let clips = clips.map(|clip| stick.animation(&clip, &HUMAN_MODEL, animations));
            AnimationGraph::from_clips(clips)
        });
    let graph = app
        .world_mut()
        .resource_mut::<Assets<AnimationGraph>>()
        .add(graph);
    let mut player = AnimationPlayer::default();
    for node in nodes {
        player.play(node).repeat();
    }
    app.world_mut()
        .spawn((StickFigure::human(), player, AnimationGraphHandle(graph)))
        .id()
}

/// The allocations of 60 frames, after others in which everything came to its size.
fn allocations(app: &mut App) -> usize {
    for _ in 0..60 {
        app.update();
    }
    app.world_mut().resource_mut::<Counted>().sum = 0;
    for _ in 0..60 {
        app.update();
    }
    app.world().resource::<Counted>().sum
}

#[test]
fn a_playing_figure_allocates_nothing() {
    let mut app = app();
    let player = spawn_player(&mut app);
    assert_eq!(allocations(&mut app), 0);
    let latent = |app: &App| app.world().get::<Latent>(player).unwrap().clone();
    let before = latent(&app);
    app.update();
    assert_ne!(latent(&app), before, "he plays");

    // The counter counts.
    let allocate = |mut latents: Query<&mut Latent>| {
        for mut latent in &mut latents {
            latent.0 = latent.0.clone();
        }
    };
    app.add_systems(PostUpdate, allocate.in_set(Stick3dSystems::Encode));
    assert!(allocations(&mut app) >= 60);
}

#[test]
fn a_figure_whose_sketch_stays_allocates_nothing() {
    let mut app = app();
    let man = app
        .world_mut()
        .spawn((StickFigure::human(), pose(0.2)))
        .id();
    app.update();
    let chosen = app.world().get::<SketchAlternatives>(man).unwrap().chosen();
    assert_eq!(chosen, Some(0));
    assert_eq!(allocations(&mut app), 0);
}
