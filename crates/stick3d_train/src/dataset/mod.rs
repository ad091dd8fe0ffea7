//! Training pairs: posed bodies and the sketches of them.
//!
//! Nothing in training touches 3N numbers. A body is its *code*: two columns of every bone's rotation in a
//! [skin](SkinBasis), or coefficients of [principal components](principal_shape). Its [`Shape`] gives vertices and joints
//! for the code; turning the body turns the code. So a [`BodySet`] is small, and [batches](Batcher) with ever new rotations
//! and sketches are made while training.

mod augment;
mod basis;
mod batch;
mod bodies;
mod influences;
mod principal;
mod rotation;
mod shape;

pub use augment::{Augmentation, SketchNoise};
pub use basis::{BasisConfig, BasisError, SkinBasis};
pub(crate) use batch::drawn;
pub use batch::{Batch, Batcher};
pub use bodies::{BodySet, PoseStream, PoseStreams};
pub(crate) use bodies::{centre, posed};
pub use influences::InfluenceTable;
pub use principal::principal_shape;
pub(crate) use rotation::turn_coefficients;
pub use rotation::{Rotations, rotation};
pub use shape::{BasisFit, Shape};

use rand::Rng;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

/// Random numbers for one purpose, step and part of a run: the same arguments give the same numbers, whatever was drawn before.
#[must_use]
pub fn random(seed: u64, purpose: &str, step: u64) -> ChaCha8Rng {
    use sha2::Digest as _;
    let mut hasher = sha2::Sha256::new();
    hasher.update(seed.to_le_bytes());
    hasher.update(step.to_le_bytes());
    hasher.update(purpose.as_bytes());
    ChaCha8Rng::from_seed(hasher.finalize().into())
}

/// Two independent standard normal numbers (Box and Muller).
pub(crate) fn normal_pair(rng: &mut impl Rng) -> [f32; 2] {
    // 1 - u is in (0, 1], where the logarithm is finite.
    let radius = (-2.0 * (1.0 - rng.random::<f32>()).ln()).sqrt();
    let (sin, cos) = (std::f32::consts::TAU * rng.random::<f32>()).sin_cos();
    [radius * cos, radius * sin]
}

/// To a millionth, for what is reported: so short a decimal is read back from JSON exactly.
pub(crate) fn rounded(number: f64) -> f64 {
    (1e6 * number).round() / 1e6
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod random_tests {
    use super::*;

    #[test]
    fn random_numbers_depend_on_all_arguments_and_nothing_else() {
        let draw = |seed, purpose, step| random(seed, purpose, step).random::<u64>();
        assert_eq!(draw(1, "noise", 2), draw(1, "noise", 2));
        assert_ne!(draw(1, "noise", 2), draw(2, "noise", 2));
        assert_ne!(draw(1, "noise", 2), draw(1, "noise", 3));
        assert_ne!(draw(1, "noise", 2), draw(1, "order", 2));
    }

    #[test]
    fn normals_have_mean_zero_and_variance_one() {
        let mut rng = random(5, "test", 0);
        let numbers: Vec<f64> = (0..50_000)
            .flat_map(|_| normal_pair(&mut rng))
            .map(f64::from)
            .collect();
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        let variance = numbers.iter().map(|x| x * x).sum::<f64>() / numbers.len() as f64;
        assert!(
            mean.abs() < 0.02 && (variance - 1.0).abs() < 0.02,
            "{mean} {variance}"
        );
    }
}
