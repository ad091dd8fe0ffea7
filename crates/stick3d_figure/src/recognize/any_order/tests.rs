//! Drawings of random poses must be recovered whatever the order, the directions and the pieces of their strokes.

use proptest::prelude::*;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::edit::swap_pair;
use crate::interchange::{Drawing, figure_name};
use crate::simulate::any_order::{Habits, draw, flat_pose, is_readable, misdrawn};
use crate::simulate::subjects::{HORSE, HUMAN};
use crate::simulate::{self, Hand, farthest_px, is_recognised};

/// As [`Hand::any_order`] draws.
const HEIGHT_PX: f32 = 500.0;
/// A joint is right within this part of the height: 30 px.
const RIGHT: f32 = 0.06;

/// The largest distance of a joint from where it is meant, in parts of the height.
fn farthest(found: &[Option<Vec2>], meant: &[Vec2]) -> f32 {
    farthest_px(found, meant) / HEIGHT_PX
}

/// How many of the drawings of these poses are recognised with every joint right, of a hundred.
fn percent_right(
    figure: &Figure,
    habits: Habits,
    count: u64,
    mut pose: impl FnMut(u64, &mut ChaCha8Rng) -> Vec<Vec2>,
) -> f32 {
    let mut right = 0;
    let started = std::time::Instant::now();
    for seed in 0..count {
        let mut rng = simulate::rng(seed);
        let pose = pose(seed, &mut rng);
        right += u32::from(is_recognised(
            figure,
            &mut rng,
            &pose,
            Hand::any_order(),
            habits,
        ));
    }
    let percent = 100.0 * right as f32 / count as f32;
    let spent = started.elapsed() / count as u32;
    println!("{}: {percent} %, {spent:?} each", figure.name);
    percent
}

fn readable_pose(figure: &Figure, rng: &mut ChaCha8Rng) -> Vec<Vec2> {
    let mut poses = std::iter::repeat_with(|| flat_pose(figure, rng));
    poses.find(|pose| is_readable(figure, pose)).unwrap()
}

#[test]
fn drawings_in_any_order_are_recognised() {
    let human = Figure::human();
    let percent = percent_right(human, Habits::of(human), 400, |_, rng| {
        readable_pose(human, rng)
    });
    assert!(percent >= 98.0, "human: {percent} %");
    let horse = Figure::horse();
    let percent = percent_right(horse, Habits::of(horse), 200, |_, rng| {
        readable_pose(horse, rng)
    });
    assert!(percent >= 92.0, "horse: {percent} %");
}

/// Bodies turned in space, seen from the front and from the side: bones are foreshortened at will.
#[test]
fn projected_poses_are_recognised() {
    for (subject, clear, any) in [(HUMAN, 92.0, 70.0), (HORSE, 84.0, 72.0)] {
        let figure = (subject.figure)();
        let percent = percent_right(figure, Habits::of(figure), 150, |_, rng| {
            (subject.clear_pose)(rng)
        });
        assert!(percent >= clear, "{}, clear: {percent} %", figure.name);
        let percent = percent_right(figure, Habits::of(figure), 150, |_, rng| {
            (subject.pose)(rng)
        });
        assert!(percent >= any, "{}, any: {percent} %", figure.name);
    }
}

/// The sketches that come with the project, each with its figure; those of other figures are left out.
fn sample_sketches() -> Vec<(&'static Figure, Sketch)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/sketches");
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|file| file.unwrap().path())
        .collect();
    files.sort();
    let sketch = |file: &std::path::PathBuf| {
        let bytes = std::fs::read(file).unwrap();
        let name = figure_name(&bytes).unwrap();
        let figure = *Figure::shipped()
            .iter()
            .find(|figure| figure.name == name)?;
        match Drawing::from_json(figure, &bytes).unwrap() {
            Drawing::Strokes(_) => None,
            joints => Some((figure, joints.sketch(figure).unwrap())),
        }
    };
    files.iter().filter_map(sketch).collect()
}

