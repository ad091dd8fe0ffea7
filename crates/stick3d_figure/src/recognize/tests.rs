//! Drawings of random poses must be recovered, in every style, size and sampling.

use proptest::prelude::*;

use super::*;
use crate::simulate::guided::{self, STYLES, Style};
use crate::simulate::subjects::{HORSE, HUMAN, Subject};
use crate::simulate::{self, Hand};

/// A simulated drawing: what was meant, how the path was cut into strokes, the strokes.
struct Drawing {
    meant: Vec<Vec2>,
    cuts: Vec<(usize, usize)>,
    strokes: Vec<Stroke>,
}

fn drawing(seed: u64, style: Style, hand: Hand, clear: bool) -> Drawing {
    drawing_of(HUMAN, seed, style, hand, clear)
}

fn drawing_of(subject: Subject, seed: u64, style: Style, hand: Hand, clear: bool) -> Drawing {
    let figure = (subject.figure)();
    let mut rng = simulate::rng(seed);
    let pose = if clear {
        (subject.clear_pose)(&mut rng)
    } else {
        (subject.pose)(&mut rng)
    };
    let meant = simulate::on_canvas(&pose, hand.height_px);
    let cuts = guided::cuts(figure, &mut rng, style);
    let strokes = guided::draw(figure, &mut rng, &meant, &cuts, hand);
    Drawing {
        meant,
        cuts,
        strokes,
    }
}

/// Distances between recognised and meant joints, in parts of the body height.
fn errors(drawing: &Drawing, height_px: f32) -> Vec<f32> {
    errors_of(HUMAN, drawing, height_px)
}

fn errors_of(subject: Subject, drawing: &Drawing, height_px: f32) -> Vec<f32> {
    let sketch = recognize((subject.figure)(), &drawing.strokes).unwrap();
    let pairs = sketch.points().iter().zip(&drawing.meant);
    pairs.map(|(a, b)| a.distance(*b) / height_px).collect()
}

fn largest(values: &[f32]) -> f32 {
    values.iter().copied().fold(0.0, f32::max)
}

/// Any pose at all, also those that can be read in several ways (a limb drawn straight hides its elbow, an arm
/// folded flat may be an arm drawn back): nearly all must be right, none far off.
#[test]
fn any_pose_is_recovered_in_every_style() {
    for subject in [HUMAN, HORSE] {
        any_pose_of(subject);
    }
}

fn any_pose_of(subject: Subject) {
    let hand = Hand::default();
    let figure = (subject.figure)();
    let name = &figure.name;
    // Errors are in parts of a height of 1.8 m; a horse is longer than that.
    let xs = || figure.template.iter().map(|point| point.x);
    let width_m = xs().fold(f32::MIN, f32::max) - xs().fold(f32::MAX, f32::min);
    let mean_limit = 0.015 * (width_m / 1.8).max(1.0);
    for style in STYLES {
        let count = 120;
        let (mut good, mut fair) = (0, 0);
        let mut sum = 0.0;
        for seed in 0..count {
            let drawing = drawing_of(subject, seed, style, hand, false);
            let errors = errors_of(subject, &drawing, hand.height_px);
            good += u32::from(largest(&errors) < 0.06);
            fair += u32::from(largest(&errors) < 0.1);
            sum += errors.iter().sum::<f32>() / errors.len() as f32;
            assert!(
                largest(&errors) < 0.25,
                "{name} {style:?} {seed}: {errors:?}"
            );
        }
        let mean = sum / count as f32;
        assert!(
            good * 100 >= 85 * count as u32,
            "{name} {style:?}: only {good} of {count} are good"
        );
        assert!(
            fair * 100 >= 97 * count as u32,
            "{name} {style:?}: only {fair} of {count} are fair"
        );
        assert!(mean < mean_limit, "{name} {style:?}: mean error {mean}");
    }
}

