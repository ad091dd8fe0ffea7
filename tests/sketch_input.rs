//! A pointer draws the man, stroke by stroke, without any user interface: messages, events, body.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

mod support;

use bevy::camera::NormalizedRenderTarget;
use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::prelude::*;
use bevy_stick3d::prelude::*;
use bevy_stick3d::sketch_input::{SketchPreview, screen_from_canvas};
use support::{app, joint, positions, status, t_pose};

const AREA: Rect = Rect {
    min: Vec2::new(100.0, 50.0),
    max: Vec2::new(700.0, 650.0),
};

/// The bones in drawing order, one stroke each.
const BONES: [(&str, &str); 10] = [
    ("forehead", "neck"),
    ("neck", "elbow_r"),
    ("elbow_r", "hand_r"),
    ("neck", "elbow_l"),
    ("elbow_l", "hand_l"),
    ("neck", "abdomen"),
    ("abdomen", "knee_r"),
    ("knee_r", "foot_r"),
    ("abdomen", "knee_l"),
    ("knee_l", "foot_l"),
];

/// Where events of the canvas were seen.
#[derive(Resource, Default)]
struct Seen {
    strokes: usize,
    undone: usize,
    completed: usize,
}

struct Studio {
    app: App,
    man: Entity,
    canvas: Entity,
}

impl Studio {
    fn new(preview: bool) -> Self {
        let mut app = app();
        app.init_resource::<Seen>()
            .add_observer(|_: On<StrokeFinished>, mut seen: ResMut<Seen>| seen.strokes += 1)
            .add_observer(|_: On<StrokeUndone>, mut seen: ResMut<Seen>| seen.undone += 1)
            .add_observer(|_: On<SketchCompleted>, mut seen: ResMut<Seen>| seen.completed += 1);
        let man = app.world_mut().spawn(StickFigure::human()).id();
        let mut canvas = SketchCanvas::new(CanvasArea::rect(AREA), man);
        canvas.preview = preview;
        let canvas = app.world_mut().spawn(canvas).id();
        app.update();
        Self { app, man, canvas }
    }

    fn point(&mut self, at_px: Vec2, action: PointerAction) {
        let target = NormalizedRenderTarget::None {
            width: 800,
            height: 700,
        };
        let location = Location {
            target,
            position: at_px,
        };
        self.app
            .world_mut()
            .write_message(PointerInput::new(PointerId::Mouse, location, action));
    }

    fn press(&mut self, at_px: Vec2) {
        self.point(at_px, PointerAction::Press(PointerButton::Primary));
    }

    fn move_to(&mut self, at_px: Vec2) {
        self.point(at_px, PointerAction::Move { delta: Vec2::ZERO });
    }

    fn release(&mut self, at_px: Vec2) {
        self.point(at_px, PointerAction::Release(PointerButton::Primary));
    }

    /// A straight stroke over several frames, with a little tremor; the last frame is the caller's.
    fn stroke(&mut self, from: Vec2, to: Vec2) {
        self.press(from);
        for step in 1..=20 {
            let tremor = vec2((step * 7 % 5) as f32 - 2.0, (step * 11 % 5) as f32 - 2.0) * 0.5;
            self.move_to(from.lerp(to, step as f32 / 20.0) + tremor);
            if step % 5 == 0 {
                self.app.update();
            }
        }
        self.release(to);
    }

    fn drawing(&self) -> &SketchDrawing {
        self.app.world().get::<SketchDrawing>(self.canvas).unwrap()
    }

    fn seen(&self) -> &Seen {
        self.app.world().resource::<Seen>()
    }
}

/// Where the T-pose is drawn, pixels of the screen.
fn place(name: &str) -> Vec2 {
    let point = (t_pose().points[joint(name)] - vec2(0.0, 0.9)) * 380.0;
    screen_from_canvas(AREA, point)
}

fn draw(studio: &mut Studio, bones: &[(&str, &str)]) {
    for (from, to) in bones {
        studio.stroke(place(from), place(to));
        studio.app.update();
    }
}

