//! The words at the top of a canvas' card.

use std::sync::Arc;

use bevy_egui::egui::{CornerRadius, Galley, Painter, Pos2, Rect, pos2, vec2};

use super::canvas::{Card, LOW};
use super::theme;
use super::words::capitalised;
use crate::sketch_input::SketchDrawing;

/// Space between the card's edge and its words, points.
const MARGIN: f32 = 24.0;

/// Narrower cards have smaller words.
const NARROW: f32 = 420.0;

/// The words at the top of the card, laid out.
pub(super) struct Header {
    headline: (Pos2, Arc<Galley>),
    hint: Option<(Pos2, Arc<Galley>)>,
    /// How far the drawing has come, while it is not finished.
    rail: Option<Rect>,
    /// Where the words end.
    pub(super) bottom: f32,
}

impl Header {
    pub(super) fn of(painter: &Painter, card: &Card) -> Self {
        let (rect, drawing, words) = (card.rect, card.drawing, card.words);
        let margin = MARGIN.min(rect.width() / 12.0);
        let width = (rect.width() - 2.0 * margin).max(1.0);
        let font = if card.is_small || rect.width() < NARROW {
            theme::small_headline()
        } else {
            theme::headline()
        };
        let (top, between) = if card.is_small {
            (10.0, 0.0)
        } else {
            (margin - 4.0, 4.0)
        };
        let left = rect.min + vec2(margin, top);
        let headline = painter.layout(capitalised(&words.headline), font, theme::INK, width);
        let mut bottom = left.y + headline.size().y;
        let has_room = card.is_small || rect.height() >= LOW;
        let hint = (has_room && !words.hint.is_empty()).then(|| {
            let font = if card.is_small {
                theme::small()
            } else {
                theme::body()
            };
            let hint = painter.layout(words.hint.clone(), font, theme::INK_SOFT, width);
            let at = pos2(left.x, bottom + between);
            bottom = at.y + hint.size().y;
            (at, hint)
        });
        let rail = drawing.sketch().is_none().then(|| {
            let space = if card.is_small { 6.0 } else { 12.0 };
            let rail = Rect::from_min_size(pos2(left.x, bottom + space), vec2(width, 4.0));
            bottom = rail.max.y;
            rail
        });
        Self {
            headline: (left, headline),
            hint,
            rail,
            bottom,
        }
    }

    pub(super) fn paint(self, painter: &Painter, drawing: &SketchDrawing) {
        for (at, galley) in std::iter::once(self.headline).chain(self.hint) {
            painter.galley(at, galley, theme::INK);
        }
        if let Some(rail) = self.rail {
            painter.rect_filled(rail, CornerRadius::same(2), theme::HAIRLINE);
            let mut done = rail;
            done.set_width(rail.width() * drawing.live_progress().fraction);
            painter.rect_filled(done, CornerRadius::same(2), theme::ACCENT);
        }
    }
}
