//! Feet that are down stay where they are.

use stick3d_figure::sketch::Sketch;

use super::contact::{Step, flat, planted_feet};
use super::flight::{filled, lifts};
use super::*;
use crate::Model;
use crate::latent::{Easing, Interpolation, LatentKey, Motion, MotionSettings, Repeat};

/// A body of height 1 whose feet are where they are told to be.
fn step(feet: [[f32; 3]; 2]) -> Step {
    let feet = feet.map(Vec3::from);
    let lowest_m = feet.iter().map(|foot| foot.y).fold(f32::INFINITY, f32::min);
    Step {
        soles: feet.map(|foot| vec![foot]).to_vec(),
        lowest_m,
    }
}

fn stance() -> Stance {
    Stance {
        soles: vec![vec![]; 2],
        height_m: 1.0,
    }
}

/// A walk on the spot: each foot goes back on the ground for half a second, then swings forward.
fn walk(time_s: f32) -> Step {
    let foot = |phase: f32| {
        let phase = phase.rem_euclid(1.0);
        if phase < 0.5 {
            [0.2 - 0.8 * phase, -0.9, 0.1]
        } else {
            let swing = 2.0 * (phase - 0.5);
            let lift = 0.1 * (std::f32::consts::PI * swing).sin();
            [-0.2 + 0.4 * swing, -0.9 + lift, 0.1]
        }
    };
    step([foot(time_s), foot(time_s + 0.5)])
}

#[test]
fn a_walk_goes_forward_on_planted_feet() {
    let times_s: Vec<f32> = (0..=80).map(|i| i as f32 / 40.0).collect();
    let steps: Vec<Step> = times_s.iter().map(|t| walk(*t)).collect();
    // Keys every quarter of a second.
    let intervals: Vec<Interval> = (0..8)
        .map(|i| Interval {
            first_step: 10 * i,
            last_step: 10 * i + 10,
            keys: [10 * i, 10 * i + 10],
        })
        .collect();
    let velocities = horizontal_velocities(&steps, &times_s, &intervals, &stance());
    assert!(velocities.iter().all(Option::is_some), "he never flies");
    let velocities = filled(&velocities, true);
    for (index, velocity) in velocities.iter().enumerate() {
        assert!(
            (velocity.x - 0.8).abs() < 0.02 && velocity.y.abs() < 1e-6,
            "{velocity} in step {index}"
        );
    }
    let track = GroundTrack::new(
        times_s,
        steps.iter().map(|step| step.lowest_m),
        vec![0.0; steps.len()],
        &velocities,
        0.0,
    );
    assert!(
        (track.per_round.x - 1.6).abs() < 0.03,
        "{}",
        track.per_round
    );
    assert!(
        track
            .translation(0.0, 2.0)
            .distance(Vec3::new(3.2, 0.9, 0.0))
            < 0.06
    );
    // The planted foot does not move.
    let foot = |time_s: f32| walk(time_s).soles[0][0] + track.translation(time_s, 0.0);
    for i in 0..40 {
        let time_s = 0.012 * i as f32;
        assert!(
            foot(time_s).distance(foot(0.0)) < 2e-3,
            "{} at {time_s}",
            foot(time_s)
        );
    }
}

#[test]
fn a_body_in_flight_keeps_its_speed() {
    let speeds = [
        Some(Vec2::X),
        Some(Vec2::X),
        None,
        None,
        None,
        Some(3.0 * Vec2::X),
    ];
    let flown = filled(&speeds, false);
    assert_eq!(flown[3], 2.0 * Vec2::X);
    assert!(flown.windows(2).all(|pair| pair[1].x >= pair[0].x));
    assert_eq!(filled(&[None, None], false), [Vec2::ZERO; 2]);
    assert_eq!(filled(&[None, Some(Vec2::Y)], false), [Vec2::Y; 2]);
    // In a loop the flight at the end goes on to the beginning.
    let round = filled(&[Some(Vec2::ZERO), Some(3.0 * Vec2::X), None], true);
    assert!((0.5..2.5).contains(&round[2].x), "{round:?}");
}

