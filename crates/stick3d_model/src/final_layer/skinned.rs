//! The final layer of a rigged figure: linear blend skinning, whose basis is sparse and exact.
//!
//! A skinned vertex is a sum over its bones of weight × (the bone's affine 3×4) × rest position. So the basis has four
//! columns a bone, `weight · [rest; 1]`, and a mesh is one 3×4 per bone. *Helper bones*, which no skeleton has, carry
//! what blending alone cannot (the volume that dual quaternions keep at a bent joint). An `expansion` maps the few
//! coefficients that the networks speak to those 3×4s.

use glam::Vec3;

use super::{FinalLayerError, FinalScratch, Rotations, expect_len};
use crate::kernels;

/// The arrays of a [`SkinnedLayer`].
#[derive(Debug, Clone, PartialEq)]
pub struct SkinnedParts {
    /// Rest position of every vertex, metres.
    pub rest: Vec<[f32; 3]>,
    /// Where the influences of each vertex begin; one more entry than vertices.
    pub offsets: Vec<u32>,
    /// Per influence, the bone.
    pub bones: Vec<u16>,
    /// Per influence, the weight.
    pub weights: Vec<f32>,
    /// How many bones there are, helpers included.
    pub bone_count: usize,
    /// `[rank][4 · bone_count]`: how one feature (a coefficient, or a column of a rotation) moves the bones. A bone's four entries multiply its x, y, z and 1.
    pub expansion: Vec<f32>,
    /// Where the head gives rotations: which. Else it gives the coefficients themselves.
    pub rotations: Option<Rotations>,
}

/// A sparse basis: `positions[v] = Σ_b weight_vb · A_b · [rest_v; 1]` with `A = expansion · coefficients`.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinnedLayer {
    parts: SkinnedParts,
    rank: usize,
}

impl SkinnedLayer {
    /// A layer from its arrays.
    ///
    /// # Errors
    /// When the arrays do not fit together.
    pub fn new(parts: SkinnedParts) -> Result<Self, FinalLayerError> {
        let SkinnedParts {
            rest,
            offsets,
            bones,
            weights,
            bone_count,
            expansion,
            rotations,
        } = &parts;
        expect_len("offsets", offsets.len(), rest.len() + 1)?;
        expect_len("weights", weights.len(), bones.len())?;
        let ordered = offsets.first() == Some(&0)
            && offsets.is_sorted()
            && offsets
                .last()
                .is_some_and(|last| *last as usize == bones.len());
        if !ordered {
            let problem = "they must rise from 0 to the number of influences".to_owned();
            return Err(FinalLayerError {
                what: "offsets",
                problem,
            });
        }
        if let Some(bone) = bones.iter().find(|bone| usize::from(**bone) >= *bone_count) {
            let problem = format!("bone {bone} is named, there are {bone_count}");
            return Err(FinalLayerError {
                what: "bones",
                problem,
            });
        }
        if expansion.is_empty() || *bone_count == 0 {
            let problem = "it is empty".to_owned();
            return Err(FinalLayerError {
                what: "expansion",
                problem,
            });
        }
        let row_len = 4 * bone_count;
        expect_len(
            "remainder of an expansion row",
            expansion.len() % row_len,
            0,
        )?;
        let rank = expansion.len() / row_len;
        if let Some(rotations) = rotations {
            rotations.validate()?;
            expect_len("rotation columns", rotations.feature_columns(), rank)?;
        }
        Ok(Self { parts, rank })
    }

    /// The arrays.
    #[must_use]
    pub fn parts(&self) -> &SkinnedParts {
        &self.parts
    }

    /// How many numbers the head gives.
    #[must_use]
    pub fn coefficient_len(&self) -> usize {
        3 * self
            .parts
            .rotations
            .as_ref()
            .map_or(self.rank, Rotations::code_columns)
    }