#[test]
fn one_stroke_per_bone_is_a_body_when_the_pen_lifts() {
    let mut studio = Studio::new(false);
    draw(&mut studio, &BONES[..9]);
    assert_eq!(studio.seen().strokes, 9);
    assert_eq!(studio.seen().completed, 0);
    assert!(studio.app.world().get::<StickSketch>(studio.man).is_none());

    let (from, to) = BONES[9];
    studio.stroke(place(from), place(to));
    studio.app.update();
    assert_eq!(studio.seen().completed, 1);
    let sketch = studio
        .app
        .world()
        .get::<StickSketch>(studio.man)
        .unwrap()
        .clone();
    for (name, drawn) in Figure::human().joints.iter().zip(&sketch.points) {
        let meant = place(&name.name);
        let drawn = screen_from_canvas(AREA, *drawn);
        assert!(
            drawn.distance(meant) < 12.0,
            "{}: {drawn} for {meant}",
            name.name
        );
    }
    assert_eq!(status(&studio.app, studio.man), FigureStatus::Ready);

    // The body of this very frame is that of the sketch.
    let twin = studio
        .app
        .world_mut()
        .spawn((StickFigure::human(), sketch))
        .id();
    let body = positions(&studio.app, studio.man).unwrap();
    studio.app.update();
    assert_eq!(positions(&studio.app, twin).unwrap(), body);
}

