//! Where things are in the window: pure arithmetic.

use bevy_egui::egui::{Rect, pos2, vec2};

use super::gallery::Grid;
use super::session::Mode;
use super::theme::GAP;

/// Height of a row of buttons, points.
const ROW_HEIGHT: f32 = 40.0;
/// Space between a row of buttons and the paper, points.
const ROW_GAP: f32 = 10.0;
/// What the file field and its buttons need beside the figures, points.
const FILES_WIDTH: f32 = 230.0;
/// The timeline's share of the window's height, and its limits, points.
const TIMELINE_SHARE: f32 = 0.19;
const TIMELINE_HEIGHT: [f32; 2] = [126.0, 160.0];
/// Two canvases beside each other are at least so wide, points; else there is one at a time.
const LEAST_PAIR: f32 = 230.0;
/// Between them, points.
const PAIR_GAP: f32 = 12.0;
/// Between the 3D view and the bodies beside it, points.
const GALLERY_GAP: f32 = 10.0;

/// The parts of the window, in egui points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    /// The figures to choose from, over the canvas.
    pub(super) choices: Rect,
    /// The file: beside the figures, or under the tools where that is too narrow.
    pub(super) files: Rect,
    /// What is drawn on.
    pub(super) canvas: Rect,
    /// The same for two drawings beside each other, where there is room for them.
    pub(super) pair: Option<[Rect; 2]>,
    /// The tools, under the canvas.
    pub(super) tools: Rect,
    /// The 3D view.
    pub(super) view: Rect,
    /// The bodies that the drawing may mean, beside the view.
    pub(super) gallery: Option<Grid>,
    /// The timeline along the bottom, of motions.
    pub(super) timeline: Option<Rect>,
}

impl Layout {
    /// Canvas left and view right; canvas above view where the window is taller than wide.
    ///
    /// `choices_width` is what the figures need beside each other.
    pub(super) fn of(window: Rect, choices_width: f32, mode: Mode) -> Self {
        let gap = GAP.min(window.width().min(window.height()) / 8.0);
        let inner = window.shrink(gap);
        let (inner, timeline) = match mode {
            Mode::Pose => (inner, None),
            Mode::Animate => {
                let [least, most] = TIMELINE_HEIGHT;
                let height = (inner.height() * TIMELINE_SHARE)
                    .clamp(least, most)
                    .min(inner.height() / 3.0);
                let top = inner.max.y - height;
                let above = inner.with_max_y(top - gap);
                (above, Some(inner.with_min_y(top)))
            }
        };
        let (left, view) = if inner.width() >= inner.height() {
            let share = match mode {
                Mode::Pose => 0.46,
                Mode::Animate => 0.54,
            };
            let width = ((inner.width() - GAP) * share).max(1.0);
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
        let canvas = Rect::from_min_max(
            pos2(left.min.x, top.max.y + gap),
            pos2(left.max.x, tools.min.y - gap),
        );
        Self {
            choices,
            files,
            canvas,
            pair: (mode == Mode::Animate).then(|| pair(canvas)).flatten(),
            tools,
            view,
            gallery: None,
            timeline,
        }
    }

    /// The same with a place for the bodies that the drawing may mean, which the 3D view gives up, if there is room.
    #[must_use]
    pub(super) fn with_gallery(mut self) -> Self {
        self.gallery = Grid::beside(self.view);
        if let Some(gallery) = &self.gallery {
            self.view.max.x = gallery.place.min.x - GALLERY_GAP;
        }
        self
    }
}

/// The two halves of the place for drawings, if they are wide enough.
fn pair(canvas: Rect) -> Option<[Rect; 2]> {
    let width = (canvas.width() - PAIR_GAP) / 2.0;
    (width >= LEAST_PAIR).then(|| {
        [
            canvas.with_max_x(canvas.min.x + width),
            canvas.with_min_x(canvas.max.x - width),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_never_overlap_and_stay_inside() {
        let sizes = [
            (1600.0, 900.0),
            (960.0, 540.0),
            (900.0, 1600.0),
            (700.0, 500.0),
            (640.0, 600.0),
            (400.0, 300.0),
            (40.0, 30.0),
        ];
        for ((width, height), mode) in sizes
            .into_iter()
            .flat_map(|size| [(size, Mode::Pose), (size, Mode::Animate)])
        {
            let window = Rect::from_min_size(pos2(0.0, 0.0), vec2(width, height));
            let mut layout = Layout::of(window, 200.0, mode);
            if mode == Mode::Pose {
                layout = layout.with_gallery();
                assert!(layout.gallery.is_some() || width < 600.0, "{window:?}");
            }
            let mut parts = vec![layout.choices, layout.files, layout.tools, layout.view];
            parts.extend(layout.timeline);
            parts.extend(layout.gallery.map(|gallery| gallery.place));
            match layout.pair {
                Some(pair) => parts.extend(pair),
                None => parts.push(layout.canvas),
            }
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
            assert!(layout.canvas.height() > height / 9.0, "{layout:?}");
        }
    }

    #[test]
    fn the_file_goes_below_where_it_has_no_room_beside_the_figures() {
        let of = |width| {
            let window = Rect::from_min_size(pos2(0.0, 0.0), vec2(width, 600.0));
            Layout::of(window, 200.0, Mode::Pose)
        };
        assert!(of(1600.0).files.max.y < of(1600.0).canvas.min.y);
        assert!(of(640.0).files.min.y > of(640.0).canvas.max.y);
    }

    #[test]
    fn two_drawings_are_beside_each_other_where_they_have_room() {
        let pair = |width, mode| {
            let window = Rect::from_min_size(pos2(0.0, 0.0), vec2(width, 540.0));
            Layout::of(window, 200.0, mode).pair.is_some()
        };
        assert!(pair(960.0, Mode::Animate) && !pair(700.0, Mode::Animate));
        assert!(!pair(1600.0, Mode::Pose));
    }
}
