//! Measuring a model on poses it never saw.
//!
//! Test cases are poses from the sampler with a seed of its own, and the library poses (or the registered meshes) that
//! training left out, each turned at random ([`Rotations::test_of`](crate::dataset::Rotations::test_of)). Each is drawn four times: as it is, with joints
//! jittered, with bones scaled, with both ([`SketchNoise`]).
//!
//! Meshes are compared centred on the figure's root joint, without aligning rotation or scale. Only PA-MPJPE
//! aligns, as its name says. Every figure stands beside that of the [nearest neighbour](Baseline): the mesh among the
//! library's training poses in the paper's 21 turns (facing both ways where the figure does) whose sketch is closest.

mod baseline;
mod metrics;
mod motion;
mod report;

pub use baseline::Baseline;
pub use metrics::{Collector, Metrics, procrustes_mean_distance};
pub(crate) use motion::sketch_between;
pub use motion::{
    BetweenReport, BeyondReport, GaitReport, MotionEvalConfig, MotionEvalInput, MotionReport,
    MotionTestSet, TrueMotion, clip_gaits, clip_motions, evaluate_motion, held_out_motions,
};
pub use report::{Drawn, Report, TestSet};

use glam::{Quat, Vec2, Vec3};
use serde::{Deserialize, Serialize};
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::{Sketch, SketchError};
use stick3d_model::latent::PathError;
use stick3d_model::metadata::topology_hash;
use stick3d_model::{InferError, Inference, Model, ModelError};
use thiserror::Error;

use crate::dataset::{PoseStream, Rotations, SketchNoise, centre, drawn, posed, random};
use crate::meshes::{MeshSet, NamedMesh};
use crate::rig::{Pose, Rig};
use crate::size::relative_size;
use crate::training::Progress;

/// What a measurement is made of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EvalConfig {
    /// What rotations and disturbances depend on; the poses depend on the stream.
    pub seed: u64,
    /// How many poses are drawn from the sampler, each turned once.
    pub sampled_poses: usize,
    /// How often each held-out library pose is turned.
    pub turns_per_library_pose: usize,
}

impl Default for EvalConfig {
    fn default() -> Self {
        Self {
            seed: 20_220_811,
            sampled_poses: 400,
            turns_per_library_pose: 10,
        }
    }
}

/// What a model is measured on.
pub struct EvalInput<'a> {
    /// The body.
    pub rig: &'a Rig,
    /// Library poses that were trained on: the baseline's.
    pub library: &'a [Pose],
    /// Library poses that were not.
    pub held_out: &'a [Pose],
    /// Sampled poses, from a seed that training does not use.
    pub stream: PoseStream<'a>,
}

/// Why a model could not be measured.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EvalError {
    /// The model is for another mesh.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A test body has no sketch.
    #[error("a test body has no sketch: {0}")]
    Sketch(#[from] SketchError),
    /// The model gave no mesh.
    #[error(transparent)]
    Infer(#[from] InferError),
    /// The baseline has no meshes.
    #[error("there are no library poses for the nearest-neighbour baseline; give at least one")]
    NoLibrary,
    /// The keys of a motion are no path.
    #[error(transparent)]
    Path(#[from] PathError),
    /// There is no motion, or one has fewer than two keys.
    #[error(
        "there is no motion to measure; name the body and the pose library that the model was trained on"
    )]
    NoMotions,
    /// No mesh of the set was kept from the model.
    #[error(
        "the set has none of the meshes that the model did not learn from ({names}); name the folder it was trained on"
    )]
    NoHeldOut {
        /// The meshes that were kept from it.
        names: String,
    },
}

/// How far joints are jittered on a figure of usual size, metres, and how much bones are scaled.
const JITTER_M: f32 = 0.025;
const BONE_SCALE: f32 = 0.15;

/// The four ways in which every test case of a figure is drawn, by name; a small one is jittered less
/// ([`relative_size`]).
#[must_use]
pub fn ways_to_draw(figure: &Figure) -> [(String, SketchNoise); 4] {
    let jitter_m = JITTER_M * relative_size(figure.template_extent_m());
    let jittered = format!("joints jittered by {:.1} cm", 100.0 * jitter_m);
    let scaled = format!("bones scaled by {:.0} %", 100.0 * BONE_SCALE);
    let way = |name: &str, jitter_m: f32, bone_scale: f32| {
        let noise = SketchNoise {
            jitter_m,
            bone_scale,
        };
        (name.to_owned(), noise)
    };
    [
        way("clean", 0.0, 0.0),
        way(&jittered, jitter_m, 0.0),
        way(&scaled, 0.0, BONE_SCALE),
        way("both", jitter_m, BONE_SCALE),
    ]
}

/// Measures a model and the baseline.
///
/// # Errors
/// [`EvalError`].
pub fn evaluate(
    model: &Model,
    input: EvalInput<'_>,
    config: &EvalConfig,
    progress: &dyn Progress,
) -> Result<Report, EvalError> {
    let (rig, regressor, root) = (input.rig, model.regressor(), model.figure().root);
    let vertex_count = rig.mesh.positions.len();
    model.require_topology(&topology_hash(vertex_count, &rig.mesh.triangles))?;
    let body = |pose: &Pose| -> Body {
        let mut mesh = vec![];
        let joints = posed(rig, regressor, root, pose, &mut mesh);
        (mesh, joints)
    };
    let sampled = input.stream.take(config.sampled_poses);
    let cases = Cases {
        sampled: config.sampled_poses,
        library: input.held_out.len(),
        baseline: &mut input.library.iter().map(body),
        bodies: &mut sampled.map(|pose| (Source::Sampler, body(&pose))).chain(
            input
                .held_out
                .iter()
                .map(|pose| (Source::Library, body(pose))),
        ),
    };
    measure(model, cases, config, progress)
}

