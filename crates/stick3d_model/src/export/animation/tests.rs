//! Motions of the shipped man and invented ones, written and read back by other code.

use proptest::prelude::*;

use super::reduce::{Morphs, reduce};
use super::*;
use crate::latent::{Easing, Extrapolation, LatentKey, Motion, MotionSettings, Repeat};
use crate::synthetic::{Kind, model};
use crate::{Inference, Model};
use glam::Vec3;
use stick3d_figure::sketch::Sketch;

const TRIANGLES: [[u32; 3]; 2] = [[0, 2, 1], [0, 1, 2]];

/// A frame of three vertices.
fn frame(time_s: f32, positions: [[f32; 3]; 3]) -> Frame {
    Frame {
        time_s,
        positions: positions.to_vec(),
        normals: vec![[0.0, 1.0, 0.0]; 3],
        root: None,
    }
}

fn invented() -> AnimationMesh<'static> {
    AnimationMesh {
        name: "invented",
        colors: &[[200, 100, 50, 255]; 3],
        triangles: &TRIANGLES,
    }
}

/// Where the weights of a frame put the vertices.
fn rebuilt(morphs: &Morphs, frame: usize) -> Vec<Vec3> {
    let mut positions: Vec<Vec3> = morphs
        .base
        .positions
        .iter()
        .map(|p| Vec3::from(*p))
        .collect();
    for target in &morphs.targets {
        for (to, from) in positions.iter_mut().zip(&target.shape.positions) {
            *to += target.weights[frame] * Vec3::from(*from);
        }
    }
    positions
}

fn worst_m(morphs: &Morphs, frames: &[Frame]) -> f32 {
    let mut worst_m = 0.0_f32;
    for (index, frame) in frames.iter().enumerate() {
        for (made, meant) in rebuilt(morphs, index).iter().zip(&frame.positions) {
            worst_m = worst_m.max(made.distance(Vec3::from(*meant)));
        }
    }
    worst_m
}

/// The man's motion through some sketches, half a second apart.
fn walk(settings: MotionSettings) -> (Model, Inference, Motion) {
    let model =
        Model::from_bytes(include_bytes!("../../../../../assets/models/human.stick3d")).unwrap();
    let mut inference = Inference::new(&model).unwrap();
    let sketches: [&[u8]; 3] = [
        include_bytes!("../../../../../assets/sketches/standing.json"),
        include_bytes!("../../../../../assets/sketches/walk.json"),
        include_bytes!("../../../../../assets/sketches/wave.json"),
    ];
    let keys = (0_u8..).zip(sketches).map(|(index, sketch)| {
        let sketch = Sketch::from_json(inference.figure(), sketch).unwrap();
        let mut latent = vec![0.0; inference.latent_len()];
        inference.encode(&sketch, &mut latent).unwrap();
        LatentKey {
            latent,
            time_s: 0.25 + 0.5 * f32::from(index),
            easing: Easing::InOut,
        }
    });
    let keys: Vec<_> = keys.collect();
    let motion = Motion::new(&keys, settings, &mut inference).unwrap();
    (model, inference, motion)
}

fn still() -> MotionSettings {
    MotionSettings {
        grounded: false,
        ..MotionSettings::default()
    }
}

proptest! {
    #[test]
    fn every_frame_is_rebuilt_within_the_tolerance(
        bodies in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-2.0_f32..2.0)), 1..20),
        tolerance_m in prop::sample::select(vec![1e-5_f32, 1e-3, 0.1, 3.0]),
    ) {
        let frames: Vec<Frame> = bodies.iter().map(|body| frame(0.0, *body)).collect();
        let morphs = reduce(frames.clone(), tolerance_m, MOST_TARGETS).unwrap();
        let worst_m = worst_m(&morphs, &frames);
        prop_assert!(worst_m <= tolerance_m + 5e-6, "{worst_m}");
        prop_assert!((worst_m - morphs.worst_m).abs() < 5e-6, "said {}, is {worst_m}", morphs.worst_m);
        prop_assert_eq!(&morphs.base.positions, &frames[0].positions);
        // Three vertices in space can differ from the first body in nine ways; one more target lifts the weights.
        prop_assert!(morphs.targets.len() <= 9.min(frames.len() - 1) + 1, "{}", morphs.targets.len());
        let mut weights = morphs.targets.iter().flat_map(|target| &target.weights);
        prop_assert!(weights.all(|weight| (0.0..=1.0).contains(weight)));
    }
}

