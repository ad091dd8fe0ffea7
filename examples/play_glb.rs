//! A motion that `stick3d animate` exported, played by Bevy alone: a game that only plays needs neither model nor plugin.
//!
//! `cargo run --example play_glb -- walk.glb`
//! `cargo run --example play_glb -- walk.glb --at 0.5 --screenshot walk.png`

mod scene;

use std::path::PathBuf;
use std::process::ExitCode;

use bevy::camera::primitives::Aabb;
use bevy::gltf::GltfAssetLabel;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;
use bevy_stick3d::launch::{self, Launch, LaunchError, asset_place};
use bevy_stick3d::prelude::FigureStatus;
use clap::Parser;

/// Plays the animation of a glTF file over and over.
#[derive(Parser)]
struct Arguments {
    /// The file, as `stick3d animate` writes it.
    #[arg(value_name = "CLIP.glb")]
    clip: PathBuf,
    /// Hold the animation at this time, seconds.
    #[arg(long, value_name = "SECONDS")]
    at: Option<f32>,
    /// Take a picture without opening a window, and end.
    #[arg(long, value_name = "OUT.png")]
    screenshot: Option<PathBuf>,
}

/// What is played when the scene is there.
#[derive(Component)]
struct ToPlay {
    graph: Handle<AnimationGraph>,
    node: AnimationNodeIndex,
    hold_s: Option<f32>,
}

fn main() -> ExitCode {
    launch::ended("play_glb", run(Arguments::parse()), |error| {
        error.downcast_ref().map_or(1, LaunchError::exit_code)
    })
}

fn run(arguments: Arguments) -> anyhow::Result<()> {
    let (folder, file) = asset_place(&arguments.clip)?;
    let launch = Launch {
        title: format!("stick3d: {file}"),
        size_px: UVec2::new(1280, 720),
        screenshot: arguments.screenshot,
        asset_folder: Some(folder),
        ..default()
    };
    let spawn = move |mut commands: Commands,
                      assets: Res<AssetServer>,
                      mut graphs: ResMut<Assets<AnimationGraph>>| {
        let clip = assets.load(GltfAssetLabel::Animation(0).from_asset(file.clone()));
        let (graph, node) = AnimationGraph::from_clip(clip);
        commands
            .spawn((
                WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(file.clone()))),
                ToPlay {
                    graph: graphs.add(graph),
                    node,
                    hold_s: arguments.at,
                },
                // A picture waits for it.
                FigureStatus::Waiting,
            ))
            .observe(play);
        commands.spawn((Camera3d::default(), Transform::default()));
    };
    launch.run(|app| {
        app.add_systems(Startup, (scene::build, spawn))
            .add_systems(Update, end_on_problem)
            .add_systems(PostUpdate, follow.after(TransformSystems::Propagate));
    })?;
    Ok(())
}

fn play(
    ready: On<WorldInstanceReady>,
    mut commands: Commands,
    children: Query<&Children>,
    mut scenes: Query<(&ToPlay, &mut FigureStatus)>,
    mut players: Query<&mut AnimationPlayer>,
) {
    let Ok((to_play, mut status)) = scenes.get_mut(ready.entity) else {
        return;
    };
    *status = FigureStatus::Ready;
    for child in children.iter_descendants(ready.entity) {
        let Ok(mut player) = players.get_mut(child) else {
            continue;
        };
        let animation = player.play(to_play.node);
        match to_play.hold_s {
            Some(time_s) => animation.seek_to(time_s).pause(),
            None => animation.repeat(),
        };
        commands
            .entity(child)
            .insert(AnimationGraphHandle(to_play.graph.clone()));
    }
}

/// A file that cannot be loaded has been logged by Bevy; there is nothing to look at.
fn end_on_problem(
    scenes: Query<&WorldAssetRoot>,
    assets: Res<AssetServer>,
    mut exit: MessageWriter<AppExit>,
) {
    let failed = |scene: &WorldAssetRoot| assets.load_state(scene.0.id()).is_failed();
    if scenes.iter().any(failed) {
        exit.write(AppExit::error());
    }
}

/// Keeps the camera beside the body, wherever it walks.
fn follow(
    bodies: Query<(&Aabb, &GlobalTransform), With<MeshMorphWeights>>,
    mut cameras: Query<&mut Transform, With<Camera3d>>,
) {
    for ((body, place), mut camera) in bodies.iter().zip(&mut cameras) {
        let centre = place.transform_point(body.center.into());
        let distance = 3.2 * Vec3::from(body.half_extents).length();
        let from = Vec3::new(0.45, 0.28, 1.0).normalize() * distance;
        *camera = Transform::from_translation(centre + from).looking_at(centre, Vec3::Y);
    }
}
