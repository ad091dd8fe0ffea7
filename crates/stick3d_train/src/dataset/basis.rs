//! The shape of a rigged figure: from the rotations of its bones to its vertices, linear and sparse.
//!
//! A posed mesh is close to `Φ · C`: `Φ` the sparse columns of [`SkinnedLayer`], `C` one affine 3×4 per bone. Linear blend
//! skinning says what `C` is for given rotations `F` of the bones: `C = E · F`, exactly. The rig's own skinning keeps the
//! volume that blending loses; what it differs by is fitted to posed meshes by least squares, with helper bones between
//! neighbouring bones among the columns of `Φ`, and rotations half way between them among those of `F`.
//!
//! `Φ` is centred first: whatever the rotations, the figure's root joint is at the origin.

use glam::{Mat3, Vec3};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use stick3d_figure::regressor::JointRegressor;
use stick3d_model::final_layer::{
    FinalLayer, FinalLayerError, Rotations, SkinnedLayer, SkinnedParts,
};

use super::{BasisFit, InfluenceTable, Shape, posed};
use crate::rig::{Pose, Rig};

/// How a basis is made.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BasisConfig {
    /// The most helper bones, and rotations half way between two bones.
    pub helpers: usize,
    /// How many poses the fit is made on.
    pub poses: usize,
}

/// Why there is no basis.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BasisError {
    /// No poses.
    #[error("no poses to fit the skin to; give at least one")]
    NoPoses,
    /// The equations have no solution.
    #[error("the skin cannot be fitted: the poses' rotations are degenerate")]
    Degenerate,
    /// The layer's arrays do not fit together.
    #[error(transparent)]
    Layer(#[from] FinalLayerError),
}

/// A final layer that turns rotations into vertices, and how to find a pose's numbers for it.
#[derive(Debug, Clone)]
pub struct SkinBasis {
    shape: Shape,
    rotations: Rotations,
    rig_bones: Vec<usize>,
}

impl SkinBasis {
    /// The basis of a rig, fitted to meshes in `poses`, centred on the joint `root` of the regressor.
    ///
    /// # Errors
    /// [`BasisError`].
    pub fn fit(
        rig: &Rig,
        regressor: &JointRegressor,
        root: usize,
        config: BasisConfig,
        poses: &[Pose],
    ) -> Result<Self, BasisError> {
        let table = InfluenceTable::new(rig, config.helpers);
        let rotations = Rotations {
            bone_count: table.rig_bones.len(),
            halves: table.helpers.iter().map(|(a, b)| [*a, *b]).collect(),
        };
        let probe = SkinnedLayer::new(parts(rig, &table, vec![0.0; 4 * table.bone_count], None))?;
        let skin = CentredSkin::new(rig, &table, &regressor.rows[root]);
        let count = rig.mesh.positions.len() as f64;
        let samples: Vec<(DMatrix<f64>, DMatrix<f64>)> = poses
            .par_iter()
            .map(|pose| {
                let mut mesh = vec![];
                posed(rig, regressor, root, pose, &mut mesh);
                let moments = probe.moments(&mesh);
                let moments =
                    DMatrix::from_fn(moments.len(), 3, |i, axis| moments[i][axis] / count);
                (
                    skin.whitened(&moments),
                    features(rig, &rotations, &table.rig_bones, pose),
                )
            })
            .collect();
        let blended =
            skin.centring.clone() * blend_skinning(rig, &table, rotations.feature_columns());
        let expansion = skin.corrected(blended, &samples)?;
        // Column-major storage is the order wanted: one row of the layer's expansion per feature.
        let expansion = expansion.as_slice().iter().map(|x| *x as f32).collect();
        let parts = parts(rig, &table, expansion, Some(rotations.clone()));
        let layer = FinalLayer::Skinned(SkinnedLayer::new(parts)?);
        Ok(Self {
            shape: Shape::new(layer, regressor),
            rotations,
            rig_bones: table.rig_bones,
        })
    }

    /// What codes stand for.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Which rotations a code consists of.
    #[must_use]
    pub fn rotations(&self) -> &Rotations {
        &self.rotations
    }

    /// The numbers `[3][code_columns]` of a pose: what the networks encode and decode.
    #[must_use]
    pub fn code(&self, rig: &Rig, pose: &Pose) -> Vec<f32> {
        self.rotations
            .code(&bone_matrices(rig, &self.rig_bones, pose))
    }

    /// How far posed meshes are from their images.
    #[must_use]
    pub fn measure(
        &self,
        rig: &Rig,
        regressor: &JointRegressor,
        root: usize,
        poses: &[Pose],
    ) -> BasisFit {
        self.shape.measure(poses.iter().map(|pose| {
            let mut mesh = vec![];
            posed(rig, regressor, root, pose, &mut mesh);
            (mesh, self.code(rig, pose))
        }))
    }
}

fn parts(
    rig: &Rig,
    table: &InfluenceTable,
    expansion: Vec<f32>,
    rotations: Option<Rotations>,
) -> SkinnedParts {
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
        rotations,
    }
}

fn bone_matrices(rig: &Rig, rig_bones: &[usize], pose: &Pose) -> Vec<Mat3> {
    let posed = rig.bone_transforms(pose);
    rig_bones
        .iter()
        .map(|bone| Mat3::from_quat(posed[*bone].0))
        .collect()
}

