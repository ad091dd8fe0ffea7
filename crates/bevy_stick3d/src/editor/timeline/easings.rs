//! The signs between the keys of the track: how time passes there.

use bevy_egui::egui::{self, Painter, Rect, Sense, Stroke, Ui, WidgetInfo, WidgetType, pos2, vec2};
use stick3d_model::latent::Easing;

use super::super::session::{Action, Choice};
use super::super::theme::{self, faded};
use super::controls::next_easing;
use super::track::Places;

/// Width and height of the sign of an easing, points.
const CHIP: egui::Vec2 = vec2(26.0, 20.0);
/// Between two keys stands how time passes there.
pub(super) fn show(ui: &Ui, places: &Places, choice: &Choice) -> Option<Action> {
    let mut asked = None;
    for pair in choice.document.scene().keys().windows(2) {
        let [from, to] = [0, 1].map(|at| places.thumb_at(pair[at].time_s));
        if to.min.x - from.max.x < CHIP.x + 4.0 {
            continue;
        }
        let centre = pos2((from.max.x + to.min.x) / 2.0, places.thumbs.center().y);
        let chip = Rect::from_center_size(centre, CHIP);
        let id = ui.id().with(("easing", pair[0].id));
        let response = ui.interact(chip, id, Sense::click());
        paint_easing(ui.painter(), chip, pair[0].easing, response.hovered());
        let name = easing_name(pair[0].easing);
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, name));
        if response.hovered() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        }
        let about = format!("{name} (click, or E for the selected key)");
        if response.on_hover_text(about).clicked() {
            asked = Some(Action::Ease(pair[0].id, next_easing(pair[0].easing)));
        }
    }
    asked
}

fn easing_name(easing: Easing) -> &'static str {
    match easing {
        Easing::Linear => "At an even pace",
        Easing::In => "Starts slowly",
        Easing::Out => "Ends slowly",
        Easing::InOut => "Starts and ends slowly",
    }
}

fn paint_easing(painter: &Painter, chip: Rect, easing: Easing, is_hovered: bool) {
    let ink = if is_hovered {
        painter.rect_filled(chip, 6.0, faded(theme::ACCENT, 0.12));
        theme::ACCENT
    } else {
        theme::INK_SOFT
    };
    let inner = chip.shrink2(vec2(5.0, 4.0));
    let points = (0..=16).map(|step| {
        let t = step as f32 / 16.0;
        inner.left_bottom() + vec2(inner.width() * t, -inner.height() * easing.apply(t))
    });
    painter.line(points.collect(), Stroke::new(1.6, ink));
}
