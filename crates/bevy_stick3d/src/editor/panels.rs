//! The parts of the window that are not paper: tools, status line, and the frame of the 3D view.

use bevy_egui::egui::{
    self, Align, Align2, Button, Color32, CornerRadius, Key, KeyboardShortcut, Layout, Modifiers,
    Rect, RichText, Sense, Stroke, StrokeKind, TextEdit, Ui, UiBuilder, load::SizedTexture, vec2,
};

use super::status_line::StatusLine;
use super::theme;
use crate::sketch_input::SketchDrawing;

/// What the user asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    Undo,
    Redo,
    Mirror,
    Clear,
    Save,
    Open,
}

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// The keys, the longer combinations first: a match takes the key from those after it.
const SHORTCUTS: [(Modifiers, Key, Action); 7] = [
    (COMMAND_SHIFT, Key::Z, Action::Redo),
    (Modifiers::COMMAND, Key::Y, Action::Redo),
    (Modifiers::COMMAND, Key::Z, Action::Undo),
    (Modifiers::COMMAND, Key::S, Action::Save),
    (Modifiers::COMMAND, Key::O, Action::Open),
    (Modifiers::NONE, Key::M, Action::Mirror),
    (Modifiers::NONE, Key::Escape, Action::Clear),
];

/// The key combination that was pressed, unless somebody is typing.
pub(super) fn shortcut(ctx: &egui::Context) -> Option<Action> {
    let typing = ctx.egui_wants_keyboard_input();
    ctx.input_mut(|input| {
        SHORTCUTS
            .iter()
            .filter(|(_, _, action)| !typing || matches!(action, Action::Save | Action::Open))
            .find(|(modifiers, key, _)| {
                input.consume_shortcut(&KeyboardShortcut::new(*modifiers, *key))
            })
            .map(|(.., action)| *action)
    })
}

/// The strip under the canvas: what can be done, and the file.
pub(super) fn toolbar(
    ui: &mut Ui,
    rect: Rect,
    drawing: &SketchDrawing,
    file: &mut String,
) -> Option<Action> {
    let mut action = None;
    let mut button = |ui: &mut Ui, words: &str, keys: &str, enabled: bool, meaning: Action| {
        let button = Button::new(words).min_size(vec2(0.0, 32.0));
        let response = ui.add_enabled(enabled, button);
        if response.on_hover_text(keys).clicked() {
            action = Some(meaning);
        }
    };
    let begun = !drawing.strokes().is_empty() || drawing.sketch().is_some();
    let finished = drawing.sketch().is_some();
    let strip = rect.with_min_y(rect.max.y - 36.0);
    ui.scope_builder(
        UiBuilder::new()
            .max_rect(strip)
            .layout(Layout::left_to_right(Align::Center)),
        |ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            button(
                ui,
                "Undo",
                "Ctrl+Z, or scribble",
                drawing.can_undo(),
                Action::Undo,
            );
            button(ui, "Redo", "Ctrl+Shift+Z", drawing.can_redo(), Action::Redo);
            button(ui, "Mirror", "M", finished, Action::Mirror);
            button(ui, "Clear", "Esc", begun, Action::Clear);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                button(ui, "Save", "Ctrl+S", finished, Action::Save);
                button(
                    ui,
                    "Open",
                    "Ctrl+O, or drop a file on the window",
                    true,
                    Action::Open,
                );
                let width = (ui.available_width() - 8.0).clamp(40.0, 200.0);
                ui.add(
                    TextEdit::singleline(file)
                        .hint_text("sketch.json")
                        .desired_width(width)
                        .text_color(theme::INK_SOFT)
                        .font(theme::small()),
                );
            });
        },
    );
    action
}

/// One quiet line inside the canvas' lower edge.
pub(super) fn status_text(ui: &Ui, canvas: Rect, status: &StatusLine) {
    let Some((text, is_problem)) = status.shown() else {
        return;
    };
    let color = if is_problem {
        theme::ALERT
    } else {
        theme::INK_SOFT
    };
    let room = canvas.width() - 48.0;
    let galley = ui
        .painter()
        .layout(text.to_owned(), theme::small(), color, room.max(40.0));
    let at = canvas.left_bottom() + vec2(24.0, -18.0 - galley.size().y);
    ui.painter().galley(at, galley, color);
}

/// What the pointer did to the 3D view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ViewInput {
    /// Points dragged.
    pub(super) drag: egui::Vec2,
    /// Points scrolled.
    pub(super) scroll: f32,
    /// Back to the first view.
    pub(super) reset: bool,
}

/// The 3D view in its frame.
pub(super) fn view(
    ui: &mut Ui,
    rect: Rect,
    texture: egui::TextureId,
    note: Option<&str>,
) -> ViewInput {
    let corners = CornerRadius::from(theme::CARD_RADIUS);
    ui.painter().add(theme::CARD_SHADOW.as_shape(rect, corners));
    egui::Image::from_texture(SizedTexture::new(texture, rect.size()))
        .corner_radius(corners)
        .paint_at(ui, rect);
    ui.painter().rect_stroke(
        rect,
        corners,
        Stroke::new(1.0, Color32::from_black_alpha(18)),
        StrokeKind::Inside,
    );
    if let Some(note) = note {
        ui.painter().text(
            rect.center(),
            Align2::CENTER_CENTER,
            note,
            theme::body(),
            theme::faded(theme::INK, 0.45),
        );
    }
    ui.painter().text(
        rect.center_bottom() - vec2(0.0, 16.0),
        Align2::CENTER_BOTTOM,
        "Drag to turn, scroll to zoom, double-click to reset",
        theme::small(),
        theme::faded(theme::INK, 0.55),
    );
    let response = ui.interact(rect, ui.id().with("view"), Sense::click_and_drag());
    let scroll = if response.hovered() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Grab);
        ui.input(|input| input.smooth_scroll_delta.y)
    } else {
        0.0
    };
    if response.dragged() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Grabbing);
    }
    ViewInput {
        drag: response.drag_delta(),
        scroll,
        reset: response.double_clicked(),
    }
}

/// A file is being dragged over the window.
pub(super) fn drop_hint(ui: &Ui, canvas: Rect) {
    let corners = CornerRadius::from(theme::CARD_RADIUS);
    ui.painter()
        .rect_filled(canvas, corners, theme::faded(theme::ACCENT, 0.12));
    ui.painter().rect_stroke(
        canvas,
        corners,
        Stroke::new(2.0, theme::ACCENT),
        StrokeKind::Inside,
    );
    let words = RichText::new("Drop the sketch here").font(theme::headline());
    ui.painter().text(
        canvas.center(),
        Align2::CENTER_CENTER,
        words.text(),
        theme::headline(),
        theme::ACCENT,
    );
}
