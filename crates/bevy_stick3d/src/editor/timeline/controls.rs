//! The row over the timeline: play, time, and how the keys become a motion. And the keys of the keyboard.

use bevy_egui::egui::{
    self, Align, Color32, Key, Layout, Modifiers, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui,
    UiBuilder, WidgetInfo, WidgetType, pos2, vec2,
};
use stick3d_model::latent::{Easing, Interpolation, Repeat};

use super::super::segments::{HEIGHT, Segments};
use super::super::session::{Action, Choice, Mode};
use super::super::theme;

/// Height of the row, points.
pub(crate) const ROW_HEIGHT: f32 = 32.0;
/// Between its parts, points.
const SPACE: f32 = 6.0;
/// What the buttons and the time need beside the words to choose from, points.
const BUTTONS_WIDTH: f32 = 450.0;
/// One press of an arrow key, seconds.
const FRAME_S: f32 = 1.0 / 30.0;

const REPEATS: [&str; 3] = ["Once", "Loop", "Ping-pong"];
const INTERPOLATIONS: [&str; 2] = ["Linear", "Cubic"];

fn repeat_index(repeat: Repeat) -> usize {
    match repeat {
        Repeat::Once => 0,
        Repeat::Loop { .. } => 1,
        Repeat::PingPong => 2,
    }
}

fn repeat_of(index: usize) -> Repeat {
    match index % REPEATS.len() {
        0 => Repeat::Once,
        1 => Repeat::Loop { closing_s: None },
        _ => Repeat::PingPong,
    }
}

fn interpolation_of(index: usize) -> Interpolation {
    match index % INTERPOLATIONS.len() {
        0 => Interpolation::Linear,
        _ => Interpolation::Cubic,
    }
}

/// The easing after this one, when they come in turn.
pub(crate) fn next_easing(easing: Easing) -> Easing {
    let all = Easing::ALL;
    let place = all.iter().position(|other| *other == easing);
    all[place.map_or(0, |place| (place + 1) % all.len())]
}

/// The key that was pressed; nobody may be typing.
pub(crate) fn shortcut(input: &mut egui::InputState, choice: &Choice) -> Option<Action> {
    let document = &choice.document;
    let settings = document.scene().settings();
    let selected = document.scene().key(document.selected())?;
    let actions = [
        (Key::Space, Action::Play),
        (Key::Home, Action::Seek(0.0)),
        (Key::ArrowLeft, Action::Step(-FRAME_S)),
        (Key::ArrowRight, Action::Step(FRAME_S)),
        (Key::N, Action::AddKey),
        (Key::K, Action::KeyHere),
        (Key::Delete, Action::RemoveKey),
        (Key::Backspace, Action::RemoveKey),
        (Key::G, Action::Ghosts),
        (Key::S, Action::Speed),
        (
            Key::E,
            Action::Ease(selected.id, next_easing(selected.easing)),
        ),
        (
            Key::L,
            Action::Repeat(repeat_of(repeat_index(settings.repeat) + 1)),
        ),
        (
            Key::C,
            Action::Interpolate(interpolation_of(settings.interpolation as usize + 1)),
        ),
    ];
    let pressed = |key: Key| input.consume_key(Modifiers::NONE, key);
    let mut keys = actions.iter().map(|(key, _)| *key);
    let place = keys.position(pressed)?;
    actions.get(place).map(|(_, action)| *action)
}

/// The switch between poses and motions, at the upper left of the 3D view, over what is painted there later.
pub(crate) fn mode_switch(ctx: &egui::Context, view: Rect, mode: Mode) -> Option<Action> {
    let segments = Segments {
        words: &["Pose", "Animate"],
        active: mode as usize,
        about: "One pose, or a motion (key A)",
    };
    let layer = egui::LayerId::new(egui::Order::Middle, egui::Id::new("mode"));
    let room = Rect::from_min_max(view.min + vec2(12.0, 12.0), view.max);
    let builder = UiBuilder::new().layer_id(layer).max_rect(room);
    let mut ui = Ui::new(ctx.clone(), "mode".into(), builder);
    Some(Action::Switch(match segments.show(&mut ui)? {
        0 => Mode::Pose,
        _ => Mode::Animate,
    }))
}

/// The row over the track.
pub(crate) fn show(ui: &mut Ui, row: Rect, choice: &Choice, shows_ghosts: bool) -> Option<Action> {
    let left = UiBuilder::new()
        .max_rect(row)
        .layout(Layout::left_to_right(Align::Center));
    let of_left = ui
        .scope_builder(left, |ui| {
            ui.spacing_mut().item_spacing.x = SPACE;
            let asked = play_button(ui, choice);
            ui.add_space(2.0);
            time_words(ui, choice);
            asked
        })
        .inner;
    let right = UiBuilder::new()
        .max_rect(row)
        .layout(Layout::right_to_left(Align::Center));
    let of_right = ui
        .scope_builder(right, |ui| {
            ui.spacing_mut().item_spacing.x = SPACE;
            ui.spacing_mut().button_padding = vec2(7.0, 4.0);
            // Right to left: the last is read first.
            let keys = key_buttons(ui, choice);
            let ghosts = ghosts_button(ui, shows_ghosts);
            let rest = settings(ui, row.width(), choice);
            keys.or(ghosts).or(rest)
        })
        .inner;
    of_left.or(of_right)
}

