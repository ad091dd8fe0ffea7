//! Two sketches become a motion: between them, and beyond both. Space pauses.
//!
//! `cargo run --example animate`
//! `cargo run --example animate -- --screenshot beyond.png --at 1.1`
//! `cargo run --example animate -- --screenshot frames --frames 8 --every 10`

mod pictures;
mod scene;

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_stick3d::launch::{self, LaunchError};
use bevy_stick3d::prelude::*;
use clap::Parser;
use pictures::Pictures;

/// Shows a man between two drawn poses, and beyond them.
#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    pictures: Pictures,
}

fn main() -> ExitCode {
    let launch = Arguments::parse().pictures.launch("between and beyond");
    let result = launch.run(|app| {
        app.add_plugins(Stick3dPlugin)
            .add_systems(Startup, (scene::build, spawn_figures, spawn_camera))
            .add_systems(Update, pictures::pause_on_space);
    });
    launch::ended("animate", result, LaunchError::exit_code)
}

fn spawn_figures(mut commands: Commands, mut clips: ResMut<Assets<StickClip>>) -> Result {
    // One point per joint, x right, y up, in any unit. "Right" is the man's own, on the left of the picture.
    let ready = StickSketch::human([
        ("forehead", vec2(0.0, 1.68)),
        ("neck", vec2(0.0, 1.49)),
        ("elbow_r", vec2(-0.27, 1.24)),
        ("hand_r", vec2(-0.40, 0.99)),
        ("elbow_l", vec2(0.27, 1.24)),
        ("hand_l", vec2(0.40, 0.99)),
        ("abdomen", vec2(0.0, 0.96)),
        ("knee_r", vec2(-0.13, 0.52)),
        ("foot_r", vec2(-0.18, 0.06)),
        ("knee_l", vec2(0.13, 0.52)),
        ("foot_l", vec2(0.18, 0.06)),
    ])?;
    let balancing = StickSketch::human([
        ("forehead", vec2(-0.16, 1.64)),
        ("neck", vec2(-0.10, 1.46)),
        ("elbow_r", vec2(-0.37, 1.46)),
        ("hand_r", vec2(-0.62, 1.58)),
        ("elbow_l", vec2(0.17, 1.58)),
        ("hand_l", vec2(0.36, 1.78)),
        ("abdomen", vec2(0.0, 0.96)),
        ("knee_r", vec2(-0.04, 0.51)),
        ("foot_r", vec2(-0.04, 0.06)),
        ("knee_l", vec2(0.36, 0.66)),
        ("foot_l", vec2(0.58, 0.30)),
    ])?;

    let clip = StickClip::builder(Figure::human())
        .sketch(0.0, ready.clone())
        .sketch(0.8, balancing.clone())
        // On along the same line for as far as the body is to be trusted, back, and to the other side.
        .extrapolation(Extrapolation::PingPong { least_trust: 0.5 })
        .build()?;
    commands.spawn((StickFigure::human(), PlayStickClip(clips.add(clip))));

    // What was drawn, beside it.
    for (x, sketch) in [(-1.7, ready), (1.6, balancing)] {
        let place = Transform::from_xyz(x, 0.0, -0.6);
        commands.spawn((StickFigure::human(), sketch, place));
    }
    Ok(())
}

fn spawn_camera(mut commands: Commands) {
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.3, 1.4, 3.9).looking_at(Vec3::new(0.0, 1.0, 0.0), Vec3::Y),
    ));
}
