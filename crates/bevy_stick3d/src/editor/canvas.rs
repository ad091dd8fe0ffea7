//! Painting the canvas: paper, the guide, the ink, the joints.

use bevy::math::Vec2;
use bevy_egui::egui::{
    Align2, Color32, CornerRadius, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2,
};
use stick3d_figure::{Figure, Side, Sketch};

use super::header::Header;
use super::theme::{self, faded, side_color};
use super::words::Words;
use crate::sketch_input::{DrawingOrder, SketchDrawing, screen_from_canvas};

/// Lower cards have no room for hints.
pub(super) const LOW: f32 = 340.0;

/// What the words take of a card, with and without hints, points: nothing is drawn there.
const WORDS_HEIGHT: f32 = 78.0;
const HEADLINE_HEIGHT: f32 = 50.0;

/// The same of a card beside another.
const SMALL_WORDS_HEIGHT: f32 = 60.0;

/// And what is kept free under the drawing there.
const SMALL_MARGIN: f32 = 12.0;

/// A card with a drawing on it.
pub(super) struct Card<'a> {
    /// Where it is.
    pub(super) rect: Rect,
    /// What is drawn on it.
    pub(super) drawing: &'a SketchDrawing,
    /// What it says.
    pub(super) words: &'a Words,
    /// One of several: with less space for words.
    pub(super) is_small: bool,
    /// Whether the body follows it.
    pub(super) is_selected: bool,
    /// The drawing before it, shown faintly under it.
    pub(super) before: Option<&'a Sketch>,
}

/// The part of a card that is drawn on.
pub(super) fn drawing_area(card: Rect, is_small: bool) -> Rect {
    let words = match (is_small, card.height() < LOW) {
        (true, _) => SMALL_WORDS_HEIGHT,
        (false, true) => HEADLINE_HEIGHT,
        (false, false) => WORDS_HEIGHT,
    };
    let area = card.with_min_y(card.min.y + words.min(card.height() / 4.0));
    if is_small {
        area.with_max_y(area.max.y - SMALL_MARGIN)
    } else {
        area
    }
}

/// Turns canvas units into egui points.
#[derive(Clone, Copy)]
struct ToScreen(bevy::math::Rect);

impl ToScreen {
    fn new(rect: Rect) -> Self {
        Self(bevy::math::Rect::new(
            rect.min.x, rect.min.y, rect.max.x, rect.max.y,
        ))
    }

    fn point(self, canvas: Vec2) -> Pos2 {
        let point = screen_from_canvas(self.0, canvas);
        pos2(point.x, point.y)
    }

    /// Points per 1/700 of the canvas: lines and joints grow with it, a little.
    fn size(self) -> f32 {
        (self.0.size().min_element() / 700.0).clamp(0.7, 1.6)
    }
}

/// Paints the whole card of a canvas. `pulse` goes from 0 to 1 and back.
pub(super) fn paint(painter: &Painter, card: &Card, pulse: f32) {
    let (rect, drawing) = (card.rect, card.drawing);
    let to_screen = ToScreen::new(drawing_area(rect, card.is_small));
    let header = Header::of(painter, card);
    paper(painter, rect, header.bottom);
    if card.is_small && card.is_selected {
        let corners = CornerRadius::from(theme::CARD_RADIUS);
        let edge = Stroke::new(2.0, theme::ACCENT);
        painter.rect_stroke(rect, corners, edge, StrokeKind::Inside);
    }
    let painter = &painter.with_clip_rect(painter.clip_rect().intersect(rect));
    if let Some(before) = card.before {
        shade(painter, to_screen, drawing.figure(), before.points());
    }
    match drawing.sketch() {
        Some(sketch) => {
            ink(painter, to_screen, drawing, 0.10);
            finished(painter, to_screen, drawing, sketch.points());
        }
        None => {
            guide(painter, to_screen, drawing);
            recognised(painter, to_screen, drawing);
            ink(painter, to_screen, drawing, 0.92);
            let is_guided = drawing.order() == DrawingOrder::Guided;
            if card.is_selected && is_guided {
                next_joint(painter, to_screen, drawing, pulse);
            }
        }
    }
    if let Some(stroke) = drawing.pen_stroke() {
        let positions = stroke.positions().map(|p| to_screen.point(p)).collect();
        painter.line(positions, Stroke::new(3.6 * to_screen.size(), theme::INK));
    }
    header.paint(painter, drawing);
}

