//! From when on a drawing is held for an exact one.

use rayon::prelude::*;
use stick3d_figure::sketch::Sketch;
use stick3d_model::{Inference, Model};

use super::TrainError;
use crate::dataset::{Augmentation, BodySet, Rotations, drawn, random};

/// How many bodies are drawn, exactly and crookedly.
const BODIES: usize = 2000;

/// The evidence half way between that of exact and that of crooked drawings of the training bodies (medians); see
/// [`exact_from`](stick3d_model::latent::TrainingStatistics::exact_from). 0 for a model that does not refine.
pub(super) fn exact_from(
    model: &Model,
    bodies: &BodySet,
    rotations: Rotations,
    augmentation: Augmentation,
    seed: u64,
) -> Result<f32, TrainError> {
    let crooked = Augmentation {
        clean_share: 0.0,
        missing_share: 0.0,
        ..augmentation
    };
    let inference = Inference::new(model)?;
    let pairs = (0..BODIES)
        .into_par_iter()
        .map_init(
            || inference.clone(),
            |inference, draw| {
                let mut rng = random(seed, "exactness", draw as u64);
                let turn = rotations.sample(&mut rng);
                let body = draw * bodies.len / BODIES;
                let figure = model.figure();
                let exact = drawn(turn, bodies.joints_of(body));
                let mut points = exact.clone();
                crooked
                    .sample(&mut rng)
                    .apply(figure, &mut points, &mut rng);
                let mut evidence = |points| -> Result<Option<f64>, TrainError> {
                    Ok(inference.exact_over_crooked(&Sketch::new(figure, points)?)?)
                };
                Ok(evidence(exact)?.zip(evidence(points)?))
            },
        )
        .collect::<Result<Option<Vec<_>>, TrainError>>()?;
    let (exact, crooked) = pairs.unwrap_or_default().into_iter().unzip();
    Ok(between(exact, crooked) as f32)
}

/// Half way between the medians of two lists; 0 for none.
fn between(mut first: Vec<f64>, mut second: Vec<f64>) -> f64 {
    let median = |list: &mut Vec<f64>| {
        let middle = list.len() / 2;
        if list.is_empty() {
            return 0.0;
        }
        *list.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    0.5 * (median(&mut first) + median(&mut second))
}

#[cfg(test)]
mod tests {
    use super::between;

    #[test]
    fn what_divides_is_half_way_between_the_medians() {
        assert_eq!(between(vec![9.0, 5.0, 4.0], vec![2.0, -70.0, 1.0]), 3.0);
        assert_eq!(between(vec![], vec![]), 0.0);
    }
}
