//! The missing part of an unfinished drawing, filled in from the figure's template for a faint preview.

use glam::Vec2;

use crate::figure::Figure;
use crate::sketch::Sketch;

/// A whole sketch from the joints drawn so far: drawn ones stay where they are, each missing one hangs on the nearest
/// drawn one as the template has it, in the drawing's scale. Missing limbs hang upright whatever the torso does, except
/// that a drawing upside down is completed upside down, and one of a body seen from the side that faces the other way
/// is completed facing that way.
///
/// None when fewer than two joints are drawn at different places (there is no scale yet), or when `placed` is of
/// another figure.
pub fn complete_from_template(figure: &Figure, placed: &[Option<Vec2>]) -> Option<Sketch> {
    if placed.len() != figure.joint_count() {
        return None;
    }
    let to_drawing = drawn_scale(figure, placed)? * turned(figure, placed);
    let mut points = placed.to_vec();
    // Bones form a tree, so one pass per bone reaches every joint.
    for _ in &figure.bones {
        for &[a, b] in &figure.bones {
            for (from, to) in [(a, b), (b, a)] {
                if let (Some(start), None) = (points[from], points[to]) {
                    points[to] =
                        Some(start + (figure.template[to] - figure.template[from]) * to_drawing);
                }
            }
        }
    }
    Sketch::new(figure, points.into_iter().collect::<Option<Vec<_>>>()?).ok()
}

/// Drawing units per metre of the template: from the drawn bones, else from the drawn joints' distance.
fn drawn_scale(figure: &Figure, placed: &[Option<Vec2>]) -> Option<f32> {
    let lengths = |pairs: &mut dyn Iterator<Item = [usize; 2]>| {
        pairs.fold((0.0, 0.0), |(drawn, template), [a, b]| {
            match (placed[a], placed[b]) {
                (Some(start), Some(end)) => (
                    drawn + start.distance(end),
                    template + figure.template[a].distance(figure.template[b]),
                ),
                _ => (drawn, template),
            }
        })
    };
    let (mut drawn, mut template): (f32, f32) = lengths(&mut figure.bones.iter().copied());
    if drawn <= 0.0 {
        let all = (0..placed.len()).flat_map(|a| (a + 1..placed.len()).map(move |b| [a, b]));
        (drawn, template) = lengths(&mut { all });
    }
    let scale = drawn / template;
    (drawn > 0.0 && scale.is_finite()).then_some(scale)
}

/// Which way round the template has to be for what is drawn: 1 or -1 for x and y.
pub(crate) fn turned(figure: &Figure, placed: &[Option<Vec2>]) -> Vec2 {
    let center = (0..placed.len()).filter(|&j| figure.mirror_of(j) == j);
    let drawn: Vec<(Vec2, Vec2)> = center
        .filter_map(|j| Some((placed[j]?, figure.template[j])))
        .collect();
    let (Some(first), Some(last)) = (drawn.first(), drawn.last()) else {
        return Vec2::ONE;
    };
    let here = (last.0 - first.0).normalize_or_zero();
    let there = (last.1 - first.1).normalize_or_zero();
    let about = Vec2::new(-1.0, 1.0);
    // A body that is drawn from the front has nothing to turn about: its middle is upright.
    let facing = if here.dot(there * about) > here.dot(there) + 0.2 {
        about
    } else {
        Vec2::ONE
    };
    // More than 120 degrees away.
    if here.dot(there * facing) < -0.5 {
        -facing
    } else {
        facing
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_head_and_a_torso_make_a_whole_man_of_their_scale() {
        let human = Figure::human();
        let mut placed = vec![None; 11];
        for joint in [0, 1, 2] {
            placed[joint] = Some(human.template[joint] * 300.0 + Vec2::new(50.0, 10.0));
        }
        let sketch = complete_from_template(human, &placed).unwrap();
        for (point, template) in sketch.points().iter().zip(&human.template) {
            assert!(point.distance(*template * 300.0 + Vec2::new(50.0, 10.0)) < 0.1);
        }
        for p in placed.iter_mut().flatten() {
            p.y = -p.y;
        }
        let handstand = complete_from_template(human, &placed).unwrap();
        assert!(handstand.points()[6].y > handstand.points()[0].y);
    }

    #[test]
    fn a_horse_is_completed_the_way_it_faces() {
        let horse = Figure::horse();
        let [forehead, shoulder] = ["forehead", "shoulder"].map(|j| horse.joint_index(j).unwrap());
        for facing in [Vec2::ONE, Vec2::new(-1.0, 1.0)] {
            let whole: Vec<Vec2> = horse.template.iter().map(|p| *p * facing * 200.0).collect();
            let mut placed = vec![None; horse.joint_count()];
            for joint in [forehead, shoulder] {
                placed[joint] = Some(whole[joint]);
            }
            let sketch = complete_from_template(horse, &placed).unwrap();
            for (point, expected) in sketch.points().iter().zip(&whole) {
                assert!(point.distance(*expected) < 0.1, "{facing}: {point}");
            }
            // Lowering the head does not turn it about.
            let down = Vec2::new(0.0, -1.5) * 200.0;
            placed[forehead] = placed[forehead].map(|point| point + down);
            let grazing = complete_from_template(horse, &placed).unwrap();
            let hip = horse.joint_index("hip").unwrap();
            let behind = (grazing.points()[hip] - grazing.points()[shoulder]).x * facing.x;
            assert!(behind < 0.0, "{facing}");
        }
    }

    #[test]
    fn nothing_comes_of_nothing() {
        let human = Figure::human();
        let mut placed = vec![None; 11];
        assert_eq!(complete_from_template(human, &placed), None);
        placed[3] = Some(Vec2::ONE);
        assert_eq!(complete_from_template(human, &placed), None);
        placed[4] = Some(Vec2::ONE);
        assert_eq!(complete_from_template(human, &placed), None);
        assert_eq!(complete_from_template(human, &[]), None);
    }

    proptest! {
        #[test]
        fn what_is_drawn_stays(mask in 0u32..2048, dx in -0.1f32..0.1, dy in -0.1f32..0.1) {
            let human = Figure::human();
            let placed: Vec<Option<Vec2>> = human
                .template
                .iter()
                .enumerate()
                .map(|(j, p)| (mask >> j & 1 == 1).then(|| (*p + Vec2::new(dx * j as f32, dy)) * 200.0))
                .collect();
            let completed = complete_from_template(human, &placed);
            prop_assert_eq!(completed.is_some(), mask.count_ones() >= 2);
            if let Some(sketch) = completed {
                for (point, drawn) in sketch.points().iter().zip(&placed) {
                    prop_assert!(drawn.is_none_or(|d| d == *point));
                }
            }
        }
    }
}
