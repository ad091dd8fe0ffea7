//! Tests of drawings that the pen makes bone by bone, in whatever order.

use bevy::math::Vec2;
use stick3d_figure::{Drawing, Figure};

use super::SketchDrawing;
use super::guide::fitted;

/// A man who waves, standing on one leg and a half.
const WAVE: &[u8] = include_bytes!("../../../../assets/sketches/wave.json");

/// A drawing that looks finished before its last bone: joints in the figure's order, bones as they are drawn.
struct Early {
    joints: [[f32; 2]; 11],
    bones: [[usize; 2]; 10],
}

const EARLY: [Early; 2] = [
    Early {
        joints: [
            [481.0, 538.6],
            [454.5, 497.5],
            [400.0, 380.0],
            [348.4, 506.7],
            [306.0, 416.2],
            [308.8, 305.4],
            [163.4, 282.1],
            [479.9, 367.4],
            [475.6, 269.7],
            [336.3, 257.2],
            [364.5, 142.7],
        ],
        bones: [
            [0, 1],
            [7, 8],
            [2, 5],
            [3, 4],
            [1, 7],
            [1, 2],
            [5, 6],
            [1, 3],
            [9, 10],
            [2, 9],
        ],
    },
    Early {
        joints: [
            [463.6, 555.1],
            [433.5, 515.7],
            [400.0, 380.0],
            [370.2, 433.2],
            [289.5, 463.6],
            [283.4, 319.7],
            [212.2, 432.6],
            [441.5, 400.9],
            [512.8, 350.2],
            [348.8, 262.2],
            [337.0, 146.4],
        ],
        bones: [
            [9, 10],
            [0, 1],
            [7, 8],
            [5, 6],
            [1, 2],
            [2, 5],
            [2, 9],
            [3, 4],
            [1, 3],
            [1, 7],
        ],
    },
];

/// Per joint of the man where it is on the canvas.
fn wave() -> Vec<Vec2> {
    let human = Figure::human();
    let file = Drawing::from_json(human, WAVE).unwrap();
    fitted(file.sketch(human).unwrap().points())
}

fn draw(drawing: &mut SketchDrawing, from: Vec2, to: Vec2) {
    drawing.press(from, 0.0);
    for step in 1..=14 {
        drawing.move_to(from.lerp(to, step as f32 / 14.0), 0.0);
    }
    drawing.release();
}

#[test]
fn a_bone_at_a_time_in_whatever_order() {
    let human = Figure::human();
    let points = wave();
    let count = human.bones.len();
    // Steps without a common divisor with the number of bones reach all of them.
    let orders = [1, 3, 7, 9]
        .into_iter()
        .flat_map(|step| (0..count).map(move |start| (start, step)));
    for order in orders {
        let (start, step) = order;
        let bones = (0..count).map(|i| human.bones[(start + step * i) % count]);
        let mut drawing = SketchDrawing::default();
        for [a, b] in bones {
            draw(&mut drawing, points[a], points[b]);
        }
        let sketch = drawing.sketch().map(|sketch| sketch.points().to_vec());
        let Some(sketch) = sketch else {
            panic!("order {order:?}: not finished: {:?}", drawing.joints());
        };
        for (joint, (found, meant)) in human.joints.iter().zip(sketch.iter().zip(&points)) {
            let off = found.distance(*meant);
            assert!(off < 25.0, "order {order:?}: {} is {off} off", joint.name);
        }
    }
}

#[test]
fn what_looked_finished_is_drawn_on() {
    let (mut early, mut right) = (0, 0);
    for (Early { joints, bones }, hand) in EARLY.iter().flat_map(|e| (0..12).map(move |h| (e, h))) {
        let points = fitted(&joints.map(Vec2::from));
        // Nobody's hand hits every joint.
        let aimed = |joint: usize, bone: usize| {
            let turn = (hand * 37 + bone * 13 + joint * 7) as f32;
            points[joint] + 8.0 * Vec2::from_angle(turn)
        };
        let mut drawing = SketchDrawing::default();
        let bone = |drawing: &mut SketchDrawing, index: usize| {
            let [a, b] = bones[index];
            draw(drawing, aimed(a, index), aimed(b, index));
        };
        let last = bones.len() - 1;
        (0..last).for_each(|index| bone(&mut drawing, index));
        let Some(looked) = drawing.sketch().cloned() else {
            continue;
        };
        drawing.press(aimed(bones[last][0], last), 0.0);
        let is_taken_hold_of = drawing.dragged().is_some();
        drawing.cancel();
        bone(&mut drawing, last);
        let found = drawing.sketch().map_or(&[][..], |sketch| sketch.points());
        let off = found.iter().zip(&points).map(|(a, b)| a.distance(*b));
        let is_right = !found.is_empty() && off.fold(0.0, f32::max) < 30.0;
        early += usize::from(is_taken_hold_of);
        right += usize::from(is_taken_hold_of && is_right);
        if is_right && is_taken_hold_of {
            drawing.undo();
            assert_eq!(drawing.sketch(), Some(&looked), "one step back");
            // A joint that is dragged elsewhere is dragged.
            let end = looked.points()[8];
            draw(&mut drawing, end, end + Vec2::new(30.0, 60.0));
            assert!(drawing.strokes().is_empty() && drawing.sketch().is_some());
        }
    }
    assert!(early >= 12 && right + 1 >= early, "{right} of {early}");
}

#[test]
fn enter_finishes_what_has_a_torso() {
    let human = Figure::human();
    let points = wave();
    let joint = |name: &str| human.joint_index(name).unwrap();
    let mut drawing = SketchDrawing::default();
    let bone = |drawing: &mut SketchDrawing, from: &str, to: &str| {
        draw(drawing, points[joint(from)], points[joint(to)]);
    };
    assert!(!drawing.finish(), "an empty sheet");
    bone(&mut drawing, "forehead", "neck");
    bone(&mut drawing, "neck", "abdomen");
    bone(&mut drawing, "neck", "elbow_r");
    bone(&mut drawing, "elbow_r", "hand_r");
    assert!(drawing.sketch().is_none());
    let guess = drawing.guess().unwrap();
    assert!(drawing.finish());
    assert_eq!(drawing.sketch().unwrap().points(), guess);
    drawing.undo();
    assert!(drawing.sketch().is_none() && drawing.strokes().len() == 4);
}
