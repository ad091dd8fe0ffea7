//! The track of the timeline: keys as thumbnails where they are in time, what is between and beyond them, the playhead.

use bevy_egui::egui::{
    self, Align2, Color32, CornerRadius, Id, Painter, Rangef, Rect, Response, Sense, Shadow, Shape,
    Stroke, StrokeKind, Ui, WidgetInfo, WidgetType, pos2, vec2,
};
use stick3d_model::Motion;
use stick3d_model::latent::{Extrapolation, Repeat};

use super::super::session::{Action, Choice};
use super::super::theme::{self, faded, side_color};
use super::easings;
use super::scale::{TimeScale, span_s};
use super::state::Key;
use super::thumbnail::{LittleFigure, fitting_scale};

/// Height of the names of the times, points.
const RULER: f32 = 15.0;
/// Height of the line of time, points.
const BAND: f32 = 7.0;
/// Between the thumbnails and the line of time, points.
const STEM: f32 = 7.0;
/// A thumbnail's width as a share of its height, and the least, points.
const THUMB_SHAPE: f32 = 0.86;
const LEAST_THUMB: f32 = 18.0;
/// Between two thumbnails, points.
const THUMB_GAP: f32 = 4.0;
/// In so many steps is drawn how trust fades.
const FADE_STEPS: usize = 48;

/// Where everything of the track is.
pub(super) struct Places {
    pub(super) thumbs: Rect,
    thumb: egui::Vec2,
    band: Rect,
    ruler: Rect,
    add: Rect,
    scale: TimeScale,
}

impl Places {
    fn of(rect: Rect, choice: &Choice, span_s: f32) -> Self {
        let ruler = rect.with_min_y(rect.max.y - RULER);
        let band_y = Rangef::new(ruler.min.y - BAND - 2.0, ruler.min.y - 2.0);
        let thumbs = rect.with_max_y(band_y.min - STEM);
        let width = thumbs.height() * THUMB_SHAPE;
        let xs = Rangef::new(
            rect.min.x + width / 2.0 + 2.0,
            rect.max.x - 1.5 * width - 14.0,
        );
        let scale = TimeScale::new(xs, span_s);
        let xs_of_keys = choice.document.scene().keys().iter();
        let xs_of_keys: Vec<f32> = xs_of_keys.map(|key| scale.x_of(key.time_s)).collect();
        let nearest = xs_of_keys
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .fold(f32::INFINITY, f32::min);
        let width = (nearest - THUMB_GAP).clamp(LEAST_THUMB.min(width), width);
        let add_width = thumbs.height() * THUMB_SHAPE;
        let add = thumbs.with_min_x(thumbs.max.x - add_width);
        Self {
            thumb: vec2(width, thumbs.height()),
            thumbs,
            band: Rect::from_x_y_ranges(xs, band_y),
            ruler,
            add,
            scale,
        }
    }

    /// The thumbnail of a key at a time.
    pub(super) fn thumb_at(&self, time_s: f32) -> Rect {
        let centre = pos2(self.scale.x_of(time_s), self.thumbs.center().y);
        Rect::from_center_size(centre, self.thumb)
    }
}

/// Shows the track. Says what was done to it.
pub(crate) fn show(ui: &mut Ui, rect: Rect, choice: &Choice) -> Option<Action> {
    let span = held_span(ui, rect, choice);
    let places = Places::of(rect, choice, span);
    let scrubbed = scrub(ui, &places);
    paint_ruler(ui.painter(), &places);
    paint_band(ui.painter(), &places, choice);
    let eased = easings::show(ui, &places, choice);
    let moved = keys(ui, &places, choice);
    let added = add_key(ui, &places);
    paint_playhead(ui.painter(), &places, choice);
    moved.or(added).or(eased).or(scrubbed)
}

/// How many seconds are shown. It does not change while something is dragged: that would move under the pointer.
fn held_span(ui: &Ui, rect: Rect, choice: &Choice) -> f32 {
    let id = ui.id().with("timeline span");
    let is_held = ui.input(|input| {
        input.pointer.any_down()
            && input
                .pointer
                .press_origin()
                .is_some_and(|origin| rect.contains(origin))
    });
    let held: Option<f32> = ui.data(|data| data.get_temp(id));
    if let (true, Some(span)) = (is_held, held) {
        return span;
    }
    let last_s = choice.document.scene().last_s();
    let end_s = choice.performance.course().map_or(last_s, |c| c.end_s);
    let span = span_s(last_s, end_s);
    ui.data_mut(|data| data.insert_temp(id, span));
    span
}

