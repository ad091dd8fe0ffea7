//! Where sketches are drawn: canvases, what they tell, and the units they are drawn in.

use bevy::camera::NormalizedRenderTarget;
use bevy::prelude::*;

use super::drawing::{DrawingOrder, SketchDrawing};

/// Canvas units along the shorter side of a canvas.
pub const CANVAS_SIZE: f32 = 1000.0;

/// A surface to sketch on with mouse, touch or pen.
///
/// # Mandatory components
/// Added by itself: [`SketchDrawing`], which holds what was drawn. It becomes a drawing of the figure of its
/// entity's model as soon as that is loaded, and does not draw before. A canvas without an entity draws the man,
/// unless you insert a drawing of another figure.
///
/// # What it does
/// Strokes become a [`StickSketch`](crate::StickSketch) on the [`figure`](SketchCanvas::figure), in any order unless
/// [`order`](SketchCanvas::order) says otherwise. After that the joints can be dragged: bones keep their lengths,
/// unless Alt is held. A click on a joint pins it, a click on a bone [flips its limb](crate::FlipLimb), a stroke draws a
/// limb anew. It needs Bevy's pointers (`bevy_picking`, in the default plugins of most apps).
///
/// # Canvas units
/// The origin is in the middle, x goes right, **y up**, and the shorter side is [`CANVAS_SIZE`] units long,
/// so that a drawing stays where it is when the window is resized. A pen that leaves the canvas draws along its
/// edge: every joint can be taken hold of again.
#[derive(Component, Clone, Debug, Reflect)]
#[reflect(Component, Debug, Clone)]
#[require(SketchDrawing)]
pub struct SketchCanvas {
    /// Where on the screen it is.
    pub area: CanvasArea,
    /// The entity that takes the pose; `None` to do nothing but tell.
    pub figure: Option<Entity>,
    /// Whether an unfinished sketch is shown on the figure, once its middle line is drawn: the missing limbs
    /// are guessed, and the figure is marked with [`SketchPreview`].
    pub preview: bool,
    /// In which order strokes are expected.
    pub order: DrawingOrder,
    /// Whether the pointer draws.
    pub enabled: bool,
}

impl SketchCanvas {
    /// A canvas over an area, for a figure.
    pub fn new(area: CanvasArea, figure: Entity) -> Self {
        Self {
            area,
            figure: Some(figure),
            preview: false,
            order: DrawingOrder::default(),
            enabled: true,
        }
    }

    /// Shows unfinished sketches too.
    #[must_use]
    pub fn with_preview(mut self) -> Self {
        self.preview = true;
        self
    }

    /// Expects strokes along the figure's sketch path.
    #[must_use]
    pub fn guided(mut self) -> Self {
        self.order = DrawingOrder::Guided;
        self
    }
}

/// Where a canvas is.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
pub enum CanvasArea {
    /// The view of a camera.
    Camera(Entity),
    /// A rectangle in logical pixels from the top left of a render target, such as a node of a user interface.
    Rect {
        /// The rectangle.
        rect: Rect,
        /// On which target; `None` for whichever the pointer is on, which suits apps with one window.
        target: Option<NormalizedRenderTarget>,
    },
}

impl CanvasArea {
    /// A rectangle of the only window, logical pixels from its top left.
    pub fn rect(rect: Rect) -> Self {
        Self::Rect { rect, target: None }
    }
}

/// A figure shows a sketch that is not finished. Written by the plugin.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
pub struct SketchPreview;

/// A pen was lifted, and what it drew is part of the drawing.
///
/// Sent as a message, and as an event of the canvas.
#[derive(EntityEvent, Message, Clone, Debug, Reflect)]
#[reflect(Event, Debug, Clone)]
pub struct StrokeFinished {
    /// The canvas.
    #[event_target]
    pub canvas: Entity,
    /// Where the pen went, canvas units.
    pub positions: Vec<Vec2>,
}

/// The last stroke was taken back, by a scribble or by an undo.
///
/// Sent as a message, and as an event of the canvas.
#[derive(EntityEvent, Message, Clone, Copy, Debug, Reflect)]
#[reflect(Event, Debug, Clone)]
pub struct StrokeUndone {
    /// The canvas.
    #[event_target]
    pub canvas: Entity,
}

/// The drawing is another than before: a stroke, an undo, a dragged joint, a file.
///
/// Sent as a message, and as an event of the canvas.
#[derive(EntityEvent, Message, Clone, Debug, Reflect)]
#[reflect(Event, Debug, Clone)]
pub struct SketchChanged {
    /// The canvas.
    #[event_target]
    pub canvas: Entity,
    /// The joints known so far, canvas units, in the order of the figure's joints.
    pub joints: Vec<Option<Vec2>>,
}

/// Every joint has its place: sent once, when the last stroke ends or a sketch is loaded.
///
/// Sent as a message, and as an event of the canvas.
#[derive(EntityEvent, Message, Clone, Debug, Reflect)]
#[reflect(Event, Debug, Clone)]
pub struct SketchCompleted {
    /// The canvas.
    #[event_target]
    pub canvas: Entity,
    /// One point per joint, canvas units.
    pub points: Vec<Vec2>,
}

/// Canvas units of a point in logical pixels, y down, for a canvas over `rect`.
///
/// The one place where y turns round.
pub fn canvas_from_screen(rect: Rect, position_px: Vec2) -> Vec2 {
    let units_per_px = CANVAS_SIZE / rect.size().min_element().max(1.0);
    (position_px - rect.center()) * Vec2::new(units_per_px, -units_per_px)
}

/// The point in logical pixels, y down, of a point in canvas units; the inverse of [`canvas_from_screen`].
pub fn screen_from_canvas(rect: Rect, point: Vec2) -> Vec2 {
    let px_per_unit = rect.size().min_element().max(1.0) / CANVAS_SIZE;
    point * Vec2::new(px_per_unit, -px_per_unit) + rect.center()
}

/// The point of the canvas nearest to a point in logical pixels, in canvas units. One that is not finite stays so.
pub(super) fn nearest_on_canvas(rect: Rect, position_px: Vec2) -> Vec2 {
    let inside = if position_px.is_finite() {
        position_px.min(rect.max).max(rect.min)
    } else {
        position_px
    };
    canvas_from_screen(rect, inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_drawn_beside_the_canvas() {
        let rect = Rect::new(100.0, 50.0, 500.0, 450.0);
        let corner = nearest_on_canvas(rect, Vec2::new(9.0e9, -1.0));
        assert_eq!(corner, Vec2::splat(500.0));
        assert_eq!(nearest_on_canvas(rect, rect.center()), Vec2::ZERO);
        assert!(!nearest_on_canvas(rect, Vec2::new(f32::INFINITY, 60.0)).is_finite());
    }

    #[test]
    fn the_shorter_side_is_a_thousand_units_and_y_goes_up() {
        let rect = Rect::new(100.0, 50.0, 500.0, 850.0);
        assert_eq!(canvas_from_screen(rect, rect.center()), Vec2::ZERO);
        assert_eq!(
            canvas_from_screen(rect, Vec2::new(500.0, 50.0)),
            Vec2::new(500.0, 1000.0)
        );
        let there = Vec2::new(123.0, 456.0);
        let back = screen_from_canvas(rect, canvas_from_screen(rect, there));
        assert!(back.distance(there) < 1.0e-3);
    }
}
