//! From pointer to sketch: canvases to draw on, without any user interface of their own.

mod canvas;
mod drawing;
#[cfg(test)]
mod growing;
mod guide;
mod pen;

use bevy::camera::RenderTarget;
use bevy::ecs::system::SystemParam;
use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::time::Real;
use bevy::window::PrimaryWindow;

pub use canvas::{
    CANVAS_SIZE, CanvasArea, SketchCanvas, SketchChanged, SketchCompleted, SketchPreview,
    StrokeFinished, StrokeUndone, canvas_from_screen, screen_from_canvas,
};

use canvas::nearest_on_canvas;
pub use drawing::{DrawingChange, DrawingOrder, GRAB_RADIUS, Ink, SketchDrawing};
pub use guide::fit_to_canvas;

use crate::alternatives::FlipLimb;
use crate::figure::{StickFigure, StickSketch};
use crate::model_asset::StickModel;
use crate::schedule::Stick3dSystems;

/// Turns pointer input over a [`SketchCanvas`] into strokes and sketches, messages and events.
#[derive(Debug, Default, Clone, Copy)]
pub struct Stick3dSketchInputPlugin;

impl Plugin for Stick3dSketchInputPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<PointerInput>()
            .add_message::<StrokeFinished>()
            .add_message::<StrokeUndone>()
            .add_message::<SketchChanged>()
            .add_message::<SketchCompleted>()
            .add_message::<FlipLimb>()
            .register_type::<SketchCanvas>()
            .register_type::<SketchDrawing>()
            .register_type::<DrawingOrder>()
            .register_type::<SketchPreview>()
            .add_systems(
                PreUpdate,
                (follow_canvases, draw_with_pointers, tell_changes)
                    .chain()
                    .in_set(Stick3dSystems::Input),
            )
            // What code changed during `Update` is told in the same frame.
            .add_systems(PostUpdate, tell_changes.in_set(Stick3dSystems::Tell));
    }
}

/// The models of the figures that canvases pose.
#[derive(SystemParam)]
struct PosedModels<'w, 's> {
    figures: Query<'w, 's, &'static StickFigure>,
    /// None in an app that takes its sketches elsewhere.
    models: Option<Res<'w, Assets<StickModel>>>,
}

impl PosedModels<'_, '_> {
    /// What the canvas poses, if that is a figure; the model once it is loaded.
    fn of(&self, canvas: &SketchCanvas) -> Option<Option<&StickModel>> {
        let figure = self.figures.get(canvas.figure?).ok()?;
        Some(self.models.as_ref()?.get(&figure.0))
    }
}

/// Drawings become such of the figures whose models their canvases pose, in the order that the canvases want, and let
/// joints be dragged alone while Alt is held.
fn follow_canvases(
    models: PosedModels,
    keys: Option<Res<ButtonInput<KeyCode>>>,
    mut canvases: Query<(&SketchCanvas, &mut SketchDrawing)>,
) {
    let alt = [KeyCode::AltLeft, KeyCode::AltRight];
    for (canvas, mut drawing) in &mut canvases {
        if let Some(Some(model)) = models.of(canvas)
            && !drawing.follows(model.figure())
        {
            drawing.follow(model.figure());
        }
        if drawing.order() != canvas.order {
            drawing.set_order(canvas.order);
        }
        // An app without a keyboard may set it itself.
        if let Some(is_free) = keys.as_ref().map(|keys| keys.any_pressed(alt))
            && drawing.is_free_drag() != is_free
        {
            drawing.set_free_drag(is_free);
        }
    }
}

/// The canvases as the pointer system needs them.
type Canvases<'w, 's> = Query<'w, 's, (Entity, &'static SketchCanvas, &'static mut SketchDrawing)>;

