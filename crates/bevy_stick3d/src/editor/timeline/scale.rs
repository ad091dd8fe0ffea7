//! Where times are on the timeline: pure arithmetic.

use bevy_egui::egui::Rangef;

/// The timeline is never shorter, seconds.
const LEAST_SPAN_S: f32 = 1.5;
/// Room after the last key to drag it into, as a share of its time.
const ROOM: f32 = 1.15;
/// Marks are at least so far apart, points.
const LEAST_STEP: f32 = 56.0;
/// Between marks, seconds.
const STEPS_S: [f32; 9] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 60.0];

/// From 0 to some seconds, from left to right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimeScale {
    xs: Rangef,
    span_s: f32,
}

impl TimeScale {
    /// So many seconds between two places.
    pub(crate) fn new(xs: Rangef, span_s: f32) -> Self {
        Self {
            xs: Rangef::new(xs.min, xs.max.max(xs.min + 1.0)),
            span_s: span_s.max(LEAST_SPAN_S),
        }
    }

    /// Where a time is, points. Times outside are at the ends.
    pub(crate) fn x_of(&self, time_s: f32) -> f32 {
        self.xs.min + self.xs.span() * (time_s / self.span_s).clamp(0.0, 1.0)
    }

    /// The time at a place, seconds.
    pub(crate) fn time_at(&self, x: f32) -> f32 {
        self.span_s * ((x - self.xs.min) / self.xs.span()).clamp(0.0, 1.0)
    }

    /// The times of the marks, and how many digits their names need.
    pub(crate) fn marks(&self) -> (impl Iterator<Item = f32> + use<>, usize) {
        let per_s = self.xs.span() / self.span_s;
        let fits = |step_s: &f32| step_s * per_s >= LEAST_STEP;
        let step_s = STEPS_S.into_iter().find(fits).unwrap_or(STEPS_S[8]);
        let count = (self.span_s / step_s + 1.0e-3) as usize;
        let marks = (0..=count).map(move |mark| mark as f32 * step_s);
        (marks, usize::from(step_s < 1.0))
    }
}

/// How many seconds are to be seen: all keys, what comes after, and some room to drag the last key into.
pub(crate) fn span_s(last_key_s: f32, end_s: f32) -> f32 {
    (last_key_s * ROOM).max(end_s * 1.02).max(LEAST_SPAN_S)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn places_and_times_are_inverse(
            left in 0.0_f32..500.0,
            width in 10.0_f32..2000.0,
            span_s in 0.1_f32..120.0,
            share in 0.0_f32..1.0,
        ) {
            let scale = TimeScale::new(Rangef::new(left, left + width), span_s);
            let time_s = share * span_s.max(LEAST_SPAN_S);
            prop_assert!((scale.time_at(scale.x_of(time_s)) - time_s).abs() < 1e-3 * (1.0 + span_s));
            prop_assert_eq!(scale.time_at(left - 10.0), 0.0);
            let (marks, _) = scale.marks();
            let places: Vec<f32> = marks.map(|mark| scale.x_of(mark)).collect();
            prop_assert!(places.len() < 60);
            prop_assert!(places.windows(2).all(|pair| pair[1] - pair[0] >= LEAST_STEP - 0.1 || span_s > 20.0));
        }
    }

    #[test]
    fn everything_has_room() {
        assert!(span_s(3.0, 3.0) > 3.3);
        assert!(span_s(3.0, 5.0) > 5.0);
        assert_eq!(span_s(0.0, 0.0), LEAST_SPAN_S);
    }
}
