//! The clock of a motion: play, pause, seek, speed, and what comes at the end.

use stick3d_model::LatentPath;
use stick3d_model::latent::{Extrapolation, Repeat};

/// How fast a motion may be played, as multiples of real time.
pub(crate) const SPEEDS: [f32; 4] = [0.25, 0.5, 1.0, 2.0];

/// A path that never comes to rest is played this many times its keys' duration beyond the last one.
const ENDLESS: f32 = 1.0;

/// How the clock's time runs along a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Run {
    /// From the beginning to the end, and stop.
    Once,
    /// From the end to the beginning again.
    Round,
    /// Back and forth between the two.
    BackAndForth,
}

/// From when to when a motion is played, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Course {
    pub(crate) start_s: f32,
    pub(crate) end_s: f32,
    pub(crate) run: Run,
}

impl Course {
    /// Of a motion: from its first key to where it comes to rest.
    pub(crate) fn of(path: &LatentPath) -> Self {
        let first_s = path.key_times_s()[0];
        let (start_s, end_s) = path.range_s();
        match (path.repeat(), path.extrapolation()) {
            (Repeat::Loop { .. }, _) => Self::new(start_s, end_s, Run::Round),
            (Repeat::PingPong, _) | (Repeat::Once, Extrapolation::PingPong { .. }) => {
                Self::new(start_s, end_s, Run::BackAndForth)
            }
            (Repeat::Once, _) if end_s.is_finite() => Self::new(first_s, end_s, Run::Once),
            (Repeat::Once, _) => Self::endless(path),
        }
    }

    fn new(start_s: f32, end_s: f32, run: Run) -> Self {
        Self {
            start_s,
            end_s,
            run,
        }
    }

    fn endless(path: &LatentPath) -> Self {
        let start_s = path.key_times_s()[0];
        let end_s = start_s + path.duration_s() * (1.0 + ENDLESS);
        Self::new(start_s, end_s, Run::Once)
    }

    /// Whether the beginning comes again after the end.
    pub(crate) fn goes_round(&self) -> bool {
        self.run == Run::Round
    }

    /// The time between start and end at which the motion is at a clock's time.
    pub(crate) fn folded(&self, time_s: f32) -> f32 {
        let (span_s, since_s) = (self.end_s - self.start_s, time_s - self.start_s);
        if span_s <= 0.0 || !time_s.is_finite() {
            return self.start_s;
        }
        self.start_s
            + match self.run {
                Run::Once => since_s.clamp(0.0, span_s),
                Run::Round => since_s.rem_euclid(span_s),
                Run::BackAndForth => {
                    let along_s = since_s.rem_euclid(2.0 * span_s);
                    along_s.min(2.0 * span_s - along_s)
                }
            }
    }

    /// The clock's time at which the round began in which it is now; the start unless it goes round and round.
    pub(crate) fn round_start_s(&self, time_s: f32) -> f32 {
        match self.run {
            Run::Round => time_s - (self.folded(time_s) - self.start_s),
            Run::Once | Run::BackAndForth => self.start_s,
        }
    }
}

/// When in the motion it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Player {
    /// The clock: goes on beyond the end where the motion repeats, seconds.
    pub(crate) time_s: f32,
    pub(crate) is_playing: bool,
    /// As a multiple of real time.
    pub(crate) speed: f32,
}

impl Default for Player {
    fn default() -> Self {
        Self {
            time_s: 0.0,
            is_playing: false,
            speed: 1.0,
        }
    }
}

impl Player {
    /// From the beginning on.
    pub(crate) fn start(&mut self) {
        self.time_s = f32::NEG_INFINITY;
        self.is_playing = true;
    }

    /// Goes to a time, and stays there.
    pub(crate) fn seek(&mut self, time_s: f32) {
        if time_s.is_finite() {
            self.time_s = time_s;
        }
        self.is_playing = false;
    }

    /// Plays or pauses; what has come to its end begins anew.
    pub(crate) fn toggle(&mut self, course: &Course) {
        if self.is_playing {
            self.is_playing = false;
        } else if course.run == Run::Once && self.time_s >= course.end_s {
            self.start();
        } else {
            self.is_playing = true;
        }
    }

    /// The next of the speeds.
    pub(crate) fn next_speed(&mut self) {
        let place = SPEEDS.iter().position(|speed| *speed == self.speed);
        self.speed = SPEEDS[place.map_or(0, |place| (place + 1) % SPEEDS.len())];
    }

    /// Lets time pass, and keeps it within what there is to see. What was just started is at its beginning.
    pub(crate) fn advance(&mut self, delta_s: f32, course: &Course) {
        if self.time_s == f32::NEG_INFINITY {
            self.time_s = course.start_s;
        } else if self.is_playing {
            self.time_s += delta_s * self.speed;
        }
        if course.run == Run::Once {
            if self.time_s >= course.end_s {
                self.time_s = course.end_s;
                self.is_playing = false;
            }
            self.time_s = self.time_s.max(course.start_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn course(run: Run) -> Course {
        Course::new(1.0, 3.0, run)
    }

    #[test]
    fn it_starts_at_the_beginning_and_stops_at_the_end() {
        let once = course(Run::Once);
        let mut player = Player::default();
        player.start();
        player.advance(0.5, &once);
        assert_eq!(player.time_s, 1.0, "the first frame is the first key");
        player.advance(0.5, &once);
        assert_eq!(player.time_s, 1.5);
        player.advance(9.0, &once);
        assert_eq!((player.time_s, player.is_playing), (3.0, false));
        player.toggle(&once);
        player.advance(0.1, &once);
        assert_eq!((player.time_s, player.is_playing), (1.0, true));
        player.toggle(&once);
        player.advance(0.1, &once);
        assert_eq!((player.time_s, player.is_playing), (1.0, false));
    }

    #[test]
    fn a_motion_that_repeats_goes_on() {
        let mut player = Player::default();
        player.seek(2.9);
        player.toggle(&course(Run::Round));
        player.speed = 2.0;
        player.advance(0.1, &course(Run::Round));
        assert!((player.time_s - 3.1).abs() < 1e-6 && player.is_playing);
        assert!((course(Run::Round).folded(player.time_s) - 1.1).abs() < 1e-5);
        assert!((course(Run::BackAndForth).folded(player.time_s) - 2.9).abs() < 1e-5);
        assert!((course(Run::Round).round_start_s(player.time_s) - 3.0).abs() < 1e-5);
        player.seek(f32::NAN);
        assert!(player.time_s.is_finite() && !player.is_playing);
    }

    #[test]
    fn speeds_come_round() {
        let mut player = Player::default();
        let seen: Vec<f32> = (0..SPEEDS.len())
            .map(|_| {
                player.next_speed();
                player.speed
            })
            .collect();
        assert_eq!(seen, [2.0, 0.25, 0.5, 1.0]);
    }

    proptest! {
        #[test]
        fn folded_times_are_in_range(
            time_s in prop::num::f32::ANY,
            run in prop::sample::select(vec![Run::Once, Run::Round, Run::BackAndForth]),
        ) {
            let folded = course(run).folded(time_s);
            prop_assert!((1.0..=3.0).contains(&folded), "{folded}");
        }
    }
}
