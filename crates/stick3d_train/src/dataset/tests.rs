//! Basis, bodies and batches on the real rig.

use std::sync::LazyLock;

use glam::{Quat, Vec3};
use rand::Rng as _;
use stick3d_figure::figure::Figure;
use stick3d_figure::regressor::JointRegressor;

use super::*;
use crate::rig::{Pose, Rig, regressor};

struct Scene {
    rig: Rig,
    regressor: JointRegressor,
    basis: SkinBasis,
}

static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let rig = Rig::from_glb(include_bytes!("../../../../assets/rigs/human.glb")).unwrap();
    let regressor = regressor(Figure::human(), &rig).unwrap();
    let sample: Vec<Pose> = poses(&rig, 1).take(150).collect();
    let config = BasisConfig {
        helpers: 16,
        poses: 150,
    };
    let basis = SkinBasis::fit(&rig, &regressor, Figure::human().root, config, &sample).unwrap();
    Scene {
        rig,
        regressor,
        basis,
    }
});

/// Limbs turned at random.
fn poses(rig: &Rig, seed: u64) -> impl Iterator<Item = Pose> {
    let mut rng = random(seed, "basis test", 0);
    std::iter::repeat_with(move || {
        let mut pose = Pose::rest(rig.skeleton.bones.len());
        for (bone, rotation) in rig.skeleton.bones.iter().zip(&mut pose.rotations) {
            if ["upperarm", "lowerarm", "thigh", "calf", "spine"]
                .iter()
                .any(|limb| bone.name.starts_with(limb))
            {
                let mut number = || rng.random::<f32>() - 0.5;
                *rotation = Quat::from_scaled_axis(2.0 * Vec3::new(number(), number(), number()));
            }
        }
        pose
    })
}

fn image(code: &[f32]) -> Vec<Vec3> {
    let layer = SCENE.basis.shape().layer();
    let mut positions = vec![[0.0; 3]; layer.vertex_count()];
    layer.evaluate(code, &mut layer.scratch(), &mut positions);
    positions.into_iter().map(Vec3::from).collect()
}

#[test]
fn fresh_meshes_are_held_to_millimetres() {
    let Scene {
        rig,
        regressor,
        basis,
    } = &*SCENE;
    let fresh: Vec<Pose> = poses(rig, 2).take(20).collect();
    let fit = basis.measure(rig, regressor, Figure::human().root, &fresh);
    assert!(fit.mean_m < 0.002 && fit.p99_m < 0.01, "{fit:?}");
    assert!(fit.mean_m > 0.0, "an exact fit is no measurement");
}

#[test]
fn turning_the_code_turns_the_mesh_and_the_root_joint_stays() {
    let Scene {
        rig,
        regressor,
        basis,
    } = &*SCENE;
    let code = basis.code(rig, &poses(rig, 4).next().unwrap());
    let turn = rotation(40.0, -5.0, 20.0);
    let mut turned = vec![0.0; code.len()];
    turn_coefficients(turn, &code, &mut turned);
    for (a, b) in image(&turned).iter().zip(image(&code)) {
        assert!(a.distance(turn * b) < 1e-4);
    }
    // Any numbers at all, not only those of bodies.
    let any: Vec<f32> = (0..turned.len()).map(|i| (i as f32 * 0.7).sin()).collect();
    for code in [turned, any] {
        let joints = regressor.joints(&image(&code));
        assert!(
            joints[Figure::human().root].length() < 1e-4,
            "{:?}",
            joints[Figure::human().root]
        );
        for (a, b) in joints.iter().zip(basis.shape().joints(&code)) {
            assert!(a.distance(b) < 1e-4);
        }
    }
}

#[test]
fn between_two_poses_limbs_keep_their_length() {
    let Scene { rig, basis, .. } = &*SCENE;
    let figure = Figure::human();
    let length = |code: &[f32], from: &str, to: &str| {
        let joints = basis.shape().joints(code);
        let index = |name| figure.joint_index(name).unwrap();
        joints[index(from)].distance(joints[index(to)])
    };
    let codes: Vec<Vec<f32>> = poses(rig, 8)
        .take(12)
        .map(|pose| basis.code(rig, &pose))
        .collect();
    for pair in codes.windows(2) {
        // What a network says that cannot decide between two poses.
        let between: Vec<f32> = pair[0]
            .iter()
            .zip(&pair[1])
            .map(|(a, b)| 0.5 * (a + b))
            .collect();
        for (from, to) in [("elbow_r", "hand_r"), ("knee_l", "foot_l")] {
            let (found, expected) = (length(&between, from, to), length(&pair[0], from, to));
            assert!(
                (found / expected - 1.0).abs() < 0.06,
                "{from} {to}: {found} {expected}"
            );
        }
    }
}

#[test]
fn bodies_do_not_depend_on_how_threads_share_them() {
    let Scene { rig, basis, .. } = &*SCENE;
    let streams = |number: u64| -> PoseStream<'_> { Box::new(poses(rig, number)) };
    let sample = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| BodySet::sample(rig, basis, &streams, 37, &|_| {}))
    };
    let (one, three) = (sample(1), sample(3));
    assert_eq!(one.len, 37);
    assert!(one == three && one.hash() == three.hash());
    let other = BodySet::from_poses(rig, basis, poses(rig, 50).take(37), &|_| {});
    assert_ne!(one.hash(), other.hash());
}

#[test]
fn batches_are_turned_bodies_with_their_sketches() {
    let Scene {
        rig,
        regressor,
        basis,
    } = &*SCENE;
    let figure = Figure::human();
    let bodies = BodySet::from_poses(rig, basis, poses(rig, 5).take(7), &|_| {});
    let augmentation = Augmentation {
        clean_share: 1.0,
        jitter_m: 0.1,
        bone_scale: 0.2,
        missing_share: 0.0,
    };
    let batcher = Batcher {
        figure,
        bodies: &bodies,
        rotations: Rotations::of(&figure.views),
        augmentation,
        batch_size: 3,
        seed: 9,
    };
    assert_eq!(batcher.batches_per_epoch(), 2);
    let order = batcher.order(4);
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, [0, 1, 2, 3, 4, 5, 6]);
    let batch = batcher.batch(4, 1, &order).unwrap();
    assert_eq!(batch, batcher.batch(4, 1, &order).unwrap());
    assert_ne!(batch, batcher.batch(5, 1, &order).unwrap());

    // The sketch of a clean batch is the projection of the very mesh that its coefficients stand for.
    let width = 3 * basis.shape().code_columns();
    for slot in 0..batch.len {
        let joints = regressor.joints(&image(&batch.codes[slot * width..][..width]));
        let points = joints.iter().map(|joint| joint.truncate()).collect();
        let sketch = stick3d_figure::sketch::Sketch::new(figure, points).unwrap();
        let input = sketch.input_vector(figure).unwrap();
        for (a, b) in input.iter().zip(&batch.inputs[slot * figure.input_len()..]) {
            assert!((a - b).abs() < 1e-4, "{a} {b}");
        }
    }
    let noise = batcher.noise(4, 1, 33);
    assert_eq!(noise.len(), 33);
    assert_eq!(noise, batcher.noise(4, 1, 33));
}