/// Pointer input, in the order it came, becomes strokes and drags.
fn draw_with_pointers(
    mut inputs: MessageReader<PointerInput>,
    mut canvases: Canvases,
    cameras: Query<(&Camera, &RenderTarget)>,
    primary_window: Query<Entity, With<PrimaryWindow>>,
    models: PosedModels,
    time: Res<Time<Real>>,
    mut drawing_pointers: Local<HashMap<PointerId, Entity>>,
) {
    let count = inputs.len() as f64;
    let window = primary_window.single().ok();
    for (index, input) in inputs.read().enumerate() {
        // Input that came during one frame came one after the other: scribbles are told by their speed.
        let share = (index + 1) as f64 / count;
        let time_s = time.elapsed_secs_f64() - (1.0 - share) * time.delta_secs_f64();
        let pointer = input.pointer_id;
        let held = drawing_pointers.get(&pointer).copied();
        match input.action {
            PointerAction::Press(PointerButton::Primary) => {
                for (entity, canvas, mut drawing) in &mut canvases {
                    let busy = drawing_pointers.values().any(|&other| other == entity);
                    // What would be drawn before the figure is known would be lost.
                    if matches!(models.of(canvas), Some(None)) {
                        continue;
                    }
                    let Some(rect) = area_under(canvas, &input.location, &cameras, window) else {
                        continue;
                    };
                    if !busy && rect.contains(input.location.position) {
                        let at = canvas_from_screen(rect, input.location.position);
                        drawing.press(at, time_s);
                        drawing_pointers.insert(pointer, entity);
                        break;
                    }
                }
            }
            PointerAction::Move { .. } => {
                for (entity, canvas, mut drawing) in &mut canvases {
                    let rect = area_under(canvas, &input.location, &cameras, window);
                    let inside = rect.is_some_and(|rect| rect.contains(input.location.position));
                    match rect {
                        Some(rect) if held == Some(entity) || (held.is_none() && inside) => {
                            let at = nearest_on_canvas(rect, input.location.position);
                            drawing.move_to(at, time_s);
                        }
                        _ if drawing.hovered().is_some() => drawing.leave(),
                        _ => {}
                    }
                }
            }
            PointerAction::Release(PointerButton::Primary) | PointerAction::Cancel => {
                if let Some(canvas) = drawing_pointers.remove(&pointer)
                    && let Ok((.., mut drawing)) = canvases.get_mut(canvas)
                {
                    match input.action {
                        PointerAction::Cancel => drawing.cancel(),
                        _ => drawing.release(),
                    }
                }
            }
            _ => {}
        }
    }
    for (.., mut drawing) in &mut canvases {
        if drawing.is_pen_unread() {
            drawing.read_pen();
        }
    }
}

/// The rectangle of a canvas on the target a pointer is on; none when it is elsewhere or does not draw.
fn area_under(
    canvas: &SketchCanvas,
    location: &Location,
    cameras: &Query<(&Camera, &RenderTarget)>,
    primary_window: Option<Entity>,
) -> Option<Rect> {
    if !canvas.enabled {
        return None;
    }
    match &canvas.area {
        CanvasArea::Rect { rect, target } => target
            .as_ref()
            .is_none_or(|target| *target == location.target)
            .then_some(*rect),
        CanvasArea::Camera(camera) => {
            let (camera, target) = cameras.get(*camera).ok()?;
            (target.normalize(primary_window).as_ref() == Some(&location.target))
                .then(|| camera.logical_viewport_rect())
                .flatten()
        }
    }
}

/// Tells what happened to the drawings, and puts their sketches on the figures.
fn tell_changes(
    mut commands: Commands,
    mut canvases: Query<(Entity, &SketchCanvas, &mut SketchDrawing), Changed<SketchDrawing>>,
    mut finished: MessageWriter<StrokeFinished>,
    mut undone: MessageWriter<StrokeUndone>,
    mut changed: MessageWriter<SketchChanged>,
    mut completed: MessageWriter<SketchCompleted>,
    mut flips: MessageWriter<FlipLimb>,
) {
    for (canvas, settings, mut drawing) in &mut canvases {
        let changes = drawing.bypass_change_detection().take_changes();
        let mut redrawn = false;
        for change in changes {
            match change {
                DrawingChange::StrokeFinished(positions) => {
                    let event = StrokeFinished { canvas, positions };
                    commands.trigger(event.clone());
                    finished.write(event);
                }
                DrawingChange::StrokeUndone => {
                    let event = StrokeUndone { canvas };
                    commands.trigger(event);
                    undone.write(event);
                }
                DrawingChange::Completed(points) => {
                    let event = SketchCompleted { canvas, points };
                    commands.trigger(event.clone());
                    completed.write(event);
                }
                DrawingChange::Redrawn => redrawn = true,
                DrawingChange::LimbClicked(joint) => {
                    flips.write_batch(settings.figure.map(|figure| FlipLimb { figure, joint }));
                }
            }
        }
        if redrawn {
            let joints = drawing.joints().to_vec();
            let event = SketchChanged { canvas, joints };
            commands.trigger(event.clone());
            changed.write(event);
            if let Some(figure) = settings.figure
                && let Ok(mut figure) = commands.get_entity(figure)
            {
                pose_figure(&mut figure, &drawing, settings.preview);
            }
        }
    }
}

/// The sketch of a drawing as a figure should show it.
fn pose_figure(figure: &mut EntityCommands, drawing: &SketchDrawing, preview: bool) {
    let pinned = drawing.pinned();
    if let Some(sketch) = drawing.sketch() {
        figure
            .try_insert(StickSketch::from(sketch).with_pinned(pinned))
            .try_remove::<SketchPreview>();
    } else if let Some(points) = drawing.guess().filter(|_| preview) {
        let joints = drawing.joints().iter().enumerate();
        let guessed = joints.filter_map(|(joint, place)| place.is_none().then_some(joint));
        let sketch = StickSketch::new(points).with_guessed(guessed);
        figure.try_insert((sketch, SketchPreview));
    } else {
        figure.try_remove::<(StickSketch, SketchPreview)>();
    }
}
