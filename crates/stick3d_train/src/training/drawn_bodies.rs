//! The training bodies turned and drawn as in training: what a finished model is looked at with.

use glam::{Quat, Vec2};
use rayon::prelude::*;
use stick3d_model::{Inference, Model};

use super::TrainError;
use crate::dataset::{Augmentation, BodySet, Rotations, drawn, random};

/// Bodies, and how they are turned and drawn.
#[derive(Clone, Copy)]
pub(super) struct DrawnBodies<'a> {
    pub(super) bodies: &'a BodySet,
    pub(super) rotations: Rotations,
    pub(super) augmentation: Augmentation,
    pub(super) seed: u64,
}

/// One of them.
pub(super) struct DrawnBody {
    /// Its place in the set.
    pub(super) number: usize,
    pub(super) turn: Quat,
    /// Its joints on the sketch plane, metres.
    pub(super) exact: Vec<Vec2>,
    /// The same as they are drawn, crookedly or not.
    pub(super) points: Vec<Vec2>,
}

impl DrawnBodies<'_> {
    /// What `look` finds in `count` of them, spread over the set; `purpose` names their random numbers.
    pub(super) fn each<T: Send>(
        &self,
        model: &Model,
        purpose: &str,
        count: usize,
        look: impl Fn(&mut Inference, DrawnBody) -> Result<T, TrainError> + Sync,
    ) -> Result<Vec<T>, TrainError> {
        let inference = Inference::new(model)?;
        (0..count)
            .into_par_iter()
            .map_init(
                || inference.clone(),
                |inference, draw| {
                    let mut rng = random(self.seed, purpose, draw as u64);
                    let turn = self.rotations.sample(&mut rng);
                    let number = draw * self.bodies.len / count;
                    let exact = drawn(turn, self.bodies.joints_of(number));
                    let mut points = exact.clone();
                    let noise = self.augmentation.sample(&mut rng);
                    noise.apply(model.figure(), &mut points, &mut rng);
                    let body = DrawnBody {
                        number,
                        turn,
                        exact,
                        points,
                    };
                    look(inference, body)
                },
            )
            .collect()
    }
}
