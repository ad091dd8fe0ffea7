//! A motion as a curve of a Bevy animation clip.

use std::any::{Any, TypeId};
use std::sync::Arc;

use bevy::animation::{AnimationEvaluationError, AnimationTargetId, RepeatAnimation};
use bevy::asset::uuid::Uuid;
use bevy::math::curve::Interval;
use bevy::prelude::*;
use stick3d_model::Motion;
use stick3d_model::latent::{Extrapolation, PathError, Repeat};

use super::evaluator::LatentCurveEvaluator;
use crate::figure::Latent;
use crate::model_asset::StickModel;

/// What the clips of this plugin animate: the figure itself. The same for every figure, so that any clip may be played by any
/// figure of its model.
///
/// A figure with an `AnimationPlayer` on its own entity is given it; one that is played from another entity needs
/// `(STICK_TARGET, AnimatedBy(player))`.
pub const STICK_TARGET: AnimationTargetId =
    AnimationTargetId(Uuid::from_u128(0x5b9c_1f5e_7a39_4d0f_8f0b_6c2d_3e51_a7c4));

/// A motion as an [`AnimationCurve`]: it animates the figure's [`Latent`], and where it stands; see
/// [`RootMotion`](super::RootMotion).
///
/// It begins at the motion's first key, which is at time 0 of the clip. Playing it allocates nothing.
#[derive(Clone, Debug)]
pub struct LatentCurve {
    motion: Arc<Motion>,
    duration_s: f32,
    model: Option<AssetId<StickModel>>,
}

impl LatentCurve {
    /// The curve of a motion.
    pub fn new(motion: impl Into<Arc<Motion>>) -> Self {
        let motion = motion.into();
        Self {
            duration_s: duration_s(&motion),
            motion,
            model: None,
        }
    }

    /// Says whose latents these are, so that figures of other models refuse them: they would be no body there.
    #[must_use]
    pub fn for_model(mut self, model: impl Into<AssetId<StickModel>>) -> Self {
        self.model = Some(model.into());
        self
    }

    /// Whose latents these are, as far as it was said.
    pub fn model(&self) -> Option<AssetId<StickModel>> {
        self.model
    }

    /// The motion.
    pub fn motion(&self) -> &Arc<Motion> {
        &self.motion
    }

    /// From the first key to the end, seconds: to where a motion that ends comes to rest, once round for one that repeats or
    /// turns back, infinite for one that goes on for ever.
    pub fn duration_s(&self) -> f32 {
        self.duration_s
    }

    /// How often a player has to repeat the clip for the motion to go as its author said: for ever, if it repeats or turns
    /// back; else once.
    pub fn repeat_animation(&self) -> RepeatAnimation {
        if is_periodic(&self.motion) {
            RepeatAnimation::Forever
        } else {
            RepeatAnimation::Never
        }
    }

    /// The clip with this curve alone, for [`STICK_TARGET`].
    pub fn into_clip(self) -> AnimationClip {
        let mut clip = AnimationClip::default();
        // Bevy lengthens a clip by finite curves only.
        clip.set_duration(self.duration_s);
        clip.add_curve_to_target(STICK_TARGET, self);
        clip
    }

    /// The latent at a time of the clip.
    ///
    /// # Errors
    /// [`PathError::Time`] for NaN.
    pub fn latent(&self, clip_s: f32) -> Result<Vec<f32>, PathError> {
        let mut latent = vec![0.0; self.motion.path().latent_len()];
        self.motion
            .sample_into(self.motion_s(clip_s), &mut latent)?;
        Ok(latent)
    }

    /// Where the root joint is at a time of the clip, metres; the origin for a motion that is not grounded.
    pub(super) fn root_translation(&self, clip_s: f32) -> Vec3 {
        let at = self.motion.root_translation(self.motion_s(clip_s));
        at.unwrap_or_default()
    }

    /// How high the lowest point is above the ground at a time of the clip, metres.
    pub(super) fn lift_m(&self, clip_s: f32) -> f32 {
        let lift_m = self.motion.lift_m(self.motion_s(clip_s));
        lift_m.unwrap_or_default()
    }

    /// The motion's time at a time of the clip.
    fn motion_s(&self, clip_s: f32) -> f32 {
        first_key_s(&self.motion) + clip_s.clamp(0.0, self.duration_s)
    }
}

fn first_key_s(motion: &Motion) -> f32 {
    motion
        .path()
        .key_times_s()
        .first()
        .copied()
        .unwrap_or_default()
}

fn is_periodic(motion: &Motion) -> bool {
    let path = motion.path();
    path.repeat() != Repeat::Once || matches!(path.extrapolation(), Extrapolation::PingPong { .. })
}

