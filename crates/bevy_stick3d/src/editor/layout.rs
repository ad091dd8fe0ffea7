//! Where things are in the window: pure arithmetic.

use bevy_egui::egui::{Rect, pos2, vec2};

use super::theme::GAP;

/// Height of the strip of tools under the canvas, points.
pub(super) const TOOLBAR_HEIGHT: f32 = 52.0;

/// The parts of the window, in egui points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    /// What is drawn on.
    pub(super) canvas: Rect,
    /// The tools, under the canvas.
    pub(super) toolbar: Rect,
    /// The 3D view.
    pub(super) view: Rect,
}

impl Layout {
    /// Canvas left and view right; canvas above view where the window is taller than wide.
    pub(super) fn of(window: Rect) -> Self {
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
        let toolbar_height = TOOLBAR_HEIGHT.min(left.height() / 3.0);
        let split = left.max.y - toolbar_height;
        Self {
            canvas: Rect::from_min_max(left.min, pos2(left.max.x, split)),
            toolbar: Rect::from_min_max(pos2(left.min.x, split), left.max),
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
            (400.0, 300.0),
            (40.0, 30.0),
        ] {
            let window = Rect::from_min_size(pos2(0.0, 0.0), vec2(width, height));
            let layout = Layout::of(window);
            for part in [layout.canvas, layout.toolbar, layout.view] {
                assert!(window.contains_rect(part), "{part:?} in {window:?}");
                assert!(part.is_positive(), "{part:?}");
            }
            assert!(!layout.canvas.shrink(0.1).intersects(layout.view));
            assert!(
                !layout
                    .canvas
                    .shrink(0.1)
                    .intersects(layout.toolbar.shrink(0.1))
            );
        }
    }
}