fn styles() -> impl Strategy<Value = Style> {
    prop::sample::select(STYLES.to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn a_clear_drawing_is_recovered_at_every_size_and_sampling(
        seed in any::<u64>(),
        style in styles(),
        height_px in 150.0f32..1200.0,
        spacing_px in 0.7f32..10.0,
        jitter in 0.0f32..1.0,
        subject in prop::sample::select(vec![HUMAN, HORSE]),
    ) {
        let hand = Hand {
            height_px,
            spacing_px,
            // A hand shakes by some pixels, however big the drawing.
            jitter_px: jitter * 3.0_f32.min(0.006 * height_px),
            aim_px: 0.015 * height_px,
            ..Hand::default()
        };
        let drawing = drawing_of(subject, seed, style, hand, true);
        let errors = errors_of(subject, &drawing, height_px);
        prop_assert!(largest(&errors) < 0.12, "{:?}", errors);
        prop_assert!(progress((subject.figure)(), &drawing.strokes, Pen::Up).complete);
    }

    #[test]
    fn the_unit_does_not_matter(seed in 0u64..1000, style in styles()) {
        let hand = Hand { jitter_px: 1.0, ..Hand::default() };
        let in_pixels = drawing(seed, style, hand, true);
        let in_metres: Vec<Stroke> = in_pixels
            .strokes
            .iter()
            .map(|s| Stroke::from_positions(s.positions().map(|p| p / 250.0)).unwrap())
            .collect();
        let sketch = recognize(Figure::human(), &in_metres).unwrap();
        for (a, b) in sketch.points().iter().zip(&in_pixels.meant) {
            prop_assert!((*a * 250.0).distance(*b) < 0.12 * hand.height_px);
        }
    }

    #[test]
    fn anything_drawn_is_answered(
        strokes in prop::collection::vec(
            prop::collection::vec((-1.0e6f32..1.0e6, -1.0e6f32..1.0e6), 0..40), 0..12),
        coarse in 1.0f32..1.0e6,
    ) {
        // Coarse grids make points, strokes and whole drawings coincide.
        let strokes: Vec<Stroke> = strokes
            .into_iter()
            .map(|s| s.into_iter().map(|p| (Vec2::from(p) / coarse).round() * coarse))
            .map(|s| Stroke::from_positions(s.map(|p| p.clamp(Vec2::splat(-1.0e6), Vec2::splat(1.0e6)))))
            .collect::<Result<_, _>>()
            .unwrap();
        let human = Figure::human();
        if let Ok(sketch) = recognize(human, &strokes) {
            prop_assert!(sketch.input_vector(human).unwrap().iter().all(|v| v.is_finite()));
        }
        for pen in [Pen::Up, Pen::Down] {
            let progress = progress(human, &strokes, pen);
            prop_assert!((0.0..=1.0).contains(&progress.fraction));
            prop_assert_eq!(progress.complete, progress.next_joint.is_none());
        }
    }
}

#[test]
fn elbows_of_straight_arms_are_put_where_the_template_has_them() {
    let human = Figure::human();
    let mut joints = human.template.clone();
    // A T-pose: both arms one straight line through the neck.
    for (side, elbow, hand) in [(-1.0, 3, 4), (1.0, 7, 8)] {
        joints[elbow] = Vec2::new(side * 0.45, 1.5);
        joints[hand] = Vec2::new(side * 0.78, 1.5);
    }
    let meant = simulate::on_canvas(&joints, 450.0);
    for style in STYLES {
        for seed in 0..10 {
            let mut rng = simulate::rng(seed);
            let cuts = guided::cuts(human, &mut rng, style);
            let strokes = guided::draw(human, &mut rng, &meant, &cuts, Hand::default());
            let errors = errors(
                &Drawing {
                    meant: meant.clone(),
                    cuts,
                    strokes,
                },
                450.0,
            );
            assert!(largest(&errors) < 0.09, "{style:?} {seed}: {errors:?}");
        }
    }
}

#[test]
fn progress_follows_the_strokes() {
    let human = Figure::human();
    for style in STYLES {
        let (mut count, mut next_right, mut false_complete) = (0, 0, 0);
        let (mut drawn, mut incomplete, mut fraction_right) = (0, 0, 0);
        for seed in 0..30 {
            let Drawing { cuts, strokes, .. } = drawing(seed, style, Hand::default(), false);
            for n in 1..=strokes.len() {
                let up = progress(human, &strokes[..n], Pen::Up);
                if n == strokes.len() {
                    incomplete += u32::from(!up.complete);
                } else {
                    count += 1;
                    false_complete += u32::from(up.complete);
                    let end = cuts[n - 1].1;
                    let next = human.path[end + 1..]
                        .iter()
                        .find(|j| !human.path[..=end].contains(j));
                    next_right += u32::from(up.next_joint == next.copied());
                }
                // The same stroke when two thirds of it were drawn.
                let (from, to) = cuts[n - 1];
                let points = strokes[n - 1].points();
                let part = Stroke::new(points[..points.len() * 2 / 3].iter().copied()).unwrap();
                let so_far: Vec<Stroke> = strokes[..n - 1].iter().cloned().chain([part]).collect();
                let down = progress(human, &so_far, Pen::Down);
                let exact = (from as f32 + (to - from) as f32 * 2.0 / 3.0) / 16.0;
                drawn += 1;
                fraction_right += u32::from((down.fraction - exact).abs() < 0.08);
            }
        }
        assert!(
            incomplete <= 1,
            "{style:?}: {incomplete} of 30 were not seen to be complete"
        );
        assert!(
            false_complete * 20 <= count,
            "{style:?}: {false_complete} of {count} early"
        );
        assert!(
            next_right * 5 >= count * 4,
            "{style:?}: next joint right in {next_right} of {count}"
        );
        assert!(
            fraction_right * 20 >= drawn * 17,
            "{style:?}: {fraction_right} of {drawn} fractions"
        );
    }
}

#[test]
fn too_little_ink_is_told_with_the_next_joint() {
    let human = Figure::human();
    assert_eq!(
        recognize(human, &[]),
        Err(RecognizeError::Empty { strokes: 0 })
    );
    let dot = Stroke::from_positions([Vec2::ONE; 5]).unwrap();
    assert_eq!(
        recognize(human, &[dot]),
        Err(RecognizeError::Empty { strokes: 1 })
    );
    let head = Stroke::from_positions([Vec2::new(0.0, 500.0), Vec2::new(0.0, 440.0)]).unwrap();
    let message = recognize(human, std::slice::from_ref(&head))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("next joint to draw is \"elbow_r\""),
        "{message}"
    );
    let progress = progress(human, std::slice::from_ref(&head), Pen::Up);
    assert_eq!(progress.placed[0], Some(Vec2::new(0.0, 500.0)));
    assert_eq!(progress.placed.iter().flatten().count(), 2);
    let many = vec![head; MAX_STROKES + 1];
    assert!(matches!(
        recognize(human, &many),
        Err(RecognizeError::TooManyStrokes { .. })
    ));
}

