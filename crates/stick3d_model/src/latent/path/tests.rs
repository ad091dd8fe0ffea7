//! What holds of every path.

use proptest::prelude::*;

use super::*;

const LEN: usize = 3;

fn key(latent: [f32; LEN], time_s: f32, easing: Easing) -> LatentKey {
    LatentKey {
        latent: latent.to_vec(),
        time_s,
        easing,
    }
}

fn keys(easings: impl Strategy<Value = Easing> + Clone) -> impl Strategy<Value = Vec<LatentKey>> {
    let latent = prop::array::uniform3(-5.0_f32..5.0);
    let one = (latent, 0.1_f32..2.0, easings);
    prop::collection::vec(one, 2..7).prop_map(|steps| {
        let mut time_s = -1.0;
        let next = |(latent, interval_s, easing): ([f32; LEN], f32, Easing)| {
            time_s += interval_s;
            key(latent, time_s, easing)
        };
        steps.into_iter().map(next).collect()
    })
}

fn any_easing() -> impl Strategy<Value = Easing> + Clone {
    prop::sample::select(Easing::ALL.to_vec())
}

fn any_interpolation() -> impl Strategy<Value = Interpolation> {
    prop::sample::select(vec![Interpolation::Linear, Interpolation::Cubic])
}

fn any_repeat() -> impl Strategy<Value = Repeat> {
    prop_oneof![
        Just(Repeat::Once),
        Just(Repeat::PingPong),
        Just(Repeat::Loop { closing_s: None }),
        (0.1_f32..2.0).prop_map(|s| Repeat::Loop { closing_s: Some(s) }),
    ]
}

fn at(path: &LatentPath, time_s: f32) -> [f32; LEN] {
    let mut latent = [f32::NAN; LEN];
    path.sample_into(time_s, &mut latent).unwrap();
    latent
}

fn distance(a: &[f32], b: &[f32]) -> f32 {
    let square = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
    square.sqrt()
}

/// How far a point is from the straight line between two others.
fn from_line(point: &[f32], a: &[f32], b: &[f32]) -> f32 {
    let dot = |f: &dyn Fn(usize) -> f32, g: &dyn Fn(usize) -> f32| -> f32 {
        (0..LEN).map(|i| f(i) * g(i)).sum()
    };
    let (along, to) = (|i: usize| b[i] - a[i], |i: usize| point[i] - a[i]);
    let share = (dot(&along, &to) / dot(&along, &along).max(1e-12)).clamp(0.0, 1.0);
    let foot: Vec<f32> = (0..LEN).map(|i| a[i] + share * along(i)).collect();
    distance(point, &foot)
}

fn error_of(change: impl Fn(&mut Vec<LatentKey>)) -> PathError {
    let mut keys = vec![
        key([0.0; 3], 0.0, Easing::Linear),
        key([1.0; 3], 1.0, Easing::Linear),
        key([2.0; 3], 2.0, Easing::Linear),
    ];
    change(&mut keys);
    LatentPath::new(&keys, Interpolation::Linear, Repeat::Once).unwrap_err()
}

#[test]
fn bad_keys_are_told_apart() {
    assert_eq!(
        error_of(|keys| keys.truncate(1)),
        PathError::TooFewKeys { found: 1 }
    );
    assert_eq!(error_of(Vec::clear), PathError::TooFewKeys { found: 0 });
    assert_eq!(
        error_of(|keys| keys[2].time_s = 1.0),
        PathError::EqualTimes {
            key: 3,
            time_s: 1.0
        }
    );
    assert_eq!(
        error_of(|keys| keys[1].time_s = -1.0),
        PathError::OutOfOrder {
            key: 2,
            time_s: -1.0,
            before_s: 0.0
        }
    );
    assert!(matches!(
        error_of(|keys| keys[1].time_s = f32::NAN),
        PathError::KeyTime { key: 2, .. }
    ));
    assert_eq!(
        error_of(|keys| keys[1].latent.truncate(2)),
        PathError::LatentLength {
            key: 2,
            expected: 3,
            found: 2
        }
    );
    assert!(matches!(
        error_of(|keys| keys.iter_mut().for_each(|key| key.latent.clear())),
        PathError::LatentLength { key: 1, .. }
    ));
    assert_eq!(
        error_of(|keys| keys[2].latent[1] = f32::NAN),
        PathError::NotFinite { key: 3, index: 1 }
    );
    assert_eq!(
        error_of(|keys| keys[0].latent[2] = 1e30),
        PathError::NotFinite { key: 1, index: 2 }
    );
}

