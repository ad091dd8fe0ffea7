//! Tests of drawings that grow bone by bone in any order: nothing is taken for finished before it is, and what is
//! finished is.

use glam::Vec2;
use rand::Rng as _;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::freely::{FreeReading, completes, read_freely, recognize_finished};
use crate::figure::Figure;
use crate::simulate::any_order::{flat_pose, is_readable};
use crate::simulate::{self, Hand};
use crate::stroke::Stroke;

const HEIGHT_PX: f32 = 500.0;
const HAND: Hand = Hand {
    height_px: HEIGHT_PX,
    jitter_px: 2.0,
    spacing_px: 4.0,
    aim_px: 7.0,
    bow: 0.02,
    speed_px_per_s: 900.0,
};

/// One stroke per bone, or through several joints.
fn strokes(rng: &mut ChaCha8Rng, lines: &[Vec<Vec2>]) -> Vec<Stroke> {
    let mut time_s = 0.0;
    let mut draw = |line: &Vec<Vec2>| simulate::line(rng, line, HAND, &mut time_s);
    lines.iter().map(&mut draw).collect()
}

fn read(figure: &Figure, strokes: &[Stroke]) -> FreeReading {
    read_freely(figure, strokes, HEIGHT_PX / figure.template_extent_m())
}

/// Joints on the canvas, and their drawing: a stroke per bone, shuffled.
fn shuffled(figure: &Figure, rng: &mut ChaCha8Rng) -> (Vec<Vec2>, Vec<Stroke>) {
    let pose = std::iter::repeat_with(|| flat_pose(figure, rng))
        .find(|pose| is_readable(figure, pose))
        .unwrap();
    let meant = simulate::on_canvas(&pose, HEIGHT_PX);
    let mut lines: Vec<Vec<Vec2>> = figure
        .bones
        .iter()
        .map(|bone| bone.map(|joint| meant[joint]).to_vec())
        .collect();
    lines.shuffle(rng);
    let strokes = strokes(rng, &lines);
    (meant, strokes)
}

/// Per number of strokes how many of `rounds` drawings are taken for finished.
fn finished(figure: &Figure, rounds: u64) -> Vec<u64> {
    let count = figure.bones.len();
    let mut finished = vec![0; count + 1];
    for seed in 0..rounds {
        let (_, strokes) = shuffled(figure, &mut simulate::rng(seed));
        for n in 1..=count {
            finished[n] += u64::from(read(figure, &strokes[..n]).progress.complete);
        }
    }
    finished
}

#[test]
fn drawings_are_finished_with_their_last_bone() {
    let rounds = 60;
    for figure in [Figure::human(), Figure::horse()] {
        let finished = finished(figure, rounds);
        let (whole, before) = finished.split_last().unwrap();
        let (but_one, earlier) = before.split_last().unwrap();
        assert!(*whole + 1 >= rounds, "{}: {finished:?}", figure.name);
        // The outer half of a limb that floats may be taken for the whole of it, hung on a line that it crosses.
        assert!(
            *but_one * 100 <= 15 * rounds,
            "{}: {finished:?}",
            figure.name
        );
        assert!(
            earlier.iter().all(|early| *early * 100 <= 4 * rounds),
            "{}: {finished:?}",
            figure.name
        );
    }
}

#[test]
fn the_last_bone_completes_what_looked_finished_and_a_drag_does_not() {
    for figure in [Figure::human(), Figure::horse()] {
        let (mut early, mut completed, mut torn) = (0, 0, 0);
        for seed in 0..150 {
            let mut rng = simulate::rng(seed);
            let (meant, drawn) = shuffled(figure, &mut rng);
            let (last, before) = drawn.split_last().unwrap();
            if read(figure, before).progress.complete {
                early += 1;
                completed += u32::from(completes(figure, before, last));
            }
            let joint = rng.random_range(0..meant.len());
            let bone = figure.bones.iter().find(|bone| bone.contains(&joint));
            let [a, b] = *bone.unwrap();
            let fixed = meant[if a == joint { b } else { a }];
            let turn = Vec2::from_angle(rng.random_range(-2.0..2.0));
            let way = [meant[joint], fixed + turn.rotate(meant[joint] - fixed)];
            let drag = &strokes(&mut rng, &[way.to_vec()])[0];
            torn += u32::from(completes(figure, &drawn, drag));
        }
        let name = &figure.name;
        assert!(early >= 5, "{name}: {early} looked finished before");
        assert!(completed * 3 >= early * 2, "{name}: {completed} of {early}");
        assert_eq!(torn, 0, "{name}: drags taken for strokes");
    }
}

#[test]
fn straight_limbs_in_one_stroke_are_whole_and_their_halves_are_not() {
    let human = Figure::human();
    let joint = |name: &str| human.joint_index(name).unwrap();
    let mut pose = human.template.clone();
    for (side, elbow, hand) in [(-1.0, "elbow_r", "hand_r"), (1.0, "elbow_l", "hand_l")] {
        pose[joint(elbow)] = Vec2::new(side * 0.42, 1.49);
        pose[joint(hand)] = Vec2::new(side * 0.75, 1.49);
    }
    let meant = simulate::on_canvas(&pose, HEIGHT_PX);
    let line = |from: &str, to: &str| vec![meant[joint(from)], meant[joint(to)]];
    let mut lines = vec![
        line("neck", "hand_l"),
        line("abdomen", "foot_r"),
        line("neck", "abdomen"),
        line("hand_r", "neck"),
        line("forehead", "neck"),
        line("foot_l", "abdomen"),
    ];
    for seed in 0..20 {
        let mut rng = simulate::rng(seed);
        lines.shuffle(&mut rng);
        let whole = read(human, &strokes(&mut rng, &lines));
        assert!(whole.progress.complete, "{seed}: {whole:?}");

        let mut half = lines.clone();
        let leg = half
            .iter_mut()
            .find(|line| line.contains(&meant[joint("foot_r")]));
        *leg.unwrap() = line("abdomen", "knee_r");
        let half = read(human, &strokes(&mut rng, &half)).progress;
        assert!(!half.complete, "{seed}: {half:?}");
        let unseen: Vec<usize> = (0..pose.len())
            .filter(|at| half.placed[*at].is_none())
            .collect();
        assert_eq!(unseen, [joint("foot_r")], "{seed}");
    }
}

#[test]
fn finished_strokes_in_any_order_are_a_sketch_and_unfinished_ones_are_told() {
    let human = Figure::human();
    let meant = simulate::on_canvas(&human.template, 3.0);
    for seed in 0..20 {
        let mut rng = simulate::rng(seed);
        let mut bones = human.bones.clone();
        bones.shuffle(&mut rng);
        let strokes: Vec<Stroke> = bones
            .iter()
            .map(|bone| Stroke::from_positions(bone.map(|joint| meant[joint])).unwrap())
            .collect();
        let sketch = recognize_finished(human, &strokes).unwrap();
        for (found, meant) in sketch.points().iter().zip(&meant) {
            assert!(found.distance(*meant) < 0.05, "{seed}: {found} {meant}");
        }
    }
    let head = Stroke::from_positions([meant[0], meant[1]]).unwrap();
    assert!(recognize_finished(human, &[head]).is_err());
    assert!(recognize_finished(human, &[]).is_err());
}
