//! The smallest game: one man in a drawn pose, and light to see him by.
//!
//! `cargo run --example spawn_pose`

use bevy::prelude::*;
use bevy_stick3d::prelude::*;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, Stick3dPlugin))
        .add_systems(Startup, setup)
        .run();
}

fn setup(mut commands: Commands) -> Result {
    // One point per joint, x right, y up, in any unit. "Right" is the man's own, on the left of the picture.
    let cheer = StickSketch::human([
        ("forehead", vec2(0.0, 1.70)),
        ("neck", vec2(0.0, 1.50)),
        ("elbow_r", vec2(-0.35, 1.72)),
        ("hand_r", vec2(-0.45, 2.05)),
        ("elbow_l", vec2(0.35, 1.72)),
        ("hand_l", vec2(0.45, 2.05)),
        ("abdomen", vec2(0.0, 0.97)),
        ("knee_r", vec2(-0.16, 0.52)),
        ("foot_r", vec2(-0.24, 0.05)),
        ("knee_l", vec2(0.16, 0.52)),
        ("foot_l", vec2(0.24, 0.05)),
    ])?;
    commands.spawn((StickFigure::human(), cheer));

    commands.spawn((
        DirectionalLight::default(),
        Transform::from_xyz(-1.0, 3.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(1.2, 1.6, 3.6).looking_at(Vec3::new(0.0, 1.0, 0.0), Vec3::Y),
    ));
    Ok(())
}
