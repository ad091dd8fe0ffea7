//! The bodies that the drawing may mean: little pictures beside the 3D view, one of them chosen.

mod picture;

use bevy_egui::egui::{
    self, Align2, CornerRadius, Rect, Sense, Stroke, StrokeKind, Ui, WidgetInfo, WidgetType, vec2,
};
use stick3d_figure::Figure;
use stick3d_model::{Alternative, Alternatives};

use self::picture::{Picture, common_scale};
use super::session::Action;
use super::theme;
use crate::SketchAlternatives;

/// Between two tiles, points.
const TILE_GAP: f32 = 6.0;
/// A tile that is not lower than this stands in one column, points.
const USUAL_TILE: f32 = 52.0;
/// The lowest and the highest tile, points.
const LEAST_TILE: f32 = 36.0;
const LARGEST_TILE: f32 = 96.0;
/// All of them take at most this share of the view's width.
const VIEW_SHARE: f32 = 0.34;
/// A tile's width as a share of its height.
const TILE_SHAPE: f32 = 1.3;
/// What the words at the right of a tile take of its width, points.
const WORDS_WIDTH: f32 = 24.0;
/// Between a tile's edge and what is in it, points.
const MARGIN: f32 = 4.0;

/// The tiles at the right of a view: pure arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    /// What all of them take.
    pub(super) place: Rect,
    tile: egui::Vec2,
    columns: usize,
}

impl Grid {
    /// In one column where that is high enough for tiles to be seen, else in two; none where there is no room.
    pub(super) fn beside(view: Rect) -> Option<Self> {
        let room = view.width() * VIEW_SHARE;
        let height_in = |columns: usize| {
            let rows = Alternatives::MOST.div_ceil(columns);
            let gaps = |count: usize| (count - 1) as f32 * TILE_GAP;
            let by_width = (room - gaps(columns)) / columns as f32 / TILE_SHAPE;
            let by_height = (view.height() - gaps(rows)) / rows as f32;
            by_width.min(by_height).min(LARGEST_TILE)
        };
        let one = height_in(1);
        let (columns, height) = if one >= USUAL_TILE || one >= height_in(2) {
            (1, one)
        } else {
            (2, height_in(2))
        };
        let tile = vec2(TILE_SHAPE * height, height);
        let width = tile.x * columns as f32 + TILE_GAP * (columns - 1) as f32;
        (height >= LEAST_TILE).then(|| Self {
            place: view.with_min_x(view.max.x - width),
            tile,
            columns,
        })
    }

    fn tile_at(&self, index: usize) -> Rect {
        let (column, row) = (index % self.columns, index / self.columns);
        let step = self.tile + vec2(TILE_GAP, TILE_GAP);
        let corner = self.place.min + vec2(step.x * column as f32, step.y * row as f32);
        Rect::from_min_size(corner, self.tile)
    }
}

/// What a tile shows.
struct Tile<'a> {
    body: &'a Alternative,
    words: String,
    about: String,
    is_chosen: bool,
    action: Option<Action>,
}

/// The tiles: a body that is shown and is none of the alternatives has the place of the last.
fn tiles(alternatives: &SketchAlternatives) -> Vec<Tile<'_>> {
    let chosen = alternatives.chosen();
    let own = alternatives.shown().filter(|_| chosen.is_none());
    let own = own.map(|body| Tile {
        body,
        words: "yours".to_owned(),
        about: "As you turned it, or kept it while you dragged".to_owned(),
        is_chosen: true,
        action: None,
    });
    let room = Alternatives::MOST - usize::from(own.is_some());
    let found = alternatives.as_slice().iter().take(room).enumerate();
    let found = found.map(|(index, body)| Tile {
        body,
        words: (index + 1).to_string(),
        about: format!(
            "{} likely to be meant (Tab shows the next)",
            per_cent(body.probability)
        ),
        is_chosen: chosen == Some(index),
        action: Some(Action::Alternative(index)),
    });
    found.chain(own).collect()
}

