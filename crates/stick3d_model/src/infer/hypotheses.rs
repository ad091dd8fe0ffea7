//! Encoder2D's output taken apart: the latents that a sketch may mean, and how likely each is.

/// A view of Encoder2D's output: one latent, or several with a score each (see
/// [`NetworkSizes::hypotheses`](crate::architecture::NetworkSizes::hypotheses)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hypotheses<'a> {
    latents: &'a [f32],
    scores: &'a [f32],
    latent_len: usize,
}

impl<'a> Hypotheses<'a> {
    /// Takes an output apart.
    ///
    /// # Panics
    /// When `latent_len` is 0.
    #[must_use]
    pub fn new(output: &'a [f32], latent_len: usize) -> Self {
        let count = match output.len() {
            len if len <= latent_len => 1,
            len => len / (latent_len + 1),
        };
        let (latents, scores) = output.split_at((count * latent_len).min(output.len()));
        Self {
            latents,
            scores,
            latent_len,
        }
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.scores.len().max(1)
    }

    /// Never.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// A latent, `[latent_len]`.
    #[must_use]
    pub fn latent(&self, index: usize) -> &'a [f32] {
        &self.latents[index * self.latent_len..][..self.latent_len]
    }

    /// The latent with the highest score.
    #[must_use]
    pub fn likeliest(&self) -> &'a [f32] {
        let best =
            (0..self.scores.len()).max_by(|a, b| self.scores[*a].total_cmp(&self.scores[*b]));
        self.latent(best.unwrap_or(0))
    }

    /// The mean of the latents, each counted by its probability: what one answer would be.
    ///
    /// # Shapes
    /// - `mean`: `[latent_len]`
    pub fn write_mean(&self, mean: &mut [f32]) {
        mean.fill(0.0);
        for index in 0..self.len() {
            let probability = self.log_probability(index).exp();
            for (mean, x) in mean.iter_mut().zip(self.latent(index)) {
                *mean += probability * x;
            }
        }
    }

    /// The natural logarithm of a latent's probability among all. Beyond the last: that of an average one.
    #[must_use]
    pub fn log_probability(&self, index: usize) -> f32 {
        let Some(score) = self.scores.get(index) else {
            return -(self.len() as f32).ln();
        };
        let highest = self
            .scores
            .iter()
            .copied()
            .fold(f32::NEG_INFINITY, f32::max);
        let sum: f32 = self.scores.iter().map(|s| (s - highest).exp()).sum();
        score - highest - sum.ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_latent_is_certain() {
        let one = Hypotheses::new(&[1.0, 2.0, 3.0], 3);
        assert_eq!(
            (one.len(), one.likeliest(), one.log_probability(0)),
            (1, &[1.0, 2.0, 3.0][..], 0.0)
        );
    }

    #[test]
    fn several_latents_have_probabilities_that_sum_to_one() {
        let output = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.3, 2.0, -1.0];
        let three = Hypotheses::new(&output, 2);
        assert_eq!(three.len(), 3);
        assert_eq!(three.latent(2), [5.0, 6.0]);
        assert_eq!(three.likeliest(), [3.0, 4.0]);
        let sum: f32 = (0..3).map(|i| three.log_probability(i).exp()).sum();
        assert!((sum - 1.0).abs() < 1e-6);
        let ratio = three.log_probability(1) - three.log_probability(0);
        assert!((ratio - 1.7).abs() < 1e-5);
    }
}