fn duration_s(motion: &Motion) -> f32 {
    let path = motion.path();
    let (start_s, end_s) = path.range_s();
    match path.repeat() {
        Repeat::Loop { .. } => end_s - start_s,
        // There and back.
        Repeat::PingPong => 2.0 * (end_s - start_s),
        Repeat::Once if is_periodic(motion) => 2.0 * (end_s - start_s),
        Repeat::Once => end_s - first_key_s(motion),
    }
}

impl AnimationCurve for LatentCurve {
    fn clone_value(&self) -> Box<dyn AnimationCurve> {
        Box::new(self.clone())
    }

    fn domain(&self) -> Interval {
        Interval::new(0.0, self.duration_s).unwrap_or(Interval::UNIT)
    }

    fn evaluator_id(&self) -> EvaluatorId<'_> {
        EvaluatorId::Type(TypeId::of::<LatentCurveEvaluator>())
    }

    fn create_evaluator(&self) -> Box<dyn AnimationCurveEvaluator> {
        Box::new(LatentCurveEvaluator::default())
    }

    fn apply(
        &self,
        curve_evaluator: &mut dyn AnimationCurveEvaluator,
        t: f32,
        weight: f32,
        graph_node: AnimationNodeIndex,
    ) -> Result<(), AnimationEvaluationError> {
        let evaluator = curve_evaluator
            .downcast_mut::<LatentCurveEvaluator>()
            .ok_or_else(|| {
                let id = TypeId::of::<LatentCurveEvaluator>();
                AnimationEvaluationError::InconsistentEvaluatorImplementation(id)
            })?;
        let latent_len = self.motion.path().latent_len();
        evaluator.push(self, graph_node, weight, latent_len, |latent| {
            self.motion.sample_into(self.motion_s(t), latent)
        });
        Ok(())
    }

    /// A boxed [`Latent`]; empty for a time that is none.
    fn sample_clamped(&self, t: f32) -> Box<dyn Any> {
        Box::new(Latent(self.latent(t).unwrap_or_default()))
    }
}

#[cfg(test)]
mod tests {
    use stick3d_model::latent::{Easing, MotionSettings};
    use stick3d_model::{Inference, LatentKey};

    use super::*;
    use crate::embedded::EMBEDDED_MODELS;

    /// Three keys, a second apart, from 2 s on.
    fn curve(repeat: Repeat, extrapolation: Extrapolation) -> LatentCurve {
        let model = EMBEDDED_MODELS[0].model().unwrap();
        let mut inference = Inference::new(model.model()).unwrap();
        let keys = [2.0, 3.0, 4.0].map(|time_s| LatentKey {
            latent: vec![0.01 * time_s; inference.latent_len()],
            time_s,
            easing: Easing::Linear,
        });
        let settings = MotionSettings {
            repeat,
            extrapolation,
            ..MotionSettings::default()
        };
        LatentCurve::new(Motion::new(&keys, settings, &mut inference).unwrap())
    }

    #[test]
    fn a_clip_begins_at_its_first_key_and_lasts_one_round() {
        let loop_ = Repeat::Loop {
            closing_s: Some(0.5),
        };
        let turning = Extrapolation::PingPong { least_trust: 0.5 };
        for (repeat, extrapolation, duration_s, mode) in [
            (
                Repeat::Once,
                Extrapolation::Hold,
                2.0,
                RepeatAnimation::Never,
            ),
            (loop_, Extrapolation::Hold, 2.5, RepeatAnimation::Forever),
            (
                Repeat::PingPong,
                Extrapolation::Hold,
                4.0,
                RepeatAnimation::Forever,
            ),
            (
                Repeat::Once,
                Extrapolation::Unbounded,
                f32::INFINITY,
                RepeatAnimation::Never,
            ),
        ] {
            let curve = curve(repeat, extrapolation);
            assert_eq!(curve.duration_s(), duration_s, "{repeat:?}");
            assert_eq!(curve.repeat_animation(), mode);
            assert_eq!(curve.latent(0.0).unwrap()[0], 0.02);
            assert_eq!(curve.latent(1.0).unwrap()[0], 0.03);
            assert_eq!(curve.domain().end(), duration_s);
            assert_eq!(curve.into_clip().duration(), duration_s);
        }
        let turning = curve(Repeat::Once, turning);
        assert_eq!(turning.repeat_animation(), RepeatAnimation::Forever);
        let ends = [0.0, turning.duration_s()].map(|clip_s| turning.latent(clip_s).unwrap()[0]);
        assert!((ends[0] - ends[1]).abs() < 1e-5, "{ends:?}");
    }

    #[test]
    fn what_has_no_end_goes_on() {
        let curve = curve(Repeat::Once, Extrapolation::Unbounded);
        assert!((curve.latent(10.0).unwrap()[0] - 0.12).abs() < 1e-6);
        assert!(curve.latent(f32::NAN).is_err());
    }
}