#[test]
fn the_work_is_bounded_whatever_the_sampling() {
    let hand = Hand {
        spacing_px: 0.02,
        ..Hand::default()
    };
    let drawing = drawing(1, Style::OneLine, hand, false);
    assert!(drawing.strokes[0].points().len() > 50_000);
    assert!(Ink::new(&drawing.strokes).unwrap().samples.len() < 200);
}

#[test]
fn bulging_bones_are_bones_still() {
    for style in STYLES {
        let hand = Hand {
            bow: 0.1,
            ..Hand::default()
        };
        let fair = (0..60)
            .filter(|&seed| {
                largest(&errors(&drawing(seed, style, hand, true), hand.height_px)) < 0.12
            })
            .count();
        assert!(fair >= 57, "{style:?}: {fair} of 60");
    }
}

#[test]
fn strokes_after_the_end_are_told_and_looked_past() {
    let human = Figure::human();
    // Sixteen strokes use up all steps of the path.
    let style = Style::StrokePerBoneWithRetraces;
    let mut strokes = drawing(3, style, Hand::default(), true).strokes;
    let placed = progress(human, &strokes, Pen::Up).placed;
    let x = [
        Vec2::new(100.0, 100.0),
        Vec2::new(700.0, 700.0),
        Vec2::new(100.0, 700.0),
    ];
    strokes.extend((0..2).map(|_| Stroke::from_positions(x).unwrap()));
    for pen in [Pen::Up, Pen::Down] {
        let progress = progress(human, &strokes, pen);
        assert!(progress.complete);
        assert_eq!(progress.placed, placed);
    }
    let many = [strokes.clone(), strokes].concat();
    assert!(matches!(
        recognize(human, &many),
        Err(RecognizeError::Surplus { .. })
    ));
}