#[test]
fn bad_times_and_buffers_are_refused() {
    let keys = [
        key([0.0; 3], 0.0, Easing::Linear),
        key([1.0; 3], 1.0, Easing::Linear),
    ];
    for closing_s in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let repeat = Repeat::Loop {
            closing_s: Some(closing_s),
        };
        let path = LatentPath::new(&keys, Interpolation::Linear, repeat);
        assert!(
            matches!(path, Err(PathError::ClosingTime { .. })),
            "{closing_s}"
        );
    }
    let path = LatentPath::new(&keys, Interpolation::Linear, Repeat::Once).unwrap();
    let short = path.sample_into(0.5, &mut [0.0; 2]);
    assert_eq!(
        short,
        Err(PathError::Buffer {
            expected: 3,
            found: 2
        })
    );
    for time_s in [f32::NAN, f32::INFINITY] {
        let sampled = path.sample_into(time_s, &mut [0.0; 3]);
        assert!(matches!(sampled, Err(PathError::Time { .. })));
    }
}

#[test]
fn a_last_key_that_is_the_first_closes_the_loop_itself() {
    let keys = [
        key([0.0; 3], 0.0, Easing::Linear),
        key([1.0; 3], 1.0, Easing::Linear),
        key([0.0; 3], 2.0, Easing::Linear),
    ];
    let path = LatentPath::new(
        &keys,
        Interpolation::Cubic,
        Repeat::Loop { closing_s: None },
    );
    assert_eq!(path.unwrap().duration_s(), 2.0);
}

