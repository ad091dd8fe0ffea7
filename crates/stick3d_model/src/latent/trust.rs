//! How far a latent is to be trusted to be a body.

use stick3d_figure::mesh::unique_edges;
use stick3d_figure::sketch::Sketch;

use super::TrainingStatistics;
use super::easing::smoothstep;
use crate::final_layer::{FinalLayer, FinalLayerError, FinalScratch};
use crate::infer::Hypotheses;
use crate::model::Model;

/// Triangles whose edges stand for all edges of a mesh: so many that a 99th percentile of theirs is one of all.
const PROBED_TRIANGLES: usize = 1500;

/// The distance from the training set at which trust begins to fall, and at which none is left.
const DISTANCE: [f32; 2] = [1.0, 2.0];
/// The edge stretch at which trust begins to fall, and at which none is left.
const STRETCH: [f32; 2] = [0.01, 0.07];

/// How far a latent is to be trusted to be a body of the kind that the model was trained on, and why.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trust {
    /// How far the latent is from those of the training set: at 1 are the farthest of them, but for one in a hundred.
    /// `None` where the model file has no [`TrainingStatistics`].
    pub distance: Option<f32>,
    /// By which share edges are longer than the longest that they should be: 99 of 100 edges are stretched less.
    ///
    /// The longest that an edge should be is the longest that it is on any training body: skin stretches over a bent knee.
    /// Where the model file does not say, it is the edge's length on the figure's template pose; for a
    /// [`Motion`](super::Motion) it is at least what it is in the keys.
    pub edge_stretch: f32,
}

impl Trust {
    /// One number: 1 for a body as good as those trained on, 0 for what is none; it falls as distance and stretch grow.
    #[must_use]
    pub fn value(&self) -> f32 {
        let fall = |x: f32, [from, to]: [f32; 2]| 1.0 - smoothstep((x - from) / (to - from));
        let near = self.distance.map_or(1.0, |x| fall(x, DISTANCE));
        near.min(fall(self.edge_stretch, STRETCH))
    }
}

/// Some edges of a mesh, how long they may be, and what it takes to decode their vertices alone.
#[derive(Debug, Clone)]
pub(crate) struct Probe {
    layer: FinalLayer,
    scratch: FinalScratch,
    positions: Vec<[f32; 3]>,
    /// Pairs of positions.
    edges: Vec<[u32; 2]>,
    /// How long each may be, metres.
    longest_m: Vec<f32>,
    stretches: Vec<f32>,
    statistics: Option<TrainingStatistics>,
}

/// The longest that a probe's edges may be, metres.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LongestEdges(Vec<f32>);

impl Probe {
    pub(crate) fn new(model: &Model) -> Result<Self, FinalLayerError> {
        let all_edges = unique_edges(model.triangles());
        let triangles = model.triangles();
        let step = triangles.len().div_ceil(PROBED_TRIANGLES).max(1);
        let probed: Vec<[u32; 3]> = triangles.iter().step_by(step).copied().collect();
        let mut vertices: Vec<u32> = probed.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        if vertices.is_empty() {
            // A cloud of points has no edges; a layer has at least one vertex.
            vertices.push(0);
        }
        // Every vertex and edge looked for is there: both lists were made of these triangles.
        let local = |v: u32| vertices.binary_search(&v).unwrap_or_default() as u32;
        let edges = unique_edges(&probed);
        let statistics = model.statistics().cloned();
        let natural = statistics.as_ref().map(|statistics| {
            let of_edge = |edge: &[u32; 2]| {
                let index = all_edges.binary_search(edge).unwrap_or_default();
                statistics
                    .longest_edges_m
                    .get(index)
                    .copied()
                    .unwrap_or(0.0)
            };
            edges.iter().map(of_edge).collect()
        });
        let layer = model.final_layer().of_vertices(&vertices)?;
        let mut probe = Self {
            scratch: layer.scratch(),
            positions: vec![[0.0; 3]; vertices.len()],
            longest_m: vec![0.0; edges.len()],
            stretches: vec![0.0; edges.len()],
            edges: edges.iter().map(|edge| edge.map(local)).collect(),
            layer,
            statistics,
        };
        probe.longest_m = natural.unwrap_or_else(|| probe.template_lengths(model));
        Ok(probe)
    }