#[test]
fn a_runner_flies_along_a_parabola_and_others_do_not() {
    let times_s: Vec<f32> = (0..=10).map(|i| 0.05 * i as f32).collect();
    let speeds = |speed: f32, flights: &[usize]| -> Vec<Option<Vec2>> {
        (0..10)
            .map(|step| (!flights.contains(&step)).then_some(speed * Vec2::X))
            .collect()
    };
    let run = lifts(&speeds(2.0, &[4, 5, 6]), &times_s, 1.0, false);
    assert!(run[4] == 0.0 && run[7] == 0.0 && run[5] > 0.0);
    assert!((run[5] - 0.5 * 9.81 * 0.05 * 0.1).abs() < 1e-4, "{run:?}");
    // Too slow, too long, not carried before.
    for (speed, flight) in [
        (0.3, vec![4, 5]),
        (2.0, vec![2, 3, 4, 5, 6, 7, 8]),
        (2.0, vec![0, 1]),
    ] {
        let lifts = lifts(&speeds(speed, &flight), &times_s, 1.0, false);
        assert!(lifts.iter().all(|lift| *lift == 0.0), "{flight:?}");
    }
    // A flight across the end of a loop.
    let round = lifts(&speeds(2.0, &[0, 9]), &times_s, 1.0, true);
    assert!(round[0] > 0.0 && (round[0] - round[10]).abs() < 1e-6 && round[1] == 0.0);
}

#[test]
fn feet_that_slip_against_each_other_do_not_both_hold() {
    // Both feet on the ground, changing places.
    let swap = |t: f32| {
        step([
            [0.2 - 0.4 * t, 0.01 * t * (1.0 - t), 0.0],
            [-0.2 + 0.4 * t, 0.0, 0.0],
        ])
    };
    let steps: Vec<Step> = (0..=10).map(|i| swap(0.1 * i as f32)).collect();
    let interval = Interval {
        first_step: 0,
        last_step: 10,
        keys: [0, 10],
    };
    assert_eq!(planted_feet(&steps, interval, &stance()), [1]);
}

#[test]
fn the_human_stands_on_its_feet() {
    let human = Figure::human();
    let names: Vec<&str> = feet(human)
        .iter()
        .map(|j| human.joints[*j].name.as_str())
        .collect();
    assert_eq!(names, ["foot_r", "foot_l"]);
}

/// The man, walking: sketches of one step from the side, and the same with sides exchanged.
fn walking_man() -> (Inference, Motion) {
    let bytes = include_bytes!("../../../../../assets/models/human.stick3d");
    let mut man = Inference::new(&Model::from_bytes(bytes).unwrap()).unwrap();
    let human = Figure::human().clone();
    // He walks to the right: joints in the order of the figure's file, metres.
    let contact = [
        (0.07, 1.68),
        (0.03, 1.48),
        (0.0, 0.93),
        (-0.16, 1.20),
        (-0.12, 0.92),
        (0.22, 0.50),
        (0.42, 0.10),
        (0.16, 1.19),
        (0.36, 1.02),
        (-0.02, 0.49),
        (-0.34, 0.16),
    ];
    let passing = [
        (0.07, 1.72),
        (0.03, 1.52),
        (0.0, 0.97),
        (0.02, 1.22),
        (0.12, 0.95),
        (0.04, 0.52),
        (0.02, 0.06),
        (0.02, 1.22),
        (0.12, 0.95),
        (0.17, 0.58),
        (-0.08, 0.27),
    ];
    let exchanged = |points: [(f32, f32); 11]| -> [(f32, f32); 11] {
        std::array::from_fn(|joint| points[human.mirror_of(joint)])
    };
    let poses = [contact, passing, exchanged(contact), exchanged(passing)];
    let keys: Vec<LatentKey> = poses
        .into_iter()
        .enumerate()
        .map(|(index, points)| {
            let points = points.map(Vec2::from).to_vec();
            let mut latent = vec![0.0; man.latent_len()];
            man.encode(&Sketch::new(&human, points).unwrap(), &mut latent)
                .unwrap();
            LatentKey {
                latent,
                time_s: 0.25 * index as f32,
                easing: Easing::Linear,
            }
        })
        .collect();
    let settings = MotionSettings {
        interpolation: Interpolation::Cubic,
        repeat: Repeat::Loop { closing_s: None },
        ..MotionSettings::default()
    };
    let motion = Motion::new(&keys, settings, &mut man).unwrap();
    (man, motion)
}

/// Where the hips face in one round of a motion: mean, on the ground.
fn mean_heading(man: &mut Inference, motion: &Motion) -> Vec3 {
    let mut latent = vec![0.0; man.latent_len()];
    let mut positions = vec![[0.0; 3]; man.vertex_count()];
    let standing = Sketch::template(man.figure());
    man.encode(&standing, &mut latent).unwrap();
    man.decode_positions(&latent, &mut positions).unwrap();
    // The root joint, at the origin, is between them.
    let near_hips =
        |index: &usize| positions[*index][1].abs() < 0.05 && positions[*index][0].abs() < 0.25;
    let by_x = |a: &usize, b: &usize| positions[*a][0].total_cmp(&positions[*b][0]);
    let right = (0..positions.len()).filter(near_hips).min_by(by_x).unwrap();
    let left = (0..positions.len()).filter(near_hips).max_by(by_x).unwrap();
    let mut heading = Vec3::ZERO;
    for frame in 0..60 {
        motion
            .sample_into(frame as f32 / 60.0, &mut latent)
            .unwrap();
        man.decode_positions(&latent, &mut positions).unwrap();
        let [left, right] = [left, right].map(|index| Vec3::from(positions[index]));
        heading += (left - right).cross(Vec3::Y).normalize();
    }
    heading.normalize()
}

