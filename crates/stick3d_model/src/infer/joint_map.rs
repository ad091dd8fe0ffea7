//! From a head's coefficients to the joints, without making the mesh where that can be.

use glam::Vec3;
use stick3d_figure::regressor::JointRegressor;

use crate::final_layer::{FinalLayer, FinalScratch};
use crate::model::Model;

/// From coefficients to joints.
#[derive(Debug, Clone)]
pub(super) enum JointMap {
    /// The joints as linear functions of the final layer's features.
    Linear(JointRows),
    /// The final layer is not linear: through the whole mesh.
    Mesh {
        regressor: JointRegressor,
        positions: Vec<[f32; 3]>,
    },
}

/// The joints as linear functions of features, the same for x, y and z.
#[derive(Debug, Clone)]
pub(super) struct JointRows {
    /// `[joint][rank]`.
    pub(super) rows: Vec<f32>,
    pub(super) rank: usize,
}

impl JointMap {
    pub(super) fn new(model: &Model) -> Self {
        let regressor = model.regressor();
        let Some(matrix) = model.final_layer().matrix() else {
            let positions = vec![[0.0; 3]; model.vertex_count()];
            return Self::Mesh {
                regressor: regressor.clone(),
                positions,
            };
        };
        let rank = model.final_layer().matrix_columns();
        let mut rows = vec![0.0; regressor.joint_count() * rank];
        for (out, row) in rows.chunks_exact_mut(rank).zip(&regressor.rows) {
            for (vertex, weight) in row {
                let matrix_row = &matrix[*vertex as usize * rank..][..rank];
                out.iter_mut()
                    .zip(matrix_row)
                    .for_each(|(out, entry)| *out += weight * entry);
            }
        }
        Self::Linear(JointRows { rows, rank })
    }

    /// Writes the joints of coefficients.
    pub(super) fn write(
        &mut self,
        layer: &FinalLayer,
        scratch: &mut FinalScratch,
        coefficients: &[f32],
        joints: &mut [Vec3],
    ) {
        match self {
            Self::Linear(rows) => rows.write(layer.features(coefficients, scratch), joints),
            Self::Mesh {
                regressor,
                positions,
            } => {
                layer.evaluate(coefficients, scratch, positions);
                regressor.write_joints(positions, joints);
            }
        }
    }
}

impl JointRows {
    /// Writes the joints of features `[3][rank]`.
    pub(super) fn write(&self, features: &[f32], joints: &mut [Vec3]) {
        for (joint, row) in joints.iter_mut().zip(self.rows.chunks_exact(self.rank)) {
            let along = |axis: usize| -> f32 {
                row.iter()
                    .zip(&features[axis * self.rank..])
                    .map(|(a, b)| a * b)
                    .sum()
            };
            *joint = Vec3::new(along(0), along(1), along(2));
        }
    }
}
