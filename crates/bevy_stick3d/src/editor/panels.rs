//! The parts of the window that are not paper: tools, status line, and the frame of the 3D view.

use bevy_egui::egui::{
    self, Align, Align2, Button, Color32, CornerRadius, FocusDirection, Key, KeyboardShortcut,
    Layout, Modifiers, Rect, RichText, Sense, Stroke, StrokeKind, TextEdit, Ui, UiBuilder,
    load::SizedTexture, vec2,
};

use super::session::{Action, Mode, Session};
use super::status_line::StatusLine;
use super::theme;
use super::timeline::controls;
use super::timeline::history::Document;
use crate::sketch_input::{DrawingOrder, SketchDrawing};

/// The file field is at most so wide, points.
const FILE_WIDTH: f32 = 200.0;
/// In narrower rows buttons are closer together, points.
const NARROW_ROW: f32 = 340.0;

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// The keys of the first figures.
const FIGURE_KEYS: [Key; 9] = [
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::Num6,
    Key::Num7,
    Key::Num8,
    Key::Num9,
];

/// The keys, the longer combinations first: a match takes the key from those after it.
const SHORTCUTS: [(Modifiers, Key, Action); 10] = [
    (COMMAND_SHIFT, Key::Z, Action::Redo),
    (Modifiers::COMMAND, Key::Y, Action::Redo),
    (Modifiers::COMMAND, Key::Z, Action::Undo),
    (Modifiers::COMMAND, Key::S, Action::Save),
    (Modifiers::COMMAND, Key::O, Action::Open),
    (Modifiers::NONE, Key::M, Action::Mirror),
    (Modifiers::NONE, Key::X, Action::SwapSides),
    (Modifiers::NONE, Key::O, Action::Order),
    (Modifiers::NONE, Key::Enter, Action::Finish),
    (Modifiers::NONE, Key::Escape, Action::Clear),
];

/// The key combination that was pressed, unless somebody is typing.
pub(super) fn shortcut(ctx: &egui::Context, session: &Session) -> Option<Action> {
    let typing = ctx.egui_wants_keyboard_input();
    let (mode, other) = match session.mode() {
        Mode::Pose => (Mode::Pose, Mode::Animate),
        Mode::Animate => (Mode::Animate, Mode::Pose),
    };
    ctx.input_mut(|input| {
        SHORTCUTS
            .iter()
            .filter(|(_, _, action)| !typing || matches!(action, Action::Save | Action::Open))
            .find(|(modifiers, key, _)| {
                input.consume_shortcut(&KeyboardShortcut::new(*modifiers, *key))
            })
            .map(|(.., action)| *action)
            .or_else(|| {
                FIGURE_KEYS
                    .iter()
                    .position(|key| !typing && input.consume_key(Modifiers::NONE, *key))
                    .map(Action::Choose)
            })
            .or_else(|| {
                let asked = !typing && input.consume_key(Modifiers::NONE, Key::A);
                asked.then_some(Action::Switch(other))
            })
            .or_else(|| {
                let choice = session.choice()?;
                (!typing && mode == Mode::Animate)
                    .then(|| controls::shortcut(input, choice))
                    .flatten()
            })
    })
}

/// Tab and Shift+Tab go through the bodies that a drawing may mean, and not through the buttons, unless somebody is typing.
pub(super) fn tab(ctx: &egui::Context, session: &Session) -> Option<Action> {
    if session.mode() != Mode::Pose || ctx.egui_wants_keyboard_input() {
        return None;
    }
    let keys = [
        (Modifiers::SHIFT, Action::LastAlternative),
        (Modifiers::NONE, Action::NextAlternative),
    ];
    let asked = ctx.input_mut(|input| {
        let mut keys = keys.into_iter();
        keys.find(|(modifiers, _)| input.consume_key(*modifiers, Key::Tab))
    });
    asked.map(|(_, action)| {
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
        action
    })
}

/// One button of a row.
struct Tool {
    words: &'static str,
    keys: &'static str,
    enabled: bool,
    action: Action,
}

impl Tool {
    fn new(words: &'static str, keys: &'static str, enabled: bool, action: Action) -> Self {
        Self {
            words,
            keys,
            enabled,
            action,
        }
    }

    /// Shows it; says whether it was clicked.
    fn show(&self, ui: &mut Ui) -> bool {
        let button = Button::new(self.words).min_size(vec2(0.0, 32.0));
        ui.add_enabled(self.enabled, button)
            .on_hover_text(self.keys)
            .clicked()
    }
}

/// A row of things beside each other, which paints nowhere else.
fn row(ui: &mut Ui, rect: Rect, layout: Layout, content: impl FnOnce(&mut Ui)) {
    ui.scope_builder(UiBuilder::new().max_rect(rect).layout(layout), |ui| {
        ui.shrink_clip_rect(rect);
        ui.spacing_mut().item_spacing.x = 2.0;
        if rect.width() < NARROW_ROW {
            ui.spacing_mut().button_padding.x = 5.0;
        }
        content(ui);
    });
}

