//! Exported motions in Bevy's own glTF loader: they load, play, and show the bodies that the motion has.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::time::{Duration, Instant};

use bevy::animation::AnimationPlugin;
use bevy::asset::AssetPlugin;
use bevy::gltf::{GltfAssetLabel, GltfPlugin};
use bevy::mesh::MeshPlugin;
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::world_serialization::WorldSerializationPlugin;
use bevy_stick3d::figure_data::Sketch;
use stick3d_model::export::animation::{
    AnimationMesh, AnimationReport, DEFAULT_TOLERANCE_M, FrameSettings, sample_frames,
    save_glb_animation,
};
use stick3d_model::latent::{Easing, MotionSettings};
use stick3d_model::{Inference, LatentKey, Model, Motion};

/// Two ticks of the clock are one frame of the clips.
const TICK: Duration = Duration::from_nanos(16_666_667);

/// A motion through sketches of the repository, 0.4 s apart.
fn motion(inference: &mut Inference, sketches: &[&str]) -> Motion {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/sketches");
    let keys = (0_u8..).zip(sketches).map(|(index, name)| {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let sketch = Sketch::from_json(inference.figure(), &bytes).unwrap();
        let mut latent = vec![0.0; inference.latent_len()];
        inference.encode(&sketch, &mut latent).unwrap();
        LatentKey {
            latent,
            time_s: 0.4 * f32::from(index),
            easing: Easing::Linear,
        }
    });
    let keys: Vec<_> = keys.collect();
    Motion::new(&keys, MotionSettings::default(), inference).unwrap()
}

/// An app that has what glTF files and their animations need, and no renderer.
fn app(folder: &Path) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        AssetPlugin {
            file_path: folder.to_str().unwrap().to_owned(),
            ..default()
        },
        TransformPlugin,
        MeshPlugin,
        WorldSerializationPlugin,
        AnimationPlugin,
        GltfPlugin::default(),
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
    app.finish();
    app.cleanup();
    app
}

/// Loads `clip.glb` and starts its animation as the manual of Bevy says.
fn play(app: &mut App) -> Entity {
    let server = app.world().resource::<AssetServer>();
    let clip = server.load(GltfAssetLabel::Animation(0).from_asset("clip.glb"));
    let scene = server.load(GltfAssetLabel::Scene(0).from_asset("clip.glb"));
    let (graph, node) = AnimationGraph::from_clip(clip.clone());
    let graph = app
        .world_mut()
        .resource_mut::<Assets<AnimationGraph>>()
        .add(graph);
    app.world_mut().spawn(WorldAssetRoot(scene));
    let start = Instant::now();
    let mut players = app
        .world_mut()
        .query_filtered::<Entity, With<AnimationPlayer>>();
    loop {
        assert!(start.elapsed() < Duration::from_secs(60), "it never loaded");
        app.update();
        let loaded = app
            .world()
            .resource::<Assets<AnimationClip>>()
            .contains(&clip);
        if let Some(entity) = players.iter(app.world()).next().filter(|_| loaded) {
            let mut entity = app.world_mut().entity_mut(entity);
            entity.insert(AnimationGraphHandle(graph));
            let mut player = entity.get_mut::<AnimationPlayer>().unwrap();
            player.play(node);
            return entity.id();
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Where Bevy puts the vertices: the mesh, what morph targets add, and the node's place.
fn shown(app: &mut App) -> Vec<Vec3> {
    let mut nodes = app.world_mut().query::<(&MorphWeights, &GlobalTransform)>();
    let (weights, transform) = nodes.single(app.world()).unwrap();
    let meshes = app.world().resource::<Assets<Mesh>>();
    let mesh = meshes.get(weights.first_mesh().unwrap()).unwrap();
    let base = mesh.attribute(Mesh::ATTRIBUTE_POSITION).unwrap();
    let mut positions: Vec<Vec3> = base
        .as_float3()
        .unwrap()
        .iter()
        .map(|p| (*p).into())
        .collect();
    let targets = mesh.get_morph_targets().unwrap();
    for (weight, target) in weights
        .weights()
        .iter()
        .zip(targets.chunks(positions.len()))
    {
        for (position, added) in positions.iter_mut().zip(target) {
            *position += *weight * added.position;
        }
    }
    positions
        .into_iter()
        .map(|position| transform.transform_point(position))
        .collect()
}

/// Exports a motion, plays it, and compares it with itself at every second tick, which is where its frames are.
fn plays(model: &[u8], sketches: &[&str]) -> AnimationReport {
    let model = Model::from_bytes(model).unwrap();
    let mut inference = Inference::new(&model).unwrap();
    let motion = motion(&mut inference, sketches);
    let settings = FrameSettings {
        past_s: 0.2,
        ..FrameSettings::default()
    };
    let frames = sample_frames(&motion, settings, &mut inference).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let report = save_glb_animation(
        &folder.path().join("clip.glb"),
        &AnimationMesh::of(&model, "clip"),
        frames,
        DEFAULT_TOLERANCE_M,
    )
    .unwrap();

    let mut app = app(folder.path());
    let player = play(&mut app);
    let mut latent = vec![0.0; inference.latent_len()];
    let mut meant = vec![[0.0; 3]; inference.vertex_count()];
    let (mut times_s, mut moved_m) = (vec![], 0.0_f32);
    let first = shown(&mut app);
    while times_s.len() + 1 < report.frame_count {
        app.update();
        app.update();
        let player = app.world().get::<AnimationPlayer>(player).unwrap();
        let (_, playing) = player.playing_animations().next().unwrap();
        let time_s = playing.seek_time();
        times_s.push(time_s);
        motion.sample_into(time_s, &mut latent).unwrap();
        inference.decode_positions(&latent, &mut meant).unwrap();
        let root = motion.root_translation(time_s).unwrap();
        let shown = shown(&mut app);
        assert_eq!(shown.len(), meant.len());
        for ((shown, meant), first) in shown.iter().zip(&meant).zip(&first) {
            let away_m = shown.distance(Vec3::from(*meant) + root);
            // A hair of the time step is between the clock's ticks and the frames.
            assert!(
                away_m < DEFAULT_TOLERANCE_M + 2e-4,
                "{away_m} m away at {time_s} s"
            );
            moved_m = moved_m.max(shown.distance(*first));
        }
    }
    assert!(moved_m > 0.3, "it moved by {moved_m} m");
    assert!(
        (times_s[0] - 1.0 / 30.0).abs() < 1e-4 && times_s.is_sorted(),
        "{times_s:?}"
    );
    report
}

#[test]
fn a_man_plays() {
    let report = plays(
        stick3d_human::MODEL,
        &["standing.json", "walk.json", "wave.json"],
    );
    assert_eq!(report.frame_count, 31);
}

#[test]
fn a_horse_plays() {
    let report = plays(
        stick3d_horse::MODEL,
        &["horse_walk.json", "horse_rear.json"],
    );
    assert_eq!(report.frame_count, 19);
}
