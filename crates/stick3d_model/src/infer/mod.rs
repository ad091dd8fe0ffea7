//! Running a model at frame rate: sketch to latent, latent to mesh, on plain arrays.

mod alternatives;

pub use alternatives::{Alternative, Alternatives};

use glam::Vec3;
use stick3d_figure::figure::Figure;
use stick3d_figure::mesh::NormalAdjacency;
use stick3d_figure::sketch::{Sketch, SketchError};
use thiserror::Error;

use crate::file::ModelError;
use crate::final_layer::{FinalLayer, FinalScratch};
use crate::kernels;
use crate::latent::{LongestEdges, Probe, Trust};
use crate::model::Model;
use crate::weights::MlpWeights;

/// Why one inference did not run. Nothing is written then.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum InferError {
    /// The sketch is not one of this model's figure, or says nothing.
    #[error(transparent)]
    Sketch(#[from] SketchError),
    /// A buffer or a latent has another length than the model needs.
    #[error("{what} has room for {found}, the model needs {expected}")]
    Length {
        /// Which one.
        what: &'static str,
        /// What the model needs.
        expected: usize,
        /// What it has.
        found: usize,
    },
    /// A latent has NaN, infinity or something huge in it, or makes the networks give such.
    #[error("the {what} has a number that is not finite, or huge, at index {index}")]
    NotFinite {
        /// Of what.
        what: &'static str,
        /// Where.
        index: usize,
    },
}

/// The largest number that a latent or a coefficient may have: far beyond any body, far from overflow.
const LARGEST: f32 = 1e9;

/// The ready networks of one model with all memory they need. Running them allocates nothing.
#[derive(Debug, Clone)]
pub struct Inference {
    figure: Figure,
    encoder2d: Perceptron,
    head: Perceptron,
    final_layer: FinalLayer,
    final_scratch: FinalScratch,
    adjacency: NormalAdjacency,
    joints: JointMap,
    probe: Probe,
    latent_len: usize,
    input: Vec<f32>,
}

/// A perceptron with the memory for its layers.
#[derive(Debug, Clone)]
struct Perceptron {
    weights: MlpWeights,
    values: Vec<Vec<f32>>,
}

/// From coefficients to joints.
#[derive(Debug, Clone)]
enum JointMap {
    /// The joints as linear functions of the final layer's features: `[joint][rank]`.
    Linear { rows: Vec<f32>, rank: usize },
    /// The final layer is not linear: through the whole mesh.
    Mesh {
        regressor: stick3d_figure::regressor::JointRegressor,
        positions: Vec<[f32; 3]>,
    },
}

impl Inference {
    /// Makes a model ready to run.
    ///
    /// # Errors
    /// [`ModelError::TriangleOutOfRange`] when the mesh is not sound, which a [`Model`] excludes.
    pub fn new(model: &Model) -> Result<Self, ModelError> {
        let vertex_count = model.vertex_count();
        let adjacency = NormalAdjacency::new(model.triangles(), vertex_count)
            .map_err(|error| ModelError::Metadata(error.to_string()))?;
        let final_layer = model.final_layer().clone();
        let final_scratch = final_layer.scratch();
        Ok(Self {
            figure: model.figure().clone(),
            encoder2d: Perceptron::new(model.encoder2d()),
            head: Perceptron::new(model.head()),
            joints: JointMap::new(model),
            probe: Probe::new(model)?,
            final_layer,
            final_scratch,
            adjacency,
            latent_len: model.latent_len(),
            input: vec![0.0; model.figure().input_len()],
        })
    }

    /// The figure it draws.
    #[must_use]
    pub fn figure(&self) -> &Figure {
        &self.figure
    }

    /// Length of the latent.
    #[must_use]
    pub fn latent_len(&self) -> usize {
        self.latent_len
    }

