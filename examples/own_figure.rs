//! A figure of your own: a model file that `stick3d train` wrote, posed after a sketch, in a lit scene.
//!
//! `cargo run --example own_figure -- fox.stick3d fox_sketch.json`
//! `cargo run --example own_figure -- fox.stick3d fox_sketch.json --screenshot fox.png`

mod scene;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use bevy::camera::primitives::Aabb;
use bevy::prelude::*;
use bevy_stick3d::launch::{self, Launch, LaunchError, asset_place};
use bevy_stick3d::prelude::*;
use clap::Parser;

/// Shows the figure of a model file in the pose of a sketch.
#[derive(Parser)]
struct Arguments {
    /// The model file, as `stick3d train` writes it.
    #[arg(value_name = "MODEL.stick3d")]
    model: PathBuf,
    /// The sketch file.
    #[arg(value_name = "SKETCH.json")]
    sketch: PathBuf,
    /// Take a picture without opening a window, and end.
    #[arg(long, value_name = "OUT.png")]
    screenshot: Option<PathBuf>,
}

/// The sketch file, until the model is there to say what its joints mean.
#[derive(Resource)]
struct SketchFile {
    path: PathBuf,
    bytes: Vec<u8>,
}

fn main() -> ExitCode {
    launch::ended("own_figure", run(Arguments::parse()), |error| {
        error.downcast_ref().map_or(1, LaunchError::exit_code)
    })
}

fn run(arguments: Arguments) -> anyhow::Result<()> {
    let (folder, file) = asset_place(&arguments.model)?;
    let bytes = std::fs::read(&arguments.sketch)
        .with_context(|| format!("cannot read the sketch {}", arguments.sketch.display()))?;
    let launch = Launch {
        title: format!("stick3d: {file}"),
        size_px: UVec2::new(1280, 720),
        screenshot: arguments.screenshot,
        asset_folder: Some(folder),
        ..default()
    };
    launch.run(|app| {
        app.add_plugins(Stick3dPlugin)
            .insert_resource(SketchFile {
                path: arguments.sketch,
                bytes,
            })
            .add_systems(
                Startup,
                move |commands: Commands, assets: Res<AssetServer>| {
                    spawn_figure(commands, assets.load(file.clone()));
                },
            )
            .add_systems(Startup, (scene::build, spawn_camera))
            .add_systems(Update, (pose_when_loaded, end_on_problem))
            .add_systems(PostUpdate, frame_body.after(Stick3dSystems::Dress));
    })?;
    Ok(())
}

/// The model is all that says which figure it is.
fn spawn_figure(mut commands: Commands, model: Handle<StickModel>) {
    commands.spawn(StickFigure(model));
}

/// Once the model is loaded, its figure tells how to read the sketch.
fn pose_when_loaded(
    mut commands: Commands,
    figures: Query<(Entity, &StickFigure), Without<StickSketch>>,
    models: Res<Assets<StickModel>>,
    file: Res<SketchFile>,
    mut exit: MessageWriter<AppExit>,
) {
    for (entity, figure) in &figures {
        let Some(model) = models.get(&figure.0) else {
            continue;
        };
        match Sketch::from_json(model.figure(), &file.bytes) {
            Ok(sketch) => {
                commands.entity(entity).insert(StickSketch::from(sketch));
            }
            Err(problem) => {
                error!("{} does not fit the model: {problem}", file.path.display());
                exit.write(AppExit::error());
            }
        }
    }
}

/// A model that cannot be loaded has been logged by the plugin; there is nothing to look at.
fn end_on_problem(figures: Query<&FigureStatus>, mut exit: MessageWriter<AppExit>) {
    if figures.iter().any(|status| status.problem().is_some()) {
        exit.write(AppExit::error());
    }
}

fn spawn_camera(mut commands: Commands) {
    commands.spawn((Camera3d::default(), Transform::default()));
}

/// Keeps the camera in front of the body, whatever its size.
fn frame_body(
    bodies: Query<&Aabb, (With<StickFigure>, Changed<Aabb>)>,
    mut cameras: Query<&mut Transform, With<Camera3d>>,
) {
    for (body, mut camera) in bodies.iter().zip(&mut cameras) {
        let centre = Vec3::from(body.center);
        let distance = 2.4 * Vec3::from(body.half_extents).length();
        let from = Vec3::new(0.45, 0.28, 1.0).normalize() * distance;
        *camera = Transform::from_translation(centre + from).looking_at(centre, Vec3::Y);
    }
}
