//! The system of [the paper](https://doi.org/10.1016/j.cag.2022.10.004) as it was published: its data, its networks, its
//! three stages, its baseline.
//!
//! A [`PaperSet`] is some key meshes in 21 turns each (section 4.1). [`train_paper`] learns them with fully connected
//! networks from all 3N coordinates to all 3N coordinates (section 4.2): equation 1 with alpha 1e5, equation 2, and
//! Adam at a constant rate (section 4.3). [`PaperKind::Plain`] is the autoencoder of its figure 4. The result is a
//! [`Model`](stick3d_model::Model) like any other. [`measure`] compares models on the samples that training left out.
//!
//! The paper does not say: the width of the hidden layers (512 here), the size of a batch (64; 8 for a set as small as its horses), the scale of the meshes
//! (the farthest vertex from the root joint is at 0.95, where the tanh can still reach it), and the first weights (He and
//! others). The variance of the latents begins at exp(-4): from 1 on, noise may drown what the decoder could learn
//! from, and equation 1 find its way to the mean mesh at no divergence. No run from there was made; from exp(-4) none did.

mod coarse;
mod config;
mod export;
mod losses;
mod measure;
mod networks;
mod run;
mod set;

pub use config::{PaperConfig, PaperKind};
pub use measure::{Errors, Measured, measure, reconstructed, sketched};
pub(crate) use measure::{decoded, errors};
pub use run::{PaperTrained, train_paper};
pub use set::{KeyMesh, PaperSet, Sample, Samples, Split};

#[cfg(test)]
mod tests;
