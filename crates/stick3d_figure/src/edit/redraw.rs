//! A limb of a finished sketch drawn anew, by one stroke.

use glam::Vec2;

use super::drag::bone_lengths;
use super::reach::tree;
use crate::figure::Figure;
use crate::sketch::Sketch;
use crate::stroke::Stroke;

/// How far from its joint a limb may begin, in parts of the sketch's extent.
const BEGINNING: f32 = 0.08;
/// By which factor a limb may be longer or shorter than before.
const MAX_RATIO: f32 = 1.8;
/// What the factor's logarithm costs, and a new end far from the old one, in parts of the extent.
const RATIO_COST: f32 = 0.2;
const END_COST: f32 = 0.15;
/// What it costs to take a stroke for the first bones of a limb alone.
const BEGUN_COST: f32 = 0.05;
/// A stroke that bends away from its chord by this part of its length has a corner there.
const CORNER: f32 = 0.1;

/// Bones one after the other that a stroke may stand for, from where they hang outwards.
struct Run {
    from: usize,
    joints: Vec<usize>,
}

/// The sketch with a limb, or the outer part of one, where the stroke has it. The stroke begins or ends where the limb
/// hangs, and is about as long as the limb was; of two limbs that hang there it is the one that ends nearer. What hangs
/// on the limb's end comes along. None when the stroke is no such limb.
pub fn redrawn(figure: &Figure, sketch: &Sketch, stroke: &Stroke) -> Option<Sketch> {
    let points = sketch.points();
    if points.len() != figure.joint_count() {
        return None;
    }
    let drawn: Vec<Vec2> = stroke.positions().collect();
    let backwards: Vec<Vec2> = stroke.positions().rev().collect();
    let length = stroke.length_px();
    let extent = extent(points);
    let lengths = bone_lengths(figure, points);
    let (above, order) = tree(figure, |bone| lengths[bone]);
    let above_of = |joint: usize| above.get(joint).copied().flatten();
    let mut best: Option<(f32, Run, &[Vec2])> = None;
    for line in [&drawn, &backwards] {
        let (Some(begin), Some(end)) = (line.first(), line.last()) else {
            continue;
        };
        for run in runs(figure, &order, above_of) {
            let last = run.joints.last().copied().unwrap_or(run.from);
            let bones = run.joints.iter().filter_map(|&joint| above_of(joint));
            let before: f32 = bones.map(|(_, length)| length).sum();
            let ratio = (length / before.max(f32::MIN_POSITIVE)).ln().abs();
            let beside = begin.distance(points[run.from]) / extent;
            if beside > BEGINNING || ratio > MAX_RATIO.ln() {
                continue;
            }
            let moved = end.distance(points[last]) / extent;
            let is_begun = figure.bones_at(last) > 1;
            let begun = if is_begun { BEGUN_COST } else { 0.0 };
            let cost = beside + RATIO_COST * ratio + END_COST * moved + begun;
            if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                best = Some((cost, run, line));
            }
        }
    }
    let (_, run, line) = best?;
    let mut moved = points.to_vec();
    let shares: Vec<f32> = run
        .joints
        .iter()
        .filter_map(|&joint| above_of(joint))
        .map(|(_, length)| length)
        .collect();
    for (joint, place) in run.joints.iter().zip(places(line, &shares)) {
        moved[*joint] = place;
    }
    let last = run.joints.last().copied()?;
    let mut along = vec![last];
    for joint in order {
        if let Some((from, _)) = above_of(joint)
            && along.contains(&from)
        {
            along.push(joint);
            moved[joint] = points[joint] + moved[last] - points[last];
        }
    }
    Sketch::new(figure, moved).ok()
}

/// All runs of bones that no other bones hang on but at their ends, the trunk left out.
fn runs(
    figure: &Figure,
    order: &[usize],
    above: impl Fn(usize) -> Option<(usize, f32)>,
) -> Vec<Run> {
    let mut runs = Vec::new();
    for &end in order.iter().filter(|&&end| figure.bones_at(end) <= 2) {
        let mut joints = vec![end];
        let mut at = end;
        while let Some((from, _)) = above(at) {
            let ordered = joints.iter().rev().copied().collect();
            runs.push(Run {
                from,
                joints: ordered,
            });
            if figure.bones_at(from) > 2 {
                break;
            }
            joints.push(from);
            at = from;
        }
    }
    runs
}

