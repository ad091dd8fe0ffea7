//! Measuring a model on poses it never saw.
//!
//! The test set has two parts. *Natural*: the library poses (or the registered meshes) that training left out, and
//! perturbations of such poses ([`natural_poses`]). *Broad*: any pose inside the joints' limits ([`broad_poses`]), from a
//! seed of its own. Every body is turned at random ([`Rotations::test_of`](crate::dataset::Rotations::test_of)) and drawn
//! five times: as it is, with joints jittered, with bones scaled, with both
//! ([`SketchNoise`](crate::dataset::SketchNoise)), and with one limb left out, filled in from the template as it is while a
//! person draws.
//!
//! Of the model's alternatives the first answer is measured, and the best: the one nearest to the truth. *One limb flipped*
//! is what one click makes of the first: the limb whose depth had best be the other way round is. Meshes are compared
//! centred on the figure's root joint, without aligning rotation or scale. Only PA-MPJPE aligns, as its name says.
//! Beside them stands the [nearest neighbour](Baseline): the mesh among the library's training poses in the paper's 21
//! turns (facing both ways where the figure does) whose sketch is closest. The bodies are also drawn with strokes in any
//! order ([`Recognition`]).

mod baseline;
mod measure;
mod metrics;
mod motion;
mod poses;
mod recognition;
mod report;
mod sheet;
mod spread;
mod ways;

pub use baseline::Baseline;
pub use metrics::{Collector, Metrics, procrustes_mean_distance};
pub(crate) use motion::sketch_between;
pub use motion::{
    BetweenReport, BeyondReport, GaitReport, MotionEvalConfig, MotionEvalInput, MotionReport,
    MotionTestSet, TrueMotion, clip_gaits, clip_motions, evaluate_motion, held_out_motions,
};
pub use poses::{broad_poses, natural_poses};
pub use recognition::Recognition;
pub use report::{Latency, PartReport, Report, Row, TestSet};
pub use sheet::answer_sheet;

use serde::{Deserialize, Serialize};
use stick3d_figure::sketch::{Sketch, SketchError};
use stick3d_model::latent::PathError;
use stick3d_model::metadata::topology_hash;
use stick3d_model::{InferError, Model, ModelError};
use thiserror::Error;

use crate::dataset::{PoseStream, centre, posed};
use crate::meshes::{MeshSet, NamedMesh};
use crate::rig::{Pose, Rig};
use crate::training::Progress;
use measure::{Part, measure};
use ways::Body;

/// What a measurement is made of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EvalConfig {
    /// What rotations and disturbances depend on; the poses depend on their streams.
    pub seed: u64,
    /// How many natural poses are measured, each turned once.
    pub natural_cases: usize,
    /// How many broad ones.
    pub broad_cases: usize,
    /// How often each registered mesh that was not trained on is turned.
    pub turns_per_mesh: usize,
    /// How often each body that can be read is drawn with strokes in any order.
    pub drawings_per_case: usize,
    /// How many flat poses are drawn so.
    pub flat_drawings: usize,
    /// Whether the time that answers take is measured, too.
    pub latency: bool,
}

impl Default for EvalConfig {
    fn default() -> Self {
        Self {
            seed: 20_220_811,
            natural_cases: 400,
            broad_cases: 400,
            turns_per_mesh: 10,
            drawings_per_case: 2,
            flat_drawings: 400,
            latency: false,
        }
    }
}

/// What a model is measured on.
pub struct EvalInput<'a> {
    /// The body.
    pub rig: &'a Rig,
    /// Library poses that were trained on: the baseline's.
    pub library: &'a [Pose],
    /// Natural poses that were not; there may be none.
    pub natural: PoseStream<'a>,
    /// Broad poses, from a seed that training does not use.
    pub broad: PoseStream<'a>,
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
    /// There is nothing to draw.
    #[error("there is no sketch to draw a sheet of")]
    NoSketches,
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
    let vertex_count = input.rig.mesh.positions.len();
    model.require_topology(&topology_hash(vertex_count, &input.rig.mesh.triangles))?;
    let body = |pose: &Pose| body_of(model, input.rig, pose);
    let baseline = Baseline::new(model.figure(), input.library.iter().map(body))?;
    let parts = parts(
        input.natural.take(config.natural_cases),
        input.broad.take(config.broad_cases),
    );
    measure(model, &baseline, &parts, &body, config, progress)
}

/// The first `count` sketches that [`evaluate`] measures by, named after their part and number: half of them natural, half
/// broad; every third with joints jittered and bones scaled.
///
/// # Errors
/// [`EvalError`].
pub fn test_sketches(
    model: &Model,
    input: EvalInput<'_>,
    config: &EvalConfig,
    count: usize,
) -> Result<Vec<(String, Sketch)>, EvalError> {
    let parts = parts(input.natural.take(count), input.broad.take(count));
    let body = |pose: &Pose| body_of(model, input.rig, pose);
    measure::sketches(model, &parts, &body, config, count)
}

fn parts(
    natural: impl Iterator<Item = Pose>,
    broad: impl Iterator<Item = Pose>,
) -> [Part<Pose>; 2] {
    let [natural, broad] = [natural.collect(), broad.collect()];
    [(NATURAL, natural), (BROAD, broad)].map(|(name, cases)| Part { name, cases })
}

fn body_of(model: &Model, rig: &Rig, pose: &Pose) -> Body {
    let mut mesh = vec![];
    let joints = posed(rig, model.regressor(), model.figure().root, pose, &mut mesh);
    (mesh, joints)
}

/// Measures a model of registered meshes: on those of `set` that it did not learn from, beside the baseline among the
/// others. There is no broad part.
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
    let baseline = Baseline::new(model.figure(), trained.iter().map(body))?;
    let cases = held_out.len() * config.turns_per_mesh;
    let natural = Part {
        name: NATURAL,
        cases: held_out.iter().copied().cycle().take(cases).collect(),
    };
    measure(model, &baseline, &[natural], &body, config, progress)
}

/// The names of the parts of the test set.
const NATURAL: &str = "natural";
const BROAD: &str = "broad";
