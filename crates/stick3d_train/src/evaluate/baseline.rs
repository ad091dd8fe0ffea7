//! The nearest neighbour: no learning, just the training mesh whose sketch is closest.

use glam::{Quat, Vec3};
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::Sketch;

use super::EvalError;
use crate::dataset::{Rotations, drawn};

/// Meshes in the paper's 21 turns, found by their sketches' input vectors.
#[derive(Debug, Clone)]
pub struct Baseline {
    meshes: Vec<Vec<Vec3>>,
    turns: Vec<Quat>,
    /// Per mesh and turn, the input vector.
    inputs: Vec<Vec<f32>>,
}

impl Baseline {
    /// The baseline over bodies, each its vertices and joints, in the paper's turns.
    ///
    /// # Errors
    /// [`EvalError::NoLibrary`] without bodies, [`EvalError::Sketch`] when one cannot be drawn.
    pub fn new(
        figure: &Figure,
        bodies: impl IntoIterator<Item = (Vec<Vec3>, Vec<Vec3>)>,
    ) -> Result<Self, EvalError> {
        let turns = Rotations::paper_list_of(&figure.views);
        let (mut meshes, mut inputs) = (vec![], vec![]);
        for (mesh, joints) in bodies {
            meshes.push(mesh);
            for turn in &turns {
                inputs.push(Sketch::new(figure, drawn(*turn, &joints))?.input_vector(figure)?);
            }
        }
        if meshes.is_empty() {
            return Err(EvalError::NoLibrary);
        }
        Ok(Self {
            meshes,
            turns,
            inputs,
        })
    }

    /// How many meshes there are, turns counted.
    #[must_use]
    pub fn len(&self) -> usize {
        self.inputs.len()
    }

    /// Whether there are none; never, see [`Baseline::new`].
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.inputs.is_empty()
    }

    /// The mesh whose input vector is closest to the sketch's.
    ///
    /// # Errors
    /// [`EvalError::Sketch`] when the sketch has no input vector.
    pub fn nearest(&self, figure: &Figure, sketch: &Sketch) -> Result<Vec<Vec3>, EvalError> {
        let wanted = sketch.input_vector(figure)?;
        let distance = |input: &[f32]| -> f32 {
            input
                .iter()
                .zip(&wanted)
                .map(|(a, b)| (a - b).powi(2))
                .sum()
        };
        let closest = (0..self.inputs.len())
            .min_by(|a, b| distance(&self.inputs[*a]).total_cmp(&distance(&self.inputs[*b])))
            .ok_or(EvalError::NoLibrary)?;
        let turn = self.turns[closest % self.turns.len()];
        Ok(self.meshes[closest / self.turns.len()]
            .iter()
            .map(|point| turn * *point)
            .collect())
    }
}