proptest! {
    #[test]
    fn every_key_is_met_exactly(
        keys in keys(any_easing()),
        interpolation in any_interpolation(),
        repeat in any_repeat(),
    ) {
        let path = LatentPath::new(&keys, interpolation, repeat).unwrap();
        for (index, key) in keys.iter().enumerate() {
            prop_assert_eq!(&at(&path, key.time_s)[..], &key.latent[..], "key {}", index);
            prop_assert_eq!(path.key_latent(index).unwrap(), &key.latent[..]);
        }
    }

    #[test]
    fn a_path_never_jumps(
        keys in keys(any_easing()),
        interpolation in any_interpolation(),
        repeat in any_repeat(),
        start_s in -30.0_f32..30.0,
    ) {
        let path = LatentPath::new(&keys, interpolation, repeat).unwrap();
        let path = if repeat == Repeat::Once { path.unbounded() } else { path };
        // The fastest way between two keys, doubled by an easing, and by a cubic by half.
        let knots = 0..path.segment_count();
        let fastest = knots
            .map(|i| distance(path.knot(i), path.knot(i + 1)) / (path.knot_time_s(i + 1) - path.knot_time_s(i)))
            .fold(0.0, f32::max);
        for i in 0..1000 {
            let time_s = start_s + 0.005 * i as f32;
            let moved = distance(&at(&path, time_s), &at(&path, time_s + 0.005));
            prop_assert!(moved <= 0.005 * 3.0 * fastest * 1.1 + 1e-3, "{moved} at {time_s}");
        }
    }

    #[test]
    fn a_cubic_has_no_kink(keys in keys(Just(Easing::Linear)), repeat in any_repeat()) {
        let path = LatentPath::new(&keys, Interpolation::Cubic, repeat).unwrap();
        let path = if repeat == Repeat::Once { path.unbounded() } else { path };
        let shortest = (0..path.segment_count())
            .map(|i| path.knot_time_s(i + 1) - path.knot_time_s(i))
            .fold(1.0, f32::min);
        let step_s = 0.01 * shortest;
        let end_s = keys[0].time_s + path.duration_s();
        for knot_s in keys.iter().map(|key| key.time_s).chain([end_s]) {
            let [before, middle, after] = [-step_s, 0.0, step_s].map(|dt| at(&path, knot_s + dt));
            let speed = distance(&before, &middle).max(distance(&middle, &after)) / step_s;
            let left: Vec<f32> = middle.iter().zip(&before).map(|(a, b)| (a - b) / step_s).collect();
            let right: Vec<f32> = after.iter().zip(&middle).map(|(a, b)| (a - b) / step_s).collect();
            // A cubic's velocity changes by at most some multiple of the fastest way's over an interval.
            let fastest = (0..path.segment_count())
                .map(|i| distance(path.knot(i), path.knot(i + 1)) / (path.knot_time_s(i + 1) - path.knot_time_s(i)))
                .fold(0.0, f32::max);
            prop_assert!(
                distance(&left, &right) <= 0.15 * fastest + 0.02,
                "{} of {speed} at {knot_s}", distance(&left, &right)
            );
        }
    }

    #[test]
    fn a_cubic_stays_within_a_quarter_of_the_distance_from_the_straight_line(
        keys in keys(any_easing()),
        repeat in any_repeat(),
    ) {
        let path = LatentPath::new(&keys, Interpolation::Cubic, repeat).unwrap();
        for segment in 0..path.segment_count() {
            let (a, b) = (path.knot(segment), path.knot(segment + 1));
            let (from_s, to_s) = (path.knot_time_s(segment), path.knot_time_s(segment + 1));
            for i in 0..=50 {
                let point = at(&path, from_s + (to_s - from_s) * i as f32 / 50.0);
                prop_assert!(from_line(&point, a, b) <= 0.25 * distance(a, b) + 1e-3);
            }
        }
    }

    #[test]
    fn straight_lines_are_straight_and_go_on_as_in_the_paper(
        keys in keys(Just(Easing::Linear)),
        u in 0.0_f32..5.0,
    ) {
        let path = LatentPath::new(&keys, Interpolation::Linear, Repeat::Once).unwrap().unbounded();
        let [.., before, last] = keys.as_slice() else { unreachable!() };
        let interval_s = last.time_s - before.time_s;
        let found = at(&path, last.time_s + u * interval_s);
        let beyond = |near: &LatentKey, far: &LatentKey| -> Vec<f32> {
            let ends = near.latent.iter().zip(&far.latent);
            ends.map(|(near, far)| far + u * (far - near)).collect()
        };
        prop_assert!(distance(&found, &beyond(before, last)) < 5e-3 * (1.0 + u));
        let first = at(&path, keys[0].time_s - u * (keys[1].time_s - keys[0].time_s));
        prop_assert!(distance(&first, &beyond(&keys[1], &keys[0])) < 5e-3 * (1.0 + u));
    }

    #[test]
    fn loops_come_round_and_ping_pong_comes_back(
        keys in keys(any_easing()),
        interpolation in any_interpolation(),
        repeat in any_repeat(),
        share in 0.0_f32..1.0,
        rounds in -3_i32..4,
    ) {
        let path = LatentPath::new(&keys, interpolation, repeat).unwrap();
        let (start_s, period_s) = (keys[0].time_s, path.duration_s());
        let time_s = start_s + share * period_s;
        let here = at(&path, time_s);
        // In single precision a time some rounds away is a little off.
        let tolerance = 0.03;
        match repeat {
            Repeat::Loop { .. } => {
                let later = at(&path, time_s + rounds as f32 * period_s);
                prop_assert!(distance(&here, &later) < tolerance || !(0.01..0.99).contains(&share));
                let closed = at(&path, start_s + period_s);
                prop_assert!(distance(&closed, &keys[0].latent) < tolerance);
            }
            Repeat::PingPong => {
                let mirrored = at(&path, start_s + (2.0 - share) * period_s);
                prop_assert!(distance(&here, &mirrored) < tolerance);
            }
            Repeat::Once => {
                let (first, last) = (at(&path, start_s - 9.0), at(&path, start_s + period_s + 9.0));
                prop_assert_eq!(&first[..], &keys[0].latent[..]);
                prop_assert_eq!(&last[..], &keys[keys.len() - 1].latent[..]);
            }
        }
    }
}