fn play_button(ui: &mut Ui, choice: &Choice) -> Option<Action> {
    let (rect, response) = ui.allocate_exact_size(vec2(ROW_HEIGHT, ROW_HEIGHT), Sense::click());
    let (is_playing, can_play) = (
        choice.player.is_playing,
        choice.performance.course().is_some(),
    );
    response.widget_info(|| {
        let word = if is_playing { "Pause" } else { "Play" };
        WidgetInfo::labeled(WidgetType::Button, can_play, word)
    });
    let fill = match (can_play, response.hovered()) {
        (false, _) => theme::TRACK,
        (true, false) => theme::ACCENT,
        (true, true) => theme::ACCENT.lerp_to_gamma(theme::INK, 0.25),
    };
    ui.painter().circle_filled(rect.center(), 15.0, fill);
    if is_playing {
        pause_sign(ui.painter(), rect.center());
    } else {
        play_sign(ui.painter(), rect.center());
    }
    if response.hovered() && can_play {
        ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    let clicked = response.on_hover_text("Play or pause (Space)").clicked();
    clicked.then_some(Action::Play)
}

fn play_sign(painter: &Painter, centre: Pos2) {
    let corners = [(-4.0, -6.5), (7.0, 0.0), (-4.0, 6.5)];
    let points = corners.map(|(x, y)| centre + vec2(x, y)).to_vec();
    painter.add(Shape::convex_polygon(points, theme::PAPER, Stroke::NONE));
}

fn pause_sign(painter: &Painter, centre: Pos2) {
    for x in [-6.0, 1.5] {
        let bar = Rect::from_min_size(pos2(centre.x + x, centre.y - 6.0), vec2(4.5, 12.0));
        painter.rect_filled(bar, 1.0, theme::PAPER);
    }
}

fn time_words(ui: &mut Ui, choice: &Choice) {
    let Some(course) = choice.performance.course() else {
        return;
    };
    let time_s = course.folded(choice.player.time_s);
    let color = match choice.performance.motion() {
        Some(motion) if motion.is_beyond(time_s) => theme::BEYOND,
        _ => theme::INK,
    };
    // As wide as the longest time, so that nothing beside it trembles.
    let (rect, _) = ui.allocate_exact_size(vec2(54.0, ROW_HEIGHT), Sense::hover());
    let words = format!("{time_s:.2} s");
    let at = rect.left_center();
    let align = egui::Align2::LEFT_CENTER;
    ui.painter().text(at, align, words, theme::body(), color);
}

fn button(ui: &mut Ui, words: &str, about: &str, is_enabled: bool) -> bool {
    let text = egui::RichText::new(words).font(theme::small());
    let button = egui::Button::new(text).min_size(vec2(0.0, HEIGHT));
    ui.add_enabled(is_enabled, button)
        .on_hover_text(about)
        .clicked()
}

fn key_buttons(ui: &mut Ui, choice: &Choice) -> Option<Action> {
    let can_move = choice.performance.course().is_some();
    let about =
        "Writes the motion from the first key to the last as a .glb file beside the clip file";
    let export = button(ui, "Export", about, can_move);
    let remove = button(ui, "Remove", "Removes the selected key (Delete)", true);
    let about = "Makes a key of what the body shows at the playhead (K)";
    let here = button(ui, "Key here", about, can_move);
    let clicked = [
        (export, Action::Export),
        (remove, Action::RemoveKey),
        (here, Action::KeyHere),
    ];
    let mut clicked = clicked.into_iter();
    clicked.find_map(|(is_clicked, action)| is_clicked.then_some(action))
}

fn ghosts_button(ui: &mut Ui, shows_ghosts: bool) -> Option<Action> {
    let color = if shows_ghosts {
        theme::ACCENT
    } else {
        theme::INK_SOFT
    };
    let text = egui::RichText::new("Ghosts")
        .font(theme::small())
        .color(color);
    let fill = if shows_ghosts {
        theme::faded(theme::ACCENT, 0.12)
    } else {
        Color32::TRANSPARENT
    };
    let button = egui::Button::new(text)
        .fill(fill)
        .min_size(vec2(0.0, HEIGHT));
    let about = "Shows the bodies of the neighbouring keys (G)";
    let clicked = ui.add(button).on_hover_text(about).clicked();
    clicked.then_some(Action::Ghosts)
}

fn settings(ui: &mut Ui, row_width: f32, choice: &Choice) -> Option<Action> {
    let settings = choice.document.scene().settings();
    let repeat = Segments {
        words: &REPEATS,
        active: repeat_index(settings.repeat),
        about: "After the last key (L)",
    };
    let interpolation = Segments {
        words: &INTERPOLATIONS,
        active: settings.interpolation as usize,
        about: "Between the keys (C)",
    };
    let has_room = row_width >= BUTTONS_WIDTH + repeat.width(ui) + interpolation.width(ui);
    let mut show = |segments: &Segments| {
        if has_room {
            segments.show(ui)
        } else {
            segments.show_one(ui)
        }
    };
    let interpolated = show(&interpolation).map(interpolation_of);
    let repeated = show(&repeat).map(repeat_of);
    let words = format!("{}\u{d7}", choice.player.speed);
    let speed = button(ui, &words, "Speed (S)", true).then_some(Action::Speed);
    interpolated
        .map(Action::Interpolate)
        .or(repeated.map(Action::Repeat))
        .or(speed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_comes_in_turn() {
        for index in 0..REPEATS.len() {
            assert_eq!(repeat_index(repeat_of(index)), index);
        }
        for index in 0..INTERPOLATIONS.len() {
            assert_eq!(interpolation_of(index) as usize, index);
        }
        let mut easing = Easing::default();
        for _ in Easing::ALL {
            easing = next_easing(easing);
        }
        assert_eq!(easing, Easing::default());
    }
}
