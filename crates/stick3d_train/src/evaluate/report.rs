//! What a measurement says.

use serde::{Deserialize, Serialize};

use super::{Metrics, Recognition};
use crate::dataset::SketchNoise;

/// A model beside the baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// What both were measured on.
    pub test: TestSet,
    /// What was found on each part of it.
    pub parts: Vec<PartReport>,
    /// Recognition of flat poses: the figure's template with its bones turned in the plane and scaled.
    pub flat_any_order: Recognition,
    /// How long it takes; none where it was not asked for. It differs from run to run.
    pub latency: Option<Latency>,
}

/// What was measured on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestSet {
    /// The figure.
    pub figure: String,
    /// The seed of rotations and disturbances.
    pub seed: u64,
    /// Meshes of the baseline, turns counted.
    pub baseline_meshes: usize,
}

/// What was found on one part of the test set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartReport {
    /// `natural`: library poses (or registered meshes) that were not trained on, and perturbations of such poses. `broad`: any
    /// pose inside the joints' limits.
    pub name: String,
    /// How many bodies there are, each turned at random and drawn in every way.
    pub cases: usize,
    /// Per answer and way of drawing, in the order of the answers.
    pub rows: Vec<Row>,
    /// Recognition of these bodies, drawn with strokes in any order.
    pub any_order: Recognition,
}

impl PartReport {
    /// The row of an answer and a way of drawing.
    #[must_use]
    pub fn row(&self, answer: &str, drawn: &str) -> Option<&Row> {
        self.rows
            .iter()
            .find(|row| row.answer == answer && row.drawn == drawn)
    }
}

/// The measures of one kind of answer to one way of drawing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Whose answer: `first answer`, `best alternative` (the one nearest to the truth), `one limb flipped` (the first but for
    /// the limb whose depth had best be the other way round), `network alone` (not refined), `nearest neighbour`.
    pub answer: String,
    /// How it was drawn: `clean`, `jittered`, `scaled`, `both`, `incomplete` (a limb left out).
    pub drawn: String,
    /// What was done to the sketches.
    pub noise: SketchNoise,
    /// How many answers there were to choose from: mean.
    pub choice: f64,
    /// The measures.
    pub metrics: Metrics,
}

/// How long it takes to find all answers to a sketch, milliseconds, on one core.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Latency {
    /// How many clean sketches were measured.
    pub sketches: usize,
    /// Half of them take less.
    pub p50_ms: f64,
    /// 99 of 100 take less.
    pub p99_ms: f64,
}
