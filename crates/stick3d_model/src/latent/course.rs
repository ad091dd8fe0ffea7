//! From a clock's time to a place on the path: once, round and round, or back and forth.

use serde::{Deserialize, Serialize};

/// What comes after the last key.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub enum Repeat {
    /// Whatever the [`Extrapolation`](super::Extrapolation) says.
    #[default]
    Once,
    /// On to the first key, and so on for ever. A last key that equals the first closes the loop itself.
    Loop {
        /// How long the way from the last key to the first takes, seconds; as long as the mean between two keys if not
        /// given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        closing_s: Option<f32>,
    },
    /// Back to the first key the same way, and so on for ever.
    PingPong,
}

/// How a clock's time becomes a time on the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Course {
    /// The same, within limits.
    Clamped { start_s: f32, end_s: f32 },
    /// Starts again.
    Round { start_s: f32, end_s: f32 },
    /// Turns back at both ends.
    BackAndForth { start_s: f32, end_s: f32 },
}

impl Course {
    /// The time on the path at a clock's time, and how many rounds were done before.
    pub(super) fn place(self, time_s: f32) -> (f32, f32) {
        let (start_s, end_s) = self.range_s();
        // Within its range a time is itself, to the last digit; the end of a round is the beginning of the next.
        let turns_there = !matches!(self, Self::Round { .. });
        if (start_s..end_s).contains(&time_s) || (turns_there && time_s == end_s) {
            return (time_s, 0.0);
        }
        let (span, since) = (end_s - start_s, time_s - start_s);
        match self {
            Self::Clamped { .. } => (time_s.clamp(start_s, end_s), 0.0),
            // Rounding may land on the end of the range itself.
            Self::Round { .. } => {
                let within = since.rem_euclid(span).min(span);
                (start_s + within, (since / span).floor())
            }
            Self::BackAndForth { .. } => {
                let along = since.rem_euclid(2.0 * span);
                (
                    start_s + along.min(2.0 * span - along).clamp(0.0, span),
                    0.0,
                )
            }
        }
    }

    /// The first and the last time on the path that can come.
    pub(super) fn range_s(self) -> (f32, f32) {
        match self {
            Self::Clamped { start_s, end_s }
            | Self::Round { start_s, end_s }
            | Self::BackAndForth { start_s, end_s } => (start_s, end_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_are_counted_and_turns_are_made() {
        let (start_s, end_s) = (1.0, 3.0);
        let round = Course::Round { start_s, end_s };
        assert_eq!(round.place(1.5), (1.5, 0.0));
        assert_eq!(round.place(3.5), (1.5, 1.0));
        assert_eq!(round.place(0.5), (2.5, -1.0));
        let turning = Course::BackAndForth { start_s, end_s };
        assert_eq!(turning.place(1.5).0, 1.5);
        assert_eq!(turning.place(3.5).0, 2.5);
        assert_eq!(turning.place(5.5).0, 1.5);
        assert_eq!(turning.place(0.5).0, 1.5);
        let clamped = Course::Clamped { start_s, end_s };
        assert_eq!((clamped.place(0.0).0, clamped.place(9.0).0), (1.0, 3.0));
    }
}
