//! The paper's final layer: fully connected, tanh, all 3N coordinates (section 4.2).

use super::{FinalLayerError, FinalScratch, expect_len};
use crate::kernels;
use crate::weights::LinearWeights;

/// `positions = extent · tanh(coefficients · weight + bias)`.
#[derive(Debug, Clone, PartialEq)]
pub struct DenseLayer {
    linear: LinearWeights,
    extent_m: f32,
}

impl DenseLayer {
    /// A layer whose output is vertex by vertex x, y, z, and `extent_m` metres where the tanh is 1.
    ///
    /// # Errors
    /// When the output is not a whole number of vertices or `extent_m` is not a positive length.
    pub fn new(linear: LinearWeights, extent_m: f32) -> Result<Self, FinalLayerError> {
        expect_len(
            "weight",
            linear.weight.len(),
            linear.input_len * linear.output_len,
        )?;
        expect_len("bias", linear.bias.len(), linear.output_len)?;
        expect_len("remainder of a vertex", linear.output_len % 3, 0)?;
        if !(extent_m.is_finite() && extent_m > 0.0) {
            let problem = format!("it is {extent_m}, a positive length is needed");
            return Err(FinalLayerError {
                what: "extent",
                problem,
            });
        }
        Ok(Self { linear, extent_m })
    }

    /// The fully connected part.
    #[must_use]
    pub fn linear(&self) -> &LinearWeights {
        &self.linear
    }

    /// The length that an output of 1 means, metres.
    #[must_use]
    pub fn extent_m(&self) -> f32 {
        self.extent_m
    }

    /// How many vertices it writes.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.linear.output_len / 3
    }

    pub(super) fn evaluate(
        &self,
        coefficients: &[f32],
        scratch: &mut FinalScratch,
        positions: &mut [[f32; 3]],
    ) {
        let sums = scratch.axis.as_mut_slice();
        sums.copy_from_slice(&self.linear.bias);
        kernels::accumulate(coefficients, &self.linear.weight, sums);
        let extent = self.extent_m;
        kernels::vectorised(
            #[inline(always)]
            || {
                for (out, sum) in positions.as_flattened_mut().iter_mut().zip(sums.iter()) {
                    *out = extent * kernels::tanh(*sum);
                }
            },
        );
    }
}
