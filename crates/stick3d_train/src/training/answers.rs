//! How Encoder2D's answers are off: what refinement is told of the latents that it may move them by.

use glam::Vec3;
use nalgebra::{DMatrix, DVector};
use stick3d_figure::sketch::Sketch;
use stick3d_model::infer::Hypotheses;
use stick3d_model::{Inference, Model, ModelParts};

use super::TrainError;
use super::drawn_bodies::{DrawnBodies, DrawnBody};
use crate::dataset::{BodySet, turn_coefficients};

/// How many sketches are looked at, per number of a latent.
const SKETCHES_PER_NUMBER: usize = 16;
/// The most ways that are kept.
const MOST_WAYS: usize = 64;

/// The ways in which the nearest of a sketch's latents are off the latent of the body drawn, longest first; see
/// [`answer_ways`](stick3d_model::latent::TrainingStatistics::answer_ways). Empty for a final layer that is not linear.
pub(super) fn answer_ways(
    parts: &ModelParts,
    drawn: DrawnBodies<'_>,
) -> Result<Vec<f32>, TrainError> {
    if parts.final_layer.matrix_columns() == 0 {
        return Ok(vec![]);
    }
    let model = Model::new(parts.clone())?;
    let draws = SKETCHES_PER_NUMBER * parts.metadata.latent_len;
    let differences = drawn.each(&model, "answers", draws, |inference, body| {
        difference(parts, inference, drawn.bodies, body)
    })?;
    Ok(principal_ways(&differences))
}

/// From a body's latent to the latent of its sketch whose joints are nearest.
fn difference(
    parts: &ModelParts,
    inference: &mut Inference,
    bodies: &BodySet,
    body: DrawnBody,
) -> Result<Vec<f32>, TrainError> {
    let turn = body.turn;
    let sketch = Sketch::new(&parts.metadata.figure, body.points)?;
    let code = bodies.code_of(body.number);
    let mut turned = vec![0.0; code.len()];
    turn_coefficients(turn, code, &mut turned);
    let (truth, _) = parts.encoder3d.forward(&turned);
    let joints: Vec<Vec3> = bodies
        .joints_of(body.number)
        .iter()
        .map(|j| turn * *j)
        .collect();
    let output = parts
        .encoder2d
        .forward(&sketch.input_vector(&parts.metadata.figure)?);
    let hypotheses = Hypotheses::new(&output, truth.len());
    let mut found = vec![Vec3::ZERO; joints.len()];
    let mut nearest = (f32::INFINITY, 0);
    for index in 0..hypotheses.len() {
        inference.joints(hypotheses.latent(index), &mut found)?;
        let distance = found.iter().zip(&joints).map(|(a, b)| a.distance(*b)).sum();
        if distance < nearest.0 {
            nearest = (distance, index);
        }
    }
    let latent = hypotheses.latent(nearest.1);
    Ok(latent.iter().zip(&truth).map(|(a, b)| a - b).collect())
}

/// The principal axes of vectors about 0, each as long as the root of its mean square.
fn principal_ways(vectors: &[Vec<f32>]) -> Vec<f32> {
    let len = vectors.first().map_or(0, Vec::len);
    let mut squares = DMatrix::<f64>::zeros(len, len);
    for vector in vectors {
        let vector = DVector::from_iterator(len, vector.iter().copied().map(f64::from));
        squares.ger(1.0 / vectors.len() as f64, &vector, &vector, 1.0);
    }
    let eigen = squares.symmetric_eigen();
    let mut order: Vec<usize> = (0..len).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    order
        .into_iter()
        .take(MOST_WAYS)
        .flat_map(|index| {
            let length = eigen.eigenvalues[index].max(0.0).sqrt();
            let way = eigen.eigenvectors.column(index);
            way.iter().map(|x| (length * x) as f32).collect::<Vec<_>>()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_are_as_long_as_what_they_stand_for() {
        let vectors: Vec<Vec<f32>> = (0..100)
            .map(|i| {
                let (a, b) = ((i as f32).sin(), (3.7 * i as f32).cos());
                vec![3.0 * a, 3.0 * a, 0.5 * b]
            })
            .collect();
        let ways = principal_ways(&vectors);
        let square = |range: std::ops::Range<usize>| ways[range].iter().map(|x| x * x).sum::<f32>();
        let total: f32 = vectors.iter().flatten().map(|x| x * x).sum::<f32>() / 100.0;
        assert!((square(0..9) - total).abs() < 1e-3 * total);
        assert!(square(0..3) > 50.0 * square(3..6));
        assert!(
            (ways[0] - ways[1]).abs() < 0.05 && ways[2].abs() < 0.1,
            "{ways:?}"
        );
    }
}