#[test]
fn messages_reach_systems_in_the_frame_of_the_stroke() {
    #[derive(Resource, Default)]
    struct Told(Vec<&'static str>);
    fn listen(
        mut told: ResMut<Told>,
        mut strokes: MessageReader<StrokeFinished>,
        mut changes: MessageReader<SketchChanged>,
    ) {
        told.0.extend(strokes.read().map(|_| "stroke"));
        told.0.extend(changes.read().map(|_| "change"));
    }
    let mut studio = Studio::new(false);
    studio
        .app
        .init_resource::<Told>()
        .add_systems(Update, listen);
    studio.stroke(place("forehead"), place("neck"));
    studio.app.update();
    assert_eq!(
        studio.app.world().resource::<Told>().0,
        ["stroke", "change"]
    );
}

#[test]
fn torso_and_head_make_a_preview_with_guessed_limbs() {
    let mut studio = Studio::new(true);
    draw(&mut studio, &BONES[..5]);
    assert!(
        studio
            .app
            .world()
            .get::<SketchPreview>(studio.man)
            .is_none()
    );
    draw(&mut studio, &BONES[5..6]);
    assert!(
        studio
            .app
            .world()
            .get::<SketchPreview>(studio.man)
            .is_some()
    );
    assert!(positions(&studio.app, studio.man).is_some());
    draw(&mut studio, &BONES[6..]);
    assert!(
        studio
            .app
            .world()
            .get::<SketchPreview>(studio.man)
            .is_none()
    );
    assert!(studio.app.world().get::<StickSketch>(studio.man).is_some());
}

#[test]
fn joints_are_dragged_and_everything_is_undone() {
    let mut studio = Studio::new(false);
    draw(&mut studio, &BONES);
    let hand = screen_from_canvas(AREA, studio.drawing().joints()[joint("hand_l")].unwrap());
    let before = positions(&studio.app, studio.man).unwrap();
    studio.move_to(hand);
    studio.app.update();
    assert_eq!(studio.drawing().hovered(), Some(joint("hand_l")));

    studio.press(hand);
    studio.move_to(hand + vec2(-40.0, -120.0));
    studio.app.update();
    let during = positions(&studio.app, studio.man).unwrap();
    assert_ne!(before, during, "the body follows while the joint is held");
    studio.release(hand + vec2(-40.0, -120.0));
    studio.app.update();

    let undo = |studio: &mut Studio| {
        studio
            .app
            .world_mut()
            .get_mut::<SketchDrawing>(studio.canvas)
            .unwrap()
            .undo();
        studio.app.update();
    };
    undo(&mut studio);
    assert_eq!(positions(&studio.app, studio.man).unwrap(), before);
    undo(&mut studio);
    assert!(studio.drawing().sketch().is_none());
    assert_eq!(studio.drawing().strokes().len(), 9);
    assert_eq!(studio.seen().undone, 1);
    studio
        .app
        .world_mut()
        .get_mut::<SketchDrawing>(studio.canvas)
        .unwrap()
        .redo();
    studio.app.update();
    assert_eq!(positions(&studio.app, studio.man).unwrap(), before);
}

#[test]
fn a_scribble_takes_back_the_last_stroke() {
    let mut studio = Studio::new(false);
    draw(&mut studio, &BONES[..3]);
    let (left, right) = (place("elbow_r") + vec2(-60.0, 0.0), place("neck"));
    studio.press(left);
    for turn in 0..9 {
        let (from, to) = if turn % 2 == 0 {
            (left, right)
        } else {
            (right, left)
        };
        for step in 1..=6 {
            let slide = vec2(0.0, turn as f32 * 2.0);
            studio.move_to(from.lerp(to, step as f32 / 6.0) + slide);
        }
        studio.app.update();
    }
    studio.release(right);
    studio.app.update();
    assert_eq!(studio.seen().undone, 1);
    assert_eq!(studio.drawing().strokes().len(), 2);
}

#[test]
fn a_disabled_canvas_and_the_world_beside_it_stay_blank() {
    let mut studio = Studio::new(false);
    studio.stroke(vec2(10.0, 10.0), vec2(60.0, 30.0));
    studio.app.update();
    studio
        .app
        .world_mut()
        .get_mut::<SketchCanvas>(studio.canvas)
        .unwrap()
        .enabled = false;
    studio.stroke(place("forehead"), place("neck"));
    studio.app.update();
    assert_eq!(studio.seen().strokes, 0);
}

#[test]
fn positions_that_are_not_finite_are_left_out() {
    let mut studio = Studio::new(false);
    studio.press(Vec2::NAN);
    studio.release(Vec2::NAN);
    studio.press(place("forehead"));
    studio.move_to(Vec2::splat(f32::INFINITY));
    studio.move_to(place("neck"));
    studio.release(place("neck"));
    studio.app.update();
    let strokes = studio.drawing().strokes();
    assert_eq!(strokes.len(), 1);
    assert!(strokes[0].positions().all(|position| position.is_finite()));
}

/// The bones from the feet up, the head last, and each toward the middle of the body.
fn from_the_feet_up() -> Vec<(&'static str, &'static str)> {
    BONES.iter().rev().map(|&(from, to)| (to, from)).collect()
}

fn swap_sides(studio: &mut Studio) -> bool {
    let canvas = studio.canvas;
    let mut drawing = studio
        .app
        .world_mut()
        .get_mut::<SketchDrawing>(canvas)
        .unwrap();
    let swapped = drawing.swap_sides();
    studio.app.update();
    swapped
}

fn joint_px(studio: &Studio, name: &str) -> Vec2 {
    screen_from_canvas(AREA, studio.drawing().joints()[joint(name)].unwrap())
}

#[test]
fn strokes_in_another_order_are_the_same_man() {
    let mut studio = Studio::new(false);
    draw(&mut studio, &from_the_feet_up());
    assert_eq!(studio.seen().completed, 1);
    for joint in &Figure::human().joints {
        let (drawn, meant) = (joint_px(&studio, &joint.name), place(&joint.name));
        assert!(
            drawn.distance(meant) < 14.0,
            "{}: {drawn} for {meant}",
            joint.name
        );
    }
    assert_eq!(status(&studio.app, studio.man), FigureStatus::Ready);
}

#[test]
fn the_guided_order_is_there_for_who_wants_it() {
    let mut studio = Studio::new(true);
    let mut canvas = studio
        .app
        .world_mut()
        .get_mut::<SketchCanvas>(studio.canvas)
        .unwrap();
    canvas.order = DrawingOrder::Guided;
    studio.app.update();
    // His left arm first: along the path the first arm is the right one.
    let mut bones = BONES;
    bones[1..5].rotate_left(2);
    draw(&mut studio, &bones);
    assert_eq!(studio.seen().completed, 1);
    assert!(joint_px(&studio, "hand_r").distance(place("hand_l")) < 14.0);
}

#[test]
fn the_body_settles_while_limbs_are_missing() {
    let mut studio = Studio::new(true);
    let bones = from_the_feet_up();
    let is_preview = |studio: &Studio| {
        studio
            .app
            .world()
            .get::<SketchPreview>(studio.man)
            .is_some()
    };
    // Both legs, then the torso: after its stroke the body stands there.
    draw(&mut studio, &bones[..5]);
    assert!(is_preview(&studio));
    assert!(joint_px(&studio, "foot_l").distance(place("foot_l")) < 14.0);
    let guessed = positions(&studio.app, studio.man).unwrap();
    draw(&mut studio, &bones[5..7]);
    assert!(is_preview(&studio));
    assert_ne!(positions(&studio.app, studio.man).unwrap(), guessed);
    draw(&mut studio, &bones[7..]);
    assert!(!is_preview(&studio));
}

#[test]
fn a_limb_under_the_pointer_changes_sides() {
    let mut studio = Studio::new(true);
    draw(&mut studio, &BONES[..9]);
    studio.move_to(place("knee_r"));
    studio.app.update();
    assert!(swap_sides(&mut studio));
    // It stays so when more is drawn.
    draw(&mut studio, &BONES[9..]);
    assert_eq!(studio.seen().completed, 1);
    assert!(joint_px(&studio, "foot_r").distance(place("foot_l")) < 14.0);
    assert!(joint_px(&studio, "hand_r").distance(place("hand_r")) < 14.0);
    studio.move_to((place("neck") + place("elbow_l")) / 2.0);
    studio.app.update();
    assert!(swap_sides(&mut studio));
    assert!(joint_px(&studio, "hand_r").distance(place("hand_l")) < 14.0);
    let body = positions(&studio.app, studio.man).unwrap();
    let canvas = studio.canvas;
    studio
        .app
        .world_mut()
        .get_mut::<SketchDrawing>(canvas)
        .unwrap()
        .undo();
    studio.app.update();
    assert!(joint_px(&studio, "hand_r").distance(place("hand_r")) < 14.0);
    assert_ne!(positions(&studio.app, studio.man).unwrap(), body);
}

#[test]
fn a_click_pins_a_foot_that_then_stays() {
    let mut studio = Studio::new(false);
    draw(&mut studio, &BONES);
    let foot = joint_px(&studio, "foot_l");
    studio.press(foot);
    studio.app.update();
    studio.release(foot);
    studio.app.update();
    assert!(studio.drawing().pins()[joint("foot_l")]);
    let hips = joint_px(&studio, "abdomen");
    studio.press(hips);
    for step in 1..=10 {
        studio.move_to(hips + vec2(0.0, 5.0 * step as f32));
        studio.app.update();
    }
    studio.release(hips + vec2(0.0, 50.0));
    studio.app.update();
    assert!(joint_px(&studio, "foot_l").distance(foot) < 0.1);
    assert!(joint_px(&studio, "foot_r").y > place("foot_r").y + 30.0);
}

#[test]
fn no_joint_jumps_while_a_hand_goes_round_its_shoulder() {
    let mut studio = Studio::new(false);
    draw(&mut studio, &BONES);
    let (hand, neck) = (joint_px(&studio, "hand_r"), joint_px(&studio, "neck"));
    let joints = |studio: &Studio| -> Vec<Vec2> {
        studio
            .drawing()
            .joints()
            .iter()
            .map(|point| point.unwrap())
            .collect()
    };
    studio.press(hand);
    studio.app.update();
    let mut before = joints(&studio);
    let mut body = positions(&studio.app, studio.man).unwrap();
    // Inwards on a spiral, and past the neck. Pixels are 1.67 canvas units.
    for step in 1..=400 {
        let turn = step as f32 * 0.04;
        let arm = (hand - neck).rotate(Vec2::from_angle(turn)) * (1.0 - step as f32 / 400.0);
        studio.move_to(neck + arm);
        studio.app.update();
        let now = joints(&studio);
        let moved = ((hand - neck).length() * 0.04 + 1.0) * 1.67;
        for (joint, (now, before)) in now.iter().zip(&before).enumerate() {
            assert!(
                now.distance(*before) < 5.0 * moved + 1.0,
                "{step}: joint {joint}"
            );
        }
        before = now;
        let bones = positions(&studio.app, studio.man).unwrap();
        assert_eq!(bones.len(), body.len());
        body = bones;
    }
    assert!(body.iter().all(|position| position.is_finite()));
    studio.release(neck);
}
