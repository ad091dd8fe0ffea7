//! What a model is told of its training set, so that it can say how far a latent is to be trusted.

use glam::{Quat, Vec3};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use stick3d_figure::mesh::unique_edges;
use stick3d_figure::sketch::Sketch;
use stick3d_model::ModelParts;
use stick3d_model::infer::Hypotheses;
use stick3d_model::latent::TrainingStatistics;

use super::TrainError;
use super::answers::answer_ways;
use super::drawn_bodies::DrawnBodies;
use crate::dataset::{BodySet, drawn, random, turn_coefficients};

/// The most bodies that are looked at.
const MOST_BODIES: usize = 4000;
/// The least variance of a latent in any direction, as a share of the mean over all directions.
const LEAST_VARIANCE: f64 = 1e-3;

/// The statistics of the bodies that a model was trained on, turned as in training.
///
/// A body counts with two latents, that of its code and that of its clean sketch: keys come from sketches, and the decoder
/// is trained on both.
pub(super) fn statistics(
    parts: &ModelParts,
    drawn: DrawnBodies<'_>,
) -> Result<TrainingStatistics, TrainError> {
    let DrawnBodies {
        bodies,
        rotations,
        seed,
        ..
    } = drawn;
    let picks: Vec<usize> = (0..bodies.len.min(MOST_BODIES))
        .map(|index| index * bodies.len / bodies.len.min(MOST_BODIES))
        .collect();
    // Enough draws for a covariance, whatever the number of bodies.
    let draws = picks.len().max(8 * parts.metadata.latent_len);
    let latents = (0..draws)
        .into_par_iter()
        .map(|draw| {
            let turn = rotations.sample(&mut random(seed, "statistics", draw as u64));
            latents_of(parts, bodies, picks[draw % picks.len()], turn)
        })
        .collect::<Result<Vec<_>, _>>()?
        .concat();
    let ways = answer_ways(parts, drawn)?;
    of_latents(&latents, longest_edges(parts, bodies, &picks), ways)
}

/// The statistics of given latents, of edges that are at most so long, and of answers that are off in these ways.
pub(crate) fn of_latents(
    latents: &[Vec<f32>],
    longest_edges_m: Vec<f32>,
    answer_ways: Vec<f32>,
) -> Result<TrainingStatistics, TrainError> {
    let (mean, whitening) = whitening(latents)?;
    let mut statistics = TrainingStatistics {
        mean,
        whitening,
        far: 1.0,
        longest_edges_m,
        answer_ways,
        exact_from: 0.0,
    };
    statistics.round_to_half();
    let mut distances: Vec<f32> = latents.iter().map(|z| statistics.distance(z)).collect();
    let index = (distances.len() - 1) * 99 / 100;
    statistics.far = *distances.select_nth_unstable_by(index, f32::total_cmp).1;
    Ok(statistics)
}

/// The latents of one turned body: of itself, and of its sketch.
fn latents_of(
    parts: &ModelParts,
    bodies: &BodySet,
    body: usize,
    turn: Quat,
) -> Result<Vec<Vec<f32>>, TrainError> {
    let figure = &parts.metadata.figure;
    let code = bodies.code_of(body);
    let mut turned = vec![0.0; code.len()];
    turn_coefficients(turn, code, &mut turned);
    let (of_body, _) = parts.encoder3d.forward(&turned);
    let sketch = Sketch::new(figure, drawn(turn, bodies.joints_of(body)))?;
    let output = parts.encoder2d.forward(&sketch.input_vector(figure)?);
    let of_sketch = Hypotheses::new(&output, of_body.len()).likeliest().to_vec();
    Ok(vec![of_body, of_sketch])
}

/// The mean, and the packed rows of the inverse of the covariance's Cholesky factor.
fn whitening(latents: &[Vec<f32>]) -> Result<(Vec<f32>, Vec<f32>), TrainError> {
    let len = latents[0].len();
    let count = latents.len() as f64;
    let mut mean = DVector::<f64>::zeros(len);
    for latent in latents {
        mean += DVector::from_iterator(len, latent.iter().copied().map(f64::from));
    }
    mean /= count;
    let centred = DMatrix::from_fn(len, latents.len(), |i, j| {
        f64::from(latents[j][i]) - mean[i]
    });
    let mut covariance = &centred * centred.transpose() / count;
    let least = LEAST_VARIANCE * covariance.trace() / len as f64 + f64::from(f32::MIN_POSITIVE);
    for index in 0..len {
        covariance[(index, index)] += least;
    }
    let degenerate = || TrainError::Backend("the latents' covariance is degenerate".to_owned());
    let factor = covariance.cholesky().ok_or_else(degenerate)?.l();
    let inverse = factor
        .solve_lower_triangular(&DMatrix::identity(len, len))
        .ok_or_else(degenerate)?;
    let packed = (0..len).flat_map(|row| (0..=row).map(move |column| (row, column)));
    Ok((
        mean.iter().map(|x| *x as f32).collect(),
        packed.map(|at| inverse[at] as f32).collect(),
    ))
}

/// The longest that each edge is on some of the bodies, metres.
fn longest_edges(parts: &ModelParts, bodies: &BodySet, picks: &[usize]) -> Vec<f32> {
    let edges = unique_edges(&parts.triangles);
    let layer = &parts.final_layer;
    let none = || vec![0.0_f32; edges.len()];
    let longer = |mut a: Vec<f32>, b: Vec<f32>| {
        a.iter_mut().zip(&b).for_each(|(a, b)| *a = a.max(*b));
        a
    };
    picks
        .par_chunks(64)
        .map(|picks| {
            let (mut scratch, mut longest) = (layer.scratch(), none());
            let mut positions = vec![[0.0; 3]; layer.vertex_count()];
            for body in picks {
                layer.evaluate(bodies.code_of(*body), &mut scratch, &mut positions);
                for (longest, [a, b]) in longest.iter_mut().zip(&edges) {
                    let [a, b] = [a, b].map(|v| Vec3::from(positions[*v as usize]));
                    *longest = longest.max(a.distance(b));
                }
            }
            longest
        })
        .reduce(none, longer)
}

#[cfg(test)]
mod tests {
    use rand::Rng as _;

    use super::*;

    #[test]
    fn whitened_latents_have_unit_variance_in_all_directions() {
        let mut rng = random(3, "test", 0);
        let latents: Vec<Vec<f32>> = (0..4000)
            .map(|_| {
                let [a, b, c]: [f32; 3] = std::array::from_fn(|_| rng.random::<f32>() - 0.5);
                vec![a + 3.0, 2.0 * a + b, c - b]
            })
            .collect();
        let (mean, whitening) = whitening(&latents).unwrap();
        assert!((mean[0] - 3.0).abs() < 0.02 && whitening.len() == 6);
        let statistics = TrainingStatistics {
            mean,
            whitening,
            far: 1.0,
            longest_edges_m: vec![],
            answer_ways: vec![],
            exact_from: 0.0,
        };
        let squares = latents.iter().map(|z| statistics.distance(z).powi(2));
        let mean_square = squares.sum::<f32>() / latents.len() as f32;
        assert!((mean_square - 1.0).abs() < 0.02, "{mean_square}");
        // 2 a + b without a is b: far, though the numbers are small.
        assert!(statistics.distance(&[3.0, 0.9, 0.0]) > statistics.distance(&[3.4, 0.8, 0.0]));
    }
}