/// How many of `count` drawings of each sample sketch are recognised, of a hundred: the human's and the horse's.
fn percent_of_samples(
    habits: fn(&Figure) -> Habits,
    count: u64,
    mut pose: impl FnMut(&Figure, &Sketch, &mut ChaCha8Rng) -> Vec<Vec2>,
) -> [f32; 2] {
    let mut sums = [(0.0, 0.0); 2];
    for (figure, sketch) in sample_sketches() {
        let of = usize::from(figure.name == Figure::horse().name);
        let habits = habits(figure);
        sums[of].0 += percent_right(figure, habits, count, |_, rng| pose(figure, &sketch, rng));
        sums[of].1 += 1.0;
    }
    sums.map(|(sum, count): (f32, f32)| sum / count)
}

#[test]
fn sample_sketches_are_recognised() {
    let [human, horse] =
        percent_of_samples(Habits::of, 12, |_, sketch, _| sketch.points().to_vec());
    assert!(
        human >= 94.0 && horse >= 60.0,
        "human: {human} %, horse: {horse} %"
    );
}

/// Strokes meet at joints, which says where these are on straight limbs in wrong proportions.
#[test]
fn misdrawn_sketches_are_recognised_bone_by_bone() {
    let [human, horse] = percent_of_samples(Habits::bone_by_bone, 60, |figure, sketch, rng| {
        misdrawn(figure, sketch.points(), 0.25, 0.26, rng)
    });
    assert!(
        human >= 94.0 && horse >= 70.0,
        "human: {human} %, horse: {horse} %"
    );
}

#[test]
fn a_limb_that_is_not_drawn_is_missing() {
    for (figure, bar) in [(Figure::human(), 95.0), (Figure::horse(), 85.0)] {
        let (mut right, count) = (0, 100);
        for seed in 0..count {
            let mut rng = simulate::rng(seed);
            let meant = simulate::on_canvas(&readable_pose(figure, &mut rng), HEIGHT_PX);
            let pairs = sides::pairs(figure);
            let pair = &pairs[rng.random_range(0..pairs.len())];
            let gone = if rng.random() {
                &pair.left
            } else {
                &pair.right
            };
            let is_gone = |bone: &[usize; 2]| bone.iter().any(|joint| gone.contains(joint));
            let bones = figure.bones.iter().enumerate();
            let undrawn: Vec<usize> = bones
                .filter(|(_, bone)| is_gone(bone))
                .map(|(i, _)| i)
                .collect();
            let strokes = draw(
                figure,
                &mut rng,
                &meant,
                &undrawn,
                Hand::any_order(),
                Habits::of(figure),
            );
            let mut found = recognize_any(figure, &strokes).unwrap();
            if found.missing.len() != 1 {
                continue;
            }
            let missing = found.missing[0].clone();
            if missing.len() != gone.len() || !(missing == pair.left || missing == pair.right) {
                continue;
            }
            // What was not drawn may be on either side; the rest is where it is meant.
            if missing != *gone {
                assert!(found.swap_pair(figure, gone[0]));
            }
            for joint in gone {
                found.joints[*joint] = Some(meant[*joint]);
            }
            let error = sides_aside(figure, &found.joints, &meant);
            right += u32::from(error < RIGHT);
        }
        let percent = 100.0 * right as f32 / count as f32;
        println!("{}, one limb missing: {percent} %", figure.name);
        assert!(percent >= bar, "{}: {percent} %", figure.name);
    }
}

/// The error with the pairs put as they fit best.
fn sides_aside(figure: &Figure, found: &[Option<Vec2>], meant: &[Vec2]) -> f32 {
    let mut meant = meant.to_vec();
    for pair in sides::pairs(figure) {
        let mut swapped = meant.clone();
        sides::swap(&pair, &mut swapped);
        if farthest(found, &swapped) < farthest(found, &meant) {
            meant = swapped;
        }
    }
    farthest(found, &meant)
}