/// Measures a model of registered meshes: on those of `set` that it did not learn from, beside the baseline among the
/// others.
///
/// # Errors
/// [`EvalError`]; [`EvalError::NoHeldOut`] when the set has none of the meshes kept from the model.
pub fn evaluate_meshes(
    model: &Model,
    set: &MeshSet,
    config: &EvalConfig,
    progress: &dyn Progress,
) -> Result<Report, EvalError> {
    model.require_topology(&topology_hash(set.vertex_count(), &set.triangles))?;
    let (trained, held_out) = set.split_by(&model.metadata().held_out_poses);
    if held_out.is_empty() {
        return Err(EvalError::NoHeldOut {
            names: model.metadata().held_out_poses.join(", "),
        });
    }
    let body = |mesh: &&NamedMesh| -> Body {
        let mut mesh = mesh.positions.clone();
        let joints = centre(model.regressor(), model.figure().root, &mut mesh);
        (mesh, joints)
    };
    let cases = Cases {
        sampled: 0,
        library: held_out.len(),
        baseline: &mut trained.iter().map(body),
        bodies: &mut held_out.iter().map(|mesh| (Source::Library, body(mesh))),
    };
    measure(model, cases, config, progress)
}

/// A mesh centred on the root joint, and its joints.
type Body = (Vec<Vec3>, Vec<Vec3>);

/// What to measure on.
struct Cases<'c> {
    sampled: usize,
    library: usize,
    baseline: &'c mut dyn Iterator<Item = Body>,
    bodies: &'c mut dyn Iterator<Item = (Source, Body)>,
}

fn measure(
    model: &Model,
    cases: Cases<'_>,
    config: &EvalConfig,
    progress: &dyn Progress,
) -> Result<Report, EvalError> {
    let ways = ways_to_draw(model.figure());
    let collectors = ways.iter().map(|_| Collectors::default()).collect();
    let mut evaluation = Evaluation {
        figure: model.figure(),
        baseline: Baseline::new(model.figure(), cases.baseline)?,
        inference: Inference::new(model)?,
        config,
        model,
        rng_step: 0,
        ways,
        collectors,
    };
    let library_cases = cases.library * config.turns_per_library_pose;
    progress.begin("measuring", cases.sampled + library_cases);
    for (source, body) in cases.bodies {
        let turns = match source {
            Source::Sampler => 1,
            Source::Library => config.turns_per_library_pose,
        };
        for _ in 0..turns {
            evaluation.case(&body, source)?;
            progress.advance(1);
        }
    }
    Ok(evaluation.report(cases.sampled, library_cases))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    Sampler,
    Library,
}

/// What one way of drawing has yielded so far: for the model and the baseline, by source of the pose.
#[derive(Debug, Default)]
struct Collectors {
    model: [Collector; 2],
    baseline: [Collector; 2],
}

struct Evaluation<'a> {
    figure: &'a Figure,
    model: &'a Model,
    inference: Inference,
    baseline: Baseline,
    config: &'a EvalConfig,
    rng_step: u64,
    ways: [(String, SketchNoise); 4],
    collectors: Vec<Collectors>,
}

impl Evaluation<'_> {
    /// Turns a body, draws it four ways, and compares what comes of it.
    fn case(&mut self, (mesh, joints): &Body, source: Source) -> Result<(), EvalError> {
        let figure = self.figure;
        let mut rng = random(self.config.seed, "evaluation", self.rng_step);
        self.rng_step += 1;
        let turn = Rotations::test_of(&figure.views).sample(&mut rng);
        let truth: Vec<Vec3> = mesh.iter().map(|point| turn * *point).collect();
        let joints: Vec<Vec3> = joints.iter().map(|joint| turn * *joint).collect();
        let mut latent = vec![0.0; self.inference.latent_len()];
        let mut positions = vec![[0.0; 3]; truth.len()];
        for (index, (_, noise)) in self.ways.iter().enumerate() {
            let mut points: Vec<Vec2> = drawn(Quat::IDENTITY, &joints);
            noise.apply(figure, &mut points, &mut rng);
            let sketch = Sketch::new(figure, points)?;
            self.inference.encode(&sketch, &mut latent)?;
            self.inference.decode_positions(&latent, &mut positions)?;
            let found: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
            let collectors = &mut self.collectors[index];
            let regressor = self.model.regressor();
            let slot = source as usize;
            collectors.model[slot].add(
                figure,
                (&found, &regressor.joints(&found)),
                (&truth, &joints),
            );
            let nearest = self.baseline.nearest(figure, &sketch)?;
            collectors.baseline[slot].add(
                figure,
                (&nearest, &regressor.joints(&nearest)),
                (&truth, &joints),
            );
        }
        Ok(())
    }

    fn report(self, sampled_cases: usize, library_cases: usize) -> Report {
        let extent_m = self.model.metadata().normalisation.extent_m;
        let (mut model, mut baseline) = (vec![], vec![]);
        for ((name, noise), collectors) in self.ways.iter().zip(self.collectors) {
            model.push(Drawn::new(name, *noise, collectors.model, extent_m));
            baseline.push(Drawn::new(name, *noise, collectors.baseline, extent_m));
        }
        let test = TestSet {
            seed: self.config.seed,
            sampled_cases,
            library_cases,
            baseline_meshes: self.baseline.len(),
        };
        Report {
            test,
            model,
            baseline,
        }
    }
}
