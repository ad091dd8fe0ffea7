//! Tests of drawings that the pen makes bone by bone, in whatever order.

use bevy::math::Vec2;
use stick3d_figure::{Drawing, Figure};

use super::SketchDrawing;
use super::guide::fitted;

/// A man who waves, standing on one leg and a half.
const WAVE: &[u8] = include_bytes!("../../../../assets/sketches/wave.json");

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
