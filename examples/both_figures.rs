//! A man and a horse in one scene, each from a drawing of its own.
//!
//! `cargo run --example both_figures`
//! `cargo run --example both_figures -- --screenshot both.png`

mod scene;

use std::path::PathBuf;
use std::process::ExitCode;

use bevy::prelude::*;
use bevy_stick3d::launch::{self, Launch, LaunchError};
use bevy_stick3d::prelude::*;
use clap::Parser;

/// Shows a man and a horse side by side.
#[derive(Parser)]
struct Arguments {
    /// Take a picture without opening a window, and end.
    #[arg(long, value_name = "OUT.png")]
    screenshot: Option<PathBuf>,
}

fn main() -> ExitCode {
    let launch = Launch {
        title: "stick3d: a man and a horse".to_owned(),
        size_px: UVec2::new(1280, 720),
        screenshot: Arguments::parse().screenshot,
        ..default()
    };
    let ended = launch.run(|app| {
        app.add_plugins(Stick3dPlugin)
            .add_systems(Startup, (scene::build, spawn_figures, spawn_camera));
    });
    launch::ended("both_figures", ended, LaunchError::exit_code)
}

fn spawn_figures(mut commands: Commands) -> Result {
    // One point per joint, x right, y up, in any unit. "Right" is the figure's own.
    let man = StickSketch::human([
        ("forehead", vec2(0.02, 1.68)),
        ("neck", vec2(0.0, 1.49)),
        ("elbow_r", vec2(-0.24, 1.18)),
        ("hand_r", vec2(-0.30, 0.86)),
        ("elbow_l", vec2(0.27, 1.22)),
        ("hand_l", vec2(0.52, 1.33)),
        ("abdomen", vec2(0.0, 0.96)),
        ("knee_r", vec2(-0.13, 0.51)),
        ("foot_r", vec2(-0.17, 0.05)),
        ("knee_l", vec2(0.12, 0.52)),
        ("foot_l", vec2(0.16, 0.05)),
    ])?;
    // Seen from its right side, as it walks to the right.
    let horse = StickSketch::horse([
        ("forehead", vec2(1.12, 1.83)),
        ("shoulder", vec2(0.55, 1.20)),
        ("knee_fr", vec2(0.74, 0.52)),
        ("foot_fr", vec2(0.86, 0.06)),
        ("knee_fl", vec2(0.46, 0.50)),
        ("foot_fl", vec2(0.26, 0.10)),
        ("hip", vec2(-0.50, 1.22)),
        ("knee_br", vec2(-0.66, 0.58)),
        ("foot_br", vec2(-0.46, 0.08)),
        ("knee_bl", vec2(-0.88, 0.58)),
        ("foot_bl", vec2(-0.98, 0.06)),
        ("tail", vec2(-1.12, 0.80)),
    ])?;
    commands.spawn((
        StickFigure::human(),
        man,
        Transform::from_xyz(-1.35, 0.0, 0.2),
    ));
    commands.spawn((
        StickFigure::horse(),
        horse,
        Transform::from_xyz(0.75, 0.0, -0.3),
    ));
    Ok(())
}

fn spawn_camera(mut commands: Commands) {
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.5, 1.5, 4.5).looking_at(Vec3::new(0.15, 0.95, 0.0), Vec3::Y),
    ));
}
