//! Reading a drawing of which nobody said in what order it was drawn: as one that follows the sketch path, or in any
//! order, whichever is likelier.

use glam::Vec2;

use super::any_order::cost::{LONGER_SPREAD, MAX_LENGTH_COST, SHORTER_SPREAD};
use super::any_order::{recognize_any, sides};
use super::coverage::EvenInk;
use super::{Pen, Progress, RecognizeError, begun, progress, recognize};
use crate::figure::{Figure, Side};
use crate::sketch::Sketch;
use crate::stroke::{Stroke, bounds_px};

/// Logarithm by which figures differ from the size that is usual on their canvas.
const SIZE_SPREAD: f32 = 0.3;
/// What a bone costs that points against its direction in the template: in the middle of the body, and elsewhere.
const CENTER_COST: f32 = 1.5;
const SIDE_COST: f32 = 0.5;
/// How much dearer the reading along the path may be before it is given up for another one: who draws along the path
/// by chance draws few likely bones.
const PATH_BONUS: f32 = 0.5;
/// Readings less sure than this are no ground to show a body on.
const SURE: f32 = 0.6;
/// A stroke that lowers a drawing's cost by more than this belongs to it.
const COMPLETING: f32 = 4.0;
/// With more unexplained ink than this share, a drawing is not finished.
const MAX_LEFTOVER: f32 = 0.25;

/// What finished strokes show, in whatever order they were drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeReading {
    /// Where the joints are, and what comes next.
    pub progress: Progress,
    /// Whether the strokes were read along the sketch path.
    pub along_path: bool,
    /// Whether no other reading is about as likely. Exchanged limbs of a pair are no other reading.
    pub is_sure: bool,
}

/// What finished strokes show, in whatever order they were drawn: along the figure's sketch path as [`progress`] reads
/// it, or in any order as [`recognize_any`] does, whichever is likelier.
///
/// `usual_scale` is how large figures are usually drawn, canvas units per metre of the template: it tells a head from a
/// torso while there is but one line. Left and right are those of [`recognize_any`]'s rule, however it is read; where
/// two limbs lie too close together for it, those of the path. A pair may be exchanged with
/// [`swap_pair`](crate::edit::swap_pair).
///
/// Its work is bounded, also for what is no figure: made for every time the pen lifts, not for every frame.
pub fn read_freely(figure: &Figure, strokes: &[Stroke], usual_scale: f32) -> FreeReading {
    let ink = EvenInk::of(strokes);
    let mut reading = as_it_looks(figure, strokes, &ink, usual_scale);
    if begun::shorten(figure, strokes, usual_scale, &mut reading.progress.placed) {
        reading.progress = progress_of(figure, reading.progress.placed, false);
    }
    if reading.progress.complete && ink.misses_a_bone(figure, &reading.progress.placed) {
        reading.progress.complete = false;
    }
    reading
}

/// The sketch that finished strokes show: along the figure's sketch path, which says which limb is which, or in any order,
/// if that is likelier; left and right are then those of [`recognize_any`]'s rule.
///
/// # Errors
/// As [`recognize`], where neither reading has all joints.
pub fn recognize_finished(figure: &Figure, strokes: &[Stroke]) -> Result<Sketch, RecognizeError> {
    let extent = |(low, high): (Vec2, Vec2)| (high - low).max_element();
    let scale = bounds_px(strokes).map_or(1.0, extent) / figure.template_extent_m();
    let found = as_it_looks(figure, strokes, &EvenInk::of(strokes), scale);
    let joints: Option<Vec<Vec2>> = found.progress.placed.into_iter().collect();
    match joints.filter(|_| !found.along_path && found.progress.complete) {
        Some(joints) => Ok(Sketch::new(figure, joints)?),
        None => recognize(figure, strokes),
    }
}

