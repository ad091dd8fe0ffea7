//! What a measurement says.

use serde::{Deserialize, Serialize};

use super::{Collector, Metrics};
use crate::dataset::SketchNoise;

/// A model beside the baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// What both were measured on.
    pub test: TestSet,
    /// The model, one entry per way of drawing.
    pub model: Vec<Drawn>,
    /// The nearest neighbour, likewise.
    pub baseline: Vec<Drawn>,
}

/// What was measured on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TestSet {
    /// The seed of rotations and disturbances.
    pub seed: u64,
    /// Cases whose pose is from the sampler.
    pub sampled_cases: usize,
    /// Cases whose pose is a library pose that was not trained on.
    pub library_cases: usize,
    /// Meshes of the baseline, turns counted.
    pub baseline_meshes: usize,
}

/// The measures for one way of drawing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Its name.
    pub name: String,
    /// What was done to the sketches.
    pub noise: SketchNoise,
    /// All cases.
    pub all: Metrics,
    /// Those from the sampler.
    pub sampled: Metrics,
    /// Those from the library.
    pub library: Metrics,
}

impl Drawn {
    pub(super) fn new(
        name: &str,
        noise: SketchNoise,
        [sampled, library]: [Collector; 2],
        extent_m: f32,
    ) -> Self {
        let mut all = sampled.clone();
        all.merge(&library);
        Self {
            name: name.to_owned(),
            noise,
            all: all.metrics(extent_m),
            sampled: sampled.metrics(extent_m),
            library: library.metrics(extent_m),
        }
    }
}