/// One straight stroke per bone, through the joints themselves.
fn neat(figure: &Figure, joints: &[Vec2], bones: &[[&str; 2]]) -> Vec<Stroke> {
    let at = |name: &str| joints[figure.joint_index(name).unwrap()];
    let stroke = |bone: &[&str; 2]| Stroke::from_positions(bone.map(at)).unwrap();
    bones.iter().map(stroke).collect()
}

#[test]
fn the_body_appears_with_its_trunk_and_grows() {
    let human = Figure::human();
    let joints = simulate::on_canvas(&human.template, HEIGHT_PX);
    let order = [
        ["neck", "abdomen"],
        ["forehead", "neck"],
        ["abdomen", "knee_l"],
        ["knee_l", "foot_l"],
        ["elbow_r", "neck"],
        ["hand_r", "elbow_r"],
        ["abdomen", "knee_r"],
        ["knee_r", "foot_r"],
        ["elbow_l", "hand_l"],
        ["neck", "elbow_l"],
    ];
    for count in 1..=order.len() {
        let strokes = neat(human, &joints, &order[..count]);
        let found = recognize_any(human, &strokes).unwrap();
        let trunk = ["neck", "abdomen"].map(|name| human.joint_index(name).unwrap());
        for joint in trunk {
            let place = found.joints[joint].unwrap();
            assert!(place.distance(joints[joint]) < 20.0, "{count}: {place}");
        }
        assert_eq!(found.is_complete(), count == order.len(), "{count}");
        let completed = crate::complete_from_template(human, &found.joints).unwrap();
        assert_eq!(completed.points().len(), human.joint_count());
    }
}

#[test]
fn a_loop_alone_is_a_head() {
    let human = Figure::human();
    let ring = (0..=30).map(|i| Vec2::from_angle(i as f32 * 0.21) * 40.0 + Vec2::splat(300.0));
    let found = recognize_any(human, &[Stroke::from_positions(ring).unwrap()]).unwrap();
    assert!(
        found.joints[human.path[0]]
            .unwrap()
            .distance(Vec2::splat(300.0))
            < 5.0
    );
    assert_eq!(found.joints.iter().flatten().count(), 1);
    assert!(!found.is_complete() && found.missing.len() == 5);
}

#[test]
fn both_arms_may_be_one_stroke_and_torso_and_head_another() {
    let human = Figure::human();
    let meant = simulate::on_canvas(&human.template, HEIGHT_PX);
    let at = |name: &str| meant[human.joint_index(name).unwrap()];
    let lines: [&[&str]; 4] = [
        &["hand_r", "elbow_r", "neck", "elbow_l", "hand_l"],
        &["abdomen", "forehead"],
        &["foot_l", "knee_l", "abdomen"],
        &["abdomen", "knee_r", "foot_r"],
    ];
    let strokes =
        lines.map(|line| Stroke::from_positions(line.iter().map(|name| at(name))).unwrap());
    let found = recognize_any(human, &strokes).unwrap();
    assert!(farthest(&found.joints, &meant) < 0.03, "{:?}", found.joints);
    assert!(
        found.ambiguous.is_empty() && found.confidence > 0.9,
        "{found:?}"
    );
}

