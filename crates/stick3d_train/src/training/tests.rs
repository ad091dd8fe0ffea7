//! Tiny real runs on the real rig.

use std::path::Path;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{Quat, Vec3};
use rand::Rng as _;
use stick3d_figure::figure::Figure;
use stick3d_model::{Inference, Model};

use super::*;
use crate::dataset::{BasisConfig, PoseStream, random};
#[cfg(feature = "ndarray")]
use crate::device::ComputeDevice;
use crate::evaluate::{EvalConfig, EvalInput, evaluate};
use crate::rig::{Pose, Rig};

static RIG: LazyLock<Rig> =
    LazyLock::new(|| Rig::from_glb(include_bytes!("../../../../assets/rigs/human.glb")).unwrap());

/// Arms and legs turned a little at random.
fn stream<'a>(number: u64) -> PoseStream<'a> {
    let mut rng = random(number, "test poses", 0);
    Box::new(std::iter::repeat_with(move || {
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
        pose
    }))
}

fn config() -> TrainConfig {
    let basis = BasisConfig {
        helpers: 4,
        poses: 48,
    };
    let stage = |epochs| StageConfig {
        epochs,
        learning_rate: 4e-3,
    };
    TrainConfig {
        hidden: HiddenLayers {
            encoder3d: vec![48],
            head: vec![48],
            encoder2d: vec![64],
        },
        latent_len: 16,
        basis,
        sampled_bodies: 192,
        library_repeats: 2,
        batch_size: 32,
        stages: [stage(6), stage(4), stage(4)],
        checkpoint_every: 2,
        ..TrainConfig::of(Figure::human())
    }
}

/// A little of every stage.
fn one_epoch_each() -> TrainConfig {
    TrainConfig {
        sampled_bodies: 64,
        stages: [StageConfig {
            epochs: 1,
            learning_rate: 1e-3,
        }; 3],
        ..config()
    }
}

fn run(
    config: &TrainConfig,
    folder: Option<&Path>,
    resume: bool,
    progress: &dyn Progress,
) -> Result<Trained, TrainError> {
    let library: Vec<Pose> = stream(99).take(3).collect();
    let input = TrainInput {
        figure: Figure::human(),
        rig: &RIG,
        library: &library,
        streams: &stream,
        held_out_poses: vec!["none".to_owned()],
    };
    train(&input, config, folder, resume, progress)
}

/// Stops after some epochs.
struct StopAfter(AtomicUsize);

impl Progress for StopAfter {
    fn should_stop(&self) -> bool {
        self.0.fetch_sub(1, Ordering::Relaxed) == 1
    }
}

#[test]
fn a_run_learns_and_can_be_stopped_and_resumed_to_the_same_bytes() {
    let whole_folder = tempfile::tempdir().unwrap();
    let whole = run(&config(), Some(whole_folder.path()), false, &Quiet).unwrap();
    assert_eq!(whole.log.records.len(), 14);
    for (first, last) in [(0, 5), (6, 9), (10, 13)] {
        let (first, last) = (&whole.log.records[first], &whole.log.records[last]);
        assert!(last.loss < 0.95 * first.loss, "{first:?} {last:?}");
    }
    assert!(whole.basis_fit.mean_m < 0.01, "{:?}", whole.basis_fit);
    let csv = std::fs::read_to_string(whole_folder.path().join("losses.csv")).unwrap();
    assert_eq!(csv, whole.log.to_csv());
    assert_eq!(csv.lines().count(), 15);
    let plot = image::open(whole_folder.path().join("losses.png")).unwrap();
    assert!(plot.width() > 300);

    // Once in the middle of the first stage, off the checkpoint rhythm; once in the last.
    let folder = tempfile::tempdir().unwrap();
    for epochs in [3, 8] {
        let stop = StopAfter(AtomicUsize::new(epochs));
        let stopped = run(&config(), Some(folder.path()), true, &stop);
        assert!(
            matches!(stopped, Err(TrainError::Stopped { .. })),
            "{stopped:?}"
        );
    }
    let resumed = run(&config(), Some(folder.path()), true, &Quiet).unwrap();
    assert!(resumed.log == whole.log);
    assert!(resumed.model.to_bytes().unwrap() == whole.model.to_bytes().unwrap());

    // What is written is what was trained.
    let read = Model::from_bytes(&whole.model.to_bytes().unwrap()).unwrap();
    assert!(read == whole.model);
    Inference::new(&read).unwrap();

    // Another configuration does not take up this checkpoint.
    let other = TrainConfig {
        seed: 2,
        ..config()
    };
    let refused = run(&other, Some(folder.path()), true, &Quiet);
    assert!(
        matches!(refused, Err(TrainError::Checkpoint { .. })),
        "{refused:?}"
    );
}

