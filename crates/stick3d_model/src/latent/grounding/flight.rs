//! What a body does while no foot is down: it flies on, and if it runs, up and down again.

use std::ops::Range;

use glam::Vec2;

/// The longest flight of a runner, seconds: what takes longer is a change of posture.
const LONGEST_S: f32 = 0.3;
/// A body that is slower than this does not run, body heights a second.
const RUNNING: f32 = 0.7;
/// Metres per square second.
const GRAVITY: f32 = 9.81;

/// How high a running body is above where it would stand, at every time of the table, metres: parabolas from one contact to the
/// next.
pub(super) fn lifts(
    velocities: &[Option<Vec2>],
    times_s: &[f32],
    height_m: f32,
    is_loop: bool,
) -> Vec<f32> {
    let flown = filled(velocities, is_loop);
    let mut lifts = vec![0.0; times_s.len()];
    let last = velocities.len();
    let span = |flight: &Range<usize>| times_s[flight.end] - times_s[flight.start];
    let flights = flights(velocities);
    // The flight at the end of a loop is that at its beginning.
    let wraps = is_loop
        && flights.len() > 1
        && flights[0].start == 0
        && flights[flights.len() - 1].end == last;
    for (index, flight) in flights.iter().enumerate() {
        let (mut earlier_s, mut later_s) = (0.0, 0.0);
        if wraps && index == 0 {
            earlier_s = span(&flights[flights.len() - 1]);
        } else if wraps && index + 1 == flights.len() {
            later_s = span(&flights[0]);
        }
        let carried = |wrapped_s: f32, at_end: bool| wrapped_s > 0.0 || is_loop || !at_end;
        let whole_s = earlier_s + span(flight) + later_s;
        let way: Vec2 = flown[flight.clone()].iter().sum();
        let runs = way.length() >= RUNNING * height_m * flight.len() as f32;
        if whole_s > LONGEST_S
            || !runs
            || !carried(earlier_s, flight.start == 0)
            || !carried(later_s, flight.end == last)
        {
            continue;
        }
        for step in flight.start..=flight.end {
            let since_s = earlier_s + times_s[step] - times_s[flight.start];
            lifts[step] = 0.5 * GRAVITY * since_s * (whole_s - since_s);
        }
    }
    lifts
}

/// The stretches of steps in which no foot carries the body.
fn flights(velocities: &[Option<Vec2>]) -> Vec<Range<usize>> {
    let mut flights: Vec<Range<usize>> = vec![];
    for step in (0..velocities.len()).filter(|step| velocities[*step].is_none()) {
        match flights.last_mut() {
            Some(flight) if flight.end == step => flight.end = step + 1,
            _ => flights.push(step..step + 1),
        }
    }
    flights
}

/// The velocity of every step: while no foot carries the body it flies on, its speed going evenly from what it was to what it
/// will be.
pub(super) fn filled(velocities: &[Option<Vec2>], is_loop: bool) -> Vec<Vec2> {
    let mut filled: Vec<Vec2> = velocities.iter().map(|v| v.unwrap_or_default()).collect();
    // In a loop the last step comes before the first.
    let round = if is_loop { velocities } else { &[] };
    for Range { start, end } in flights(velocities) {
        let before = mean_of(velocities[..start].iter().rev().chain(round.iter().rev()));
        let after = mean_of(velocities[end..].iter().chain(round));
        let (from, to) = match (before, after) {
            (Some(before), Some(after)) => (before, after),
            (Some(only), None) | (None, Some(only)) => (only, only),
            (None, None) => (Vec2::ZERO, Vec2::ZERO),
        };
        let count = (end - start + 1) as f32;
        for (index, slot) in filled[start..end].iter_mut().enumerate() {
            *slot = from.lerp(to, (index + 1) as f32 / count);
        }
    }
    filled
}

/// The mean over the nearest few steps with a foot down.
fn mean_of<'a>(velocities: impl Iterator<Item = &'a Option<Vec2>>) -> Option<Vec2> {
    let near: Vec<Vec2> = velocities.filter_map(|v| *v).take(4).collect();
    (!near.is_empty()).then(|| near.iter().sum::<Vec2>() / near.len() as f32)
}
