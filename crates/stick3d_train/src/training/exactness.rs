//! From when on a drawing is held for an exact one.

use stick3d_figure::sketch::Sketch;
use stick3d_model::Model;

use super::TrainError;
use super::drawn_bodies::DrawnBodies;
use crate::dataset::Augmentation;

/// How many bodies are drawn, exactly and crookedly.
const BODIES: usize = 2000;

/// The evidence half way between that of exact and that of crooked drawings of the training bodies (medians); see
/// [`exact_from`](stick3d_model::latent::TrainingStatistics::exact_from). 0 for a model that does not refine.
pub(super) fn exact_from(model: &Model, drawn: DrawnBodies<'_>) -> Result<f32, TrainError> {
    let crooked = DrawnBodies {
        augmentation: Augmentation {
            clean_share: 0.0,
            ..drawn.augmentation
        },
        ..drawn
    };
    let pairs = crooked.each(model, "exactness", BODIES, |inference, body| {
        let mut evidence = |points| -> Result<Option<f64>, TrainError> {
            Ok(inference.exact_over_crooked(&Sketch::new(model.figure(), points)?)?)
        };
        Ok(evidence(body.exact)?.zip(evidence(body.points)?))
    })?;
    let (exact, crooked) = pairs.into_iter().flatten().unzip();
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