    /// How many vertices its meshes have.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.final_layer.vertex_count()
    }

    /// The latent of a sketch (paper section 4.2, Encoder2D).
    ///
    /// # Shapes
    /// - `latent`: `[latent_len]`
    ///
    /// # Errors
    /// [`InferError::Sketch`] when the sketch is of another figure or all its joints coincide, [`InferError::Length`].
    pub fn encode(&mut self, sketch: &Sketch, latent: &mut [f32]) -> Result<(), InferError> {
        require("the latent", latent.len(), self.latent_len)?;
        sketch.write_input_vector(&self.figure, &mut self.input)?;
        let output = self.encoder2d.run(&self.input);
        require_finite("sketch's latent", output)?;
        latent.copy_from_slice(output);
        Ok(())
    }

    /// The bodies that a sketch may mean, the likeliest first.
    ///
    /// # Errors
    /// As [`Inference::encode`].
    pub fn infer(
        &mut self,
        sketch: &Sketch,
        alternatives: &mut Alternatives,
    ) -> Result<(), InferError> {
        alternatives.clear();
        let alternative = alternatives.add();
        alternative.latent.resize(self.latent_len, 0.0);
        alternative
            .joints
            .resize(self.figure.joint_count(), Vec3::ZERO);
        alternative.probability = 1.0;
        self.encode(sketch, &mut alternative.latent)?;
        self.joints(&alternative.latent, &mut alternative.joints)
    }

    /// The mesh of a latent (paper section 4.2, Decoder) and its unit normals; metres, the figure's root joint at the
    /// origin, +x to the right of the sketch, +y up, +z toward the viewer.
    ///
    /// # Shapes
    /// - `latent`: `[latent_len]`
    /// - `positions`, `normals`: `[vertex_count]`
    ///
    /// # Errors
    /// [`InferError::Length`], [`InferError::NotFinite`].
    pub fn decode(
        &mut self,
        latent: &[f32],
        positions: &mut [[f32; 3]],
        normals: &mut [[f32; 3]],
    ) -> Result<(), InferError> {
        require("the normals", normals.len(), self.vertex_count())?;
        self.decode_positions(latent, positions)?;
        self.adjacency.vertex_normals(positions, normals);
        Ok(())
    }

    /// [`Inference::decode`] without the normals.
    ///
    /// # Errors
    /// [`InferError::Length`], [`InferError::NotFinite`].
    pub fn decode_positions(
        &mut self,
        latent: &[f32],
        positions: &mut [[f32; 3]],
    ) -> Result<(), InferError> {
        require("the positions", positions.len(), self.vertex_count())?;
        let coefficients = coefficients(&mut self.head, self.latent_len, latent)?;
        self.final_layer
            .evaluate(coefficients, &mut self.final_scratch, positions);
        Ok(())
    }

    /// The joints of a latent's mesh, without making the mesh where the final layer is linear; metres, the space of
    /// [`Inference::decode`].
    ///
    /// # Shapes
    /// - `latent`: `[latent_len]`
    /// - `joints`: one point per joint of the figure
    ///
    /// # Errors
    /// [`InferError::Length`], [`InferError::NotFinite`].
    pub fn joints(&mut self, latent: &[f32], joints: &mut [Vec3]) -> Result<(), InferError> {
        require("the joints", joints.len(), self.figure.joint_count())?;
        let coefficients = coefficients(&mut self.head, self.latent_len, latent)?;
        match &mut self.joints {
            JointMap::Linear { rows, rank } => {
                let features = self
                    .final_layer
                    .features(coefficients, &mut self.final_scratch);
                for (joint, row) in joints.iter_mut().zip(rows.chunks_exact(*rank)) {
                    let along = |axis: usize| -> f32 {
                        row.iter()
                            .zip(&features[axis * *rank..])
                            .map(|(a, b)| a * b)
                            .sum()
                    };
                    *joint = Vec3::new(along(0), along(1), along(2));
                }
            }
            JointMap::Mesh {
                regressor,
                positions,
            } => {
                self.final_layer
                    .evaluate(coefficients, &mut self.final_scratch, positions);
                regressor.write_joints(positions, joints);
            }
        }
        Ok(())
    }

    /// How far a latent is to be trusted to be a body. Looks at some of the mesh's edges; see
    /// [`Trust`].
    ///
    /// # Errors
    /// [`InferError::Length`], [`InferError::NotFinite`].
    pub fn trust(&mut self, latent: &[f32]) -> Result<Trust, InferError> {
        self.trust_beside(latent, None)
    }

    /// [`Inference::trust`] where edges may be as long as `longest` says.
    pub(crate) fn trust_beside(
        &mut self,
        latent: &[f32],
        longest: Option<&LongestEdges>,
    ) -> Result<Trust, InferError> {
        let coefficients = coefficients(&mut self.head, self.latent_len, latent)?;
        Ok(self.probe.trust(latent, coefficients, longest))
    }

    /// How long edges may be beside some bodies: as long as trained or drawn.
    pub(crate) fn longest_edges<'a>(
        &mut self,
        latents: impl Iterator<Item = &'a [f32]>,
    ) -> Result<LongestEdges, InferError> {
        let mut longest = self.probe.longest_edges();
        for latent in latents {
            let coefficients = coefficients(&mut self.head, self.latent_len, latent)?;
            self.probe.allow(coefficients, &mut longest);
        }
        Ok(longest)
    }
}

fn coefficients<'a>(
    head: &'a mut Perceptron,
    latent_len: usize,
    latent: &[f32],
) -> Result<&'a [f32], InferError> {
    require("the latent", latent.len(), latent_len)?;
    require_finite("latent", latent)?;
    let output = head.run(latent);
    require_finite("latent's mesh", output)?;
    Ok(output)
}

impl Perceptron {
    fn new(weights: &MlpWeights) -> Self {
        let values = weights
            .layers
            .iter()
            .map(|layer| vec![0.0; layer.output_len])
            .collect();
        Self {
            weights: weights.clone(),
            values,
        }
    }

    /// The output for `input`; empty when there is no layer.
    fn run(&mut self, input: &[f32]) -> &[f32] {
        for (index, layer) in self.weights.layers.iter().enumerate() {
            let (before, after) = self.values.split_at_mut(index);
            let value = before.last().map_or(input, Vec::as_slice);
            let output = after[0].as_mut_slice();
            output.copy_from_slice(&layer.bias);
            kernels::accumulate(value, &layer.weight, output);
            if self.weights.has_relu_after(index) {
                output.iter_mut().for_each(|x| *x = x.max(0.0));
            }
        }
        self.values.last().map_or(&[], Vec::as_slice)
    }
}

impl JointMap {
    fn new(model: &Model) -> Self {
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
        Self::Linear { rows, rank }
    }
}

fn require(what: &'static str, found: usize, expected: usize) -> Result<(), InferError> {
    if found == expected {
        Ok(())
    } else {
        Err(InferError::Length {
            what,
            expected,
            found,
        })
    }
}

fn require_finite(what: &'static str, numbers: &[f32]) -> Result<(), InferError> {
    match numbers.iter().position(|x| x.is_nan() || x.abs() > LARGEST) {
        Some(index) => Err(InferError::NotFinite { what, index }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