/// Where bones of these lengths end along a line: at its corner where two bones have one, else by their lengths.
fn places(line: &[Vec2], lengths: &[f32]) -> Vec<Vec2> {
    let (Some(&begin), Some(&end)) = (line.first(), line.last()) else {
        return Vec::new();
    };
    let whole: f32 = line.windows(2).map(|two| two[0].distance(two[1])).sum();
    if lengths.len() == 2 {
        let out = |point: &Vec2| super::distance_to_line(*point, begin, end);
        let corner = line.iter().max_by(|a, b| out(a).total_cmp(&out(b)));
        if let Some(corner) = corner.filter(|corner| out(corner) > CORNER * whole) {
            return vec![*corner, end];
        }
    }
    let all: f32 = lengths.iter().sum();
    let mut share = 0.0;
    let mut places: Vec<Vec2> = lengths
        .iter()
        .map(|length| {
            share += length / all.max(f32::MIN_POSITIVE);
            along(line, share * whole)
        })
        .collect();
    if let Some(last) = places.last_mut() {
        *last = end;
    }
    places
}

/// The place on a line so far from its beginning.
fn along(line: &[Vec2], mut way: f32) -> Vec2 {
    for two in line.windows(2) {
        let length = two[0].distance(two[1]);
        if way <= length && length > 0.0 {
            return two[0].lerp(two[1], way / length);
        }
        way -= length;
    }
    line.last().copied().unwrap_or_default()
}

fn extent(points: &[Vec2]) -> f32 {
    let low = points.iter().copied().reduce(Vec2::min).unwrap_or_default();
    let high = points.iter().copied().reduce(Vec2::max).unwrap_or_default();
    low.distance(high).max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_and_a_forearm_are_drawn_anew() {
        let human = Figure::human();
        let points: Vec<Vec2> = human.template.iter().map(|p| *p * 300.0).collect();
        let sketch = Sketch::new(human, points.clone()).unwrap();
        let [neck, elbow, hand] =
            ["neck", "elbow_l", "hand_l"].map(|name| human.joint_index(name).unwrap());
        let up = [Vec2::ZERO, Vec2::new(90.0, 20.0), Vec2::new(80.0, 130.0)];
        let arm = up.map(|by| points[neck] + by);
        for line in [arm, [arm[2], arm[1], arm[0]]] {
            let moved = redrawn(human, &sketch, &Stroke::from_positions(line).unwrap()).unwrap();
            assert!(moved.points()[elbow].distance(arm[1]) < 1.0);
            assert!(moved.points()[hand].distance(arm[2]) < 1.0);
            let others = (0..11).filter(|joint| ![elbow, hand].contains(joint));
            for joint in others {
                assert_eq!(moved.points()[joint], points[joint]);
            }
        }
        let forearm = [points[elbow], points[elbow] + Vec2::new(70.0, 20.0)];
        let moved = redrawn(human, &sketch, &Stroke::from_positions(forearm).unwrap()).unwrap();
        assert_eq!(moved.points()[elbow], points[elbow]);
        assert!(moved.points()[hand].distance(forearm[1]) < 1.0);
    }

    #[test]
    fn other_strokes_are_no_limbs() {
        let human = Figure::human();
        let points: Vec<Vec2> = human.template.iter().map(|p| *p * 300.0).collect();
        let sketch = Sketch::new(human, points.clone()).unwrap();
        let neck = points[human.joint_index("neck").unwrap()];
        for line in [
            [Vec2::new(400.0, 0.0), Vec2::new(400.0, 120.0)],
            [neck, neck + Vec2::X * 2000.0],
            [neck, neck + Vec2::X * 9.0],
        ] {
            let stroke = Stroke::from_positions(line).unwrap();
            assert_eq!(redrawn(human, &sketch, &stroke), None, "{line:?}");
        }
    }
}
