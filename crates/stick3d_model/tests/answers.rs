//! The bodies that the shipped models give to drawings: they fit the drawing, have whole limbs, and differ in depth.

use std::path::Path;

use glam::{Vec2, Vec3};
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::Sketch;
use stick3d_model::{Alternatives, InferError, Inference, JointMark, MarkedSketch, Model};

fn repository(path: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

fn ready(figure: &Figure) -> Inference {
    let path = repository(&format!("assets/models/{}.stick3d", figure.name));
    let model = Model::load(&path).expect("the shipped model is sound");
    Inference::new(&model).expect("the shipped model runs")
}

/// The sketches of the repository that are of a figure, by name.
fn sketches(figure: &Figure) -> Vec<(String, Sketch)> {
    let files = std::fs::read_dir(repository("assets/sketches")).expect("the folder is there");
    let mut paths: Vec<_> = files
        .map(|file| file.expect("the folder can be read").path())
        .collect();
    paths.sort();
    let read = |path: &std::path::PathBuf| {
        let name = path.file_stem()?.to_string_lossy().into_owned();
        let sketch =
            Sketch::from_json(figure, &std::fs::read(path).expect("the file can be read")).ok()?;
        Some((name, sketch))
    };
    let found: Vec<_> = paths.iter().filter_map(read).collect();
    assert!(found.len() >= 3, "{}: {}", figure.name, found.len());
    found
}

/// Mean distance on the sketch plane after the drawing is moved and scaled onto the joints, share of the figure's size.
fn off_the_drawing(figure: &Figure, drawn: &[Vec2], joints: &[Vec3]) -> f32 {
    let flat: Vec<Vec2> = joints.iter().map(|joint| joint.truncate()).collect();
    let middle = |points: &[Vec2]| points.iter().sum::<Vec2>() / points.len() as f32;
    let (from, to) = (middle(drawn), middle(&flat));
    let along: f32 = drawn
        .iter()
        .zip(&flat)
        .map(|(a, b)| (a - from).dot(b - to))
        .sum();
    let square: f32 = drawn.iter().map(|a| (a - from).length_squared()).sum();
    let pairs = drawn.iter().zip(&flat);
    let sum: f32 = pairs
        .map(|(a, b)| (to + along / square * (a - from)).distance(*b))
        .sum();
    sum / flat.len() as f32 / figure.template_extent_m()
}

fn lengths(figure: &Figure, joints: &[Vec3]) -> Vec<f32> {
    figure
        .bones
        .iter()
        .map(|&[a, b]| joints[a].distance(joints[b]))
        .collect()
}

#[test]
fn answers_are_ranked_and_nearer_to_the_drawing_than_the_network_alone() {
    for figure in Figure::shipped() {
        let mut inference = ready(figure);
        let mut answers = Alternatives::default();
        let mut latent = vec![0.0; inference.latent_len()];
        let mut joints = vec![Vec3::ZERO; figure.joint_count()];
        let (mut refined, mut plain) = (0.0, 0.0);
        for (name, sketch) in sketches(figure) {
            inference.infer(&sketch, &mut answers).unwrap();
            let list = answers.as_slice();
            assert!(
                (2..=Alternatives::MOST).contains(&list.len()),
                "{name}: {}",
                list.len()
            );
            let sum: f32 = list.iter().map(|answer| answer.probability).sum();
            assert!((sum - 1.0).abs() < 1e-3, "{name}: {sum}");
            assert!(
                list.is_sorted_by(|a, b| a.probability >= b.probability),
                "{name}"
            );
            inference.encode(&sketch, &mut latent).unwrap();
            assert_eq!(list[0].latent, latent);
            inference.joints(&latent, &mut joints).unwrap();
            assert_eq!(list[0].joints, joints);
            refined += off_the_drawing(figure, sketch.points(), &joints);
            inference.encode_plain(&sketch, &mut latent).unwrap();
            inference.joints(&latent, &mut joints).unwrap();
            plain += off_the_drawing(figure, sketch.points(), &joints);
        }
        assert!(refined < 0.7 * plain, "{}: {refined} {plain}", figure.name);
    }
}

#[test]
fn the_size_and_place_of_a_drawing_change_nothing() {
    let human = Figure::human();
    let mut inference = ready(human);
    let (mut answers, mut others) = (Alternatives::default(), Alternatives::default());
    for (name, sketch) in sketches(human) {
        let points = sketch
            .points()
            .iter()
            .map(|p| 310.0 * *p + Vec2::new(700.0, -90.0));
        let moved = Sketch::new(human, points.collect()).unwrap();
        inference.infer(&sketch, &mut answers).unwrap();
        inference.infer(&moved, &mut others).unwrap();
        let (a, b) = (answers.first().unwrap(), others.first().unwrap());
        assert!(a.distance_m(b) < 0.01, "{name}: {}", a.distance_m(b));
    }
}

#[test]
fn a_limb_drawn_too_long_bends_the_answer_and_leaves_its_bones() {
    let human = Figure::human();
    let mut inference = ready(human);
    let mut answers = Alternatives::default();
    let [elbow, hand] = ["elbow_r", "hand_r"].map(|name| human.joint_index(name).unwrap());
    for (name, sketch) in sketches(human) {
        inference.infer(&sketch, &mut answers).unwrap();
        let before = lengths(human, &answers.first().unwrap().joints);
        let mut points = sketch.points().to_vec();
        points[hand] = points[elbow] + 1.5 * (points[hand] - points[elbow]);
        let longer = Sketch::new(human, points).unwrap();
        inference.infer(&longer, &mut answers).unwrap();
        let after = lengths(human, &answers.first().unwrap().joints);
        for (before, after) in before.iter().zip(&after) {
            // The abdomen is no hip: from it to a knee is less when the leg is bent.
            assert!(
                (after / before - 1.0).abs() < 0.3,
                "{name}: {before} {after}"
            );
        }
    }
}

#[test]
fn a_flipped_limb_points_the_other_way_and_stays_on_the_drawing() {
    for figure in Figure::shipped() {
        let mut inference = ready(figure);
        let mut answers = Alternatives::default();
        let mut joints = vec![Vec3::ZERO; figure.joint_count()];
        let (mut tried, mut turned) = (0, 0);
        for (_, sketch) in sketches(figure) {
            inference.infer(&sketch, &mut answers).unwrap();
            let first = answers.first().unwrap();
            for limb in figure.limbs() {
                let depth = first.toward_viewer_m(&limb);
                if depth.abs() < 0.1 {
                    continue;
                }
                let mut flipped = vec![0.0; first.latent.len()];
                inference
                    .flip_limb(&sketch, &first.latent, &limb, &mut flipped)
                    .unwrap();
                inference.joints(&flipped, &mut joints).unwrap();
                let now = joints[limb.end()].z - joints[limb.base].z;
                tried += 1;
                let is_on_drawing = off_the_drawing(figure, sketch.points(), &joints) < 0.03;
                turned += usize::from(now * depth < 0.0 && is_on_drawing);
            }
        }
        println!("{}: {turned} of {tried} limbs flipped", figure.name);
        // Not every limb can: a knee does not bend forward.
        assert!(
            tried >= 5 && 10 * turned >= 6 * tried,
            "{}: {turned} of {tried}",
            figure.name
        );
    }
}

/// The first answer to a sketch of which some joints are marked.
fn marked(
    inference: &mut Inference,
    sketch: &Sketch,
    joints: &[usize],
    mark: JointMark,
) -> Vec<Vec3> {
    let mut marks = vec![JointMark::Drawn; sketch.points().len()];
    joints.iter().for_each(|joint| marks[*joint] = mark);
    let marks = &marks;
    let mut answers = Alternatives::default();
    inference
        .infer(MarkedSketch { sketch, marks }, &mut answers)
        .expect("the sketch is sound");
    answers.first().expect("there is an answer").joints.clone()
}

#[test]
fn a_limb_that_was_not_drawn_says_nothing_and_a_pinned_joint_holds_the_body() {
    let human = Figure::human();
    let mut inference = ready(human);
    let hand = human.joint_index("hand_l").unwrap();
    let limb = human
        .limbs()
        .into_iter()
        .find(|limb| limb.joints.contains(&hand))
        .unwrap();
    let (mut drawn_off, mut guessed_off, mut pinned_off) = (0.0, 0.0, 0.0);
    for (_, sketch) in sketches(human) {
        // Where the limb stands is impossible: three times as long, straight up.
        let mut points = sketch.points().to_vec();
        let size = sketch.scale(human);
        for (step, joint) in limb.joints.iter().enumerate() {
            points[*joint] = points[limb.base] + Vec2::Y * (3.0 + 2.0 * step as f32) * size;
        }
        let wrong = Sketch::new(human, points).unwrap();
        // How far the joints of the rest are off what was drawn of them.
        let rest: Vec<usize> = (0..human.joint_count())
            .filter(|joint| !limb.joints.contains(joint))
            .collect();
        let of_rest = |joints: &[Vec3]| -> f32 {
            let drawn: Vec<Vec2> = rest.iter().map(|joint| sketch.points()[*joint]).collect();
            let found: Vec<Vec3> = rest.iter().map(|joint| joints[*joint]).collect();
            off_the_drawing(human, &drawn, &found)
        };
        let drawn = of_rest(&marked(&mut inference, &wrong, &[], JointMark::Drawn));
        let guessed = of_rest(&marked(
            &mut inference,
            &wrong,
            &limb.joints,
            JointMark::Guessed,
        ));
        assert!(guessed < drawn, "{guessed} {drawn}");
        drawn_off += drawn;
        guessed_off += guessed;
        // A crooked drawing whose hand is meant: the other arm is drawn far too long.
        let mut points = sketch.points().to_vec();
        let other = human.mirror_of(hand);
        points[other] += 0.8 * size * Vec2::X;
        let crooked = Sketch::new(human, points).unwrap();
        let hold = |joints: &[Vec3]| -> f32 {
            let drawn: Vec<Vec2> = crooked.points().to_vec();
            let flat: Vec<Vec2> = joints.iter().map(|joint| joint.truncate()).collect();
            let (a, b) = (human.root, hand);
            let (from, to) = (drawn[b] - drawn[a], flat[b] - flat[a]);
            from.angle_to(to).abs()
        };
        let free = hold(&marked(&mut inference, &crooked, &[], JointMark::Drawn));
        let held = hold(&marked(
            &mut inference,
            &crooked,
            &[human.root, hand],
            JointMark::Pinned,
        ));
        pinned_off += held - free;
    }
    assert!(guessed_off < 0.85 * drawn_off, "{guessed_off} {drawn_off}");
    assert!(pinned_off < 0.0, "{pinned_off}");
    let sketch = Sketch::template(human);
    let marks = &[JointMark::Drawn; 3];
    let sketch = MarkedSketch {
        sketch: &sketch,
        marks,
    };
    let refused = inference.infer(sketch, &mut Alternatives::default());
    assert!(
        matches!(refused, Err(InferError::Length { found: 3, .. })),
        "{refused:?}"
    );
}
