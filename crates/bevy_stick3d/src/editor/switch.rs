//! The switch between the figures: a row of segments, each with a little stick figure and a name.

use std::sync::Arc;

use bevy_egui::egui::{
    self, Color32, CornerRadius, Galley, Painter, Rect, Sense, Shadow, Ui, WidgetInfo, WidgetType,
    pos2, vec2,
};
use stick3d_figure::Figure;

use super::session::{Action, Choice};
use super::theme;
use super::timeline::thumbnail::LittleFigure;

/// Height of the switch, points.
const HEIGHT: f32 = 40.0;
/// Between the switch's edge and its segments.
const INSET: f32 = 3.0;
/// Beside the little figure and the name.
const PADDING: f32 = 12.0;
/// Between the two.
const SPACE: f32 = 8.0;
/// Height of the little figure, and its greatest width.
const ICON_HEIGHT: f32 = 25.0;
const ICON_WIDTH: f32 = 34.0;

/// How wide the switch is when nothing is left out.
pub(super) fn width(ui: &Ui, choices: &[Choice]) -> f32 {
    let segments: f32 = choices
        .iter()
        .map(|choice| segment_width(choice, Some(&name(ui, choice, theme::INK))))
        .sum();
    segments + 2.0 * INSET
}

/// The switch at the left of a row. Where the names have no room, only the little figures are shown.
pub(super) fn show(ui: &mut Ui, row: Rect, choices: &[Choice], active: usize) -> Option<Action> {
    let has_names = width(ui, choices) <= row.width();
    let mut asked = None;
    let widths: Vec<f32> = choices
        .iter()
        .map(|choice| {
            let name = has_names.then(|| name(ui, choice, theme::INK));
            segment_width(choice, name.as_ref())
        })
        .collect();
    let whole = Rect::from_min_size(
        row.min,
        vec2(
            (widths.iter().sum::<f32>() + 2.0 * INSET).min(row.width()),
            row.height().min(HEIGHT),
        ),
    );
    ui.painter()
        .rect_filled(whole, CornerRadius::same(12), theme::TRACK);
    let inner = whole.shrink(INSET);
    let mut left = inner.min.x;
    for (index, (choice, width)) in choices.iter().zip(widths).enumerate() {
        let segment = Rect::from_min_size(pos2(left, inner.min.y), vec2(width, inner.height()))
            .intersect(inner);
        left += width;
        if !segment.is_positive() {
            continue;
        }
        let is_active = index == active;
        let response = ui.interact(segment, ui.id().with(("figure", index)), Sense::click());
        response.widget_info(|| {
            WidgetInfo::selected(
                WidgetType::RadioButton,
                true,
                is_active,
                &choice.figure.label,
            )
        });
        let ink = match (is_active, response.hovered()) {
            (true, _) => theme::INK,
            (false, true) => theme::ACCENT,
            (false, false) => theme::INK_SOFT,
        };
        if is_active {
            raised(ui.painter(), segment);
        }
        let painter = ui.painter().with_clip_rect(segment);
        let icon = icon_rect(choice.figure.figure(), segment);
        icon_of(choice.figure.figure()).paint(&painter, icon.center(), |_| ink);
        if has_names {
            let galley = name(ui, choice, ink);
            let at = pos2(
                icon.max.x + SPACE,
                segment.center().y - galley.size().y / 2.0,
            );
            painter.galley(at, galley, ink);
        }
        if response.hovered() && !is_active {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        }
        let hover = format!("{} (key {})", choice.figure.label, index + 1);
        if response.on_hover_text(hover).clicked() && !is_active {
            asked = Some(Action::Choose(index));
        }
    }
    asked
}

/// The card under the chosen segment.
pub(super) fn raised(painter: &Painter, segment: Rect) {
    let corners = CornerRadius::same(9);
    let shadow = Shadow {
        offset: [0, 1],
        blur: 5,
        spread: 0,
        color: Color32::from_black_alpha(34),
    };
    painter.add(shadow.as_shape(segment, corners));
    painter.rect_filled(segment, corners, theme::PAPER);
}

fn name(ui: &Ui, choice: &Choice, color: Color32) -> Arc<Galley> {
    let label: String = choice.figure.label.chars().take(24).collect();
    ui.painter().layout_no_wrap(label, theme::body(), color)
}

fn segment_width(choice: &Choice, name: Option<&Arc<Galley>>) -> f32 {
    let words = name.map_or(0.0, |galley| SPACE + galley.size().x);
    2.0 * PADDING + icon_size(choice.figure.figure()).x + words
}

/// The figure's template, as large as there is room.
fn icon_of(figure: &Figure) -> LittleFigure<'_> {
    LittleFigure::fitted(figure, &figure.template, vec2(ICON_WIDTH, ICON_HEIGHT), 1.8)
}

/// How large that is.
fn icon_size(figure: &Figure) -> egui::Vec2 {
    icon_of(figure).size()
}

fn icon_rect(figure: &Figure, segment: Rect) -> Rect {
    let size = icon_size(figure);
    let centre = pos2(segment.min.x + PADDING + size.x / 2.0, segment.center().y);
    Rect::from_center_size(centre, size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_figures_are_of_one_size_whatever_the_unit() {
        let human = Figure::human();
        let mut giant = human.clone();
        for point in &mut giant.template {
            *point *= 100.0;
        }
        let (size, large) = (icon_size(human), icon_size(&giant));
        assert!((size - large).length() < 1.0e-3);
        assert!((size.y - ICON_HEIGHT).abs() < 1.0e-3 && size.x < ICON_WIDTH);
    }
}
