//! The final layer of a figure without a rig: a fixed basis shared by x, y and z.

use glam::Vec3;

use super::{FinalLayerError, FinalScratch, expect_len};
use crate::kernels;

/// `positions[v] = Σ_j columns[j][v] · coefficient_j`, each coefficient a vector.
///
/// Sharing the columns between the axes makes turning the mesh the same as turning the coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct BasisLayer {
    vertex_count: usize,
    columns: Vec<f32>,
}

impl BasisLayer {
    /// A layer from `columns`, `[rank][vertex_count]`.
    ///
    /// # Errors
    /// When `columns` is empty or not a whole number of columns.
    pub fn new(vertex_count: usize, columns: Vec<f32>) -> Result<Self, FinalLayerError> {
        if columns.is_empty() || vertex_count == 0 {
            let problem = "it is empty".to_owned();
            return Err(FinalLayerError {
                what: "columns",
                problem,
            });
        }
        expect_len("remainder of a column", columns.len() % vertex_count, 0)?;
        Ok(Self {
            vertex_count,
            columns,
        })
    }

    /// `[rank][vertex_count]`.
    #[must_use]
    pub fn columns(&self) -> &[f32] {
        &self.columns
    }

    /// How many columns it has.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.columns.len() / self.vertex_count
    }

    /// How many vertices it writes.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    pub(super) fn matrix(&self) -> Vec<f32> {
        let rank = self.rank();
        let entry = |i: usize| self.columns[(i % rank) * self.vertex_count + i / rank];
        (0..self.columns.len()).map(entry).collect()
    }

    pub(super) fn project(&self, positions: &[Vec3]) -> Vec<f32> {
        let mut coefficients = vec![0.0; 3 * self.rank()];
        for axis in 0..3 {
            for j in 0..self.rank() {
                let column = &self.columns[j * self.vertex_count..][..self.vertex_count];
                let sum: f64 = column
                    .iter()
                    .zip(positions)
                    .map(|(c, p)| f64::from(c * p[axis]))
                    .sum();
                coefficients[axis * self.rank() + j] = (sum / self.vertex_count as f64) as f32;
            }
        }
        coefficients
    }

    pub(super) fn evaluate(
        &self,
        coefficients: &[f32],
        scratch: &mut FinalScratch,
        positions: &mut [[f32; 3]],
    ) {
        for (axis, coefficients) in coefficients.chunks_exact(self.rank()).enumerate() {
            scratch.axis.fill(0.0);
            kernels::accumulate(coefficients, &self.columns, &mut scratch.axis);
            for (position, value) in positions.iter_mut().zip(&scratch.axis) {
                position[axis] = *value;
            }
        }
    }
}