#[test]
fn the_man_walks_forward_without_a_jump() {
    let (mut man, motion) = walking_man();
    let per_round = motion.root_translation(1.0).unwrap() - motion.root_translation(0.0).unwrap();
    // Two steps of some 70 cm.
    assert!((0.9..1.9).contains(&per_round.x), "{per_round}");
    assert!(per_round.y.abs() < 1e-3, "{per_round}");
    let heading = mean_heading(&mut man, &motion);
    let aside = per_round.normalize().angle_between(heading).to_degrees();
    assert!(
        aside < 5.0,
        "he faces {heading}, and walks {aside} degrees beside that"
    );
    let far = motion.root_translation(10.0).unwrap() - motion.root_translation(9.0).unwrap();
    assert!(
        far.distance(per_round) < 1e-2,
        "every round comes as far: {far} {per_round}"
    );
    let mut latent = vec![0.0; man.latent_len()];
    let mut positions = vec![[0.0; 3]; man.vertex_count()];
    let mut before = None::<Vec3>;
    let mut farthest = 0.0_f32;
    for frame in 0..120 {
        let time_s = frame as f32 / 60.0;
        let root = motion.root_translation(time_s).unwrap();
        if let Some(before) = before {
            assert!(
                root.distance(before) < 0.08,
                "{before} {root} in frame {frame}"
            );
        }
        before = Some(root);
        motion.sample_into(time_s, &mut latent).unwrap();
        man.decode_positions(&latent, &mut positions).unwrap();
        let lowest = positions.iter().map(|p| p[1]).fold(f32::INFINITY, f32::min) + root.y;
        farthest = farthest.max(lowest.abs());
    }
    assert!(
        farthest < 0.03,
        "the lowest point is {farthest} m off the ground"
    );
}

#[test]
fn the_planted_foot_of_the_man_stays() {
    let (mut man, motion) = walking_man();
    let human = Figure::human();
    let right = human.joint_index("foot_r").unwrap();
    let mut latent = vec![0.0; man.latent_len()];
    let mut joints = vec![Vec3::ZERO; human.joint_count()];
    let mut positions = vec![[0.0; 3]; man.vertex_count()];
    let mut body = |time_s: f32| {
        motion.sample_into(time_s, &mut latent).unwrap();
        man.joints(&latent, &mut joints).unwrap();
        man.decode_positions(&latent, &mut positions).unwrap();
        let root = motion.root_translation(time_s).unwrap();
        let points: Vec<Vec3> = positions.iter().map(|p| Vec3::from(*p) + root).collect();
        (joints[right] + root, points)
    };
    // From the passing pose to the next contact the right foot alone carries him.
    let (mut slid, mut trod) = (0.0, 0.0);
    let (mut ankle, mut points) = body(16.0 / 60.0);
    for frame in 17..=28 {
        let (next_ankle, next) = body(frame as f32 / 60.0);
        slid += flat(next_ankle - ankle).length();
        // What is on the ground below that ankle, or before it.
        let treads = points
            .iter()
            .zip(&next)
            .filter(|(a, b)| a.y.max(b.y) < 0.01 && flat(**a - ankle).length() < 0.3);
        let (mut sum, mut count) = (Vec2::ZERO, 0.0);
        for (a, b) in treads {
            sum += flat(*b - *a);
            count += 1.0;
        }
        trod += (sum / count).length();
        (ankle, points) = (next_ankle, next);
    }
    // The body passes some 30 cm over it meanwhile; the ankle goes on over the ball of the foot.
    assert!(slid < 0.07, "{slid} m");
    assert!(trod < 0.02, "{trod} m");
}

#[test]
fn a_motion_can_be_without_ground() {
    let (mut man, motion) = walking_man();
    let keys: Vec<LatentKey> = (0..2)
        .map(|key| LatentKey {
            latent: motion.path().key_latent(key).unwrap().to_vec(),
            time_s: key as f32,
            easing: Easing::Linear,
        })
        .collect();
    let settings = MotionSettings {
        grounded: false,
        ..MotionSettings::default()
    };
    let motion = Motion::new(&keys, settings, &mut man).unwrap();
    assert_eq!(motion.root_translation(0.5), None);
}