#[test]
fn a_straight_way_needs_one_target_and_a_bend_another() {
    let at = |x: f32, y: f32| [[x, y, 0.0], [x, y, 1.0], [x + 1.0, y, 0.0]];
    let straight: Vec<Frame> = (0_u8..9)
        .map(|i| frame(f32::from(i), at(0.1 * f32::from(i), 0.0)))
        .collect();
    let morphs = reduce(straight, 1e-3, MOST_TARGETS).unwrap();
    assert_eq!(
        (morphs.targets.len(), morphs.targets[0].frame),
        (1, Some(8))
    );
    let bent: Vec<Frame> = (0_u8..9)
        .map(|i| {
            frame(
                f32::from(i),
                at(0.1 * f32::from(i), 0.02 * f32::from(i * i)),
            )
        })
        .collect();
    assert_eq!(reduce(bent, 1e-3, MOST_TARGETS).unwrap().targets.len(), 2);
    let resting = vec![frame(0.0, at(1.0, 1.0)), frame(1.0, at(1.0, 1.0))];
    assert!(
        reduce(resting, 1e-3, MOST_TARGETS)
            .unwrap()
            .targets
            .is_empty()
    );
}

#[test]
fn where_the_most_targets_are_not_enough_it_is_said_how_far_off_that_is() {
    let corners: Vec<Frame> = (0_u8..10)
        .map(|i| {
            let mut body = [[0.0_f32; 3]; 3];
            if let Some(number) = i.checked_sub(1) {
                body.as_flattened_mut()[usize::from(number)] = 0.1 * f32::from(i);
            }
            frame(f32::from(i), body)
        })
        .collect();
    let morphs = reduce(corners.clone(), 1e-3, 6).unwrap();
    // No weight is below 0 here, so nothing is to be lifted.
    assert_eq!(morphs.targets.len(), 5);
    assert!((morphs.worst_m - 0.4).abs() < 1e-6, "{}", morphs.worst_m);
    assert!((worst_m(&morphs, &corners) - 0.4).abs() < 1e-6);
}

/// The first animation of a file: times, and for every frame where its vertices are and where its node is.
fn played(bytes: &[u8]) -> (Vec<f32>, Vec<Vec<Vec3>>, Option<Vec<Vec3>>) {
    let file = gltf::Gltf::from_slice(bytes).unwrap();
    let blob = file.blob.as_deref().unwrap();
    let mesh = file.meshes().next().unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(blob));
    let base: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
    let targets: Vec<Vec<Vec3>> = reader
        .read_morph_targets()
        .map(|(positions, normals, tangents)| {
            assert!(normals.is_some() && tangents.is_none());
            positions.unwrap().map(Vec3::from).collect()
        })
        .collect();
    let (mut times_s, mut weights, mut places) = (vec![], vec![], None);
    for channel in file.animations().next().unwrap().channels() {
        assert_eq!(channel.target().node().index(), 0);
        assert_eq!(
            channel.sampler().interpolation(),
            gltf::animation::Interpolation::Linear
        );
        let reader = channel.reader(|_| Some(blob));
        times_s = reader.read_inputs().unwrap().collect();
        match reader.read_outputs().unwrap() {
            gltf::animation::util::ReadOutputs::MorphTargetWeights(values) => {
                weights = values.into_f32().collect();
            }
            gltf::animation::util::ReadOutputs::Translations(values) => {
                places = Some(values.map(Vec3::from).collect());
            }
            _ => panic!("nothing else moves"),
        }
    }
    assert_eq!(weights.len(), times_s.len() * targets.len());
    let body = |weights: &[f32]| {
        let mut body = base.clone();
        for (weight, target) in weights.iter().zip(&targets) {
            body.iter_mut()
                .zip(target)
                .for_each(|(to, from)| *to += *weight * *from);
        }
        body
    };
    let bodies = weights.chunks_exact(targets.len()).map(body).collect();
    (times_s, bodies, places)
}

#[test]
fn the_written_file_plays_what_the_motion_shows() {
    let (model, mut inference, motion) = walk(MotionSettings::default());
    let settings = FrameSettings {
        fps: 24.0,
        past_s: 0.3,
    };
    let frames = sample_frames(&motion, settings, &mut inference).unwrap();
    let mesh = AnimationMesh::of(&model, "walk");
    let written = glb_animation(&mesh, frames.clone(), DEFAULT_TOLERANCE_M).unwrap();
    assert_eq!(
        written,
        glb_animation(&mesh, frames.clone(), DEFAULT_TOLERANCE_M).unwrap()
    );
    let report = written.report;
    assert!(report.worst_m <= DEFAULT_TOLERANCE_M && report.worst_m > 0.0);
    assert_eq!(
        (report.frame_count, report.byte_count),
        (frames.len(), written.bytes.len())
    );
    assert!(report.target_count < frames.len() - 1, "{report:?}");
    let (times_s, bodies, places) = played(&written.bytes);
    assert_eq!(times_s, frames.iter().map(|f| f.time_s).collect::<Vec<_>>());
    assert_eq!(bodies.len(), frames.len());
    let mut latent = vec![0.0; inference.latent_len()];
    let mut meant = vec![[0.0; 3]; inference.vertex_count()];
    let mut worst_m = 0.0_f32;
    for ((time_s, body), place) in times_s.iter().zip(&bodies).zip(places.unwrap()) {
        motion.sample_into(0.25 + time_s, &mut latent).unwrap();
        inference.decode_positions(&latent, &mut meant).unwrap();
        for (made, meant) in body.iter().zip(&meant) {
            worst_m = worst_m.max(made.distance(Vec3::from(*meant)));
        }
        let root = motion.root_translation(0.25 + time_s).unwrap();
        assert!(place.distance(root) < 1e-5);
    }
    assert!(
        (worst_m - report.worst_m).abs() < 1e-5,
        "said {}, is {worst_m}",
        report.worst_m
    );
}