#[test]
fn evaluation_measures_model_and_baseline_alike() {
    let quick = one_epoch_each();
    let model = run(&quick, None, false, &Quiet).unwrap().model;
    let library: Vec<Pose> = stream(7).take(4).collect();
    let config = EvalConfig {
        natural_cases: 6,
        broad_cases: 24,
        flat_drawings: 10,
        ..EvalConfig::default()
    };
    let measure = |seed| {
        let input = EvalInput {
            rig: &RIG,
            library: &library,
            natural: Box::new(library[..2].iter().cloned().cycle()),
            broad: stream(1000),
        };
        let config = EvalConfig { seed, ..config };
        evaluate(&model, input, &config, &Quiet).unwrap()
    };
    let report = measure(1);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let again = alone.unwrap().install(|| measure(1));
    assert!(report == again, "the same seed measures the same");
    assert!(report != measure(2));
    assert_eq!(report.test.baseline_meshes, 84);
    assert_eq!(report.flat_any_order.drawings, 10);
    assert_eq!(report.parts.len(), 2);
    for (part, cases) in report.parts.iter().zip([6, 24]) {
        assert_eq!((part.cases, part.any_order.poses), (cases, cases));
        assert_eq!(part.rows.len(), 5 + 5 + 2 + 5 + 2, "{:?}", part.rows);
        for row in &part.rows {
            let metrics = &row.metrics;
            assert_eq!(metrics.cases, cases);
            assert!(metrics.vertex_p95_cm > metrics.vertex_mean_cm);
            assert!(metrics.pa_mpjpe_mm < metrics.mpjpe_mm);
        }
        for way in ["clean", "jittered", "scaled", "both", "incomplete"] {
            let [first, best] = ["first answer", "best alternative"]
                .map(|answer| part.row(answer, way).unwrap().metrics.vertex_mean_cm);
            assert!(best <= first);
            if let Some(flipped) = part.row("one limb flipped", way) {
                assert!(flipped.metrics.vertex_mean_cm <= first);
            }
        }
    }
    // The baseline has the natural poses among its own here, in turns up to 15° and more away.
    let nearest = report.parts[0].row("nearest neighbour", "clean").unwrap();
    assert!(nearest.metrics.mpjpe_mm < 500.0);
    let json = serde_json::to_string(&report).unwrap();
    assert!(serde_json::from_str::<crate::evaluate::Report>(&json).unwrap() == report);
}

#[test]
fn a_configuration_that_contradicts_itself_is_refused() {
    let empty = TrainConfig {
        batch_size: 0,
        ..config()
    };
    assert!(matches!(
        run(&empty, None, false, &Quiet),
        Err(TrainError::Config(_))
    ));
    let mut still = config();
    still.stages[1].learning_rate = 0.0;
    assert!(matches!(
        run(&still, None, false, &Quiet),
        Err(TrainError::Config(_))
    ));
}

#[test]
#[cfg(feature = "ndarray")]
fn devices_agree() {
    let quick = one_epoch_each();
    let on = |device| {
        let config = TrainConfig {
            device,
            ..quick.clone()
        };
        run(&config, None, false, &Quiet).unwrap().log.records
    };
    let [flex, ndarray] = [ComputeDevice::Flex, ComputeDevice::NdArray].map(on);
    assert_eq!(flex.len(), 3);
    for (flex, ndarray) in flex.iter().zip(&ndarray) {
        for ((term, a), (_, b)) in flex.terms.iter().zip(&ndarray.terms) {
            let off = (a - b).abs() / a.abs().max(1e-3);
            assert!(off < 2e-3, "{:?} {term}: {a} and {b}", flex.stage);
        }
    }
}