fn scrub(ui: &Ui, places: &Places) -> Option<Action> {
    let area = places.band.union(places.ruler);
    let area = area.expand2(vec2(0.0, 3.0)).with_max_x(places.add.min.x);
    let id = ui.id().with("scrub");
    let response = ui.interact(area, id, Sense::click_and_drag());
    if response.hovered() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
    }
    let at = response.interact_pointer_pos()?;
    Some(Action::Seek(places.scale.time_at(at.x)))
}

fn paint_ruler(painter: &Painter, places: &Places) {
    let (marks, digits) = places.scale.marks();
    for mark in marks {
        let x = places.scale.x_of(mark);
        let at = pos2(x, places.ruler.max.y);
        let words = format!("{mark:.digits$} s");
        painter.text(
            at,
            Align2::CENTER_BOTTOM,
            words,
            theme::tiny(),
            faded(theme::INK_SOFT, 0.85),
        );
    }
}

fn between(places: &Places, from_s: f32, to_s: f32) -> Rect {
    let xs = Rangef::new(places.scale.x_of(from_s), places.scale.x_of(to_s));
    Rect::from_x_y_ranges(xs, places.band.y_range())
}

fn paint_band(painter: &Painter, places: &Places, choice: &Choice) {
    let round = CornerRadius::same((BAND / 2.0) as u8);
    let line = Stroke::new(1.0, theme::HAIRLINE);
    painter.hline(places.band.x_range(), places.band.center().y, line);
    let mut drawn = choice
        .document
        .scene()
        .complete()
        .map(|(key, _)| key.time_s);
    let (Some(first_s), Some(last_s)) = (drawn.next(), drawn.last()) else {
        return;
    };
    painter.rect_filled(between(places, first_s, last_s), round, theme::ACCENT);
    if let Some(motion) = choice.performance.motion() {
        paint_after(painter, places, motion, last_s);
    }
}

/// What comes after the last key: the way back of a loop, or what nobody drew, as far as it is to be trusted.
fn paint_after(painter: &Painter, places: &Places, motion: &Motion, last_s: f32) {
    let path = motion.path();
    let (_, end_s) = path.range_s();
    let round = CornerRadius::same((BAND / 2.0) as u8);
    match (path.repeat(), path.extrapolation()) {
        (Repeat::Loop { .. }, _) => {
            let closing = between(places, last_s, end_s);
            painter.rect_filled(closing, round, faded(theme::ACCENT, 0.35));
        }
        (Repeat::PingPong, _) | (_, Extrapolation::Hold) => {}
        _ => {
            let limit_s = places.scale.time_at(places.band.max.x);
            let step_s = (end_s.min(limit_s) - last_s) / FADE_STEPS as f32;
            for step in 0..FADE_STEPS {
                let from_s = last_s + step as f32 * step_s;
                let part = between(places, from_s, from_s + step_s);
                // Squared, so that half the trust is seen to be much less.
                let trust = motion.trust(from_s + 0.5 * step_s).powi(2);
                let height = (BAND * trust).max(1.5);
                let part = Rect::from_center_size(part.center(), vec2(part.width(), height));
                let color = faded(theme::BEYOND, trust.max(0.25));
                painter.rect_filled(part, CornerRadius::ZERO, color);
            }
        }
    }
}

fn keys(ui: &Ui, places: &Places, choice: &Choice) -> Option<Action> {
    let document = &choice.document;
    let figure = choice.figure.figure();
    let room = places.thumb - vec2(8.0, 12.0);
    let shared_scale = document
        .scene()
        .complete()
        .map(|(_, sketch)| fitting_scale(sketch.points(), room))
        .fold(f32::INFINITY, f32::min);
    let selected = document.selected();
    let (above, below): (Vec<_>, Vec<_>) = document
        .scene()
        .keys()
        .iter()
        .enumerate()
        .partition(|(_, key)| key.id == selected);
    let mut asked = None;
    // The selected one lies over its neighbours.
    for (index, key) in below.into_iter().chain(above) {
        let rect = places.thumb_at(key.time_s);
        let id = ui.id().with(("key", key.id));
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| {
            let is_selected = key.id == selected;
            let name = format!("Key {}", index + 1);
            WidgetInfo::selected(WidgetType::RadioButton, true, is_selected, name)
        });
        paint_stem(ui.painter(), places, rect, key);
        paint_card(ui.painter(), rect, key, key.id == selected, &response);
        match key.sketch() {
            Some(sketch) => LittleFigure::fitted(figure, sketch.points(), room, 1.7)
                .scaled(shared_scale)
                .paint(ui.painter(), rect.center(), side_color),
            None => paint_number(ui.painter(), rect, index + 1),
        }
        asked = key_action(ui, places, key, &response).or(asked);
    }
    asked
}

