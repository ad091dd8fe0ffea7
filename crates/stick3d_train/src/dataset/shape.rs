//! The shape of a figure as training sees it: from codes to vertices and joints.

use glam::Vec3;
use serde::{Deserialize, Serialize};
use stick3d_figure::regressor::JointRegressor;
use stick3d_model::final_layer::{FinalLayer, Rotations};

use super::rounded;

/// A final layer that is linear in the *features* of a code, with the joints as linear functions of the same features.
///
/// For a [skin](super::SkinBasis) the features are rotation matrices; for
/// [principal components](super::principal_shape) they are the code itself.
#[derive(Debug, Clone)]
pub struct Shape {
    layer: FinalLayer,
    /// `[vertex][feature column]`.
    matrix: Vec<f32>,
    /// `[joint][feature column]`.
    joint_rows: Vec<f32>,
}

/// How well a basis holds meshes: distances between their vertices and their images, metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BasisFit {
    /// Mean over all vertices.
    pub mean_m: f64,
    /// 99 of 100 vertices are closer.
    pub p99_m: f64,
    /// The farthest vertex.
    pub max_m: f64,
}

impl Shape {
    /// The shape of a layer whose joints the regressor reads.
    pub(crate) fn new(layer: FinalLayer, regressor: &JointRegressor) -> Self {
        let matrix = layer.matrix().unwrap_or_default();
        let columns = layer.matrix_columns();
        let joint_row = |row: &Vec<(u32, f32)>| -> Vec<f32> {
            let entry = |j: usize| {
                row.iter()
                    .map(|&(v, w)| w * matrix[v as usize * columns + j])
                    .sum()
            };
            (0..columns).map(entry).collect()
        };
        let joint_rows = regressor.rows.iter().flat_map(joint_row).collect();
        Self {
            layer,
            matrix,
            joint_rows,
        }
    }

    /// The final layer that turns codes into vertices.
    #[must_use]
    pub fn layer(&self) -> &FinalLayer {
        &self.layer
    }

    /// Which rotations a code consists of, where it does.
    #[must_use]
    pub fn rotations(&self) -> Option<&Rotations> {
        self.layer.rotations()
    }

    /// How many vectors a code has.
    #[must_use]
    pub fn code_columns(&self) -> usize {
        self.layer.coefficient_len() / 3
    }

    /// How many vectors the features of a code are.
    #[must_use]
    pub fn feature_columns(&self) -> usize {
        self.layer.matrix_columns()
    }

    /// `[vertex][feature column]`: the vertices as linear functions of the features.
    #[must_use]
    pub fn matrix(&self) -> &[f32] {
        &self.matrix
    }

    /// `[joint][feature column]`: the joints as linear functions of the features.
    #[must_use]
    pub fn joint_rows(&self) -> &[f32] {
        &self.joint_rows
    }

    /// The joints of a code `[3][code_columns]`, metres, the root joint at the origin.
    #[must_use]
    pub fn joints(&self, code: &[f32]) -> Vec<Vec3> {
        let columns = self.feature_columns();
        let mut scratch = self.layer.scratch();
        let features = self.layer.features(code, &mut scratch);
        let joint = |row: &[f32]| {
            let along = |axis: usize| -> f32 {
                row.iter()
                    .zip(&features[axis * columns..])
                    .map(|(a, b)| a * b)
                    .sum()
            };
            Vec3::new(along(0), along(1), along(2))
        };
        self.joint_rows.chunks_exact(columns).map(joint).collect()
    }

    /// How far meshes, centred on the root joint, are from the images of their codes.
    #[must_use]
    pub fn measure(&self, bodies: impl IntoIterator<Item = (Vec<Vec3>, Vec<f32>)>) -> BasisFit {
        let mut scratch = self.layer.scratch();
        let mut image = vec![[0.0; 3]; self.layer.vertex_count()];
        let mut distances = vec![];
        for (mesh, code) in bodies {
            self.layer.evaluate(&code, &mut scratch, &mut image);
            distances.extend(
                mesh.iter()
                    .zip(&image)
                    .map(|(a, b)| a.distance(Vec3::from(*b))),
            );
        }
        distances.sort_by(f32::total_cmp);
        let last = distances.len().saturating_sub(1);
        let at = |i: usize| distances.get(i).copied().map_or(0.0, f64::from);
        let sum: f64 = distances.iter().copied().map(f64::from).sum();
        BasisFit {
            mean_m: rounded(sum / distances.len().max(1) as f64),
            p99_m: rounded(at(last * 99 / 100)),
            max_m: rounded(at(last)),
        }
    }
}
