//! The Decoder of one model (paper section 4.2) with all memory it needs: from a latent to the mesh, or to its joints alone.

use glam::Vec3;

use super::joint_map::JointMap;
use super::perceptron::Perceptron;
use super::proposal::Body;
use super::{InferError, require, require_finite};
use crate::final_layer::{FinalLayer, FinalScratch};
use crate::model::Model;

/// The Decoder, ready to run.
#[derive(Debug, Clone)]
pub(super) struct Decoding {
    head: Perceptron,
    layer: FinalLayer,
    scratch: FinalScratch,
    joints: JointMap,
    latent_len: usize,
}

impl Decoding {
    pub(super) fn new(model: &Model) -> Self {
        let layer = model.final_layer().clone();
        Self {
            head: Perceptron::new(model.head()),
            scratch: layer.scratch(),
            layer,
            joints: JointMap::new(model),
            latent_len: model.latent_len(),
        }
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.layer.vertex_count()
    }

    /// The final layer's coefficients of a latent, `[latent_len]`.
    pub(super) fn coefficients(&mut self, latent: &[f32]) -> Result<&[f32], InferError> {
        require("the latent", latent.len(), self.latent_len)?;
        require_finite("latent", latent)?;
        let coefficients = self.head.run(latent);
        require_finite("latent's mesh", coefficients)?;
        Ok(coefficients)
    }

    /// Writes the mesh of a latent, `[vertex_count]`.
    pub(super) fn write_positions(
        &mut self,
        latent: &[f32],
        positions: &mut [[f32; 3]],
    ) -> Result<(), InferError> {
        self.coefficients(latent)?;
        let coefficients = self.head.output();
        self.layer
            .evaluate(coefficients, &mut self.scratch, positions);
        Ok(())
    }

    /// Writes the joints of a latent's mesh, one per joint of the figure.
    pub(super) fn write_joints(
        &mut self,
        latent: &[f32],
        joints: &mut [Vec3],
    ) -> Result<(), InferError> {
        self.coefficients(latent)?;
        let coefficients = self.head.output();
        self.joints
            .write(&self.layer, &mut self.scratch, coefficients, joints);
        Ok(())
    }

    /// What refinement moves; `None` where joints are not linear in the final layer's features.
    pub(super) fn body(&mut self) -> Option<Body<'_>> {
        let JointMap::Linear(rows) = &self.joints else {
            return None;
        };
        Some(Body {
            head: &mut self.head,
            layer: &self.layer,
            scratch: &mut self.scratch,
            rows,
        })
    }
}
