//! Many men who walk, each in a time of his own, and how long a frame takes with them. Space pauses.
//!
//! `cargo run --example crowd -- 20`
//! `cargo run --example crowd -- 20 --measure 300`
//! `cargo run --example crowd -- 12 --screenshot crowd.png`

mod pictures;
mod scene;

use std::io::Write as _;
use std::process::ExitCode;
use std::time::Instant;

use bevy::prelude::*;
use bevy_stick3d::animation::StartedClip;
use bevy_stick3d::launch::{self, LaunchError};
use bevy_stick3d::prelude::*;
use clap::Parser;
use pictures::Pictures;

/// Shows a crowd.
#[derive(Parser)]
struct Arguments {
    /// How many.
    #[arg(value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=2000))]
    count: u16,
    /// Run for so many frames, print how long they took, and end.
    #[arg(long, value_name = "K")]
    measure: Option<usize>,
    #[command(flatten)]
    pictures: Pictures,
}

/// How far apart they walk, metres.
const SPACING_M: Vec2 = Vec2::new(1.3, 1.1);

/// The place of a man in the crowd.
#[derive(Component)]
struct Member(u16);

/// The field that they cross, from edge to edge, metres.
#[derive(Resource)]
struct FieldWidth(f32);

/// The frames so far.
#[derive(Resource)]
struct Measure {
    /// How many to take.
    count: usize,
    last: Option<Instant>,
    times_ms: Vec<f32>,
}

fn main() -> ExitCode {
    let Arguments {
        count,
        measure,
        pictures,
    } = Arguments::parse();
    let result = pictures.launch("a crowd").run(|app| {
        app.add_plugins(Stick3dPlugin)
            .add_systems(
                Startup,
                (
                    scene::build,
                    move |commands: Commands, assets: Res<AssetServer>| {
                        spawn_crowd(commands, &assets, count);
                    },
                ),
            )
            .add_systems(Update, (pictures::pause_on_space, set_times, walk_round));
        if let Some(frames) = measure {
            app.insert_resource(Measure {
                count: frames.max(1),
                last: None,
                times_ms: vec![],
            })
            .add_systems(Last, measure_frames);
        }
    });
    launch::ended("crowd", result, LaunchError::exit_code)
}

fn spawn_crowd(mut commands: Commands, assets: &AssetServer, count: u16) {
    let walk = assets.load("clips/walk.clip.ron");
    let columns = f32::from(count).sqrt().ceil();
    let rows = (f32::from(count) / columns).ceil();
    for index in 0..count {
        let (row, column) = (
            (f32::from(index) / columns).floor(),
            f32::from(index) % columns,
        );
        // Every other row half a step aside, so that they do not hide each other.
        let aside = 0.5 * (row % 2.0);
        let x = (column + aside - 0.5 * columns) * SPACING_M.x;
        commands.spawn((
            StickFigure::human(),
            PlayStickClip(walk.clone()),
            Transform::from_xyz(x, 0.0, -row * SPACING_M.y),
            Member(index),
        ));
    }
    commands.insert_resource(FieldWidth((columns + 1.0) * SPACING_M.x));
    let centre = Vec3::new(0.0, 0.7, -0.45 * (rows - 1.0) * SPACING_M.y);
    let distance = 3.0 + 0.95 * columns.max(rows) * SPACING_M.x;
    let from = Vec3::new(0.12, 0.38, 1.0).normalize() * distance;
    commands.spawn((
        Camera3d::default(),
        Transform::from_translation(centre + from).looking_at(centre, Vec3::Y),
    ));
}

/// As soon as one starts, he gets a place in the walk and a pace of his own.
fn set_times(
    mut members: Query<(&Member, &StartedClip, &mut AnimationPlayer), Changed<StartedClip>>,
) {
    // Shares of a round that no two of a few hundred have in common.
    let share = |index: u16, step: f32| (f32::from(index) * step).fract();
    for (Member(index), started, mut player) in &mut members {
        if let Some(active) = started.node().and_then(|node| player.animation_mut(node)) {
            active
                .set_seek_time(share(*index, 0.618_034))
                .set_speed(0.85 + 0.3 * share(*index, 0.754_878));
        }
    }
}

/// Who leaves the field on one side comes back on the other.
fn walk_round(mut members: Query<&mut Transform, With<Member>>, field: Res<FieldWidth>) {
    for mut place in &mut members {
        if place.translation.x > 0.5 * field.0 {
            place.translation.x -= field.0;
        }
    }
}

fn measure_frames(
    mut measure: ResMut<Measure>,
    members: Query<&FigureStatus, With<Member>>,
    mut exit: MessageWriter<AppExit>,
) {
    if members.iter().any(|status| *status != FigureStatus::Ready) {
        return;
    }
    let now = Instant::now();
    if let Some(last) = measure.last.replace(now) {
        let time_ms = 1000.0 * (now - last).as_secs_f32();
        measure.times_ms.push(time_ms);
    }
    if measure.times_ms.len() < measure.count {
        return;
    }
    let mut times_ms = std::mem::take(&mut measure.times_ms);
    times_ms.sort_by(f32::total_cmp);
    let at = |share: f32| times_ms[((times_ms.len() - 1) as f32 * share) as usize];
    let mean_ms = times_ms.iter().sum::<f32>() / times_ms.len() as f32;
    let report = format!(
        "{} figures, {} frames: mean {mean_ms:.2} ms, median {:.2} ms, 95 % within {:.2} ms, longest {:.2} ms",
        members.iter().count(),
        times_ms.len(),
        at(0.5),
        at(0.95),
        at(1.0),
    );
    // There is nobody to tell when this fails.
    let _ = writeln!(std::io::stdout(), "{report}");
    exit.write(AppExit::Success);
}