/// What can be done with the drawing, and with its history.
pub(super) fn tools(
    ui: &mut Ui,
    rect: Rect,
    drawing: &SketchDrawing,
    order: DrawingOrder,
    document: &Document,
) -> Option<Action> {
    let begun = !drawing.strokes().is_empty() || drawing.sketch().is_some();
    let finished = drawing.sketch().is_some();
    let tools = [
        Tool::new(
            "Undo",
            "Ctrl+Z, or scribble",
            document.can_undo(),
            Action::Undo,
        ),
        Tool::new("Redo", "Ctrl+Shift+Z", document.can_redo(), Action::Redo),
        Tool::new("Mirror", "M", finished, Action::Mirror),
        Tool::new(
            "L/R",
            "X exchanges left and right of the arms or legs you last pointed at",
            begun && drawing.limb().is_some(),
            Action::SwapSides,
        ),
        match order {
            DrawingOrder::Any => Tool::new(
                "Guide",
                "O: draw in the order that is shown, which says which limb is which",
                true,
                Action::Order,
            ),
            DrawingOrder::Guided => Tool::new(
                "Any order",
                "O: draw in whatever order you like",
                true,
                Action::Order,
            ),
        },
        Tool::new("Clear", "Esc", begun, Action::Clear),
    ];
    let mut asked = None;
    row(ui, rect, Layout::left_to_right(Align::Center), |ui| {
        for tool in tools.iter().filter(|tool| tool.show(ui)) {
            asked = Some(tool.action);
        }
    });
    asked
}

/// The file, and what can be done with it.
pub(super) fn file(
    ui: &mut Ui,
    rect: Rect,
    mode: Mode,
    can_save: bool,
    file: &mut String,
) -> Option<Action> {
    let hint = match mode {
        Mode::Pose => "sketch.json",
        Mode::Animate => "motion.clip.ron",
    };
    let tools = [
        Tool::new("Save", "Ctrl+S", can_save, Action::Save),
        Tool::new(
            "Open",
            "Ctrl+O, or drop a file on the window",
            true,
            Action::Open,
        ),
    ];
    let mut asked = None;
    row(ui, rect, Layout::right_to_left(Align::Center), |ui| {
        for tool in tools.iter().filter(|tool| tool.show(ui)) {
            asked = Some(tool.action);
        }
        let width = (ui.available_width() - 8.0).clamp(1.0, FILE_WIDTH);
        ui.add(
            TextEdit::singleline(file)
                .hint_text(hint)
                .desired_width(width)
                .text_color(theme::INK_SOFT)
                .font(theme::small()),
        );
    });
    asked
}

/// A card of paper; its inside.
pub(super) fn card(ui: &Ui, rect: Rect) -> Rect {
    let corners = CornerRadius::from(theme::CARD_RADIUS);
    ui.painter().add(theme::CARD_SHADOW.as_shape(rect, corners));
    ui.painter().rect_filled(rect, corners, theme::PAPER);
    ui.painter().rect_stroke(
        rect,
        corners,
        Stroke::new(1.0, theme::HAIRLINE),
        StrokeKind::Inside,
    );
    rect.shrink2(vec2(12.0, 7.0))
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
    /// Where the pointer is over it without dragging,
    pub(super) hover: Option<egui::Pos2>,
    /// and whether it clicked there.
    pub(super) is_click: bool,
}

/// The 3D view in its frame.
pub(super) fn view(
    ui: &mut Ui,
    rect: Rect,
    texture: egui::TextureId,
    note: Option<&str>,
    help: &[&str],
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
    // The longest that has room.
    let ink = theme::faded(theme::INK, 0.55);
    let layout = |help: &&str| {
        ui.painter()
            .layout_no_wrap((*help).to_owned(), theme::small(), ink)
    };
    let mut helps = help.iter().map(layout);
    if let Some(help) = helps.find(|help| help.size().x < rect.width() - 24.0) {
        let at = rect.center_bottom() - vec2(help.size().x / 2.0, 16.0 + help.size().y);
        ui.painter().galley(at, help, theme::INK);
    }
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
        hover: response.hover_pos().filter(|_| !response.dragged()),
        is_click: response.clicked(),
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
    let words = RichText::new("Drop the sketch or clip here").font(theme::headline());
    ui.painter().text(
        canvas.center(),
        Align2::CENTER_CENTER,
        words.text(),
        theme::headline(),
        theme::ACCENT,
    );
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::{Event, RawInput};

    use super::*;

    #[test]
    fn tab_goes_through_the_bodies_and_not_through_the_buttons() {
        let ctx = egui::Context::default();
        let press = |key, modifiers| {
            let event = Event::Key {
                key,
                physical_key: None,
                pressed: true,
                repeat: false,
                modifiers,
            };
            ctx.begin_pass(RawInput {
                events: vec![event],
                ..RawInput::default()
            });
            let asked = tab(&ctx, &Session::default());
            let button = Ui::new(ctx.clone(), "test".into(), UiBuilder::new()).button("Undo");
            ctx.end_pass().textures_delta.clear();
            assert!(!button.has_focus());
            asked
        };
        let next = Some(Action::NextAlternative);
        assert_eq!(press(Key::Tab, Modifiers::NONE), next);
        assert_eq!(press(Key::Tab, Modifiers::NONE), next);
        let last = Some(Action::LastAlternative);
        assert_eq!(press(Key::Tab, Modifiers::SHIFT), last);
        assert_eq!(press(Key::M, Modifiers::NONE), None);
    }
}
