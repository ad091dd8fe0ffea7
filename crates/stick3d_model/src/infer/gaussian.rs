//! Small normal distributions: the Cholesky factor of a covariance, and what it says of a vector.

/// The factor of a covariance, and memory.
#[derive(Debug, Clone, Default)]
pub(super) struct Gaussian {
    size: usize,
    /// Lower triangle, `[size][size]`.
    factor: Vec<f64>,
    /// The inverse covariance times the last vector.
    solved: Vec<f64>,
}

impl Gaussian {
    pub(super) fn new(size: usize) -> Self {
        Self {
            size,
            factor: vec![0.0; size * size],
            solved: vec![0.0; size],
        }
    }

    /// The covariance to fill in, `[size][size]`; then comes [`Gaussian::factorise`].
    pub(super) fn covariance(&mut self) -> &mut [f64] {
        &mut self.factor
    }

    /// Cholesky's factor in place of the covariance. What is not positive is made so.
    pub(super) fn factorise(&mut self) {
        let n = self.size;
        for i in 0..n {
            for j in 0..=i {
                let (row_i, row_j) = (&self.factor[i * n..][..j], &self.factor[j * n..][..j]);
                let dot: f64 = row_i.iter().zip(row_j).map(|(a, b)| a * b).sum();
                let rest = self.factor[i * n + j] - dot;
                self.factor[i * n + j] = if i == j {
                    rest.max(f64::MIN_POSITIVE).sqrt()
                } else {
                    rest / self.factor[j * n + j]
                };
            }
        }
    }

    /// The inverse covariance times `vector`.
    pub(super) fn solve(&mut self, vector: &[f64]) -> &[f64] {
        let n = self.size;
        for (i, entry) in vector.iter().enumerate().take(n) {
            let row = &self.factor[i * n..][..=i];
            let dot: f64 = row[..i].iter().zip(&self.solved).map(|(a, b)| a * b).sum();
            self.solved[i] = (entry - dot) / row[i];
        }
        for i in (0..n).rev() {
            let dot: f64 = (i + 1..n)
                .map(|j| self.factor[j * n + i] * self.solved[j])
                .sum();
            self.solved[i] = (self.solved[i] - dot) / self.factor[i * n + i];
        }
        &self.solved
    }

    /// The natural logarithm of the density at `vector`, up to a constant of the size.
    pub(super) fn log_density(&mut self, vector: &[f64]) -> f64 {
        let n = self.size;
        let squares: f64 = self
            .solve(vector)
            .iter()
            .zip(vector)
            .map(|(a, b)| a * b)
            .sum();
        let log_root: f64 = (0..n).map(|i| self.factor[i * n + i].ln()).sum();
        -0.5 * squares - log_root
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solving_inverts_the_covariance_and_the_density_is_the_normal_one() {
        let covariance = [4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0];
        let mut gaussian = Gaussian::new(3);
        gaussian.covariance().copy_from_slice(&covariance);
        gaussian.factorise();
        let vector = [1.0, -2.0, 0.7];
        let solved = gaussian.solve(&vector).to_vec();
        for (row, expected) in covariance.chunks(3).zip(vector) {
            let found: f64 = row.iter().zip(&solved).map(|(a, b)| a * b).sum();
            assert!((found - expected).abs() < 1e-12);
        }
        // Determinant by hand: 4 (6 - 0.04) - 1 (2 + 0.1) + 0.5 (-0.2 - 1.5).
        let determinant: f64 = 4.0 * 5.96 - 2.1 - 0.85;
        let squares: f64 = vector.iter().zip(&solved).map(|(a, b)| a * b).sum();
        let expected = -0.5 * squares - 0.5 * determinant.ln();
        assert!((gaussian.log_density(&vector) - expected).abs() < 1e-12);
    }
}
