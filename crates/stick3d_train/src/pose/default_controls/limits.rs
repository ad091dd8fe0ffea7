//! How far bones turn and how far the sampler strays, by what they do; wider where the rig's clips go further.

use super::axes::{Joint, Turning};

/// Limits of a turn and the sampler's spread, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    pub(super) min: f32,
    pub(super) max: f32,
    pub(super) spread: f32,
}

/// How far limits lie beyond what the clips do, degrees.
const MARGIN_DEG: f32 = 5.0;

/// The most a limb folds, and how far it stretches beyond straight, degrees.
const FOLDED_DEG: f32 = 150.0;
const OVERSTRETCHED_DEG: f32 = 8.0;
const FOLDS_BY_DEG: f32 = 110.0;

/// An arm is lowered to this far from hanging down and raised to this far, degrees.
const ARM_LOWERED_DEG: f32 = -10.0;
const ARM_RAISED_DEG: f32 = 150.0;

const fn range(min: f32, max: f32, spread: f32) -> Range {
    Range { min, max, spread }
}

/// The default range of a turn of a bone.
pub(super) fn of_bone(joint: Joint, turning: Turning) -> Range {
    use Turning::{Bend, Side, Twist};
    match (joint, turning) {
        // Training turns bodies by itself.
        (Joint::Root, Side) => range(-180.0, 180.0, 0.0),
        (Joint::Root, Bend) => range(-35.0, 35.0, 7.0),
        (Joint::Root, Twist) => range(-20.0, 20.0, 4.0),
        // What the bones of a curve differ by.
        (Joint::Curve, Bend | Side) => range(-8.0, 8.0, 3.0),
        (Joint::Curve, Twist) => range(-5.0, 5.0, 2.0),
        (Joint::Girdle, _) => range(-10.0, 10.0, 3.0),
        (
            Joint::Ball {
                raised_deg: Some(raised_deg),
            },
            Side,
        ) => range(
            ARM_LOWERED_DEG - raised_deg,
            ARM_RAISED_DEG - raised_deg,
            35.0,
        ),
        (
            Joint::Ball {
                raised_deg: Some(_),
            },
            Bend,
        ) => range(-50.0, 85.0, 28.0),
        (Joint::Ball { .. }, Bend) => range(-50.0, 55.0, 22.0),
        (Joint::Ball { .. }, Side) => range(-14.0, 30.0, 6.0),
        (Joint::Ball { .. }, Twist) => range(-15.0, 15.0, 5.0),
        (Joint::Hinge { folded_deg }, Bend) => {
            let folds_by = (FOLDED_DEG - folded_deg).clamp(10.0, FOLDS_BY_DEG);
            range(-folded_deg - OVERSTRETCHED_DEG, folds_by, 26.0)
        }
        (Joint::Hinge { .. }, Side | Twist) => range(-8.0, 8.0, 3.0),
        (Joint::End, Bend) => range(-30.0, 30.0, 9.0),
        (Joint::End, Side | Twist) => range(-8.0, 8.0, 3.0),
    }
}

/// The range of a turn that the bones of a trunk, or of a neck or tail, share.
pub(super) fn of_curve(free: bool, turning: Turning) -> Range {
    match (free, turning) {
        (false, Turning::Bend) => range(-28.0, 28.0, 8.0),
        (false, Turning::Side) => range(-30.0, 30.0, 8.0),
        (false, Turning::Twist) => range(-18.0, 18.0, 4.0),
        (true, Turning::Bend) => range(-70.0, 70.0, 20.0),
        (true, Turning::Side) => range(-75.0, 75.0, 18.0),
        (true, Turning::Twist) => range(-30.0, 30.0, 7.0),
    }
}

impl Range {
    /// Wide enough for every one of `degrees`, with a margin; alike to both sides where `odd`.
    pub(super) fn widened(self, degrees: impl Iterator<Item = f32>, odd: bool) -> Self {
        let (mut min, mut max) = (self.min, self.max);
        for degrees in degrees {
            min = min.min((degrees - MARGIN_DEG).floor());
            max = max.max((degrees + MARGIN_DEG).ceil());
        }
        if odd {
            max = max.max(-min);
            min = -max;
        }
        Self { min, max, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_knee_folds_one_way_and_clips_widen_it() {
        let knee = of_bone(Joint::Hinge { folded_deg: 40.0 }, Turning::Bend);
        assert_eq!((knee.min, knee.max), (-48.0, 110.0));
        let wider = knee.widened([130.4, 20.0].into_iter(), false);
        assert_eq!((wider.min, wider.max), (-48.0, 136.0));
        let even = knee.widened(std::iter::empty(), true);
        assert_eq!((even.min, even.max), (-110.0, 110.0));
    }
}