fn per_cent(share: f32) -> String {
    match (share * 100.0).round() {
        least if least < 1.0 => "< 1 %".to_owned(),
        rounded => format!("{rounded} %"),
    }
}

/// Shows the tiles; says which was clicked.
pub(super) fn show(
    ui: &Ui,
    grid: &Grid,
    figure: &Figure,
    alternatives: &SketchAlternatives,
) -> Option<Action> {
    let tiles = tiles(alternatives);
    let room = grid.tile - vec2(2.0 * MARGIN + WORDS_WIDTH, 2.0 * MARGIN);
    let scale = common_scale(figure, tiles.iter().map(|tile| tile.body), room);
    let mut asked = None;
    for (index, tile) in tiles.iter().enumerate() {
        let rect = grid.tile_at(index);
        let response = ui.interact(rect, ui.id().with(("alternative", index)), Sense::click());
        response.widget_info(|| {
            let kind = WidgetType::RadioButton;
            WidgetInfo::selected(kind, true, tile.is_chosen, &tile.words)
        });
        let is_offered = response.hovered() && !tile.is_chosen;
        frame(ui, rect, tile.is_chosen, is_offered);
        let painter = ui.painter().with_clip_rect(rect.shrink(2.0));
        let centre = rect.center() - vec2(WORDS_WIDTH / 2.0, 0.0);
        Picture::new(figure, tile.body, scale).paint(&painter, centre);
        let ink = if tile.is_chosen {
            theme::ACCENT
        } else {
            theme::INK_SOFT
        };
        painter.text(
            rect.right_bottom() - vec2(1.5 * MARGIN, MARGIN),
            Align2::RIGHT_BOTTOM,
            &tile.words,
            theme::tiny(),
            ink,
        );
        if is_offered {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        }
        if response.on_hover_text(&tile.about).clicked() {
            asked = tile.action;
        }
    }
    asked
}

/// The paper of a tile.
fn frame(ui: &Ui, rect: Rect, is_chosen: bool, is_offered: bool) {
    let corners = CornerRadius::same(10);
    ui.painter().add(theme::CARD_SHADOW.as_shape(rect, corners));
    ui.painter().rect_filled(rect, corners, theme::PAPER);
    let edge = match (is_chosen, is_offered) {
        (true, _) => Stroke::new(2.0, theme::ACCENT),
        (false, true) => Stroke::new(1.5, theme::faded(theme::ACCENT, 0.6)),
        (false, false) => Stroke::new(1.0, theme::HAIRLINE),
    };
    ui.painter()
        .rect_stroke(rect, corners, edge, StrokeKind::Inside);
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::pos2;

    use super::*;

    #[test]
    fn all_tiles_fit_into_their_place_apart() {
        for (width, height) in [
            (830.0, 868.0),
            (500.0, 508.0),
            (352.0, 468.0),
            (668.0, 300.0),
        ] {
            let view = Rect::from_min_size(pos2(10.0, 20.0), vec2(width, height));
            let grid = Grid::beside(view).unwrap();
            assert!(grid.place.width() <= VIEW_SHARE * width + 0.01);
            let tiles: Vec<Rect> = (0..Alternatives::MOST)
                .map(|index| grid.tile_at(index))
                .collect();
            for (index, tile) in tiles.iter().enumerate() {
                assert!(grid.place.expand(0.01).contains_rect(*tile), "{tile:?}");
                for other in &tiles[..index] {
                    assert!(!tile.shrink(0.1).intersects(*other), "{tile:?} {other:?}");
                }
            }
        }
        let columns = |width, height| {
            let view = Rect::from_min_size(pos2(0.0, 0.0), vec2(width, height));
            Grid::beside(view).map(|grid| grid.columns)
        };
        assert_eq!(columns(500.0, 508.0), Some(1));
        assert_eq!(columns(668.0, 300.0), Some(2));
        assert_eq!(columns(80.0, 60.0), None);
    }

    #[test]
    fn shares_are_told_in_per_cent() {
        assert_eq!(per_cent(0.424), "42 %");
        assert_eq!(per_cent(0.004), "< 1 %");
        assert_eq!(per_cent(1.0), "100 %");
    }
}
