//! Tiny real runs on the real rig.

use std::path::Path;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use burn::tensor::{Device, Tensor, TensorData};
use glam::{Quat, Vec3};
use rand::Rng as _;
use stick3d_figure::figure::Figure;
use stick3d_model::network::{Decoder, Encoder2d};
use stick3d_model::{Inference, Model};

use super::*;
use crate::dataset::random;
#[cfg(feature = "ndarray")]
use crate::device::ComputeDevice;
use crate::rig::{Pose, Rig};
use crate::training::{Progress, Quiet, StageName, TrainError};

static RIG: LazyLock<Rig> =
    LazyLock::new(|| Rig::from_glb(include_bytes!("../../../../assets/rigs/human.glb")).unwrap());

/// A few poses of arms and legs on some hundred vertices.
static SET: LazyLock<PaperSet> = LazyLock::new(|| {
    let mut rng = random(4, "test poses", 0);
    let poses: Vec<(String, Pose)> = (0..6)
        .map(|number| {
            let mut pose = Pose::rest(RIG.skeleton.bones.len());
            for (bone, rotation) in RIG.skeleton.bones.iter().zip(&mut pose.rotations) {
                if ["upperarm", "lowerarm", "thigh", "calf"]
                    .iter()
                    .any(|limb| bone.name.starts_with(limb))
                {
                    let mut number = || rng.random::<f32>() - 0.5;
                    let axis = Vec3::new(number(), number(), number());
                    *rotation = Quat::from_scaled_axis(2.0 * axis);
                }
            }
            (format!("pose {number}"), pose)
        })
        .collect();
    PaperSet::of_rig(Figure::human(), &RIG, &poses)
        .unwrap()
        .coarsened(300)
});

fn config() -> PaperConfig {
    PaperConfig {
        hidden: 48,
        latent_len: 12,
        learning_rate: 3e-3,
        epochs: [20, 20, 6],
        batch_size: 16,
        checkpoint_every: 4,
        ..PaperConfig::published(72)
    }
}

fn samples() -> Samples {
    SET.samples(Split::Both, &["pose 3".to_owned()], 1).unwrap()
}

fn run(
    config: &PaperConfig,
    folder: Option<&Path>,
    progress: &dyn Progress,
) -> Result<PaperTrained, TrainError> {
    train_paper(&SET, &samples(), config, folder, true, progress)
}

/// Stops after some epochs.
struct StopAfter(AtomicUsize);

impl Progress for StopAfter {
    fn should_stop(&self) -> bool {
        self.0.fetch_sub(1, Ordering::Relaxed) == 1
    }
}

#[test]
fn splits_keep_meshes_and_turns_apart() {
    let parts = samples();
    assert_eq!((parts.pose.len(), parts.random.len()), (21, 10));
    assert_eq!(parts.train.len(), 6 * 21 - 31);
    assert!(parts.pose.iter().all(|sample| sample.mesh == 3));
    assert!(
        parts
            .random
            .iter()
            .all(|s| s.mesh != 3 && !parts.train.contains(s))
    );
    let held_out = ["pose 3".to_owned()];
    let random_only = SET.samples(Split::Random, &held_out, 1).unwrap();
    assert_eq!((random_only.random.len(), random_only.pose.len()), (12, 0));
    let pose_only = SET.samples(Split::Pose, &held_out, 1).unwrap();
    assert_eq!((pose_only.random.len(), pose_only.train.len()), (0, 105));
    assert_ne!(parts, SET.samples(Split::Both, &held_out, 2).unwrap());

    let unknown = SET.samples(Split::Both, &["pose_3".to_owned()], 1);
    let message = unknown.unwrap_err().to_string();
    assert!(
        message.contains("pose_3") && message.contains("nearest"),
        "{message}"
    );
    let all: Vec<String> = SET.meshes.iter().map(|mesh| mesh.name.clone()).collect();
    assert!(SET.samples(Split::Pose, &all, 1).is_err());
}

#[test]
fn a_coarse_set_keeps_the_body() {
    assert!(
        (150..600).contains(&SET.vertex_count()),
        "{}",
        SET.vertex_count()
    );
    let kept = SET.kept.as_ref().unwrap();
    assert!(kept.is_sorted() && kept.len() == SET.vertex_count());
    SET.regressor.validate(SET.vertex_count()).unwrap();
    assert!(SET.triangles.len() > SET.vertex_count());
    let fine = crate::rig::regressor(Figure::human(), &RIG).unwrap();
    let fine = fine.joints(&RIG.mesh.positions);
    // Bones are about as long as on the fine mesh.
    for mesh in &SET.meshes {
        for &[a, b] in &SET.figure.bones {
            let (length, full) = (
                mesh.joints[a].distance(mesh.joints[b]),
                fine[a].distance(fine[b]),
            );
            assert!((length / full - 1.0).abs() < 0.25, "{length} {full}");
        }
    }
    // The networks' units hold every turn.
    let farthest = (0..21)
        .flat_map(|turn| SET.vertices(Sample { mesh: 0, turn }))
        .map(|p| p.abs().max_element())
        .fold(0.0, f32::max);
    assert!(farthest <= 0.951 * SET.scale_m());
}