/// Whether a drawing in any order is by far likelier with one more stroke than without it: it only looked finished before.
/// (What the pen draws when it drags a joint of a finished drawing makes it less likely, or hardly likelier.)
pub fn completes(figure: &Figure, strokes: &[Stroke], more: &Stroke) -> bool {
    let cost = |strokes: &[Stroke]| recognize_any(figure, strokes).map(|found| found.cost);
    let all = [strokes, std::slice::from_ref(more)].concat();
    match (cost(strokes), cost(&all)) {
        (Ok(without), Ok(with)) => with + COMPLETING < without,
        _ => false,
    }
}

/// The reading in which limbs are whole that may as well be half drawn.
fn as_it_looks(
    figure: &Figure,
    strokes: &[Stroke],
    ink: &EvenInk,
    usual_scale: f32,
) -> FreeReading {
    let along_path = progress(figure, strokes, Pen::Up);
    let Ok(any) = recognize_any(figure, strokes) else {
        return FreeReading {
            progress: along_path,
            along_path: true,
            is_sure: true,
        };
    };
    let along_path_cost = ink.cost_beyond(ink.left_over(figure, &along_path.placed))
        + ink.cost_without(figure, &along_path.placed)
        + shape_cost(figure, &along_path.placed, usual_scale);
    let any_cost = ink.cost_beyond(any.leftover) + shape_cost(figure, &any.joints, usual_scale);
    if along_path_cost <= any_cost + PATH_BONUS {
        let mut progress = along_path;
        put_on_sides(figure, &mut progress.placed);
        return FreeReading {
            progress,
            along_path: true,
            is_sure: true,
        };
    }
    FreeReading {
        is_sure: any.confidence >= SURE,
        progress: progress_of(figure, any.joints, any.leftover <= MAX_LEFTOVER),
        along_path: false,
    }
}

/// As the rule has it; limbs that it cannot tell apart stay as they were drawn.
fn put_on_sides(figure: &Figure, placed: &mut [Option<Vec2>]) {
    let drawn = placed.to_vec();
    for pair in sides::put_on_sides(figure, placed) {
        for &joint in pair.left.iter().chain(&pair.right) {
            placed[joint] = drawn[joint];
        }
    }
}

/// How far a drawing has come that does not follow the path.
fn progress_of(figure: &Figure, placed: Vec<Option<Vec2>>, is_clear: bool) -> Progress {
    let drawn = |bone: usize| {
        figure.bones[bone]
            .iter()
            .all(|&joint| placed[joint].is_some())
    };
    let length = |bones: &mut dyn Iterator<Item = usize>| -> f32 {
        bones.map(|bone| figure.template_bone_length(bone)).sum()
    };
    let all = 0..figure.bones.len();
    let fraction = length(&mut all.clone().filter(|&bone| drawn(bone))) / length(&mut all.clone());
    let path = &figure.path;
    let next = path.iter().position(|&joint| placed[joint].is_none());
    Progress {
        next_joint: next.map(|next| path[next]),
        from_joint: next.and_then(|next| Some(path[next.checked_sub(1)?])),
        fraction: fraction.clamp(0.0, 1.0),
        complete: is_clear && next.is_none(),
        placed,
    }
}

