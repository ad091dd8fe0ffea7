//! How time passes between two keys.

use serde::{Deserialize, Serialize};

/// How time passes from a key to the next one.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Easing {
    /// Evenly.
    #[default]
    Linear,
    /// From rest: the square of the time.
    In,
    /// To rest: the mirror image of [`Easing::In`].
    Out,
    /// From rest to rest: `3 t² - 2 t³`.
    InOut,
}

impl Easing {
    /// All of them, for menus.
    pub const ALL: [Self; 4] = [Self::Linear, Self::In, Self::Out, Self::InOut];

    /// The share of the way that is done after the share `t` of the time; 0 at 0, 1 at 1, never falling.
    #[must_use]
    pub fn apply(self, t: f32) -> f32 {
        match self {
            Self::Linear => t,
            Self::In => t * t,
            Self::Out => t * (2.0 - t),
            Self::InOut => smoothstep(t),
        }
    }

    /// How fast the way is done at the start and at the end, as multiples of an even pace.
    #[must_use]
    pub fn end_slopes(self) -> [f32; 2] {
        match self {
            Self::Linear => [1.0, 1.0],
            Self::In => [0.0, 2.0],
            Self::Out => [2.0, 0.0],
            Self::InOut => [0.0, 0.0],
        }
    }
}

/// `3 t² - 2 t³` between 0 and 1, flat outside.
pub(super) fn smoothstep(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_begin_and_end_where_they_should_with_the_slopes_they_say() {
        for easing in Easing::ALL {
            assert_eq!((easing.apply(0.0), easing.apply(1.0)), (0.0, 1.0));
            let steps: Vec<f32> = (0..=1000)
                .map(|i| easing.apply(i as f32 / 1000.0))
                .collect();
            assert!(steps.is_sorted(), "{easing:?}");
            let [start, end] = easing.end_slopes();
            assert!((1000.0 * (steps[1] - steps[0]) - start).abs() < 0.01);
            assert!((1000.0 * (steps[1000] - steps[999]) - end).abs() < 0.01);
        }
    }
}
