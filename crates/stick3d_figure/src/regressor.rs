//! The joint regressor: each joint of a figure as a fixed weighted mean of mesh vertices.

use glam::Vec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Why weights are no joint regressor.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum RegressorError {
    /// A joint has no vertices.
    #[error("joint {joint} of the regressor has no vertices; give it at least one")]
    Empty {
        /// Index of the joint.
        joint: usize,
    },
    /// A joint names a vertex that does not exist.
    #[error(
        "joint {joint} of the regressor names vertex {vertex}, but the mesh has {vertex_count}"
    )]
    VertexOutOfRange {
        /// Index of the joint.
        joint: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        vertex_count: usize,
    },
    /// The weights of a joint are not a mean.
    #[error("the weights of joint {joint} sum to {sum}; they must sum to 1")]
    WeightSum {
        /// Index of the joint.
        joint: usize,
        /// What they sum to.
        sum: f32,
    },
}

/// Per joint, which vertices are averaged with which weights (which sum to 1; single ones may be negative).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointRegressor {
    /// Per joint: vertex and weight.
    pub rows: Vec<Vec<(u32, f32)>>,
}

impl JointRegressor {
    /// A regressor for a mesh of `vertex_count` vertices.
    ///
    /// # Errors
    /// [`RegressorError`] for the first joint at fault.
    pub fn new(rows: Vec<Vec<(u32, f32)>>, vertex_count: usize) -> Result<Self, RegressorError> {
        let regressor = Self { rows };
        regressor.validate(vertex_count)?;
        Ok(regressor)
    }

    /// Checks a regressor that came from elsewhere against a mesh of `vertex_count` vertices.
    ///
    /// # Errors
    /// [`RegressorError`] for the first joint at fault.
    pub fn validate(&self, vertex_count: usize) -> Result<(), RegressorError> {
        for (joint, row) in self.rows.iter().enumerate() {
            if row.is_empty() {
                return Err(RegressorError::Empty { joint });
            }
            if let Some(&(vertex, _)) = row.iter().find(|(v, _)| *v as usize >= vertex_count) {
                return Err(RegressorError::VertexOutOfRange {
                    joint,
                    vertex,
                    vertex_count,
                });
            }
            let sum: f32 = row.iter().map(|(_, weight)| weight).sum();
            if sum.is_nan() || (sum - 1.0).abs() > 1.0e-3 {
                return Err(RegressorError::WeightSum { joint, sum });
            }
        }
        Ok(())
    }

    /// How many joints it gives.
    pub fn joint_count(&self) -> usize {
        self.rows.len()
    }

    /// The joints of a posed mesh, in the unit and space of its positions (`Vec3` or `[f32; 3]`).
    ///
    /// # Panics
    /// When a row names a vertex beyond `positions`; see [`JointRegressor::validate`].
    pub fn joints<P: Copy + Into<Vec3>>(&self, positions: &[P]) -> Vec<Vec3> {
        let mut joints = vec![Vec3::ZERO; self.rows.len()];
        self.write_joints(positions, &mut joints);
        joints
    }

    /// Writes [`JointRegressor::joints`] without allocating.
    ///
    /// # Panics
    /// As [`JointRegressor::joints`], and when `joints` has another length than [`JointRegressor::joint_count`].
    pub fn write_joints<P: Copy + Into<Vec3>>(&self, positions: &[P], joints: &mut [Vec3]) {
        assert_eq!(joints.len(), self.rows.len(), "one point per joint");
        for (joint, row) in joints.iter_mut().zip(&self.rows) {
            *joint = row
                .iter()
                .map(|&(v, weight)| positions[v as usize].into() * weight)
                .sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_weighted_means() {
        let rows = vec![vec![(0, 0.25), (2, 0.75)], vec![(1, 1.0)]];
        let regressor = JointRegressor::new(rows, 3).unwrap();
        let positions = [[0.0, 0.0, 0.0], [1.0, 2.0, 3.0], [4.0, 0.0, 8.0]];
        let joints = regressor.joints(&positions);
        assert_eq!(joints, [Vec3::new(3.0, 0.0, 6.0), Vec3::new(1.0, 2.0, 3.0)]);
        assert_eq!(joints, regressor.joints(&positions.map(Vec3::from)));
    }

    #[test]
    fn faults_are_named() {
        let fault = |row: Vec<(u32, f32)>| JointRegressor::new(vec![row], 3).unwrap_err();
        assert_eq!(fault(vec![]), RegressorError::Empty { joint: 0 });
        assert!(matches!(
            fault(vec![(3, 1.0)]),
            RegressorError::VertexOutOfRange { vertex: 3, .. }
        ));
        assert_eq!(
            fault(vec![(0, 0.5)]),
            RegressorError::WeightSum { joint: 0, sum: 0.5 }
        );
        assert!(matches!(
            fault(vec![(0, f32::NAN)]),
            RegressorError::WeightSum { .. }
        ));
    }
}
