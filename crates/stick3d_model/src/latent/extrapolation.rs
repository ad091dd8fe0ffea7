//! Beyond the first and the last key.

use serde::{Deserialize, Serialize};

use super::PathError;

/// What a path that does not repeat does before its first and after its last key.
///
/// It goes on along the last interpolation vector (paper section 5.4): `key_n + u (key_n - key_(n-1))`. How far is found
/// once, when the [`Motion`](super::Motion) is made: the *horizon* of an end is the first `u` at which the
/// [trust](super::Trust) falls to the least trust.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Extrapolation {
    /// Stays at the key.
    Hold,
    /// Eases to a stop at the horizon.
    Bounded {
        /// The trust at which it stops, above 0 and below 1.
        #[serde(default = "default_least_trust")]
        least_trust: f32,
    },
    /// Eases to a stop at the horizon, turns back, and goes to and fro between the horizons of both ends.
    PingPong {
        /// The trust at which it turns, above 0 and below 1.
        #[serde(default = "default_least_trust")]
        least_trust: f32,
    },
    /// Goes on for ever, as in the paper.
    Unbounded,
}

/// The least trust of a bounded extrapolation, if nothing else is said.
pub const DEFAULT_LEAST_TRUST: f32 = 0.5;

fn default_least_trust() -> f32 {
    DEFAULT_LEAST_TRUST
}

impl Default for Extrapolation {
    fn default() -> Self {
        Self::Bounded {
            least_trust: DEFAULT_LEAST_TRUST,
        }
    }
}

impl Extrapolation {
    /// The trust at which it ends, where it does.
    ///
    /// # Errors
    /// [`PathError::LeastTrust`].
    pub(super) fn least_trust(self) -> Result<Option<f32>, PathError> {
        match self {
            Self::Hold | Self::Unbounded => Ok(None),
            Self::Bounded { least_trust } | Self::PingPong { least_trust } => {
                if least_trust > 0.0 && least_trust < 1.0 {
                    return Ok(Some(least_trust));
                }
                Err(PathError::LeastTrust { found: least_trust })
            }
        }
    }
}

/// One end of a path.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct End {
    /// Between the last two keys, seconds.
    pub(super) interval_s: f32,
    /// How fast the end key is left, as a multiple of an even pace.
    pub(super) slope: f32,
    /// How far it goes, key distances.
    pub(super) horizon: f32,
}

impl End {
    /// How far from the end key it is after a time, key distances: without a jump in speed, at first as fast as the key is
    /// left, after one interval at an even pace, over the second half of the way ever slower.
    pub(super) fn distance(self, after_s: f32) -> f32 {
        self.stopped(self.even(after_s / self.interval_s))
    }

    /// The way of an endless extrapolation after `t` intervals.
    fn even(self, t: f32) -> f32 {
        let left = (1.0 - t.min(1.0)).powi(3);
        t + (self.slope - 1.0) * (1.0 - left) / 3.0
    }

    fn stopped(self, distance: f32) -> f32 {
        let half = self.horizon / 2.0;
        if distance <= half || half.is_infinite() {
            return distance;
        }
        if half == 0.0 {
            return 0.0;
        }
        let over = ((distance - half) / half).min(2.0);
        half * (1.0 + over - over * over / 4.0)
    }

    /// How long it takes to come to rest, seconds.
    pub(super) fn duration_s(self) -> f32 {
        if self.horizon.is_infinite() || self.horizon == 0.0 {
            return self.horizon;
        }
        // It stops after one and a half times the horizon of an endless way, which is at most a third of an interval late.
        let (mut low, mut high) = (0.0, 1.5 * self.horizon + 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.even(middle) < 1.5 * self.horizon {
                low = middle;
            } else {
                high = middle;
            }
        }
        high * self.interval_s
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn it_starts_at_the_pace_of_the_key_and_stops_at_the_horizon(
            interval_s in 0.05_f32..3.0,
            slope in prop::sample::select(vec![0.0_f32, 1.0, 2.0]),
            horizon in 0.3_f32..8.0,
        ) {
            let end = End { interval_s, slope, horizon };
            let duration_s = end.duration_s();
            prop_assert!((end.distance(duration_s) - horizon).abs() < 1e-3 * horizon);
            let step_s = duration_s / 1000.0;
            let steps: Vec<f32> = (0..=2000).map(|i| end.distance(i as f32 * step_s)).collect();
            let speeds: Vec<f32> =
                steps.windows(2).map(|pair| (pair[1] - pair[0]) / step_s * interval_s).collect();
            prop_assert!((speeds[0] - slope).abs() < 0.05 * (1.0 + horizon), "{} {slope}", speeds[0]);
            prop_assert!(steps.iter().all(|distance| *distance <= horizon * 1.0001));
            for pair in speeds.windows(2) {
                // It never turns back, and its speed never jumps: a jump would be as large as the speed.
                prop_assert!(pair[1] > -1e-3 * (1.0 + horizon), "{pair:?}");
                prop_assert!((pair[1] - pair[0]).abs() < 0.1 * (1.0 + slope), "{pair:?}");
            }
            prop_assert!(speeds[1500].abs() < 1e-3);
        }
    }

    #[test]
    fn the_least_trust_is_a_share() {
        assert_eq!(Extrapolation::Hold.least_trust(), Ok(None));
        assert_eq!(
            Extrapolation::default().least_trust(),
            Ok(Some(DEFAULT_LEAST_TRUST))
        );
        for least_trust in [0.0, 1.0, f32::NAN, -3.0] {
            let error = Extrapolation::PingPong { least_trust }.least_trust();
            assert!(matches!(error, Err(PathError::LeastTrust { .. })));
        }
    }
}