    /// How many columns the expansion has.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// How many vertices it writes.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.parts.rest.len()
    }

    pub(super) fn byte_len(&self) -> usize {
        let SkinnedParts {
            rest,
            offsets,
            bones,
            weights,
            expansion,
            ..
        } = &self.parts;
        12 * rest.len()
            + 4 * offsets.len()
            + 2 * bones.len()
            + 4 * weights.len()
            + 4 * expansion.len()
    }

    pub(super) fn scratch(&self) -> FinalScratch {
        let bones = self.parts.bone_count;
        FinalScratch {
            features: vec![0.0; 3 * self.rank],
            axis: vec![0.0; 4 * bones],
            bones: vec![[0.0; 16]; bones],
        }
    }

    /// The influences of vertex `vertex`: bone and weight.
    fn influences(&self, vertex: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let range = self.parts.offsets[vertex] as usize..self.parts.offsets[vertex + 1] as usize;
        let bones = self.parts.bones[range.clone()]
            .iter()
            .map(|bone| usize::from(*bone));
        bones.zip(self.parts.weights[range].iter().copied())
    }

    pub(super) fn matrix(&self) -> Vec<f32> {
        let row_len = 4 * self.parts.bone_count;
        let mut matrix = vec![0.0; self.vertex_count() * self.rank];
        for (vertex, row) in matrix.chunks_exact_mut(self.rank).enumerate() {
            let [x, y, z] = self.parts.rest[vertex];
            for (j, out) in row.iter_mut().enumerate() {
                let bones = &self.parts.expansion[j * row_len..][..row_len];
                let moved = |bone: usize| {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|i| bones[4 * bone + i]);
                    a * x + b * y + c * z + d
                };
                *out = self
                    .influences(vertex)
                    .map(|(bone, weight)| weight * moved(bone))
                    .sum();
            }
        }
        matrix
    }

    /// The transposed sparse basis times a mesh, `[4 · bone_count]` vectors, in double precision.
    #[must_use]
    pub fn moments(&self, positions: &[Vec3]) -> Vec<[f64; 3]> {
        let mut moments = vec![[0.0_f64; 3]; 4 * self.parts.bone_count];
        for (vertex, position) in positions.iter().enumerate() {
            let [x, y, z] = self.parts.rest[vertex];
            for (bone, weight) in self.influences(vertex) {
                for (moment, entry) in moments[4 * bone..4 * bone + 4]
                    .iter_mut()
                    .zip([x, y, z, 1.0])
                {
                    for axis in 0..3 {
                        moment[axis] += f64::from(weight * entry) * f64::from(position[axis]);
                    }
                }
            }
        }
        moments
    }

    pub(super) fn project(&self, positions: &[Vec3]) -> Option<Vec<f32>> {
        if self.parts.rotations.is_some() {
            return None;
        }
        let row_len = 4 * self.parts.bone_count;
        let moments = self.moments(positions);
        let mut coefficients = vec![0.0; 3 * self.rank];
        for (j, row) in self.parts.expansion.chunks_exact(row_len).enumerate() {
            for axis in 0..3 {
                let sum: f64 = row
                    .iter()
                    .zip(&moments)
                    .map(|(e, m)| f64::from(*e) * m[axis])
                    .sum();
                coefficients[axis * self.rank + j] = (sum / self.vertex_count() as f64) as f32;
            }
        }
        Some(coefficients)
    }

    pub(super) fn evaluate(
        &self,
        coefficients: &[f32],
        scratch: &mut FinalScratch,
        positions: &mut [[f32; 3]],
    ) {
        let features = match &self.parts.rotations {
            Some(rotations) => {
                rotations.expand(coefficients, &mut scratch.features);
                scratch.features.as_slice()
            }
            None => coefficients,
        };
        for (axis, features) in features.chunks_exact(self.rank).enumerate() {
            scratch.axis.fill(0.0);
            kernels::accumulate(features, &self.parts.expansion, &mut scratch.axis);
            for (bone, entries) in scratch.bones.iter_mut().zip(scratch.axis.chunks_exact(4)) {
                for (column, entry) in entries.iter().enumerate() {
                    bone[4 * column + axis] = *entry;
                }
            }
        }
        let SkinnedParts {
            rest,
            offsets,
            bones,
            weights,
            ..
        } = &self.parts;
        let matrices = scratch.bones.as_slice();
        kernels::vectorised(
            #[inline(always)]
            || {
                let mut begin = 0;
                for ((position, rest), end) in positions.iter_mut().zip(rest).zip(&offsets[1..]) {
                    let end = *end as usize;
                    let mut blend = [0.0_f32; 16];
                    for (bone, weight) in bones[begin..end].iter().zip(&weights[begin..end]) {
                        let matrix = &matrices[usize::from(*bone)];
                        for (sum, entry) in blend.iter_mut().zip(matrix) {
                            *sum += weight * entry;
                        }
                    }
                    *position = transform(&blend, *rest);
                    begin = end;
                }
            },
        );
    }
}

/// A 3×4, stored as four columns of four, applied to a point.
#[inline(always)]
fn transform(matrix: &[f32; 16], [x, y, z]: [f32; 3]) -> [f32; 3] {
    let row = |i: usize| (matrix[i] * x + matrix[4 + i] * y) + (matrix[8 + i] * z + matrix[12 + i]);
    [row(0), row(1), row(2)]
}
