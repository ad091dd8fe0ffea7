//! The look of the editor: colours, sizes, type.
//!
//! Paper and ink, and one accent. The right and the left limbs have the orange and the blue that stay
//! apart for every common kind of colour blindness; a filled and an open joint say the same without colour.

use bevy_egui::egui::{
    self, Color32, CornerRadius, FontFamily, FontId, Margin, Shadow, Stroke, TextStyle,
};
use stick3d_figure::Side;

/// Behind everything.
pub(super) const DESK: Color32 = Color32::from_rgb(231, 227, 219);
/// What a switch slides in.
pub(super) const TRACK: Color32 = Color32::from_rgb(217, 212, 202);
/// What is drawn on.
pub(super) const PAPER: Color32 = Color32::from_rgb(252, 250, 245);
/// The dots of the paper.
pub(super) const PAPER_DOT: Color32 = Color32::from_rgb(226, 220, 209);
/// Text, and the lines of the middle of the body.
pub(super) const INK: Color32 = Color32::from_rgb(45, 42, 38);
/// Text that should not shout.
pub(super) const INK_SOFT: Color32 = Color32::from_rgb(112, 105, 95);
/// Lines between things.
pub(super) const HAIRLINE: Color32 = Color32::from_rgb(218, 212, 201);
/// The one accent.
pub(super) const ACCENT: Color32 = Color32::from_rgb(24, 117, 104);
/// What went wrong.
pub(super) const ALERT: Color32 = Color32::from_rgb(166, 54, 38);
/// What is past the last key: nobody drew it.
pub(super) const BEYOND: Color32 = Color32::from_rgb(132, 78, 163);
/// The figure's right limbs.
pub(super) const RIGHT: Color32 = Color32::from_rgb(213, 94, 0);
/// The figure's left limbs.
pub(super) const LEFT: Color32 = Color32::from_rgb(0, 103, 178);

/// Round corners of cards, points.
pub(super) const CARD_RADIUS: f32 = 14.0;
/// Space between cards and round the window, points.
pub(super) const GAP: f32 = 16.0;

/// The colour of a side of the body.
pub(super) fn side_color(side: Side) -> Color32 {
    match side {
        Side::Center => INK,
        Side::Right => RIGHT,
        Side::Left => LEFT,
    }
}

/// The same colour with another opacity, 0 to 1.
pub(super) fn faded(color: Color32, opacity: f32) -> Color32 {
    color.gamma_multiply(opacity.clamp(0.0, 1.0))
}

/// The soft shadow under a card.
pub(super) const CARD_SHADOW: Shadow = Shadow {
    offset: [0, 4],
    blur: 24,
    spread: 0,
    color: Color32::from_black_alpha(26),
};

/// Large words: what to do next.
pub(super) fn headline() -> FontId {
    FontId::new(24.0, FontFamily::Proportional)
}

/// The same where there is little room.
pub(super) fn small_headline() -> FontId {
    FontId::new(19.0, FontFamily::Proportional)
}

/// Running text.
pub(super) fn body() -> FontId {
    FontId::new(15.0, FontFamily::Proportional)
}

/// Labels and hints.
pub(super) fn small() -> FontId {
    FontId::new(13.0, FontFamily::Proportional)
}

/// The names of times.
pub(super) fn tiny() -> FontId {
    FontId::new(11.0, FontFamily::Proportional)
}

/// Makes egui look like the rest of the editor.
pub(super) fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Light);
    ctx.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Heading, headline()),
            (TextStyle::Body, body()),
            (TextStyle::Button, body()),
            (TextStyle::Small, small()),
            (
                TextStyle::Monospace,
                FontId::new(14.0, FontFamily::Monospace),
            ),
        ]
        .into();
        style.interaction.selectable_labels = false;
        style.spacing.button_padding = egui::vec2(10.0, 6.0);
        style.spacing.item_spacing = egui::vec2(8.0, 8.0);
        style.spacing.window_margin = Margin::same(12);
        let visuals = &mut style.visuals;
        visuals.override_text_color = None;
        visuals.panel_fill = DESK;
        visuals.extreme_bg_color = Color32::WHITE;
        visuals.selection.bg_fill = faded(ACCENT, 0.25);
        visuals.selection.stroke = Stroke::new(1.0, ACCENT);
        let widgets = &mut visuals.widgets;
        for (widget, fill, ink, edge) in [
            (&mut widgets.noninteractive, PAPER, INK_SOFT, HAIRLINE),
            (
                &mut widgets.inactive,
                Color32::TRANSPARENT,
                INK,
                Color32::TRANSPARENT,
            ),
            (
                &mut widgets.hovered,
                faded(ACCENT, 0.10),
                ACCENT,
                Color32::TRANSPARENT,
            ),
            (
                &mut widgets.active,
                faded(ACCENT, 0.20),
                ACCENT,
                Color32::TRANSPARENT,
            ),
        ] {
            widget.weak_bg_fill = fill;
            widget.bg_fill = fill;
            widget.bg_stroke = Stroke::new(1.0, edge);
            widget.fg_stroke = Stroke::new(1.5, ink);
            widget.corner_radius = CornerRadius::same(8);
            widget.expansion = 0.0;
        }
    });
}
