//! Little stick figures: in the switch between the figures, and on the keys of the timeline.

use bevy::math::Vec2;
use bevy_egui::egui::{self, Color32, Painter, Pos2, Rect, Stroke, pos2, vec2};
use stick3d_figure::{Figure, Side};

use super::super::canvas::bone_side;

/// A stick figure, a few lines large.
pub(crate) struct LittleFigure<'a> {
    figure: &'a Figure,
    /// One per joint, y up.
    points: &'a [Vec2],
    /// Round them, y down, in their unit.
    bounds: Rect,
    /// Points of the screen per unit.
    scale: f32,
    line_width: f32,
}

impl<'a> LittleFigure<'a> {
    /// As large as there is room.
    pub(crate) fn fitted(
        figure: &'a Figure,
        points: &'a [Vec2],
        room: egui::Vec2,
        line_width: f32,
    ) -> Self {
        Self {
            bounds: bounds(points),
            scale: fitting_scale(points, room),
            figure,
            points,
            line_width,
        }
    }

    /// Of this scale, so that several can be compared.
    #[must_use]
    pub(crate) fn scaled(mut self, scale: f32) -> Self {
        self.scale = scale;
        self
    }

    /// How large it is on the screen.
    pub(crate) fn size(&self) -> egui::Vec2 {
        self.bounds.size() * self.scale
    }

    /// Paints it round a centre, in colours by side.
    pub(crate) fn paint(&self, painter: &Painter, centre: Pos2, color: impl Fn(Side) -> Color32) {
        let middle = self.bounds.center();
        let on_screen = |joint: usize| centre + (flipped(self.points[joint]) - middle) * self.scale;
        for &bone in &self.figure.bones {
            let color = color(bone_side(self.figure, bone));
            let ends = bone.map(on_screen);
            painter.line_segment(ends, Stroke::new(self.line_width, color));
            for end in ends {
                painter.circle_filled(end, self.line_width / 2.0, color);
            }
        }
        // The path begins at the head.
        if let Some(&head) = self.figure.path.first() {
            painter.circle_filled(
                on_screen(head),
                1.8 * self.line_width,
                color(self.figure.joints[head].side),
            );
        }
    }
}

/// The scale at which points have room.
pub(crate) fn fitting_scale(points: &[Vec2], room: egui::Vec2) -> f32 {
    let size = bounds(points).size().max(vec2(1.0e-4, 1.0e-4));
    (room.y / size.y).min(room.x / size.x)
}

fn flipped(point: Vec2) -> Pos2 {
    pos2(point.x, -point.y)
}

fn bounds(points: &[Vec2]) -> Rect {
    Rect::from_points(&points.iter().copied().map(flipped).collect::<Vec<_>>())
}
