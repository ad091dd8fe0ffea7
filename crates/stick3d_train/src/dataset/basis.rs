//! The basis of a rigged figure's posed meshes: sparse columns, orthonormal coefficients.
//!
//! A posed mesh is close to `Φ · C`: `Φ` the sparse columns of [`SkinnedLayer`], `C` one affine 3×4 per bone. The least
//! squares problem for `C` is whitened by the Gram matrix of `Φ`, and rotated to principal axes; the leading ones are the
//! coefficients `a = Ψᵀ · mesh / N`, with `Ψ = Φ · E` orthonormal under the mean over the vertices. So `|a - b|²` is the mean
//! squared distance between the vertices of two meshes in the basis, and a rotation of the mesh is one of `a`.
//! `Φ` is centred first: every mesh of the basis has its root joint at the origin exactly.

use glam::Vec3;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use stick3d_figure::regressor::JointRegressor;
use stick3d_model::final_layer::{FinalLayer, FinalLayerError, SkinnedLayer, SkinnedParts};

use super::InfluenceTable;
use crate::rig::Rig;

/// How a basis is made.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BasisConfig {
    /// How many coefficients a mesh has along each axis.
    pub rank: usize,
    /// The most helper bones.
    pub helpers: usize,
    /// How many poses the principal axes come from.
    pub poses: usize,
}

/// Why there is no basis.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BasisError {
    /// Fewer independent columns than coefficients wanted.
    #[error("the rig spans only {found} independent columns, a rank of {wanted} was asked for; lower the rank")]
    Rank {
        /// Asked for.
        wanted: usize,
        /// There are.
        found: usize,
    },
    /// No poses.
    #[error("no poses to find the principal axes of the meshes with; give at least one")]
    NoPoses,
    /// The layer's arrays do not fit together.
    #[error(transparent)]
    Layer(#[from] FinalLayerError),
}

/// A basis, and how to find a mesh's coefficients in it.
#[derive(Debug, Clone)]
pub struct SkinBasis {
    layer: FinalLayer,
    rank: usize,
    /// `[joint][rank]`: the joints as linear functions of the coefficients.
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

impl SkinBasis {
    /// The basis of a rig for meshes like `meshes`, which are centred on the joint `root` of the regressor.
    ///
    /// # Errors
    /// [`BasisError`].
    pub fn fit(
        rig: &Rig,
        regressor: &JointRegressor,
        root: usize,
        config: BasisConfig,
        meshes: impl ParallelIterator<Item = Vec<Vec3>>,
    ) -> Result<Self, BasisError> {
        let table = InfluenceTable::new(rig, config.helpers);
        let probe = SkinnedLayer::new(parts(rig, &table, vec![0.0; 4 * table.bone_count]))?;
        let whitening = Whitening::new(rig, &table, &regressor.rows[root]);
        let count = rig.mesh.positions.len() as f64;
        let whitened: Vec<DMatrix<f64>> = meshes
            .map(|mesh| {
                let moments = probe.moments(&mesh);
                let moments = DMatrix::from_fn(moments.len(), 3, |i, axis| moments[i][axis] / count);
                whitening.columns.tr_mul(&moments)
            })
            .collect();
        if whitened.is_empty() {
            return Err(BasisError::NoPoses);
        }
        let expansion = whitening.expansion(&principal_axes(&whitened, config.rank)?);
        let layer = FinalLayer::Skinned(SkinnedLayer::new(parts(rig, &table, expansion))?);
        Ok(Self::new(layer, regressor))
    }

    fn new(layer: FinalLayer, regressor: &JointRegressor) -> Self {
        let rank = layer.coefficient_len() / 3;
        let matrix = layer.matrix().unwrap_or_default();
        let joint_rows = regressor
            .rows
            .iter()
            .flat_map(|row| {
                (0..rank).map(|j| row.iter().map(|&(v, weight)| weight * matrix[v as usize * rank + j]).sum())
            })
            .collect();
        Self { layer, rank, joint_rows }
    }

    /// The final layer that turns coefficients into vertices.
    #[must_use]
    pub fn layer(&self) -> &FinalLayer {
        &self.layer
    }

    /// Coefficients along each axis.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// `[joint][rank]`: the joints as linear functions of the coefficients.
    #[must_use]
    pub fn joint_rows(&self) -> &[f32] {
        &self.joint_rows
    }

    /// The coefficients `[3][rank]` that come closest to a centred mesh.
    #[must_use]
    pub fn project(&self, mesh: &[Vec3]) -> Vec<f32> {
        self.layer.project(mesh).unwrap_or_default()
    }

