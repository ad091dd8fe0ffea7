//! Which networks a model consists of, and how large they are.

use serde::{Deserialize, Serialize};

/// The length of the latent vector of the shipped models (paper section 5.2: the best of 128, 256 and 512).
pub const LATENT_LEN: usize = 256;

/// The sizes of the three networks of one model.
///
/// Both kinds are one code path: a *head* (small perceptron, latent to coefficients), then a
/// [`FinalLayer`](crate::FinalLayer) (coefficients to vertices).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Architecture {
    /// The networks of [the paper](https://doi.org/10.1016/j.cag.2022.10.004), section 4.2 and figure 2: Encoder3D
    /// reads, and Decoder writes, all 3N coordinates, through two hidden layers of equal width.
    Paper {
        /// Width of every hidden layer. The paper does not state it.
        hidden: usize,
    },
    /// Encoder3D reads, and Decoder writes, the few numbers that the posed meshes of a figure consist of: coefficients of
    /// a fixed basis, or columns of its bones' rotations.
    Basis {
        /// How many vectors these are; each has an x, a y and a z.
        rank: usize,
        /// Widths of the hidden layers of Encoder3D.
        encoder3d: Vec<usize>,
        /// Widths of the hidden layers of the decoder's head.
        head: Vec<usize>,
        /// Widths of the hidden layers of Encoder2D.
        encoder2d: Vec<usize>,
        /// How many latents Encoder2D gives to a sketch: a drawing may mean several bodies.
        #[serde(default = "one")]
        hypotheses: usize,
    },
}

fn one() -> usize {
    1
}

/// The layer widths that an [`Architecture`] has for one figure, each list from input to output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NetworkSizes {
    /// Encoder2D: sketch input vector to one latent, or to [several and their scores](NetworkSizes::hypotheses).
    pub encoder2d: Vec<usize>,
    /// How many latents Encoder2D gives. With more than one its output is all latents, one after the other, then one score
    /// each: the logarithm of its probability up to a constant.
    pub hypotheses: usize,
    /// Encoder3D without its two output layers (mean and log-variance).
    pub encoder3d_trunk: Vec<usize>,
    /// Head of the decoder: latent to the final layer's coefficients.
    pub head: Vec<usize>,
    /// Whether the head's output passes a ReLU. It does when the final layer is itself a trained layer.
    pub relu_after_head: bool,
    /// Length of the latent vector.
    pub latent_len: usize,
}

impl Architecture {
    /// The widths for a figure whose input vector has `input_len` numbers and whose mesh has `vertex_count` vertices.
    #[must_use]
    pub fn sizes(&self, input_len: usize, latent_len: usize, vertex_count: usize) -> NetworkSizes {
        let chain = |first: usize, hidden: &[usize], last: Option<usize>| -> Vec<usize> {
            std::iter::once(first)
                .chain(hidden.iter().copied())
                .chain(last)
                .collect()
        };
        match self {
            Self::Paper { hidden } => NetworkSizes {
                encoder2d: chain(input_len, &[*hidden; 2], Some(latent_len)),
                encoder3d_trunk: chain(3 * vertex_count, &[*hidden; 2], None),
                head: chain(latent_len, &[*hidden; 2], None),
                hypotheses: 1,
                relu_after_head: true,
                latent_len,
            },
            Self::Basis {
                rank,
                encoder3d,
                head,
                encoder2d,
                hypotheses,
            } => NetworkSizes {
                encoder2d: chain(
                    input_len,
                    encoder2d,
                    Some(encoder2d_output_len(*hypotheses, latent_len)),
                ),
                hypotheses: *hypotheses,
                encoder3d_trunk: chain(3 * rank, encoder3d, None),
                head: chain(latent_len, head, Some(3 * rank)),
                relu_after_head: false,
                latent_len,
            },
        }
    }
}

/// Length of Encoder2D's output; see [`NetworkSizes::hypotheses`].
fn encoder2d_output_len(hypotheses: usize, latent_len: usize) -> usize {
    match hypotheses {
        0 | 1 => latent_len,
        several => several * (latent_len + 1),
    }
}

impl NetworkSizes {
    /// How many numbers the head hands to the final layer.
    #[must_use]
    pub fn coefficient_len(&self) -> usize {
        self.head.last().copied().unwrap_or(self.latent_len)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paper_sizes_are_those_of_figure_2() {
        let sizes = Architecture::Paper { hidden: 512 }.sizes(34, 256, 12_500);
        assert_eq!(sizes.encoder2d, [34, 512, 512, 256]);
        assert_eq!(sizes.encoder3d_trunk, [37_500, 512, 512]);
        assert_eq!(sizes.head, [256, 512, 512]);
        assert!(sizes.relu_after_head);
    }

    #[test]
    fn basis_networks_meet_in_the_coefficients() {
        let mut architecture = Architecture::Basis {
            rank: 96,
            encoder3d: vec![512],
            head: vec![300],
            encoder2d: vec![768, 700],
            hypotheses: 1,
        };
        let sizes = architecture.sizes(34, 256, 12_500);
        assert_eq!(sizes.encoder2d, [34, 768, 700, 256]);
        assert_eq!(sizes.encoder3d_trunk, [288, 512]);
        assert_eq!(sizes.head, [256, 300, 288]);
        assert_eq!(sizes.coefficient_len(), 288);
        let Architecture::Basis { hypotheses, .. } = &mut architecture else {
            unreachable!()
        };
        *hypotheses = 3;
        let sizes = architecture.sizes(34, 256, 12_500);
        assert_eq!(sizes.encoder2d, [34, 768, 700, 3 * 257]);
    }
}