fn paper(painter: &Painter, rect: Rect, words_bottom: f32) {
    let corners = CornerRadius::from(theme::CARD_RADIUS);
    painter.add(theme::CARD_SHADOW.as_shape(rect, corners));
    painter.rect_filled(rect, corners, theme::PAPER);
    let spacing = 28.0;
    // The words stand on blank paper.
    let inner = rect.shrink(spacing * 0.5);
    let inner = inner.with_min_y((words_bottom + spacing * 0.5).min(inner.max.y));
    let (columns, rows) = (
        (inner.width() / spacing) as usize,
        (inner.height() / spacing) as usize,
    );
    for column in 0..=columns {
        for row in 0..=rows {
            let dot = inner.min + vec2(column as f32, row as f32) * spacing;
            painter.circle_filled(dot, 1.0, theme::PAPER_DOT);
        }
    }
    painter.rect_stroke(
        rect,
        corners,
        Stroke::new(1.0, theme::HAIRLINE),
        StrokeKind::Inside,
    );
}

/// The drawing before this one, as if the paper let it shine through.
fn shade(painter: &Painter, to_screen: ToScreen, figure: &Figure, points: &[Vec2]) {
    for &[a, b] in &figure.bones {
        let color = mixed_with_paper(side_color(bone_side(figure, [a, b])), 0.13);
        let ends = [points[a], points[b]].map(|p| to_screen.point(p));
        round_line(painter, ends, 5.0 * to_screen.size(), color);
    }
}

/// The side a bone is on: that of its outer end.
pub(super) fn bone_side(figure: &Figure, bone: [usize; 2]) -> Side {
    match figure.joints[bone[1]].side {
        Side::Center => figure.joints[bone[0]].side,
        side => side,
    }
}

/// A line with round ends.
fn round_line(painter: &Painter, ends: [Pos2; 2], width: f32, color: Color32) {
    painter.line_segment(ends, Stroke::new(width, color));
    if color.is_opaque() {
        for end in ends {
            painter.circle_filled(end, width / 2.0, color);
        }
    }
}

/// The faint figure: where the rest of the path goes.
fn guide(painter: &Painter, to_screen: ToScreen, drawing: &SketchDrawing) {
    let figure = drawing.figure();
    let points = drawing.guide();
    let placed = &drawing.live_progress().placed;
    let size = to_screen.size();
    head(painter, to_screen, figure, &points, faded(theme::INK, 0.05));
    for &[a, b] in &figure.bones {
        if placed[a].is_some() && placed[b].is_some() {
            continue;
        }
        let color = mixed_with_paper(side_color(bone_side(figure, [a, b])), 0.20);
        let ends = [points[a], points[b]].map(|p| to_screen.point(p));
        round_line(painter, ends, 9.0 * size, color);
    }
    for (joint, point) in points.iter().enumerate() {
        if placed[joint].is_none() {
            let color = mixed_with_paper(side_color(figure.joints[joint].side), 0.38);
            painter.circle_filled(to_screen.point(*point), 7.5 * size, color);
        }
    }
    side_letters(painter, to_screen, figure, &points, 0.55);
}

/// A head round the forehead of a figure that has a neck.
fn head(painter: &Painter, to_screen: ToScreen, figure: &Figure, points: &[Vec2], color: Color32) {
    let (Ok(forehead), Ok(neck)) = (figure.joint_index("forehead"), figure.joint_index("neck"))
    else {
        return;
    };
    let (top, bottom) = (points[forehead], points[neck]);
    let centre = to_screen.point(top.lerp(bottom, 0.22));
    let radius = to_screen.point(top).distance(to_screen.point(bottom)) * 0.56;
    painter.circle_filled(centre, radius, color);
}

/// The colour with which an opaque line looks like a translucent one on paper.
fn mixed_with_paper(color: Color32, share: f32) -> Color32 {
    theme::PAPER.lerp_to_gamma(color, share)
}

/// What the strokes were read as: a marker over the ink.
fn recognised(painter: &Painter, to_screen: ToScreen, drawing: &SketchDrawing) {
    let figure = drawing.figure();
    let placed = &drawing.live_progress().placed;
    let size = to_screen.size();
    for &[a, b] in &figure.bones {
        if let (Some(a_point), Some(b_point)) = (placed[a], placed[b]) {
            let color = mixed_with_paper(side_color(bone_side(figure, [a, b])), 0.42);
            let ends = [a_point, b_point].map(|p| to_screen.point(p));
            round_line(painter, ends, 9.0 * size, color);
        }
    }
    for (joint, point) in placed.iter().enumerate() {
        if let Some(point) = point {
            handle(
                painter,
                to_screen.point(*point),
                figure.joints[joint].side,
                6.0 * size,
            );
        }
    }
}

fn ink(painter: &Painter, to_screen: ToScreen, drawing: &SketchDrawing, opacity: f32) {
    let color = mixed_with_paper(theme::INK, opacity);
    for stroke in drawing.strokes() {
        let positions = stroke.positions().map(|p| to_screen.point(p)).collect();
        painter.line(positions, Stroke::new(2.6 * to_screen.size(), color));
    }
}