#[test]
fn sides_follow_the_rule_and_a_pair_can_be_swapped() {
    let human = Figure::human();
    let upright = simulate::on_canvas(&human.template, HEIGHT_PX);
    let handstand: Vec<Vec2> = upright.iter().map(|p| Vec2::splat(900.0) - *p).collect();
    for meant in [upright, handstand] {
        let bones: Vec<[&str; 2]> = human
            .bones
            .iter()
            .map(|bone| bone.map(|j| human.joints[j].name.as_str()))
            .collect();
        let mut found = recognize_any(human, &neat(human, &meant, &bones)).unwrap();
        assert!(
            farthest(&found.joints, &meant) < 0.03,
            "{} {found:?}",
            farthest(&found.joints, &meant)
        );
        let mut sketch = found.sketch(human).unwrap();
        let [elbow, hand, other] =
            ["elbow_r", "hand_r", "hand_l"].map(|name| human.joint_index(name).unwrap());
        assert!(found.swap_pair(human, elbow) && swap_pair(human, &mut sketch, hand));
        assert_eq!(found.joints[other].unwrap(), sketch.points()[other]);
        assert!(sketch.points()[other].distance(meant[hand]) < 15.0);
        assert!(!found.swap_pair(human, human.root) && !swap_pair(human, &mut sketch, 99));
    }
    let horse = Figure::horse();
    let bones: Vec<[&str; 2]> = horse
        .bones
        .iter()
        .map(|bone| bone.map(|j| horse.joints[j].name.as_str()))
        .collect();
    for facing in [1.0, -1.0] {
        let pose: Vec<Vec2> = horse
            .template
            .iter()
            .map(|p| *p * Vec2::new(facing, 1.0))
            .collect();
        let meant = simulate::on_canvas(&pose, HEIGHT_PX);
        let found = recognize_any(horse, &neat(horse, &meant, &bones)).unwrap();
        // The tail ends beside a hind knee.
        assert!(
            farthest(&found.joints, &meant) < 0.09,
            "{facing}: {:?}",
            found.joints
        );
    }
}

#[test]
fn order_direction_place_and_size_do_not_matter() {
    let human = Figure::human();
    for seed in 0..40 {
        let mut rng = simulate::rng(seed);
        let meant = simulate::on_canvas(&readable_pose(human, &mut rng), HEIGHT_PX);
        let mut strokes = draw(
            human,
            &mut rng,
            &meant,
            &[],
            Hand::any_order(),
            Habits::of(human),
        );
        let found = recognize_any(human, &strokes).unwrap();
        strokes.shuffle(&mut rng);
        let (scale, offset) = (1.7, Vec2::new(-300.0, 90.0));
        let moved: Vec<Stroke> = strokes
            .iter()
            .map(|stroke| {
                Stroke::from_positions(stroke.positions().rev().map(|p| p * scale + offset))
                    .unwrap()
            })
            .collect();
        let again = recognize_any(human, &moved).unwrap();
        let back = |place: &Option<Vec2>| place.map(|place| (place - offset) / scale);
        let again: Vec<Option<Vec2>> = again.joints.iter().map(back).collect();
        let [before, after] =
            [&found.joints, &again].map(|joints| sides_aside(human, joints, &meant));
        assert!((before - after).abs() < 0.03, "{seed}: {before} {after}");
    }
}

/// A fish: a backbone with three branchings, which one pair of ribs each hangs on.
#[test]
fn other_figures_are_drawn_in_any_order_too() {
    let text = r#"Figure(name: "fish", root: "back2", joints: [
        (name: "nose", side: Center, template: (0.0, 1.9), anchor: Vertices([])),
        (name: "back1", side: Center, template: (0.0, 1.5), anchor: Vertices([])),
        (name: "back2", side: Center, template: (0.0, 0.95), anchor: Vertices([])),
        (name: "back3", side: Center, template: (0.0, 0.5), anchor: Vertices([])),
        (name: "tail", side: Center, template: (0.1, 0.0), anchor: Vertices([])),
        (name: "rib1_r", side: Right, template: (-0.4, 1.3), anchor: Vertices([])),
        (name: "rib1_l", side: Left, template: (0.4, 1.3), anchor: Vertices([])),
        (name: "rib2_r", side: Right, template: (-0.5, 0.7), anchor: Vertices([])),
        (name: "rib2_l", side: Left, template: (0.5, 0.7), anchor: Vertices([])),
        (name: "rib3_r", side: Right, template: (-0.3, 0.35), anchor: Vertices([])),
        (name: "rib3_l", side: Left, template: (0.3, 0.35), anchor: Vertices([])),
    ], path: ["nose", "back1", "rib1_r", "back1", "rib1_l", "back1", "back2", "rib2_r", "back2", "rib2_l", "back2",
        "back3", "rib3_r", "back3", "rib3_l", "back3", "tail"],
    bones: [("nose", "back1"), ("back1", "rib1_r"), ("back1", "rib1_l"), ("back1", "back2"), ("back2", "rib2_r"),
        ("back2", "rib2_l"), ("back2", "back3"), ("back3", "rib3_r"), ("back3", "rib3_l"), ("back3", "tail")])"#;
    let fish = Figure::from_ron(text).unwrap();
    let meant = simulate::on_canvas(&fish.template, HEIGHT_PX);
    let mut right = 0;
    for seed in 0..20 {
        let mut rng = simulate::rng(seed);
        let strokes = draw(
            &fish,
            &mut rng,
            &meant,
            &[],
            Hand::any_order(),
            Habits::of(&fish),
        );
        let found = recognize_any(&fish, &strokes).unwrap();
        right += u32::from(farthest(&found.joints, &meant) < RIGHT);
    }
    assert!(right >= 15, "{right} of 20");
}

