//! Where things are in the window: pure arithmetic.

use bevy_egui::egui::{Rect, pos2, vec2};

use super::theme::GAP;

/// Height of a row of buttons, points.
const ROW_HEIGHT: f32 = 40.0;
/// Space between a row of buttons and the paper, points.
const ROW_GAP: f32 = 10.0;
/// What the file field and its buttons need beside the figures, points.
const FILES_WIDTH: f32 = 230.0;

/// The parts of the window, in egui points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    /// The figures to choose from, over the canvas.
    pub(super) choices: Rect,
    /// The file: beside the figures, or under the tools where that is too narrow.
    pub(super) files: Rect,
    /// What is drawn on.
    pub(super) canvas: Rect,
    /// The tools, under the canvas.
    pub(super) tools: Rect,
    /// The 3D view.
    pub(super) view: Rect,
}

impl Layout {
    /// Canvas left and view right; canvas above view where the window is taller than wide.
    ///
    /// `choices_width` is what the figures need beside each other.
    pub(super) fn of(window: Rect, choices_width: f32) -> Self {
        let inner = window.shrink(GAP.min(window.width().min(window.height()) / 8.0));
        let (left, view) = if inner.width() >= inner.height() {
            let width = ((inner.width() - GAP) * 0.46).max(1.0);
            let left = Rect::from_min_size(inner.min, vec2(width, inner.height()));
            let view = Rect::from_min_max(pos2(left.max.x + GAP, inner.min.y), inner.max);
            (left, view)
        } else {
            let height = ((inner.height() - GAP) * 0.55).max(1.0);
            let left = Rect::from_min_size(inner.min, vec2(inner.width(), height));
            let view = Rect::from_min_max(pos2(inner.min.x, left.max.y + GAP), inner.max);
            (left, view)
        };
        let scale = (left.height() / 8.0 / (ROW_HEIGHT + ROW_GAP)).min(1.0);
        let (row, gap) = (ROW_HEIGHT * scale, ROW_GAP * scale);
        let row_at = |top: f32| Rect::from_min_size(pos2(left.min.x, top), vec2(left.width(), row));
        let top = row_at(left.min.y);
        let bottom = row_at(left.max.y - row);
        let is_wide = left.width() >= choices_width + FILES_WIDTH;
        let (choices, files, tools) = if is_wide {
            let split = top.min.x + choices_width;
            (top.with_max_x(split), top.with_min_x(split + gap), bottom)
        } else {
            (top, bottom, row_at(bottom.min.y - row))
        };
        Self {
            choices,
            files,
            canvas: Rect::from_min_max(
                pos2(left.min.x, top.max.y + gap),
                pos2(left.max.x, tools.min.y - gap),
            ),
            tools,
            view,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_never_overlap_and_stay_inside() {
        for (width, height) in [
            (1600.0, 900.0),
            (900.0, 1600.0),
            (640.0, 600.0),
            (400.0, 300.0),
            (40.0, 30.0),
        ] {
            let window = Rect::from_min_size(pos2(0.0, 0.0), vec2(width, height));
            let layout = Layout::of(window, 200.0);
            let parts = [
                layout.choices,
                layout.files,
                layout.canvas,
                layout.tools,
                layout.view,
            ];
            for (index, part) in parts.iter().enumerate() {
                assert!(window.contains_rect(*part), "{part:?} in {window:?}");
                assert!(part.is_positive(), "{part:?}");
                for other in &parts[..index] {
                    let overlap = part.intersect(*other);
                    assert!(
                        overlap.width() < 0.1 || overlap.height() < 0.1,
                        "{part:?} and {other:?} in {window:?}"
                    );
                }
            }
            assert!(layout.canvas.height() > height / 8.0);
        }
    }

    #[test]
    fn the_file_goes_below_where_it_has_no_room_beside_the_figures() {
        let of = |width| {
            let window = Rect::from_min_size(pos2(0.0, 0.0), vec2(width, 600.0));
            Layout::of(window, 200.0)
        };
        assert!(of(1600.0).files.max.y < of(1600.0).canvas.min.y);
        assert!(of(640.0).files.min.y > of(640.0).canvas.max.y);
    }
}
