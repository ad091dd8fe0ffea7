//! What a model remembers of the bodies that it was trained on.

use half::f16;

use crate::file::ModelError;

/// What the training set was like, as far as [trust](super::Trust) in a latent needs to know. Optional in a model file.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainingStatistics {
    /// The mean of the training latents, `[latent_len]`.
    pub mean: Vec<f32>,
    /// The rows of a lower triangular matrix, one after the other, `[latent_len (latent_len + 1) / 2]`: it makes the
    /// training latents' covariance the identity.
    pub whitening: Vec<f32>,
    /// 99 of 100 training latents are within this [distance](TrainingStatistics::distance) times `far`.
    pub far: f32,
    /// The longest that each edge of the mesh is on any training body, metres, in the order of
    /// [`unique_edges`](stick3d_figure::mesh::unique_edges).
    pub longest_edges_m: Vec<f32>,
    /// The ways in which the latents of sketches were off those of the bodies drawn, `[ways][latent_len]`, each as long as
    /// it was on average (root of the mean square), the longest first. Empty where that was not measured; sketches' bodies
    /// are then not pulled onto the drawing.
    pub answer_ways: Vec<f32>,
    /// How much likelier a drawing must be as an exact one than as a crooked one, natural logarithm, to be held for either with
    /// the same right. Proposals are not normally distributed, so it is not 0: the better a model knows its bodies, the more
    /// of what is crooked it can explain. 0 where that was not measured.
    pub exact_from: f32,
}

impl TrainingStatistics {
    /// How far a latent is from the training set's: 1 is as far as all but one in a hundred of them are.
    ///
    /// The Mahalanobis distance over `far`. It is convex: along a ray from the mean it never falls.
    #[must_use]
    pub fn distance(&self, latent: &[f32]) -> f32 {
        let mut rows = self.whitening.as_slice();
        let mut squares = 0.0;
        for index in 0..self.mean.len().min(latent.len()) {
            let (row, rest) = rows.split_at((index + 1).min(rows.len()));
            rows = rest;
            let entries = row.iter().zip(latent.iter().zip(&self.mean));
            let sum: f32 = entries.map(|(w, (z, mean))| w * (z - mean)).sum();
            squares += sum * sum;
        }
        (squares / self.mean.len().max(1) as f32).sqrt() / self.far
    }

    /// Rounds the large arrays to half precision, as storing them does.
    pub fn round_to_half(&mut self) {
        let arrays = [
            &mut self.whitening,
            &mut self.longest_edges_m,
            &mut self.answer_ways,
        ];
        for number in arrays.into_iter().flatten() {
            *number = f16::from_f32(*number).to_f32();
        }
    }

    /// Checks that the arrays fit a model.
    pub(crate) fn validate(&self, latent_len: usize, edges: usize) -> Result<(), ModelError> {
        for (what, found, expected) in [
            ("numbers in the mean latent", self.mean.len(), latent_len),
            (
                "numbers in the whitening of latents",
                self.whitening.len(),
                latent_len * (latent_len + 1) / 2,
            ),
            ("longest edges", self.longest_edges_m.len(), edges),
        ] {
            if found != expected {
                return Err(ModelError::Count {
                    what,
                    expected,
                    found,
                });
            }
        }
        if !self.answer_ways.len().is_multiple_of(latent_len.max(1)) {
            return Err(ModelError::Count {
                what: "numbers in the last way that answers are off",
                expected: latent_len,
                found: self.answer_ways.len() % latent_len,
            });
        }
        if !self.exact_from.is_finite() {
            return Err(ModelError::NotFinite {
                name: "statistics.exact_from".to_owned(),
                index: 0,
            });
        }
        if !(self.far.is_finite() && self.far > 0.0) {
            return Err(ModelError::NotFinite {
                name: "statistics.far".to_owned(),
                index: 0,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn statistics() -> TrainingStatistics {
        TrainingStatistics {
            mean: vec![1.0, -2.0, 0.5],
            whitening: vec![2.0, 0.5, 1.0, -0.3, 0.2, 4.0],
            far: 1.5,
            longest_edges_m: vec![],
            answer_ways: vec![],
            exact_from: 0.0,
        }
    }

    #[test]
    fn the_distance_is_that_of_the_whitened_latent() {
        let statistics = statistics();
        assert_eq!(statistics.distance(&[1.0, -2.0, 0.5]), 0.0);
        let expected = ((4.0 + 0.25 + 0.09_f32) / 3.0).sqrt() / 1.5;
        assert!((statistics.distance(&[2.0, -2.0, 0.5]) - expected).abs() < 1e-6);
        assert!(statistics.validate(3, 0).is_ok());
        for (latent_len, edges) in [(4, 0), (2, 0), (3, 1)] {
            assert!(statistics.validate(latent_len, edges).is_err());
        }
    }

    proptest! {
        #[test]
        fn along_rays_from_the_mean_it_never_falls(ray in prop::array::uniform3(-3.0_f32..3.0)) {
            let statistics = statistics();
            let at = |t: f32| -> Vec<f32> {
                statistics.mean.iter().zip(&ray).map(|(mean, r)| mean + t * r).collect()
            };
            let distances: Vec<f32> = (0..50).map(|i| statistics.distance(&at(0.2 * i as f32))).collect();
            prop_assert!(distances.windows(2).all(|pair| pair[1] >= pair[0] - 1e-5));
        }
    }
}
