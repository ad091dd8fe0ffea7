//! Blends the latents of the clips that a figure plays, in memory that is kept from frame to frame.

use std::any::TypeId;

use bevy::animation::{AnimationEntityMut, AnimationEvaluationError};
use bevy::prelude::*;
use stick3d_model::latent::PathError;
use thiserror::Error;

use super::curve::LatentCurve;
use super::root_motion::{ClipPlayback, ClipShare};
use crate::figure::{Latent, StickFigure};

/// Why a playing clip could not move its figure. The figure keeps the pose that it had.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PlayError {
    /// Clips of different models are blended.
    #[error(
        "two clips that are blended have latents of {first} and of {other} numbers; make both for the figure's own model"
    )]
    LatentLengths {
        /// Numbers in one of them.
        first: usize,
        /// Numbers in the other.
        other: usize,
    },
    /// A clip is of another model than the figure.
    #[error("a clip is of another model than the figure; make it for the figure's own")]
    OtherModel,
    /// A clip has no pose at the player's time.
    #[error("a clip has no pose: {0}")]
    Path(#[from] PathError),
}

/// The [`AnimationCurveEvaluator`] of all [`LatentCurve`]s.
///
/// It also keeps which share each clip has in the blend, by which root motion is weighed.
#[derive(Default)]
pub struct LatentCurveEvaluator {
    /// The latents of the stack, one after the other.
    latents: Vec<f32>,
    /// The shares of the stack, one after the other.
    shares: Vec<ClipShare>,
    stack: Vec<Element>,
    register: Register,
    error: Option<PlayError>,
}

/// What is on the stack: the last so many latents and shares that are not those of an element above it.
struct Element {
    latent_len: usize,
    share_count: usize,
    weight: f32,
    node: AnimationNodeIndex,
}

/// What is being blended; empty without a weight.
#[derive(Default)]
struct Register {
    latent: Vec<f32>,
    shares: Vec<ClipShare>,
    weight: Option<f32>,
}

impl LatentCurveEvaluator {
    /// Pushes what `write` writes as the latent of a curve.
    pub(super) fn push(
        &mut self,
        curve: &LatentCurve,
        node: AnimationNodeIndex,
        weight: f32,
        latent_len: usize,
        write: impl FnOnce(&mut [f32]) -> Result<(), PathError>,
    ) {
        let start = self.latents.len();
        self.latents.resize(start + latent_len, 0.0);
        if let Err(error) = write(&mut self.latents[start..]) {
            self.latents.truncate(start);
            self.error = Some(error.into());
            return;
        }
        self.shares.push(ClipShare {
            curve: curve.clone(),
            node,
            share: 1.0,
        });
        self.stack.push(Element {
            latent_len,
            share_count: 1,
            weight,
            node,
        });
    }

    /// Moves the top of the stack into the register, if it is of the node.
    fn combine(&mut self, node: AnimationNodeIndex, additive: bool) {
        let Some(top) = self.stack.pop_if(|top| top.node == node) else {
            return;
        };
        let latent_start = self.latents.len() - top.latent_len;
        let share_start = self.shares.len() - top.share_count;
        let register = &mut self.register;
        let before = register.weight;
        if before.is_none() {
            register.latent.clear();
            register.latent.resize(top.latent_len, 0.0);
            register.shares.clear();
        }
        let total = before.unwrap_or(0.0) + top.weight;
        let (keep, take) = match (before, additive) {
            (None, false) => (0.0, 1.0),
            (_, true) => (1.0, top.weight),
            // Weights of 0 on both sides have no mean; the first stays.
            (Some(_), false) if total == 0.0 => (1.0, 0.0),
            (Some(_), false) => (1.0 - top.weight / total, top.weight / total),
        };
        if register.latent.len() == top.latent_len {
            let added = self.latents.drain(latent_start..);
            for (number, added) in register.latent.iter_mut().zip(added) {
                *number = keep * *number + take * added;
            }
            for share in &mut register.shares {
                share.share *= keep;
            }
            let added = self.shares.drain(share_start..);
            register.shares.extend(added.map(|added| ClipShare {
                share: take * added.share,
                ..added
            }));
        } else {
            self.latents.truncate(latent_start);
            self.shares.truncate(share_start);
            self.error = Some(PlayError::LatentLengths {
                first: register.latent.len(),
                other: top.latent_len,
            });
        }
        register.weight = Some(total);
    }
}

impl AnimationCurveEvaluator for LatentCurveEvaluator {
    fn blend(&mut self, graph_node: AnimationNodeIndex) -> Result<(), AnimationEvaluationError> {
        self.combine(graph_node, false);
        Ok(())
    }

    fn add(&mut self, graph_node: AnimationNodeIndex) -> Result<(), AnimationEvaluationError> {
        self.combine(graph_node, true);
        Ok(())
    }