    /// How far meshes are from their images in the basis.
    #[must_use]
    pub fn measure(&self, meshes: &[Vec<Vec3>]) -> BasisFit {
        let mut scratch = self.layer.scratch();
        let mut image = vec![[0.0; 3]; self.layer.vertex_count()];
        let mut distances: Vec<f32> = vec![];
        for mesh in meshes {
            self.layer.evaluate(&self.project(mesh), &mut scratch, &mut image);
            distances.extend(mesh.iter().zip(&image).map(|(a, b)| a.distance(Vec3::from(*b))));
        }
        distances.sort_by(f32::total_cmp);
        let last = distances.len().saturating_sub(1);
        let at = |i: usize| distances.get(i).copied().map_or(0.0, f64::from);
        let mean_m = distances.iter().copied().map(f64::from).sum::<f64>() / distances.len().max(1) as f64;
        BasisFit { mean_m, p99_m: at(last * 99 / 100), max_m: at(last) }
    }
}

fn parts(rig: &Rig, table: &InfluenceTable, expansion: Vec<f32>) -> SkinnedParts {
    let ends = table.rows.iter().scan(0_u32, |end, row| {
        *end += row.len() as u32;
        Some(*end)
    });
    let (bones, weights) = table.rows.iter().flatten().copied().unzip();
    SkinnedParts {
        rest: rig.mesh.positions.iter().map(Vec3::to_array).collect(),
        offsets: std::iter::once(0).chain(ends).collect(),
        bones,
        weights,
        bone_count: table.bone_count,
        expansion,
    }
}

/// What turns moments `Φᵀ · mesh / N` into orthonormal coefficients.
struct Whitening {
    /// `Z · U · Λ^-1/2`: centring, then the inverse root of the centred Gram matrix where it has one.
    columns: DMatrix<f64>,
}

impl Whitening {
    /// Directions whose variance is below this share of the largest are noise.
    const LEAST_SHARE: f64 = 1e-9;

    fn new(rig: &Rig, table: &InfluenceTable, root_row: &[(u32, f32)]) -> Self {
        let width = 4 * table.bone_count;
        let vertex = |v: usize| sparse_row(rig.mesh.positions[v], &table.rows[v]);
        let mut gram = DMatrix::<f64>::zeros(width, width);
        for v in 0..rig.mesh.positions.len() {
            let row = vertex(v);
            for (i, a) in &row {
                for (j, b) in &row {
                    gram[(*i, *j)] += a * b;
                }
            }
        }
        gram /= rig.mesh.positions.len() as f64;
        // Φ' = Φ - 1·g with g the root joint's row. 1 = Φ·t, t picking the rig bones' translations, so Φ' = Φ·Z.
        let mut centring = DMatrix::<f64>::identity(width, width);
        for (v, weight) in root_row {
            for (j, entry) in vertex(*v as usize) {
                for bone in 0..table.rig_bone_count {
                    centring[(4 * bone + 3, j)] -= f64::from(*weight) * entry;
                }
            }
        }
        let centred = centring.tr_mul(&(gram * &centring));
        let eigen = SymmetricEigen::new(centred);
        let largest = eigen.eigenvalues.max();
        let kept: Vec<DVector<f64>> = eigen
            .eigenvalues
            .iter()
            .enumerate()
            .filter(|(_, value)| **value > Self::LEAST_SHARE * largest)
            .map(|(i, value)| eigen.eigenvectors.column(i) / value.sqrt())
            .collect();
        Self { columns: centring * DMatrix::from_columns(&kept) }
    }

    /// The layer's expansion `[rank][4 · bones]` for principal axes `[whitened][rank]`.
    fn expansion(&self, axes: &DMatrix<f64>) -> Vec<f32> {
        let expansion = &self.columns * axes;
        // Column-major storage is the order wanted.
        expansion.as_slice().iter().map(|x| *x as f32).collect()
    }
}

/// The entries of one vertex in the sparse columns: column and value.
fn sparse_row(rest: Vec3, influences: &[(u16, f32)]) -> Vec<(usize, f64)> {
    let entries = [rest.x, rest.y, rest.z, 1.0].map(f64::from);
    let of_bone = |(bone, weight): &(u16, f32)| {
        let (bone, weight) = (usize::from(*bone), f64::from(*weight));
        entries.iter().enumerate().map(move |(i, entry)| (4 * bone + i, weight * entry)).collect::<Vec<_>>()
    };
    influences.iter().flat_map(of_bone).collect()
}

/// The `rank` leading principal axes of whitened meshes `[whitened][3]`, without centring: turning a mesh must not leave the space.
fn principal_axes(whitened: &[DMatrix<f64>], rank: usize) -> Result<DMatrix<f64>, BasisError> {
    let width = whitened[0].nrows();
    if rank > width {
        return Err(BasisError::Rank { wanted: rank, found: width });
    }
    let stacked = DMatrix::from_fn(width, 3 * whitened.len(), |i, j| whitened[j / 3][(i, j % 3)]);
    let eigen = SymmetricEigen::new(&stacked * stacked.transpose());
    let mut order: Vec<usize> = (0..width).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let columns: Vec<DVector<f64>> = order[..rank]
        .iter()
        .map(|i| {
            let column = eigen.eigenvectors.column(*i).into_owned();
            // The sign of an eigenvector is arbitrary: make the largest entry positive.
            let largest = column.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
            column * largest.signum()
        })
        .collect();
    Ok(DMatrix::from_columns(&columns))
}