/// How unlikely it is that a figure was meant so large, so proportioned and so directed.
fn shape_cost(figure: &Figure, placed: &[Option<Vec2>], usual_scale: f32) -> f32 {
    let drawn: Vec<(usize, Vec2, Vec2)> = (0..figure.bones.len())
        .filter_map(|bone| {
            let [a, b] = figure.bones[bone];
            let here = placed[b]? - placed[a]?;
            Some((bone, here, figure.template[b] - figure.template[a]))
        })
        .collect();
    let (here, there) = drawn.iter().fold((0.0, 0.0), |sum, (_, here, there)| {
        (sum.0 + here.length(), sum.1 + there.length())
    });
    if here <= 0.0 {
        return 0.0;
    }
    let scale = here / there;
    let size = (scale / usual_scale).max(1.0e-3).ln() / SIZE_SPREAD;
    let lengths: f32 = drawn
        .iter()
        .map(|(_, here, there)| {
            let ratio = (here.length() / (scale * there.length())).max(1.0e-3).ln();
            let spread = if ratio > 0.0 {
                LONGER_SPREAD
            } else {
                SHORTER_SPREAD
            };
            (0.5 * (ratio / spread).powi(2)).min(MAX_LENGTH_COST)
        })
        .sum();
    let directions = |facing: f32| -> f32 {
        let cost = |(bone, here, there): &(usize, Vec2, Vec2)| {
            let is_center = |joint: &usize| figure.joints[*joint].side == Side::Center;
            let weight = match figure.bones[*bone].iter().all(is_center) {
                true => CENTER_COST,
                false => SIDE_COST,
            };
            let there = *there * Vec2::new(facing, 1.0);
            weight * (1.0 - here.normalize_or_zero().dot(there.normalize_or_zero()))
        };
        drawn.iter().map(cost).sum()
    };
    let directions = match figure.views.both_ways {
        true => directions(1.0).min(directions(-1.0)),
        false => directions(1.0),
    };
    0.5 * size * size + lengths + directions
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::any_order::{self, Habits, flat_pose, is_readable};
    use crate::simulate::guided::{self, STYLES};
    use crate::simulate::subjects::{HORSE, HUMAN};
    use crate::simulate::{self, Hand};

    const HEIGHT_PX: f32 = 500.0;

    /// Canvas units per metre of figures that are drawn as large as in these tests.
    fn usual_scale(figure: &Figure) -> f32 {
        HEIGHT_PX / figure.template_extent_m()
    }

    /// Whether all joints are where they are meant, the limbs of pairs put as they fit best.
    fn is_right(figure: &Figure, placed: &[Option<Vec2>], meant: &[Vec2]) -> bool {
        let away = |joint: usize, meant: &[Vec2]| {
            placed[joint].map_or(f32::INFINITY, |place| place.distance(meant[joint]))
        };
        let mut meant = meant.to_vec();
        for pair in sides::pairs(figure) {
            let mut swapped = meant.clone();
            sides::swap(&pair, &mut swapped);
            let of_pair = |meant: &[Vec2]| {
                let joints = pair.left.iter().chain(&pair.right);
                joints.map(|&joint| away(joint, meant)).fold(0.0, f32::max)
            };
            if of_pair(&swapped) < of_pair(&meant) {
                meant = swapped;
            }
        }
        (0..meant.len()).all(|joint| away(joint, &meant) < 0.06 * HEIGHT_PX)
    }

    #[test]
    fn drawings_in_any_order_are_still_read() {
        for (figure, bar) in [(Figure::human(), 97), (Figure::horse(), 91)] {
            let (mut right, mut read_along) = (0, 0);
            for seed in 0..100 {
                let mut rng = simulate::rng(seed);
                let pose = std::iter::repeat_with(|| flat_pose(figure, &mut rng))
                    .find(|pose| is_readable(figure, pose))
                    .unwrap();
                let meant = simulate::on_canvas(&pose, HEIGHT_PX);
                let habits = Habits::of(figure);
                let hand = Hand {
                    height_px: HEIGHT_PX,
                    jitter_px: 3.0,
                    ..Hand::default()
                };
                let strokes = any_order::draw(figure, &mut rng, &meant, &[], hand, habits);
                let found = read_freely(figure, &strokes, usual_scale(figure));
                let is_right =
                    found.progress.complete && is_right(figure, &found.progress.placed, &meant);
                right += u32::from(is_right);
                read_along += u32::from(found.along_path && !is_right);
            }
            assert!(
                read_along <= 1,
                "{}: {read_along} % along the path",
                figure.name
            );
            assert!(right >= bar, "{}: {right} %", figure.name);
        }
    }

    #[test]
    fn drawings_along_the_path_are_still_read() {
        for subject in [HUMAN, HORSE] {
            let figure = (subject.figure)();
            let (mut right, mut of_path, mut along) = (0, 0, 0);
            for seed in 0..100 {
                let mut rng = simulate::rng(seed);
                let meant = simulate::on_canvas(&(subject.clear_pose)(&mut rng), HEIGHT_PX);
                let style = STYLES[seed as usize % STYLES.len()];
                let hand = Hand {
                    height_px: HEIGHT_PX,
                    ..Hand::default()
                };
                let cuts = guided::cuts(figure, &mut rng, style);
                let strokes = guided::draw(figure, &mut rng, &meant, &cuts, hand);
                let found = read_freely(figure, &strokes, usual_scale(figure));
                right += u32::from(
                    found.progress.complete && is_right(figure, &found.progress.placed, &meant),
                );
                let guided = progress(figure, &strokes, Pen::Up);
                of_path += u32::from(guided.complete && is_right(figure, &guided.placed, &meant));
                along += u32::from(found.along_path);
            }
            assert!(
                right + 2 >= of_path && along >= 85,
                "{}: {right} % freely, {of_path} % along the path, {along} % read so",
                figure.name
            );
        }
    }

    /// The bones of the man's limbs, from the trunk outwards.
    const LEGS: [[&str; 2]; 4] = [
        ["abdomen", "knee_r"],
        ["knee_r", "foot_r"],
        ["abdomen", "knee_l"],
        ["knee_l", "foot_l"],
    ];
    const ARMS: [[&str; 2]; 4] = [
        ["neck", "elbow_l"],
        ["elbow_l", "hand_l"],
        ["neck", "elbow_r"],
        ["elbow_r", "hand_r"],
    ];
    const HEAD: [&str; 2] = ["forehead", "neck"];
    const TORSO: [&str; 2] = ["neck", "abdomen"];

    /// After each stroke, whether all joints of the bones so far are where they are meant, and no others are there.
    fn growth(order: &[[&str; 2]]) -> Vec<bool> {
        let human = Figure::human();
        let meant = simulate::on_canvas(&human.template, HEIGHT_PX);
        let joint = |name: &str| human.joint_index(name).unwrap();
        let strokes: Vec<Stroke> = order
            .iter()
            .map(|bone| Stroke::from_positions(bone.map(|name| meant[joint(name)])).unwrap())
            .collect();
        let read = |count: usize| {
            let found = read_freely(human, &strokes[..count], usual_scale(human))
                .progress
                .placed;
            let drawn = order[..count].as_flattened();
            (0..human.joint_count()).all(|at| match found[at] {
                Some(place) => place.distance(meant[at]) < 0.06 * HEIGHT_PX,
                None => drawn.iter().all(|name| joint(name) != at),
            })
        };
        (1..=order.len()).map(read).collect()
    }

    #[test]
    fn a_drawing_from_the_head_down_is_right_from_the_first_stroke() {
        let limbs = [&ARMS[2..], &ARMS[..2], &[TORSO], &LEGS].concat();
        let grown = growth(&[&[HEAD], &limbs[..]].concat());
        assert!(grown.iter().all(|right| *right), "{grown:?}");
    }

    #[test]
    fn a_drawing_from_the_feet_up_is_right_once_the_torso_is_there() {
        let grown = growth(&[&LEGS[..], &[TORSO], &ARMS, &[HEAD]].concat());
        // A torso on two legs, and after every whole limb.
        for count in [5, 7, 9, 10] {
            assert!(grown[count - 1], "{count} strokes: {grown:?}");
        }
    }

    #[test]
    fn a_lone_line_of_its_size_is_a_torso() {
        assert_eq!(growth(&[TORSO]), [true]);
        assert_eq!(growth(&[HEAD]), [true]);
    }

    #[test]
    fn nothing_and_slips_of_the_pen_are_read_as_nothing() {
        let human = Figure::human();
        let dot = Stroke::from_positions([Vec2::ONE; 4]).unwrap();
        for strokes in [vec![], vec![dot]] {
            let found = read_freely(human, &strokes, usual_scale(human));
            assert!(found.progress.placed.iter().all(Option::is_none));
            assert_eq!(found.progress.next_joint, Some(human.path[0]));
        }
    }
}
