//! How a body's joints move when its latent moves along the ways in which answers are usually off.

use glam::Vec3;

use super::joint_map::JointRows;
use super::perceptron::Perceptron;
use crate::final_layer::FinalLayer;
use crate::kernels;
use crate::weights::MlpWeights;

/// The derivative of joints by offsets of the latent, through the head, and the memory for it.
#[derive(Debug, Clone)]
pub(super) struct Slopes {
    /// The weights of all layers of the head but the first, `[output][input]`.
    transposed: Vec<Vec<f32>>,
    /// The first layer after the ways: `[output][rank]`.
    first: Vec<f32>,
    /// How many ways there are.
    rank: usize,
    arms: Vec<Vec3>,
    /// Derivatives of one joint by the code: one `[coefficient_len]` for each of x, y and z.
    by_code: [Vec<f32>; 3],
    /// Derivatives by the outputs of each layer, `[joint][axes][output]`.
    by_output: Vec<Vec<f32>>,
}

impl Slopes {
    /// `ways`: `[rank][latent_len]`.
    pub(super) fn new(head: &MlpWeights, layer: &FinalLayer, ways: &[f32]) -> Self {
        let latent_len = head
            .layers
            .first()
            .map_or(1, |layer| layer.input_len.max(1));
        let rank = ways.len() / latent_len;
        let coefficient_len = layer.coefficient_len();
        let turning = layer
            .rotations()
            .map_or(0, |rotations| rotations.bone_count);
        let transposed = head.layers.iter().skip(1).map(|layer| {
            let (rows, columns) = (layer.input_len, layer.output_len);
            transposed(&layer.weight, rows, columns)
        });
        let width = head.layers.first().map_or(0, |layer| layer.output_len);
        let mut first = vec![0.0; rank * width];
        for (way, out) in ways
            .chunks_exact(latent_len)
            .zip(first.chunks_exact_mut(width.max(1)))
        {
            kernels::accumulate(way, &head.layers[0].weight, out);
        }
        Self {
            transposed: transposed.collect(),
            first: self::transposed(&first, rank, width),
            rank,
            arms: vec![Vec3::ZERO; turning],
            by_code: [(); 3].map(|()| vec![0.0; coefficient_len]),
            by_output: vec![vec![]; head.layers.len()],
        }
    }

    /// How many ways there are.
    pub(super) fn rank(&self) -> usize {
        self.rank
    }

    /// Writes the derivatives at what `head` ran on last.
    ///
    /// # Shapes
    /// - `features`: what the final layer made of the head's output
    /// - `slopes`: `[joint][axes][rank]`: x and y, or x, y and z
    pub(super) fn write(
        &mut self,
        head: &Perceptron,
        layer: &FinalLayer,
        features: &[f32],
        rows: &JointRows,
        axes: usize,
        slopes: &mut [f32],
    ) {
        let code = head.output();
        let width = code.len();
        let last = self.by_output.len() - 1;
        self.by_output[last].clear();
        for row in rows.rows.chunks_exact(rows.rank) {
            let [x, y, z] = &mut self.by_code;
            match layer.rotations() {
                Some(rotations) => rotations.slopes(code, features, row, &mut self.arms, [x, y, z]),
                None => {
                    for (axis, slope) in [x, y, z].into_iter().enumerate() {
                        slope.fill(0.0);
                        slope[axis * rows.rank..][..rows.rank].copy_from_slice(row);
                    }
                }
            }
            for slope in &self.by_code[..axes] {
                self.by_output[last].extend_from_slice(&slope[..width]);
            }
        }
        self.back(head, slopes);
    }

    /// From the derivatives by the code to those along the ways.
    fn back(&mut self, head: &Perceptron, slopes: &mut [f32]) {
        let count = slopes.len() / self.rank.max(1);
        for index in (0..self.by_output.len()).rev() {
            let (before, after) = self.by_output.split_at_mut(index);
            let slopes_after = &mut after[0];
            let width = head.value(index).len();
            if head.weights().has_relu_after(index) {
                for row in slopes_after.chunks_exact_mut(width) {
                    for (slope, value) in row.iter_mut().zip(head.value(index)) {
                        if *value <= 0.0 {
                            *slope = 0.0;
                        }
                    }
                }
            }
            match before.last_mut() {
                Some(slopes_before) => {
                    slopes_before.clear();
                    slopes_before.resize(count * head.value(index - 1).len(), 0.0);
                    let matrix = &self.transposed[index - 1];
                    kernels::accumulate_several(slopes_after, width, matrix, slopes_before);
                }
                None => {
                    slopes.fill(0.0);
                    kernels::accumulate_several(slopes_after, width, &self.first, slopes);
                }
            }
        }
    }
}

fn transposed(matrix: &[f32], rows: usize, columns: usize) -> Vec<f32> {
    let entry = |i: usize| matrix[(i % rows.max(1)) * columns + i / rows.max(1)];
    (0..rows * columns).map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::joint_map::JointMap;
    use crate::synthetic::{Kind, model};

    #[test]
    fn slopes_are_differences_of_joints() {
        for kind in [Kind::Basis, Kind::Skinned] {
            let model = model(kind);
            let layer = model.final_layer();
            let latent_len = model.latent_len();
            let way = |i: usize| (1.7 * i as f32).sin();
            let ways: Vec<f32> = (0..2 * latent_len).map(way).collect();
            let JointMap::Linear(rows) = JointMap::new(&model) else {
                panic!("{kind:?} is linear")
            };
            let mut head = Perceptron::new(model.head());
            let mut scratch = layer.scratch();
            let mut joints_at = |offset: [f32; 2]| {
                let latent: Vec<f32> = (0..latent_len)
                    .map(|i| 0.3 + offset[0] * ways[i] + offset[1] * ways[latent_len + i])
                    .collect();
                let mut joints = vec![Vec3::ZERO; model.figure().joint_count()];
                let code = head.run(&latent);
                rows.write(layer.features(code, &mut scratch), &mut joints);
                joints
            };
            let step = 1e-3;
            let differences = [0, 1].map(|way| {
                let mut at = |by: f32| {
                    let mut offset = [0.0; 2];
                    offset[way] = by;
                    joints_at(offset)
                };
                let (after, before) = (at(step), at(-step));
                let pairs = after.iter().zip(&before);
                pairs
                    .map(|(a, b)| (*a - *b) / (2.0 * step))
                    .collect::<Vec<_>>()
            });
            joints_at([0.0; 2]);
            let mut slopes = Slopes::new(model.head(), layer, &ways);
            let mut found = vec![0.0; 3 * differences[0].len() * 2];
            let features = layer.features(head.output(), &mut scratch).to_vec();
            slopes.write(&head, layer, &features, &rows, 3, &mut found);
            for (i, pair) in found.chunks_exact(2).enumerate() {
                for way in 0..2 {
                    let expected = differences[way][i / 3][i % 3];
                    let close = (pair[way] - expected).abs() < 0.02 * expected.abs().max(0.5);
                    assert!(close, "{kind:?} {i} {way}: {} {expected}", pair[way]);
                }
            }
        }
    }
}