#[test]
fn a_file_names_its_targets_and_shows_the_first_frame_when_still() {
    let (model, mut inference, motion) = walk(still());
    let frames = sample_frames(&motion, FrameSettings::default(), &mut inference).unwrap();
    let mesh = AnimationMesh::of(&model, "walk");
    let GlbAnimation { bytes, report } =
        glb_animation(&mesh, frames.clone(), DEFAULT_TOLERANCE_M).unwrap();
    let file = gltf::Gltf::from_slice(&bytes).unwrap();
    assert_eq!(file.extensions_required().count(), 0);
    let mesh = file.meshes().next().unwrap();
    let extras: serde_json::Value =
        serde_json::from_str(mesh.extras().as_ref().unwrap().get()).unwrap();
    let names = extras["targetNames"].as_array().unwrap();
    assert_eq!(names.len(), report.target_count);
    assert!(names[0].as_str().unwrap().starts_with("frame "));
    assert_eq!(names[names.len() - 1], "lowest");
    assert_eq!(mesh.weights().unwrap(), vec![0.0; report.target_count]);
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| file.blob.as_deref());
    assert!(
        reader
            .read_positions()
            .unwrap()
            .eq(frames[0].positions.iter().copied())
    );
    assert_eq!(file.animations().next().unwrap().name(), Some("walk"));
    assert_eq!(played(&bytes).2, None);
}

#[test]
fn normals_follow_the_weights() {
    let (model, mut inference, motion) = walk(still());
    let frames = sample_frames(&motion, FrameSettings::default(), &mut inference).unwrap();
    assert_eq!(model.vertex_count(), frames[0].normals.len());
    let morphs = reduce(frames.clone(), DEFAULT_TOLERANCE_M, MOST_TARGETS).unwrap();
    let mut angles_deg = vec![];
    for (index, frame) in frames.iter().enumerate() {
        for (vertex, meant) in frame.normals.iter().enumerate() {
            let mut made = Vec3::from(morphs.base.normals[vertex]);
            for target in &morphs.targets {
                made += target.weights[index] * Vec3::from(target.shape.normals[vertex]);
            }
            angles_deg.push(made.angle_between(Vec3::from(*meant)).to_degrees());
        }
    }
    angles_deg.sort_by(f32::total_cmp);
    let quantile = |share: f32| angles_deg[(share * angles_deg.len() as f32) as usize];
    assert!(
        quantile(0.5) < 0.5 && quantile(0.99) < 5.0,
        "{} {}",
        quantile(0.5),
        quantile(0.99)
    );
}

#[test]
fn frames_end_where_the_motion_does() {
    let (_, mut inference, motion) = walk(still());
    let mut times = |fps: f32, past_s: f32| -> Vec<f32> {
        let frames = sample_frames(&motion, FrameSettings { fps, past_s }, &mut inference);
        frames.unwrap().iter().map(|frame| frame.time_s).collect()
    };
    assert_eq!(times(4.0, 0.0), [0.0, 0.25, 0.5, 0.75, 1.0]);
    assert_eq!(times(2.0, 0.25), [0.0, 0.5, 1.0, 1.25]);
    assert_eq!(times(0.5, 0.0), [0.0, 1.0]);
    assert_eq!(times(30.0, 0.0).len(), 31);
}