/// The features of a pose, `[feature column][axis]`.
fn features(rig: &Rig, rotations: &Rotations, rig_bones: &[usize], pose: &Pose) -> DMatrix<f64> {
    let columns = rotations.feature_columns();
    let mut flat = vec![0.0; 3 * columns];
    rotations.expand(
        &rotations.code(&bone_matrices(rig, rig_bones, pose)),
        &mut flat,
    );
    DMatrix::from_fn(columns, 3, |j, axis| f64::from(flat[axis * columns + j]))
}

/// Linear blend skinning as a matrix `[4 · bones][features]`: a bone's affine map turns about its head, which hangs on the
/// bones above it.
fn blend_skinning(rig: &Rig, table: &InfluenceTable, columns: usize) -> DMatrix<f64> {
    let bones = &rig.skeleton.bones;
    let number = |bone: usize| table.rig_bones.iter().position(|known| *known == bone);
    let mut matrix = DMatrix::zeros(4 * table.bone_count, columns);
    for (index, bone) in table.rig_bones.iter().copied().enumerate() {
        for j in 0..3 {
            matrix[(4 * index + j, 3 * index + j)] = 1.0;
            matrix[(4 * index + 3, 3 * index + j)] = -f64::from(bones[bone].head[j]);
        }
        let mut child = bone;
        while let Some(parent) = bones[child].parent {
            if let Some(above) = number(parent) {
                for j in 0..3 {
                    matrix[(4 * index + 3, 3 * above + j)] +=
                        f64::from(bones[child].head[j] - bones[parent].head[j]);
                }
            }
            child = parent;
        }
    }
    matrix
}

/// The sparse columns of a skin, centred on the root joint, in coordinates in which they are orthonormal under the mean
/// over the vertices.
struct CentredSkin {
    /// `ΦᵀΦ / N`.
    gram: DMatrix<f64>,
    /// `Z` with `Φ · Z` centred.
    centring: DMatrix<f64>,
    /// `Z · U · Λ^-1/2`: centring, then the inverse root of the centred Gram matrix where it has one.
    columns: DMatrix<f64>,
}

impl CentredSkin {
    /// Directions whose variance is below this share of the largest are noise.
    const LEAST_SHARE: f64 = 1e-9;
    /// Pulls the fitted difference from blend skinning toward none, as a share of the features' own variance.
    const RIDGE: f64 = 1e-4;

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
                for bone in 0..table.rig_bones.len() {
                    centring[(4 * bone + 3, j)] -= f64::from(*weight) * entry;
                }
            }
        }
        let eigen = SymmetricEigen::new(centring.tr_mul(&(&gram * &centring)));
        let largest = eigen.eigenvalues.max();
        let kept: Vec<DVector<f64>> = eigen
            .eigenvalues
            .iter()
            .enumerate()
            .filter(|(_, value)| **value > Self::LEAST_SHARE * largest)
            .map(|(i, value)| eigen.eigenvectors.column(i) / value.sqrt())
            .collect();
        let columns = &centring * DMatrix::from_columns(&kept);
        Self {
            gram,
            centring,
            columns,
        }
    }

    /// The orthonormal coordinates of a centred mesh with moments `Φᵀ · mesh / N`.
    fn whitened(&self, moments: &DMatrix<f64>) -> DMatrix<f64> {
        self.columns.tr_mul(moments)
    }

    /// `blended`, plus what samples of (mesh, features) differ from it by, fitted by least squares.
    fn corrected(
        &self,
        blended: DMatrix<f64>,
        samples: &[(DMatrix<f64>, DMatrix<f64>)],
    ) -> Result<DMatrix<f64>, BasisError> {
        let (first, _) = samples.first().ok_or(BasisError::NoPoses)?;
        let width = blended.ncols();
        let mut of_features = DMatrix::<f64>::zeros(width, width);
        let mut of_meshes = DMatrix::<f64>::zeros(first.nrows(), width);
        for (mesh, features) in samples {
            of_features += features * features.transpose();
            of_meshes += mesh * features.transpose();
        }
        // What blending alone gives, in the same coordinates, is linear in the features too.
        let blending = self.columns.tr_mul(&(&self.gram * &blended));
        let missing = of_meshes - blending * &of_features;
        let ridge = Self::RIDGE * of_features.trace() / width as f64;
        let solver = (of_features + ridge * DMatrix::<f64>::identity(width, width))
            .cholesky()
            .ok_or(BasisError::Degenerate)?;
        let correction = solver.solve(&missing.transpose()).transpose();
        Ok(blended + &self.columns * correction)
    }
}

/// The entries of one vertex in the sparse columns: column and value.
fn sparse_row(rest: Vec3, influences: &[(u16, f32)]) -> Vec<(usize, f64)> {
    let entries = [rest.x, rest.y, rest.z, 1.0].map(f64::from);
    let of_bone = |(bone, weight): &(u16, f32)| {
        let (bone, weight) = (usize::from(*bone), f64::from(*weight));
        let entry = move |(i, entry): (usize, f64)| (4 * bone + i, weight * entry);
        entries.into_iter().enumerate().map(entry)
    };
    influences.iter().flat_map(of_bone).collect()
}