    fn push_blend_register(
        &mut self,
        weight: f32,
        graph_node: AnimationNodeIndex,
    ) -> Result<(), AnimationEvaluationError> {
        if self.register.weight.take().is_some() {
            self.stack.push(Element {
                latent_len: self.register.latent.len(),
                share_count: self.register.shares.len(),
                weight,
                node: graph_node,
            });
            self.latents.append(&mut self.register.latent);
            self.shares.append(&mut self.register.shares);
        }
        Ok(())
    }

    /// Writes the [`Latent`], which counts as changed only if it is another than before.
    fn commit(&mut self, mut entity: AnimationEntityMut) -> Result<(), AnimationEvaluationError> {
        let mut error = self.error.take();
        let top = self.stack.pop();
        if let Some(StickFigure(model)) = entity.get() {
            let is_other = |share: &ClipShare| share.curve.model().is_some_and(|m| m != model.id());
            if self.shares.iter().any(is_other) {
                error = Some(PlayError::OtherModel);
            }
        }
        if let (None, Some(top)) = (&error, &top) {
            let numbers = &self.latents[self.latents.len() - top.latent_len..];
            let mut latent = entity.get_mut::<Latent>().ok_or_else(|| {
                AnimationEvaluationError::ComponentNotPresent(TypeId::of::<Latent>())
            })?;
            if latent.0 != numbers {
                latent.0.clear();
                latent.0.extend_from_slice(numbers);
            }
        }
        if let Some(mut playback) = entity.get_mut::<ClipPlayback>() {
            let count = top.map_or(0, |top| top.share_count);
            let from = self.shares.len() - count;
            playback
                .bypass_change_detection()
                .play(self.shares.drain(from..), error);
        }
        self.latents.clear();
        self.shares.clear();
        self.stack.clear();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use stick3d_model::latent::{Easing, MotionSettings};
    use stick3d_model::{Inference, LatentKey, Motion};

    use super::*;
    use crate::embedded::EMBEDDED_MODELS;

    fn curve() -> LatentCurve {
        let model = EMBEDDED_MODELS[0].model().unwrap();
        let mut inference = Inference::new(model.model()).unwrap();
        let keys = [0.0, 1.0].map(|time_s| LatentKey {
            latent: vec![0.1 * time_s; inference.latent_len()],
            time_s,
            easing: Easing::Linear,
        });
        LatentCurve::new(Motion::new(&keys, MotionSettings::default(), &mut inference).unwrap())
    }

    /// Pushes a latent of equal numbers.
    fn push(evaluator: &mut LatentCurveEvaluator, node: u32, weight: f32, latent: &[f32]) {
        let node = AnimationNodeIndex::new(node as usize);
        evaluator.push(&curve(), node, weight, latent.len(), |out| {
            out.copy_from_slice(latent);
            Ok(())
        });
    }

    /// Blends or adds nodes 1 and 2, as Bevy does, into node 0.
    fn combine(evaluator: &mut LatentCurveEvaluator, additive: bool) {
        for node in [2, 1] {
            let node = AnimationNodeIndex::new(node);
            if additive {
                evaluator.add(node).unwrap();
            } else {
                evaluator.blend(node).unwrap();
            }
        }
        let root = AnimationNodeIndex::new(0);
        evaluator.push_blend_register(1.0, root).unwrap();
    }

    #[test]
    fn blends_weigh_latents_and_shares_alike() {
        let mut evaluator = LatentCurveEvaluator::default();
        push(&mut evaluator, 1, 3.0, &[8.0, 4.0]);
        push(&mut evaluator, 2, 1.0, &[0.0, 8.0]);
        combine(&mut evaluator, false);
        assert_eq!(evaluator.latents, [6.0, 5.0]);
        let shares: Vec<f32> = evaluator.shares.iter().map(|share| share.share).collect();
        assert_eq!(shares, [0.25, 0.75]);
        assert_eq!(evaluator.stack.len(), 1);

        let mut evaluator = LatentCurveEvaluator::default();
        push(&mut evaluator, 1, 0.5, &[8.0]);
        push(&mut evaluator, 2, 1.0, &[1.0]);
        combine(&mut evaluator, true);
        assert_eq!(evaluator.latents, [5.0]);
    }

    #[test]
    fn weights_of_nothing_make_no_nan() {
        let mut evaluator = LatentCurveEvaluator::default();
        push(&mut evaluator, 1, 0.0, &[8.0]);
        push(&mut evaluator, 2, 0.0, &[2.0]);
        combine(&mut evaluator, false);
        assert_eq!(evaluator.latents, [2.0]);
    }

    #[test]
    fn latents_of_different_lengths_are_an_error() {
        let mut evaluator = LatentCurveEvaluator::default();
        push(&mut evaluator, 1, 1.0, &[8.0, 4.0]);
        push(&mut evaluator, 2, 1.0, &[0.0]);
        combine(&mut evaluator, false);
        let error = evaluator.error.unwrap().to_string();
        assert!(error.contains("of 1 and of 2 numbers"), "{error}");
        assert_eq!(evaluator.latents, [0.0], "nothing is left over");
    }
}