#[test]
fn a_round_of_a_loop_ends_as_it_begins_and_goes_on_over_the_ground() {
    let repeated = |repeat: Repeat| {
        let settings = MotionSettings {
            repeat,
            ..MotionSettings::default()
        };
        let (_, mut inference, motion) = walk(settings);
        let frames = sample_frames(&motion, FrameSettings::default(), &mut inference).unwrap();
        assert_eq!(frames[0].positions, frames[frames.len() - 1].positions);
        frames
    };
    let there_and_back = repeated(Repeat::PingPong);
    assert_eq!(there_and_back[there_and_back.len() - 1].time_s, 2.0);
    let round = repeated(Repeat::Loop {
        closing_s: Some(0.7),
    });
    let (first, last) = (&round[0], &round[round.len() - 1]);
    assert!((last.time_s - 1.7).abs() < 1e-5);
    let (from, to) = (first.root.unwrap(), last.root.unwrap());
    assert!(
        (from.y - to.y).abs() < 1e-4 && from.distance(to) > 1e-3,
        "{from} {to}"
    );
}

#[test]
fn numbered_meshes_fill_a_folder_or_leave_nothing() {
    let model = model(Kind::Rotations);
    let mut inference = Inference::new(&model).unwrap();
    let key = |time_s: f32| LatentKey {
        latent: vec![time_s; 8],
        time_s,
        easing: Easing::Linear,
    };
    let settings = MotionSettings {
        extrapolation: Extrapolation::Hold,
        ..still()
    };
    let motion = Motion::new(&[key(0.0), key(1.0)], settings, &mut inference).unwrap();
    let fps = FrameSettings {
        fps: 11.0,
        past_s: 0.0,
    };
    let mut frames = sample_frames(&motion, fps, &mut inference).unwrap();
    frames[3].root = Some(Vec3::new(0.0, 100.0, 0.0));
    let mesh = AnimationMesh::of(&model, "torus");
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("frames");
    save_obj_sequence(&folder, &mesh, frames.clone()).unwrap();
    let mut names: Vec<_> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names.len(), 12);
    assert_eq!(
        (names[0].as_str(), names[11].as_str()),
        ("frame_0001.obj", "frame_0012.obj")
    );
    let text = std::fs::read_to_string(folder.join("frame_0004.obj")).unwrap();
    let heights = text.lines().filter_map(|line| line.strip_prefix("v "));
    let mut heights = heights.map(|line| line.split(' ').nth(1).unwrap().parse::<f32>().unwrap());
    assert!(heights.all(|height| height > 50.0), "the root is moved");

    let taken = save_obj_sequence(&folder, &mesh, frames.clone()).unwrap_err();
    assert!(
        taken.to_string().contains("frames") && taken.to_string().contains("new"),
        "{taken}"
    );
    let broken = place.path().join("broken");
    frames[7].positions[0][0] = f32::NAN;
    assert!(save_obj_sequence(&broken, &mesh, frames).is_err());
    assert_eq!(
        std::fs::read_dir(place.path()).unwrap().count(),
        1,
        "nothing is left"
    );
}

#[test]
fn bad_settings_and_unsound_frames_are_refused() {
    let (_, mut inference, motion) = walk(still());
    let mut sample = |fps: f32, past_s: f32| {
        sample_frames(&motion, FrameSettings { fps, past_s }, &mut inference).unwrap_err()
    };
    for fps in [0.0, -30.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(sample(fps, 0.0), AnimationError::FrameRate { .. }));
    }
    for past_s in [-0.1, f32::NAN, f32::INFINITY] {
        assert!(matches!(sample(30.0, past_s), AnimationError::Past { .. }));
    }
    for (fps, past_s) in [(1e9, 0.0), (30.0, 1e9), (f32::MAX, f32::MAX)] {
        assert!(matches!(
            sample(fps, past_s),
            AnimationError::TooManyFrames { .. }
        ));
    }
    let body = [[0.0; 3], [1.0; 3], [2.0, 0.0, 0.0]];
    let good = || vec![frame(0.0, body), frame(1.0, body)];
    let mesh = invented();
    assert!(glb_animation(&mesh, good(), DEFAULT_TOLERANCE_M).is_ok());
    let refused = glb_animation(&mesh, vec![], DEFAULT_TOLERANCE_M);
    assert!(matches!(refused, Err(AnimationError::NoFrames)));
    for tolerance_m in [0.0, -1.0, f32::NAN] {
        let refused = glb_animation(&mesh, good(), tolerance_m);
        assert!(matches!(refused, Err(AnimationError::Tolerance { .. })));
    }
    let mut short = good();
    short[1].positions.pop();
    let mut wild = good();
    wild[1].positions[2][1] = f32::NAN;
    for frames in [short, wild] {
        let refused = glb_animation(&mesh, frames, DEFAULT_TOLERANCE_M);
        assert!(matches!(refused, Err(AnimationError::Export(_))));
    }
    let nowhere = "/no-such-folder/a.glb".as_ref();
    let error = save_glb_animation(nowhere, &mesh, good(), DEFAULT_TOLERANCE_M).unwrap_err();
    assert!(
        error.to_string().contains("/no-such-folder/a.glb"),
        "{error}"
    );
}