fn key_action(ui: &Ui, places: &Places, key: &Key, response: &Response) -> Option<Action> {
    let offset_id = Id::new(("key drag", key.id));
    if response.hovered() && !response.dragged() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    if response.drag_stopped() {
        return Some(Action::Drop);
    }
    let pointer = response.interact_pointer_pos();
    if let (true, Some(at)) = (response.drag_started(), pointer) {
        // So that it does not jump to the pointer.
        let origin = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
        let offset = places.scale.x_of(key.time_s) - origin.x;
        ui.data_mut(|data| data.insert_temp(offset_id, offset));
    }
    if let (true, Some(at)) = (response.dragged(), pointer) {
        ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
        let offset: f32 = ui.data(|data| data.get_temp(offset_id)).unwrap_or(0.0);
        let time_s = places.scale.time_at(at.x + offset);
        return Some(Action::Retime(key.id, time_s));
    }
    response.clicked().then_some(Action::Select(key.id))
}

fn paint_stem(painter: &Painter, places: &Places, thumb: Rect, key: &Key) {
    let x = thumb.center().x;
    let dot = pos2(x, places.band.center().y);
    let color = if key.sketch().is_some() {
        theme::ACCENT
    } else {
        theme::INK_SOFT
    };
    painter.vline(x, Rangef::new(thumb.max.y, dot.y), Stroke::new(1.0, color));
    painter.circle(dot, 5.0, theme::PAPER, Stroke::new(2.0, color));
}

fn paint_card(painter: &Painter, rect: Rect, key: &Key, is_selected: bool, response: &Response) {
    let corners = CornerRadius::same(7);
    if key.sketch().is_some() || is_selected {
        let shadow = Shadow {
            offset: [0, 1],
            blur: 6,
            spread: 0,
            color: Color32::from_black_alpha(if is_selected { 50 } else { 26 }),
        };
        painter.add(shadow.as_shape(rect, corners));
    }
    painter.rect_filled(rect, corners, Color32::WHITE);
    let edge = match (is_selected, response.hovered()) {
        (true, _) => Stroke::new(2.0, theme::ACCENT),
        (false, true) => Stroke::new(1.0, theme::ACCENT),
        (false, false) => Stroke::new(1.0, theme::HAIRLINE),
    };
    painter.rect_stroke(rect, corners, edge, StrokeKind::Inside);
}

fn paint_number(painter: &Painter, rect: Rect, number: usize) {
    painter.text(
        rect.center(),
        Align2::CENTER_CENTER,
        number,
        theme::body(),
        faded(theme::INK_SOFT, 0.6),
    );
}

/// An empty place after all keys.
fn add_key(ui: &Ui, places: &Places) -> Option<Action> {
    let rect = places.add;
    let response = ui.interact(rect, ui.id().with("add key"), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, "Add a key"));
    let ink = if response.hovered() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        theme::ACCENT
    } else {
        faded(theme::INK_SOFT, 0.8)
    };
    let corners = [
        rect.left_top(),
        rect.right_top(),
        rect.right_bottom(),
        rect.left_bottom(),
        rect.left_top(),
    ];
    let edge = Shape::dashed_line(&corners, Stroke::new(1.2, ink), 5.0, 4.0);
    ui.painter().extend(edge);
    let (centre, arm) = (rect.center(), 6.0);
    let line = Stroke::new(1.8, ink);
    ui.painter()
        .hline(centre.x - arm..=centre.x + arm, centre.y, line);
    ui.painter()
        .vline(centre.x, centre.y - arm..=centre.y + arm, line);
    let about = "Another key to draw (N)";
    response
        .on_hover_text(about)
        .clicked()
        .then_some(Action::AddKey)
}

fn paint_playhead(painter: &Painter, places: &Places, choice: &Choice) {
    let Some(course) = choice.performance.course() else {
        return;
    };
    let time_s = course.folded(choice.player.time_s);
    let is_beyond = choice
        .performance
        .motion()
        .is_some_and(|motion| motion.is_beyond(time_s));
    let color = if is_beyond { theme::BEYOND } else { theme::INK };
    let x = places.scale.x_of(time_s);
    let ys = Rangef::new(places.thumbs.min.y, places.band.max.y);
    painter.vline(x, ys, Stroke::new(1.5, faded(color, 0.85)));
    let knob = Rect::from_center_size(pos2(x, places.band.center().y), vec2(8.0, 16.0));
    painter.rect(
        knob,
        CornerRadius::same(4),
        color,
        Stroke::new(1.5, theme::PAPER),
        StrokeKind::Outside,
    );
}
