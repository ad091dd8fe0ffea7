//! What the headless tests share: an app without window or renderer, and questions to ask of it.
#![allow(dead_code, reason = "every test uses some of it")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::time::Duration;

use bevy::asset::AssetPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_stick3d::prelude::*;

/// What the clock ticks per update.
pub(crate) const TICK: Duration = Duration::from_micros(16_667);

/// An app with nothing but what the plugin needs, and a clock that ticks a 60th of a second per update.
pub(crate) fn app() -> App {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data");
    app_with(Path::new(data), |_| {})
}

/// As [`app`], with assets in another folder, and with what `add` adds.
pub(crate) fn app_with(assets: &Path, add: impl FnOnce(&mut App)) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        AssetPlugin {
            file_path: assets.display().to_string(),
            ..default()
        },
        TransformPlugin,
        Stick3dPlugin,
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
    add(&mut app);
    app.finish();
    app.cleanup();
    app
}

/// The man with his arms stretched out to the sides, level.
pub(crate) fn t_pose() -> StickSketch {
    let mut points = Figure::human().template.clone();
    let neck = points[joint("neck")];
    for (name, x) in [
        ("elbow_r", -0.33),
        ("hand_r", -0.62),
        ("elbow_l", 0.33),
        ("hand_l", 0.62),
    ] {
        points[joint(name)] = neck + vec2(x, -0.03);
    }
    StickSketch::new(points)
}

/// The man with both arms up.
pub(crate) fn cheer() -> StickSketch {
    let mut points = Figure::human().template.clone();
    let neck = points[joint("neck")];
    for (name, x, y) in [
        ("elbow_r", -0.30, 0.22),
        ("hand_r", -0.38, 0.52),
        ("elbow_l", 0.30, 0.22),
        ("hand_l", 0.38, 0.52),
    ] {
        points[joint(name)] = neck + vec2(x, y);
    }
    StickSketch::new(points)
}

/// The handle of a clip that is an asset of the app from now on.
pub(crate) fn add_clip(app: &mut App, clip: StickClip) -> Handle<StickClip> {
    app.world_mut()
        .resource_mut::<Assets<StickClip>>()
        .add(clip)
}

/// The index of a joint of the man.
pub(crate) fn joint(name: &str) -> usize {
    Figure::human().joint_index(name).unwrap()
}

/// The positions of an entity's mesh; none when it has no mesh yet.
pub(crate) fn positions(app: &App, entity: Entity) -> Option<Vec<Vec3>> {
    let mesh = app.world().get::<Mesh3d>(entity)?;
    let mesh = app.world().resource::<Assets<Mesh>>().get(mesh)?;
    let values = mesh.attribute(Mesh::ATTRIBUTE_POSITION)?.as_float3()?;
    Some(
        values
            .iter()
            .map(|&position| Vec3::from(position))
            .collect(),
    )
}

/// The normals of an entity's mesh.
pub(crate) fn normals(app: &App, entity: Entity) -> Option<Vec<Vec3>> {
    let mesh = app.world().get::<Mesh3d>(entity)?;
    let mesh = app.world().resource::<Assets<Mesh>>().get(mesh)?;
    let values = mesh.attribute(Mesh::ATTRIBUTE_NORMAL)?.as_float3()?;
    Some(values.iter().map(|&normal| Vec3::from(normal)).collect())
}

/// The corners of the box round a body.
pub(crate) fn bounds(positions: &[Vec3]) -> (Vec3, Vec3) {
    positions
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| {
            (low.min(p), high.max(p))
        })
}

/// How an entity says it is doing.
pub(crate) fn status(app: &App, entity: Entity) -> FigureStatus {
    app.world().get::<FigureStatus>(entity).unwrap().clone()
}

/// Which meshes were written since the last look.
pub(crate) fn modified_meshes(app: &mut App) -> usize {
    app.world_mut()
        .resource_mut::<Messages<AssetEvent<Mesh>>>()
        .drain()
        .filter(|event| matches!(event, AssetEvent::Modified { .. }))
        .count()
}

/// How many times meshes are written in so many frames.
pub(crate) fn writes_in(app: &mut App, frames: usize) -> usize {
    modified_meshes(app);
    let writes = (0..frames).map(|_| {
        app.update();
        modified_meshes(app)
    });
    writes.sum()
}