#[test]
fn a_run_learns_and_can_be_stopped_and_resumed_to_the_same_bytes() {
    let whole_folder = tempfile::tempdir().unwrap();
    let whole = run(&config(), Some(whole_folder.path()), &Quiet).unwrap();
    assert_eq!(whole.log.records.len(), 46);
    let value = |index: usize, term: &str| {
        let terms = &whole.log.records[index].terms;
        terms.iter().find(|(name, _)| name == term).unwrap().1
    };
    assert!(value(19, "mse_per_mille") < 0.25 * value(0, "mse_per_mille"));
    assert!(value(19, "kl") > 1.0, "the latents have collapsed");
    assert!(whole.log.records[39].loss < 0.3 * whole.log.records[20].loss);
    assert_eq!(whole.log.records[40].stage, StageName::Joint);
    let csv = std::fs::read_to_string(whole_folder.path().join("losses.csv")).unwrap();
    assert_eq!(csv, whole.log.to_csv());
    assert!(whole_folder.path().join("losses.png").exists());

    // In the middle of each stage.
    let folder = tempfile::tempdir().unwrap();
    for epochs in [7, 22, 13] {
        let stopped = run(
            &config(),
            Some(folder.path()),
            &StopAfter(AtomicUsize::new(epochs)),
        );
        assert!(
            matches!(stopped, Err(TrainError::Stopped { .. })),
            "{stopped:?}"
        );
    }
    let resumed = run(&config(), Some(folder.path()), &Quiet).unwrap();
    assert!(resumed.log == whole.log);
    assert!(resumed.model.to_bytes().unwrap() == whole.model.to_bytes().unwrap());

    // Another configuration does not take up this checkpoint.
    let other = run(&config().plain(), Some(folder.path()), &Quiet);
    assert!(
        matches!(other, Err(TrainError::Checkpoint { .. })),
        "{other:?}"
    );
}

#[test]
fn the_model_is_one_like_any_other_and_decodes_as_its_networks_do() {
    let quick = PaperConfig {
        epochs: [4, 4, 2],
        ..config()
    };
    let trained = run(&quick, None, &Quiet).unwrap().model;
    let model = Model::from_bytes(&trained.to_bytes().unwrap()).unwrap();
    assert!(model == trained, "what is written is what was trained");
    assert_eq!(model.metadata().held_out_poses, ["pose 3"]);
    let recipe: PaperConfig = serde_json::from_value(model.metadata().recipe.clone()).unwrap();
    assert_eq!(recipe, quick);

    let device = Device::flex();
    let sample = Sample { mesh: 3, turn: 8 };
    let mut inference = Inference::new(&model).unwrap();
    let found = sketched(&mut inference, &SET, sample).unwrap();
    let input = SET.input_vector(sample).unwrap();
    let input = Tensor::<2>::from_data(TensorData::new(input.clone(), [1, input.len()]), &device);
    let latent = Encoder2d::from_weights(model.encoder2d(), &device).forward(input);
    let decoder = Decoder::from_weights(model.head(), model.final_layer(), &device);
    let expected = decoder
        .forward(latent)
        .into_data()
        .try_to_vec::<f32>()
        .unwrap();
    for (found, expected) in found.iter().zip(expected.as_chunks::<3>().0) {
        assert!(found.distance(Vec3::from(*expected)) < 1e-4);
    }
    // The editor asks how far a latent is to be trusted.
    let mut latent = vec![0.0; 12];
    inference
        .encode(&SET.sketch(sample).unwrap(), &mut latent)
        .unwrap();
    let trust = inference.trust(&latent).unwrap();
    assert!(trust.distance.is_some_and(f32::is_finite));
}

#[test]
fn the_plain_autoencoder_reconstructs_and_has_no_variance() {
    let plain = config().plain();
    let trained = run(&plain, None, &Quiet).unwrap();
    assert!(
        trained
            .log
            .records
            .iter()
            .all(|record| record.stage != StageName::Joint)
    );
    let (_, log_variance) = trained
        .model
        .encoder3d()
        .forward(&vec![0.1; 3 * SET.vertex_count()]);
    assert!(log_variance.iter().all(|x| *x == -20.0));
    let samples = samples();
    let [seen, unseen] = [&samples.train[..21], &samples.pose]
        .map(|part| measure(&trained.model, &SET, part).unwrap());
    let [seen_cm, unseen_cm] = [seen, unseen].map(|m| m.mesh.metrics.vertex_mean_cm);
    assert!(seen_cm < 20.0, "{seen_cm}");
    assert!(unseen_cm > seen_cm, "{unseen_cm} {seen_cm}");
    let errors = unseen.sketch;
    let ratio = errors.squared_mean / errors.metrics.mse_normalised;
    assert!((ratio - 1.0).abs() < 0.01, "{errors:?}");
    assert!(errors.squared_std > 0.0 && errors.vertex_std_normalised > 0.0);
}

#[test]
fn a_configuration_without_sense_is_refused() {
    let still = PaperConfig {
        learning_rate: 0.0,
        ..config()
    };
    assert!(matches!(
        run(&still, None, &Quiet),
        Err(TrainError::Config(_))
    ));
}

#[test]
#[cfg(feature = "ndarray")]
fn devices_agree() {
    let on = |device| {
        let quick = PaperConfig {
            epochs: [2, 1, 1],
            device,
            ..config()
        };
        run(&quick, None, &Quiet).unwrap().log.records
    };
    let [flex, ndarray] = [ComputeDevice::Flex, ComputeDevice::NdArray].map(on);
    assert_eq!(flex.len(), 4);
    for (flex, ndarray) in flex.iter().zip(&ndarray) {
        let off = (flex.loss - ndarray.loss).abs() / flex.loss;
        assert!(off < 2e-3, "{flex:?} {ndarray:?}");
    }
}
