//! The last layer of a decoder, from coefficients to vertices: three kinds behind one interface.

mod basis;
mod dense;
mod rotation_slope;
mod rotations;
mod skinned;
mod subset;

pub use basis::BasisLayer;
pub use dense::DenseLayer;
pub use rotations::Rotations;
pub(crate) use rotations::{LEAST_COSINE, SMALLEST_SQUARE};
pub use skinned::{SkinnedLayer, SkinnedParts};

use glam::Vec3;

/// What turns the head's output into vertex positions (metres, centred on the figure's root joint).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum FinalLayer {
    /// A trained fully connected layer with a tanh, as in the paper.
    Dense(DenseLayer),
    /// A fixed basis: every column one number per vertex, its coefficient a vector in space.
    Basis(BasisLayer),
    /// The sparse basis of a skinned mesh.
    Skinned(SkinnedLayer),
}

/// Memory that evaluating a final layer needs, made once.
#[derive(Debug, Clone, Default)]
pub struct FinalScratch {
    features: Vec<f32>,
    axis: Vec<f32>,
    bones: Vec<[f32; 16]>,
}

/// A layer's arrays do not fit together.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the final layer's {what} does not fit the rest of it: {problem}")]
pub struct FinalLayerError {
    /// Which array.
    pub what: &'static str,
    /// What is wrong with it.
    pub problem: String,
}

impl FinalLayer {
    /// How many vertices it writes.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        match self {
            Self::Dense(layer) => layer.vertex_count(),
            Self::Basis(layer) => layer.vertex_count(),
            Self::Skinned(layer) => layer.vertex_count(),
        }
    }

    /// How many coefficients it reads.
    #[must_use]
    pub fn coefficient_len(&self) -> usize {
        match self {
            Self::Dense(layer) => layer.linear().input_len,
            Self::Basis(layer) => 3 * layer.rank(),
            Self::Skinned(layer) => layer.coefficient_len(),
        }
    }

    /// How many bytes one evaluation reads: the yardstick for its speed.
    #[must_use]
    pub fn byte_len(&self) -> usize {
        match self {
            Self::Dense(layer) => 4 * (layer.linear().weight.len() + layer.linear().bias.len()),
            Self::Basis(layer) => 4 * layer.columns().len(),
            Self::Skinned(layer) => layer.byte_len(),
        }
    }

    /// Memory for [`FinalLayer::evaluate`].
    #[must_use]
    pub fn scratch(&self) -> FinalScratch {
        match self {
            Self::Dense(layer) => FinalScratch {
                axis: vec![0.0; layer.linear().output_len],
                ..FinalScratch::default()
            },
            Self::Basis(layer) => FinalScratch {
                axis: vec![0.0; layer.vertex_count()],
                ..FinalScratch::default()
            },
            Self::Skinned(layer) => layer.scratch(),
        }
    }

    /// Writes all vertices. Allocates nothing.
    ///
    /// # Shapes
    /// - `coefficients`: `[coefficient_len]`; for a basis `[3][rank]`, all x coefficients first
    /// - `positions`: `[vertex_count]`, metres
    ///
    /// # Panics
    /// When a slice has another length, or `scratch` was made by a layer of another shape.
    pub fn evaluate(
        &self,
        coefficients: &[f32],
        scratch: &mut FinalScratch,
        positions: &mut [[f32; 3]],
    ) {
        assert_eq!(
            coefficients.len(),
            self.coefficient_len(),
            "one number per coefficient"
        );
        assert_eq!(
            positions.len(),
            self.vertex_count(),
            "one position per vertex"
        );
        match self {
            Self::Dense(layer) => layer.evaluate(coefficients, scratch, positions),
            Self::Basis(layer) => layer.evaluate(coefficients, scratch, positions),
            Self::Skinned(layer) => layer.evaluate(coefficients, scratch, positions),
        }
    }

    /// What the layer is linear in: the coefficients themselves, or the rotations made of them.
    ///
    /// # Shapes
    /// - `coefficients`: `[coefficient_len]`
    /// - result: `[3][matrix_columns]`, or `[coefficient_len]` for the dense layer
    ///
    /// # Panics
    /// When `coefficients` has another length, or `scratch` was made by a layer of another shape.
    pub fn features<'a>(
        &self,
        coefficients: &'a [f32],
        scratch: &'a mut FinalScratch,
    ) -> &'a [f32] {
        match self.rotations() {
            Some(rotations) => {
                rotations.expand(coefficients, &mut scratch.features);
                &scratch.features
            }
            None => coefficients,
        }
    }

    /// Which rotations the head gives, where it gives rotations.
    #[must_use]
    pub fn rotations(&self) -> Option<&Rotations> {
        match self {
            Self::Skinned(layer) => layer.parts().rotations.as_ref(),
            Self::Dense(_) | Self::Basis(_) => None,
        }
    }

    /// Columns of [`FinalLayer::matrix`]; 0 for the dense layer.
    #[must_use]
    pub fn matrix_columns(&self) -> usize {
        match self {
            Self::Dense(_) => 0,
            Self::Basis(layer) => layer.rank(),
            Self::Skinned(layer) => layer.rank(),
        }
    }

    /// What the layer does to its [features](FinalLayer::features), as a plain matrix: `[vertex_count][matrix_columns]`,
    /// the same for x, y and z. `None` for the dense layer, which is not linear.
    #[must_use]
    pub fn matrix(&self) -> Option<Vec<f32>> {
        match self {
            Self::Dense(_) => None,
            Self::Basis(layer) => Some(layer.matrix()),
            Self::Skinned(layer) => Some(layer.matrix()),
        }
    }

    /// The coefficients that come closest to a mesh, for layers whose columns are orthonormal under the mean over
    /// vertices; `None` for layers that are not linear in their coefficients.
    ///
    /// # Panics
    /// When `positions` has another length than [`FinalLayer::vertex_count`].
    #[must_use]
    pub fn project(&self, positions: &[Vec3]) -> Option<Vec<f32>> {
        assert_eq!(
            positions.len(),
            self.vertex_count(),
            "one position per vertex"
        );
        match self {
            Self::Dense(_) => None,
            Self::Basis(layer) => Some(layer.project(positions)),
            Self::Skinned(layer) => layer.project(positions),
        }
    }
}

/// Checks a length and says which array is at fault.
fn expect_len(what: &'static str, found: usize, expected: usize) -> Result<(), FinalLayerError> {
    if found == expected {
        return Ok(());
    }
    Err(FinalLayerError {
        what,
        problem: format!("it has {found} numbers, {expected} are needed"),
    })
}