    /// The edges' lengths in the pose of the figure's template; all 0 where the template is no sketch.
    fn template_lengths(&mut self, model: &Model) -> Vec<f32> {
        let input = Sketch::template(model.figure()).input_vector(model.figure());
        let Ok(input) = input else {
            return vec![0.0; self.edges.len()];
        };
        let output = model.encoder2d().forward(&input);
        let latent = Hypotheses::new(&output, model.latent_len()).likeliest();
        self.decode(&model.head().forward(latent));
        self.lengths().collect()
    }

    /// Decodes the probed vertices from the final layer's coefficients.
    fn decode(&mut self, coefficients: &[f32]) {
        self.layer
            .evaluate(coefficients, &mut self.scratch, &mut self.positions);
    }

    /// The lengths of the edges of what was decoded last.
    fn lengths(&self) -> impl Iterator<Item = f32> + '_ {
        self.edges.iter().map(|&[a, b]| {
            let (a, b) = (self.positions[a as usize], self.positions[b as usize]);
            let square = |axis: usize| (a[axis] - b[axis]) * (a[axis] - b[axis]);
            (square(0) + square(1) + square(2)).sqrt()
        })
    }

    /// How long the edges may be, to begin with.
    pub(crate) fn longest_edges(&self) -> LongestEdges {
        LongestEdges(self.longest_m.clone())
    }

    /// Lets the edges be as long as they are on a body.
    pub(crate) fn allow(&mut self, coefficients: &[f32], longest: &mut LongestEdges) {
        self.decode(coefficients);
        for (longest, length) in longest.0.iter_mut().zip(self.lengths()) {
            *longest = longest.max(length);
        }
    }

    /// How far a latent is to be trusted, given its coefficients and how long edges may be; allocates nothing.
    pub(crate) fn trust(
        &mut self,
        latent: &[f32],
        coefficients: &[f32],
        longest: Option<&LongestEdges>,
    ) -> Trust {
        self.decode(coefficients);
        let mut stretches = std::mem::take(&mut self.stretches);
        let longest_m = longest.map_or(&self.longest_m, |longest| &longest.0);
        for ((out, length), longest) in stretches.iter_mut().zip(self.lengths()).zip(longest_m) {
            *out = length / longest.max(f32::MIN_POSITIVE) - 1.0;
        }
        let edge_stretch = percentile_99(&mut stretches).max(0.0);
        self.stretches = stretches;
        let statistics = self.statistics.as_ref();
        Trust {
            distance: statistics.map(|statistics| statistics.distance(latent)),
            edge_stretch,
        }
    }
}

/// 99 of 100 numbers are at most this; 0 for none.
fn percentile_99(numbers: &mut [f32]) -> f32 {
    if numbers.is_empty() {
        return 0.0;
    }
    let index = (numbers.len() - 1) * 99 / 100;
    *numbers.select_nth_unstable_by(index, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trust_falls_with_distance_and_with_stretch() {
        let value = |distance, edge_stretch| {
            let trust = Trust {
                distance,
                edge_stretch,
            };
            trust.value()
        };
        assert_eq!((value(None, 0.0), value(Some(1.0), 0.01)), (1.0, 1.0));
        assert_eq!((value(Some(2.0), 0.0), value(Some(0.0), 0.07)), (0.0, 0.0));
        let falls = |values: Vec<f32>| values.windows(2).all(|pair| pair[1] <= pair[0]);
        assert!(falls(
            (0..30).map(|i| value(Some(0.1 * i as f32), 0.0)).collect()
        ));
        assert!(falls(
            (0..30).map(|i| value(None, 0.005 * i as f32)).collect()
        ));
    }

    #[test]
    fn percentiles_of_little() {
        assert_eq!(percentile_99(&mut []), 0.0);
        assert_eq!(percentile_99(&mut [3.0]), 3.0);
        let mut many: Vec<f32> = (0..1001).rev().map(|i| i as f32).collect();
        assert_eq!(percentile_99(&mut many), 990.0);
    }
}
