//! The figure's latent as a property that curves of any kind can animate.

use std::any::TypeId;

use bevy::animation::{AnimationEntityMut, AnimationEvaluationError};
use bevy::prelude::*;

use crate::figure::Latent;

/// The [`Latent`] of a figure as an [`AnimatableProperty`], for curves of your own:
/// `AnimatableCurve::new(LatentProperty, AnimatableKeyframeCurve::new([(0.0, standing), (0.8, waving)])?)`.
///
/// Every sample of such a curve is a new vector. [`LatentCurve`](super::LatentCurve), which the plugin's own clips have,
/// allocates nothing and moves the figure over the ground too. Blend curves of one kind with each other: where clips of both
/// kinds play on one figure, one of them wins.
#[derive(Clone, Copy, Debug, Default, Reflect)]
#[reflect(Debug, Default, Clone)]
pub struct LatentProperty;

impl AnimatableProperty for LatentProperty {
    type Property = Latent;

    fn get_mut<'a>(
        &self,
        entity: &'a mut AnimationEntityMut,
    ) -> Result<&'a mut Latent, AnimationEvaluationError> {
        entity
            .get_mut::<Latent>()
            .map(Mut::into_inner)
            .ok_or_else(|| AnimationEvaluationError::ComponentNotPresent(TypeId::of::<Latent>()))
    }

    fn evaluator_id(&self) -> EvaluatorId<'_> {
        EvaluatorId::Type(TypeId::of::<Self>())
    }
}

/// Along the straight line (paper section 5.3). Latents of different lengths have no line between them: numbers that
/// only one of them has become NaN, which [`FigureStatus`](crate::FigureStatus) tells.
impl Animatable for Latent {
    fn interpolate(a: &Self, b: &Self, time: f32) -> Self {
        // So written, both ends are met exactly.
        combined(a, b, |a, b| (1.0 - time) * a + time * b)
    }

    fn blend(inputs: impl Iterator<Item = BlendInput<Self>>) -> Self {
        let mut blended: Option<Self> = None;
        for BlendInput {
            weight,
            value,
            additive,
        } in inputs
        {
            let before = blended.unwrap_or_else(|| Self(vec![0.0; value.0.len()]));
            blended = Some(if additive {
                combined(&before, &value, |before, value| before + weight * value)
            } else {
                Self::interpolate(&before, &value, weight)
            });
        }
        blended.unwrap_or_default()
    }
}

fn combined(a: &Latent, b: &Latent, combine: impl Fn(f32, f32) -> f32) -> Latent {
    let number = |latent: &Latent, index: usize| latent.0.get(index).copied().unwrap_or(f32::NAN);
    let indices = 0..a.0.len().max(b.0.len());
    Latent(
        indices
            .map(|index| combine(number(a, index), number(b, index)))
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latents_blend_along_straight_lines() {
        let (a, b) = (Latent(vec![0.1, 2.0]), Latent(vec![0.7, -2.0]));
        assert_eq!(Latent::interpolate(&a, &b, 0.0), a);
        assert_eq!(Latent::interpolate(&a, &b, 1.0), b);
        assert_eq!(Latent::interpolate(&a, &b, 0.5).0[1], 0.0);
        let input = |weight, value: &Latent, additive| BlendInput {
            weight,
            value: value.clone(),
            additive,
        };
        let sum = Latent::blend([input(1.0, &a, false), input(0.5, &b, true)].into_iter());
        assert_eq!(sum.0, [0.1 + 0.5 * 0.7, 1.0]);
        assert_eq!(Latent::blend([].into_iter()), Latent::default());
    }

    #[test]
    fn latents_of_different_lengths_become_none_that_is_usable() {
        let mixed = Latent::interpolate(&Latent(vec![1.0]), &Latent(vec![1.0, 2.0]), 0.5);
        assert!(mixed.0[0] == 1.0 && mixed.0[1].is_nan());
    }
}
