//! Clips from files: a man who goes over from a walk to a run and back, two clips that a graph blends; or a galloping horse.
//!
//! `cargo run --example clip_player`
//! `cargo run --example clip_player -- --figure horse`
//! `cargo run --example clip_player -- --screenshot frames --frames 12 --every 8`
//!
//! Up and down: more and less of the run. Space pauses.

mod pictures;
mod scene;

use std::process::ExitCode;

use bevy::camera::primitives::Aabb;
use bevy::prelude::*;
use bevy_stick3d::HUMAN_MODEL;
use bevy_stick3d::launch::{self, LaunchError};
use bevy_stick3d::prelude::*;
use clap::{Parser, ValueEnum};
use pictures::Pictures;

/// Shows motions that were sketched with a few keys each.
#[derive(Parser)]
struct Arguments {
    /// Who moves.
    #[arg(long, value_enum, default_value = "human")]
    figure: Who,
    /// How much of the run is in the man's blend, 0 to 1; it comes and goes by itself if not given.
    #[arg(long, value_name = "SHARE", value_parser = parse_share)]
    blend: Option<f32>,
    #[command(flatten)]
    pictures: Pictures,
}

#[derive(Clone, Copy, ValueEnum)]
enum Who {
    Human,
    Horse,
}

fn parse_share(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err(format!("\"{text}\" is no share from 0 to 1")),
    }
}

/// Two clips in one graph, and how they are mixed.
#[derive(Resource)]
struct Gaits {
    walk: Gait,
    run: Gait,
    /// How much of the run there is; changes by itself if `None`.
    blend: Option<f32>,
}

struct Gait {
    clip: Handle<StickClip>,
    node: AnimationNodeIndex,
}

fn main() -> ExitCode {
    let Arguments {
        figure,
        blend,
        pictures,
    } = Arguments::parse();
    let result = pictures.launch("clips").run(|app| {
        app.add_plugins(Stick3dPlugin)
            .add_systems(Startup, (scene::build, lay_stones, spawn_camera))
            .add_systems(Update, pictures::pause_on_space)
            .add_systems(
                PostUpdate,
                follow
                    .after(Stick3dSystems::Animate)
                    .before(TransformSystems::Propagate),
            );
        match figure {
            Who::Horse => app.add_systems(Startup, spawn_horse),
            Who::Human => app
                .insert_resource(Blend(blend))
                .add_systems(Startup, spawn_man)
                .add_systems(Update, (set_blend, mix).chain()),
        };
    });
    launch::ended("clip_player", result, LaunchError::exit_code)
}

/// One clip: nothing else is needed.
fn spawn_horse(mut commands: Commands, assets: Res<AssetServer>) {
    let gallop = assets.load("clips/horse_gallop.clip.ron");
    commands.spawn((StickFigure::horse(), PlayStickClip(gallop)));
}

/// What was asked for on the command line.
#[derive(Resource, Clone, Copy)]
struct Blend(Option<f32>);

/// Two clips that a graph blends.
fn spawn_man(
    mut commands: Commands,
    assets: Res<AssetServer>,
    animations: Res<Assets<AnimationClip>>,
    mut clips: ResMut<StickClips>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    blend: Res<Blend>,
) {
    let files = ["clips/walk.clip.ron", "clips/run.clip.ron"];
    let [walk, run] = files.map(|file| assets.load(file));
    // The clips are empty until their files are loaded; the graph can be made at once.
    let handles = [&walk, &run].map(|clip| clips.animation(clip, &HUMAN_MODEL, &animations));
    let (graph, nodes) = AnimationGraph::from_clips(handles);
    commands.spawn((
        StickFigure::human(),
        AnimationPlayer::default(),
        AnimationGraphHandle(graphs.add(graph)),
    ));
    let [walk, run] = [(walk, nodes[0]), (run, nodes[1])].map(|(clip, node)| Gait { clip, node });
    commands.insert_resource(Gaits {
        walk,
        run,
        blend: blend.0,
    });
}

/// Plays the two clips once both are there, weighs them, and lets both take a step in the same time, so that their feet come
/// down together.
fn mix(
    mut players: Query<&mut AnimationPlayer>,
    gaits: Res<Gaits>,
    clips: Res<StickClips>,
    time: Res<Time>,
) {
    let of = |gait: &Gait| clips.curve(&gait.clip, &HUMAN_MODEL);
    let (Some(walk), Some(run)) = (of(&gaits.walk), of(&gaits.run)) else {
        return;
    };
    let to_and_fro = 0.5 - 0.5 * (0.5 * time.elapsed_secs()).cos();
    let share = gaits.blend.unwrap_or(to_and_fro);
    let (walk_s, run_s) = (walk.duration_s(), run.duration_s());
    let round_s = walk_s + share * (run_s - walk_s);
    for mut player in &mut players {
        for (gait, weight, clip_s) in [
            (&gaits.walk, 1.0 - share, walk_s),
            (&gaits.run, share, run_s),
        ] {
            let active = player.play(gait.node).repeat();
            active.set_weight(weight).set_speed(clip_s / round_s);
        }
    }
}

/// Up and down: more and less of the run.
fn set_blend(keys: Res<ButtonInput<KeyCode>>, mut gaits: ResMut<Gaits>) {
    for (key, change) in [(KeyCode::ArrowUp, 0.1), (KeyCode::ArrowDown, -0.1)] {
        if keys.just_pressed(key) {
            let share = gaits.blend.unwrap_or(0.0) + change;
            gaits.blend = Some(share.clamp(0.0, 1.0));
        }
    }
}

fn spawn_camera(mut commands: Commands) {
    commands.spawn((Camera3d::default(), Transform::default()));
}

/// The camera goes along with the figure, as far off as its body is large.
fn follow(
    figures: Query<(&Transform, &Aabb), (With<StickFigure>, Without<Camera3d>)>,
    mut cameras: Query<&mut Transform, With<Camera3d>>,
    mut distance_m: Local<Option<f32>>,
) {
    for ((figure, body), mut camera) in figures.iter().zip(&mut cameras) {
        let distance_m = distance_m.get_or_insert(2.7 * body.half_extents.length());
        let centre = figure.translation + Vec3::from(body.center) * Vec3::X + Vec3::Y * 0.9;
        let from = centre + *distance_m * Vec3::new(0.1, 0.14, 1.0).normalize();
        *camera = Transform::from_translation(from).looking_at(centre, Vec3::Y);
    }
}

/// Stones on the meadow, to see the way by: one every metre.
fn lay_stones(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let stone = meshes.add(Sphere::new(0.035));
    let grey = materials.add(StandardMaterial {
        base_color: Color::srgb(0.78, 0.79, 0.74),
        perceptual_roughness: 1.0,
        ..default()
    });
    for x in -4..30 {
        for z in -6..14 {
            commands.spawn((
                Mesh3d(stone.clone()),
                MeshMaterial3d(grey.clone()),
                Transform::from_xyz(x as f32, 0.0, z as f32).with_scale(Vec3::new(1.0, 0.4, 1.0)),
            ));
        }
    }
}
