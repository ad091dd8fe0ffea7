//! A few words of which one holds: beside each other, or, where there is no room, one after the other at each click.

use std::sync::Arc;

use bevy_egui::egui::{
    self, CornerRadius, Galley, Rect, Sense, Ui, WidgetInfo, WidgetType, pos2, vec2,
};

use super::switch::raised;
use super::theme;

/// Height, points.
pub(super) const HEIGHT: f32 = 28.0;
/// Between the edge and the segments.
const INSET: f32 = 2.0;
/// Beside the words.
const PADDING: f32 = 9.0;

/// The words of which one holds.
pub(super) struct Segments<'a> {
    /// What there is to choose from.
    pub(super) words: &'a [&'a str],
    /// The index of that which holds.
    pub(super) active: usize,
    /// What it is about, and the key for it.
    pub(super) about: &'a str,
}

impl Segments<'_> {
    /// How wide it is.
    pub(super) fn width(&self, ui: &Ui) -> f32 {
        let widths = self.words.iter().map(|word| word_width(ui, word));
        widths.sum::<f32>() + 2.0 * INSET
    }

    /// All beside each other. Says which was clicked.
    pub(super) fn show(&self, ui: &mut Ui) -> Option<usize> {
        let (whole, response) =
            ui.allocate_exact_size(vec2(self.width(ui), HEIGHT), Sense::hover());
        ui.painter()
            .rect_filled(whole, CornerRadius::same(9), theme::TRACK);
        let inner = whole.shrink(INSET);
        let mut left = inner.min.x;
        let mut asked = None;
        for (index, word) in self.words.iter().enumerate() {
            let width = word_width(ui, word);
            let segment = Rect::from_min_size(pos2(left, inner.min.y), vec2(width, inner.height()));
            left += width;
            let is_active = index == self.active;
            let clickable = ui.interact(segment, response.id.with(index), Sense::click());
            clickable.widget_info(|| {
                WidgetInfo::selected(WidgetType::RadioButton, true, is_active, *word)
            });
            let ink = match (is_active, clickable.hovered()) {
                (true, _) => theme::INK,
                (false, true) => theme::ACCENT,
                (false, false) => theme::INK_SOFT,
            };
            if is_active {
                raised(ui.painter(), segment);
            } else if clickable.hovered() {
                ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
            }
            let galley = galley(ui, word);
            let at = segment.center() - galley.size() / 2.0;
            ui.painter()
                .galley_with_override_text_color(at, galley, ink);
            if clickable.on_hover_text(self.about).clicked() && !is_active {
                asked = Some(index);
            }
        }
        asked
    }

    /// Only that which holds. A click asks for the next one.
    pub(super) fn show_one(&self, ui: &mut Ui) -> Option<usize> {
        let word = self.words.get(self.active)?;
        let text = egui::RichText::new(*word).font(theme::small());
        let button = egui::Button::new(text)
            .fill(theme::faded(theme::TRACK, 0.6))
            .min_size(vec2(0.0, HEIGHT));
        let clicked = ui.add(button).on_hover_text(self.about).clicked();
        clicked.then(|| (self.active + 1) % self.words.len())
    }
}

fn galley(ui: &Ui, word: &str) -> Arc<Galley> {
    ui.painter()
        .layout_no_wrap(word.to_owned(), theme::small(), egui::Color32::PLACEHOLDER)
}

fn word_width(ui: &Ui, word: &str) -> f32 {
    galley(ui, word).size().x + 2.0 * PADDING
}
