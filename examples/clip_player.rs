//! Clips from files: a man who goes over from a walk to a run and back, two clips that a graph blends; and a galloping horse.
//!
//! `cargo run --release --example clip_player`
//! `cargo run --release --example clip_player -- --figure horse`
//! `cargo run --release --example clip_player -- --screenshot frames --frames 12 --every 8`
//!
//! Up and down: faster and slower. Space pauses.

mod pictures;
mod scene;

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_stick3d::prelude::*;
use bevy_stick3d::{HORSE_MODEL, HUMAN_MODEL};
use clap::{Parser, ValueEnum};
use pictures::Pictures;

/// Shows motions that were sketched with a few keys each.
#[derive(Parser)]
struct Arguments {
    /// Who moves.
    #[arg(long, value_enum, default_value = "human")]
    figure: Who,
    /// How much of the faster clip is in the blend at first, 0 to 1; it comes and goes by itself if not given.
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
    model: Handle<StickModel>,
    slow: Gait,
    fast: Gait,
    /// How much of the fast one there is; changes by itself if `None`.
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
    let (model, slow, fast) = match figure {
        Who::Human => (HUMAN_MODEL, "clips/walk.clip.ron", "clips/run.clip.ron"),
        Who::Horse => (
            HORSE_MODEL,
            "clips/horse_walk.clip.ron",
            "clips/horse_gallop.clip.ron",
        ),
    };
    let result = pictures.launch("two clips, blended").run(|app| {
        let spawn = move |commands: Commands,
                          assets: Res<AssetServer>,
                          clips: ResMut<StickClips>,
                          animations: Res<Assets<AnimationClip>>,
                          graphs: ResMut<Assets<AnimationGraph>>| {
            let files = [slow, fast].map(|file| assets.load(file));
            spawn_figure(commands, clips, animations, graphs, &model, files, blend);
        };
        app.add_plugins(Stick3dPlugin)
            .add_systems(Startup, (scene::build, spawn, spawn_camera))
            .add_systems(Update, (pause_on_space, mix).chain())
            .add_systems(
                PostUpdate,
                follow
                    .after(Stick3dSystems::Animate)
                    .before(TransformSystems::Propagate),
            );
    });
    pictures::ended("clip_player", result)
}

fn spawn_figure(
    mut commands: Commands,
    mut clips: ResMut<StickClips>,
    animations: Res<Assets<AnimationClip>>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    model: &Handle<StickModel>,
    files: [Handle<StickClip>; 2],
    blend: Option<f32>,
) {
    let [slow, fast] = files;
    // The clips are empty until their files are loaded; the graph can be made at once.
    let handles = [&slow, &fast].map(|clip| clips.animation(clip, model, &animations));
    let mut graph = AnimationGraph::new();
    let root = graph.root;
    let [slow_node, fast_node] = handles.map(|handle| graph.add_clip(handle, 1.0, root));
    let mut player = AnimationPlayer::default();
    player.play(slow_node).repeat();
    player.play(fast_node).repeat();
    commands.spawn((
        StickFigure(model.clone()),
        player,
        AnimationGraphHandle(graphs.add(graph)),
    ));
    commands.insert_resource(Gaits {
        model: model.clone(),
        slow: Gait {
            clip: slow,
            node: slow_node,
        },
        fast: Gait {
            clip: fast,
            node: fast_node,
        },
        blend,
    });
}

/// Weighs the two clips, and lets both take one step in the same time, so that their feet come down together.
fn mix(
    mut players: Query<&mut AnimationPlayer>,
    gaits: Res<Gaits>,
    clips: Res<StickClips>,
    time: Res<Time>,
) {
    let Gaits {
        model, slow, fast, ..
    } = &*gaits;
    let of = |gait: &Gait| clips.curve(&gait.clip, model);
    let (Some(slow_curve), Some(fast_curve)) = (of(slow), of(fast)) else {
        return;
    };
    let to_and_fro = 0.5 - 0.5 * (0.5 * time.elapsed_secs()).cos();
    let share = gaits.blend.unwrap_or(to_and_fro);
    let (slow_s, fast_s) = (slow_curve.duration_s(), fast_curve.duration_s());
    let round_s = slow_s + share * (fast_s - slow_s);
    for mut player in &mut players {
        for (gait, weight, clip_s) in [(slow, 1.0 - share, slow_s), (fast, share, fast_s)] {
            if let Some(active) = player.animation_mut(gait.node) {
                active.set_weight(weight).set_speed(clip_s / round_s);
            }
        }
    }
}

fn pause_on_space(
    keys: Res<ButtonInput<KeyCode>>,
    mut time: ResMut<Time<Virtual>>,
    mut gaits: ResMut<Gaits>,
) {
    if keys.just_pressed(KeyCode::Space) {
        if time.is_paused() {
            time.unpause();
        } else {
            time.pause();
        }
    }
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

/// The camera goes along with the figure.
fn follow(
    figures: Query<&Transform, (With<StickFigure>, Without<Camera3d>)>,
    mut cameras: Query<&mut Transform, With<Camera3d>>,
) {
    for (figure, mut camera) in figures.iter().zip(&mut cameras) {
        let centre = figure.translation + Vec3::new(0.0, 0.95, 0.0);
        *camera = Transform::from_translation(centre + Vec3::new(0.4, 0.5, 4.2))
            .looking_at(centre, Vec3::Y);
    }
}