/// The bone to draw next: a dashed line to a joint that pulses.
fn next_joint(painter: &Painter, to_screen: ToScreen, drawing: &SketchDrawing, pulse: f32) {
    let Some((from, to)) = drawing.next_bone() else {
        return;
    };
    let figure = drawing.figure();
    let points = drawing.guide();
    let size = to_screen.size();
    // Before the first stroke the first joint is where to begin, and its bone the one to draw.
    let (start, goal) = match from {
        Some(from) => (from, to),
        None => (to, figure.path.get(1).copied().unwrap_or(to)),
    };
    let color = side_color(figure.joints[goal].side);
    let [start, goal] = [start, goal].map(|joint| to_screen.point(points[joint]));
    painter.extend(Shape::dashed_line(
        &[start, goal],
        Stroke::new(2.5 * size, color),
        9.0 * size,
        7.0 * size,
    ));
    if from.is_none() {
        painter.circle_filled(start, 6.0 * size, color);
    }
    painter.circle_filled(
        goal,
        (11.0 + 13.0 * pulse) * size,
        faded(color, 0.24 * (1.0 - pulse) + 0.08),
    );
    painter.circle_filled(goal, 8.0 * size, color);
    painter.circle_filled(goal, 3.2 * size, theme::PAPER);
}

/// The sketch with its joints to drag.
fn finished(painter: &Painter, to_screen: ToScreen, drawing: &SketchDrawing, points: &[Vec2]) {
    let figure = drawing.figure();
    let size = to_screen.size();
    head(
        painter,
        to_screen,
        figure,
        points,
        mixed_with_paper(theme::INK, 0.08),
    );
    for &[a, b] in &figure.bones {
        let color = side_color(bone_side(figure, [a, b]));
        let ends = [points[a], points[b]].map(|p| to_screen.point(p));
        round_line(painter, ends, 5.0 * size, color);
    }
    side_letters(painter, to_screen, figure, points, 1.0);
    let held = drawing.dragged().or(drawing.hovered());
    let pins = drawing.pins();
    for (joint, point) in points.iter().enumerate() {
        let (at, side) = (to_screen.point(*point), figure.joints[joint].side);
        if held == Some(joint) {
            painter.circle_filled(at, 20.0 * size, faded(side_color(side), 0.20));
            handle(painter, at, side, 10.5 * size);
        } else {
            handle(painter, at, side, 8.0 * size);
        }
        if pins[joint] {
            pin(painter, at, size);
        }
    }
}

/// A pin through a joint: a ring round it and its head in the middle.
fn pin(painter: &Painter, at: Pos2, size: f32) {
    painter.circle_stroke(at, 14.0 * size, Stroke::new(2.4 * size, theme::INK));
    painter.circle_filled(at, 4.2 * size, theme::INK);
    painter.circle_filled(at - vec2(1.1, 1.1) * size, 1.4 * size, theme::PAPER);
}

/// A joint: filled on the right and in the middle, open on the left.
fn handle(painter: &Painter, at: Pos2, side: Side, radius: f32) {
    let color = side_color(side);
    painter.circle_filled(at, radius + 2.0, theme::PAPER);
    match side {
        Side::Left => {
            painter.circle(at, radius - 1.5, theme::PAPER, Stroke::new(3.0, color));
        }
        Side::Right | Side::Center => {
            painter.circle_filled(at, radius, color);
        }
    }
}

/// R and L beside the ends of the limbs.
fn side_letters(
    painter: &Painter,
    to_screen: ToScreen,
    figure: &Figure,
    points: &[Vec2],
    opacity: f32,
) {
    for (joint, point) in points.iter().enumerate() {
        let side = figure.joints[joint].side;
        let mut bones = figure.bones.iter().filter(|bone| bone.contains(&joint));
        let (Some(bone), None) = (bones.next(), bones.next()) else {
            continue;
        };
        let letter = match side {
            Side::Center => continue,
            Side::Right => "R",
            Side::Left => "L",
        };
        let inner = points[if bone[0] == joint { bone[1] } else { bone[0] }];
        let end = to_screen.point(*point);
        let outward = (end - to_screen.point(inner)).normalized();
        let (distance, font) = if to_screen.size() < 0.75 {
            (15.0, theme::small())
        } else {
            (24.0 * to_screen.size(), theme::body())
        };
        painter.text(
            end + outward * distance,
            Align2::CENTER_CENTER,
            letter,
            font,
            mixed_with_paper(side_color(side), opacity),
        );
    }
}