#[test]
fn bad_input_is_told() {
    let human = Figure::human();
    assert_eq!(
        recognize_any(human, &[]),
        Err(RecognizeError::Empty { strokes: 0 })
    );
    let dot = Stroke::from_positions([Vec2::ONE; 4]).unwrap();
    assert_eq!(
        recognize_any(human, std::slice::from_ref(&dot)),
        Err(RecognizeError::Empty { strokes: 1 })
    );
    let many = vec![dot; MAX_STROKES + 1];
    assert!(matches!(
        recognize_any(human, &many),
        Err(RecognizeError::TooManyStrokes { .. })
    ));
}

/// What nobody would call a figure takes no more work than a crooked figure does.
#[test]
fn the_work_is_bounded_whatever_is_drawn() {
    for figure in Figure::shipped() {
        let body = Body::new(figure);
        for (strokes, points) in [(5, 2), (20, 2), (40, 6), (MAX_STROKES, 2), (4, 300)] {
            let mut rng = simulate::rng(strokes as u64);
            let mut random =
                || Vec2::new(rng.random_range(0.0..800.0), rng.random_range(0.0..600.0));
            let strokes: Vec<Stroke> = (0..strokes)
                .map(|_| Stroke::from_positions((0..points).map(|_| random())).unwrap())
                .collect();
            let ink = Ink::new(&strokes).unwrap();
            let marks = Marks::new(&ink);
            let search = Search::new(&body, &ink, &marks);
            let readings = search.run();
            assert!(!readings.is_empty(), "{} strokes", strokes.len());
            let looks = search.work();
            // What was begun is finished.
            let most = search::MAX_WORK + search::MAX_WORK / 4;
            assert!(looks <= most, "{} strokes: {looks} looks", strokes.len());
            let found = recognize_any(figure, &strokes).unwrap();
            assert!(found.cost.is_finite() && found.leftover <= 1.0);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn nothing_makes_it_panic(
        strokes in prop::collection::vec(
            prop::collection::vec((-1.0e3f32..1.0e3, -1.0e3f32..1.0e3), 0..12), 0..12),
        coarse in prop::sample::select(vec![1.0e-3f32, 1.0, 400.0]),
        scale in prop::sample::select(vec![1.0e-6f32, 1.0, 1.0e3]),
    ) {
        // A coarse grid makes points, strokes and whole drawings coincide.
        let strokes: Vec<Stroke> = strokes
            .into_iter()
            .map(|s| s.into_iter().map(|p| (Vec2::from(p) / coarse).round() * coarse * scale))
            .map(|s| Stroke::from_positions(s.map(|p| p.clamp(Vec2::splat(-1.0e6), Vec2::splat(1.0e6)))))
            .collect::<Result<_, _>>()
            .unwrap();
        for figure in Figure::shipped() {
            if let Ok(found) = recognize_any(figure, &strokes) {
                prop_assert!(found.joints.iter().flatten().all(|place| place.is_finite()));
                prop_assert!(found.cost.is_finite() && (0.0..=1.0).contains(&found.confidence));
                prop_assert!((0.0..=1.0).contains(&found.leftover));
                prop_assert_eq!(found.missing.is_empty(), found.is_complete());
            }
        }
    }
}
