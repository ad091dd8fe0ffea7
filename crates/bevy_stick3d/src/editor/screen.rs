//! What is in the window, from frame to frame: the parts laid out, painted, and asked what the user wants.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_egui::{EguiContexts, egui};

use super::canvas::{self, Card};
use super::layout::Layout;
use super::panels::{self, ViewInput};
use super::session::{Action, Desk, Mode};
use super::status_line::StatusLine;
use super::timeline::{controls, track};
use super::viewport::{View, ViewCamera};
use super::{EditorClock, gallery, orbit, picking, switch, theme, words};
use crate::figure::{FigureStatus, StickFigure};
use crate::sketch_input::{CanvasArea, SketchCanvas, SketchDrawing};
use crate::status::Stick3dStatus;
use crate::stream::StreamedBody;

/// Lays the window out, paints it, and does what the user asks.
pub(super) fn show(
    mut contexts: EguiContexts,
    mut desk: Desk,
    mut view: ResMut<View>,
    stage: Stage,
    models: Res<Stick3dStatus>,
    clock: Res<EditorClock>,
    mut is_dressed: Local<bool>,
) -> Result {
    let ctx = contexts.ctx_mut()?;
    if !*is_dressed {
        theme::apply(ctx);
        *is_dressed = true;
    }
    desk.settle();
    desk.session.status.tick(clock.delta_s);
    let window = ctx.viewport_rect();
    let mut ui = egui::Ui::new(
        ctx.clone(),
        "editor".into(),
        egui::UiBuilder::new()
            .layer_id(egui::LayerId::background())
            .max_rect(window),
    );
    // First what the user asks, then the painting, so that all parts of the window show the same.
    let view_now = lay_out(&ui, window, &desk).view;
    let tab = panels::tab(ctx, &desk.session);
    let switched = controls::mode_switch(ctx, view_now, desk.session.mode()).or(tab);
    if let Some(action) = switched.or_else(|| panels::shortcut(ctx, &desk.session)) {
        desk.act(action);
    }
    let layout = lay_out(&ui, window, &desk);
    if let Some(action) = asked_of_panels(&mut ui, &layout, &mut desk) {
        desk.act(action);
    }
    let is_blank = show_canvases(&ui, &layout, &mut desk, &clock);
    let body = desk.session.body();
    let body = body.and_then(|body| stage.bodies.get(body).ok());
    let body = body.map(|(figure, status, ..)| (figure, status));
    let status = standing_problem(&models, body, &desk);
    panels::status_text(&ui, layout.canvas, &status);
    if desk.session.is_drop_hovering {
        panels::drop_hint(&ui, layout.canvas);
    }
    let note = is_blank.then_some("The body appears here");
    let help = view_help(layout.gallery.is_some());
    let input = panels::view(&mut ui, layout.view, view.texture, note, help);
    let limb = limb_under(&desk, &stage, layout.view, input.hover);
    if limb.is_some() {
        ctx.set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    if let Some(joint) = limb.filter(|_| input.is_click) {
        desk.act(Action::Flip(joint));
    }
    let size_px = layout.view.size() * ctx.pixels_per_point();
    view.set_size(UVec2::new(size_px.x as u32, size_px.y as u32));
    if let Some(mut edited) = desk.edited_mut()
        && input != ViewInput::default()
    {
        turn(&mut edited.orbit, layout.view, input);
    }
    Ok(())
}

fn lay_out(ui: &egui::Ui, window: egui::Rect, desk: &Desk) -> Layout {
    let choices_width = switch::width(ui, desk.session.choices());
    let layout = Layout::of(window, choices_width, desk.session.mode());
    match (desk.session.mode(), desk.alternatives()) {
        (Mode::Pose, Some(_)) => layout.with_gallery(),
        _ => layout,
    }
}

/// Where the body that is shown stands, and who looks at it.
#[derive(SystemParam)]
pub(super) struct Stage<'w, 's> {
    bodies: Query<
        'w,
        's,
        (
            &'static StickFigure,
            &'static FigureStatus,
            &'static StreamedBody,
            &'static Transform,
        ),
    >,
    cameras: Query<'w, 's, &'static Transform, With<ViewCamera>>,
}

/// The end of the limb of the body under the pointer.
fn limb_under(
    desk: &Desk,
    stage: &Stage,
    view: egui::Rect,
    at: Option<egui::Pos2>,
) -> Option<usize> {
    let choice = desk.session.choice()?;
    if desk.session.mode() != Mode::Pose {
        return None;
    }
    let shown = desk.alternatives()?.shown()?;
    let (.., body, transform) = stage.bodies.get(choice.body).ok()?;
    let raised = Vec3::Y * body.root_height_m();
    let joints = shown.joints.iter();
    let joints: Vec<Vec3> = joints
        .map(|joint| transform.transform_point(*joint + raised))
        .collect();
    let camera = stage.cameras.single().ok()?;
    picking::limb_at(choice.figure.figure(), &joints, camera, view, at?)
}

/// What can be done with the 3D view, in more and in fewer words.
fn view_help(has_body: bool) -> &'static [&'static str] {
    if has_body {
        &[
            "Drag to turn, scroll to zoom. Click a limb to turn its depth round",
            "Drag to turn, click a limb to turn it round",
        ]
    } else {
        &["Drag to turn, scroll to zoom, double-click to reset"]
    }
}

fn asked_of_panels(ui: &mut egui::Ui, layout: &Layout, desk: &mut Desk) -> Option<Action> {
    let (choices, active) = (desk.session.choices(), desk.session.active());
    let chosen = switch::show(ui, layout.choices, choices, active);
    let mut file = desk.session.file()?.to_owned();
    let choice = desk.session.choice()?;
    let of_tools = panels::tools(
        ui,
        layout.tools,
        desk.drawing()?,
        desk.session.order(),
        &choice.document,
    );
    let mode = desk.session.mode();
    let can_save = match mode {
        Mode::Pose => desk.drawing()?.sketch().is_some(),
        Mode::Animate => choice.document.scene().can_move(),
    };
    let of_file = panels::file(ui, layout.files, mode, can_save, &mut file);
    let of_timeline = layout.timeline.and_then(|rect| {
        let inner = panels::card(ui, rect);
        let row = inner.with_max_y(inner.min.y + controls::ROW_HEIGHT);
        let below = inner.with_min_y(row.max.y + 4.0);
        let of_controls = controls::show(ui, row, choice, desk.session.shows_ghosts);
        track::show(ui, below, choice).or(of_controls)
    });
    let of_gallery = layout
        .gallery
        .and_then(|grid| gallery::show(ui, &grid, choice.figure.figure(), desk.alternatives()?));
    desk.session.set_file(file);
    chosen
        .or(of_tools)
        .or(of_file)
        .or(of_timeline)
        .or(of_gallery)
}

/// Paints the drawings, and says whether nothing is drawn at all.
fn show_canvases(ui: &egui::Ui, layout: &Layout, desk: &mut Desk, clock: &EditorClock) -> bool {
    let Some(choice) = desk.session.choice() else {
        return true;
    };
    let (mode, selected) = (desk.session.mode(), choice.document.selected());
    let keys = choice.document.scene().keys();
    let is_blank = keys.iter().all(|key| key.ink == Default::default())
        && desk
            .drawing()
            .is_none_or(|drawing| drawing.joints().iter().all(Option::is_none));
    let is_small = mode == Mode::Animate;
    let mut areas = [None; 2];
    for (slot, area) in areas.iter_mut().enumerate() {
        let Some((key, drawing)) = desk.drawing_on(slot) else {
            continue;
        };
        let rect = match layout.pair {
            Some(pair) => pair[slot],
            None if key == selected => layout.canvas,
            None => continue,
        };
        let place = choice.document.scene().index_of(key).unwrap_or(0);
        let words = match mode {
            Mode::Pose => words::next_step(drawing),
            Mode::Animate => words::key_words(place, keys.len(), drawing),
        };
        let before = place
            .checked_sub(1)
            .and_then(|before| keys[before].sketch())
            .filter(|_| is_small && drawing.sketch().is_some());
        let card = Card {
            rect,
            drawing,
            words: &words,
            is_small,
            is_selected: key == selected,
            before,
        };
        canvas::paint(ui.painter(), &card, clock.pulse());
        let drawn_on = canvas::drawing_area(rect, is_small);
        show_cursor(ui.ctx(), drawn_on, drawing);
        *area = Some(drawn_on);
    }
    for (slot, area) in areas.into_iter().enumerate() {
        if let Some(mut canvas) = desk.canvas_mut(slot) {
            place_canvas(&mut canvas, area.unwrap_or(egui::Rect::NOTHING));
        }
    }
    is_blank
}

/// What is wrong with the body or with the motion comes before what was last done.
fn standing_problem(
    models: &Stick3dStatus,
    body: Option<(&StickFigure, &FigureStatus)>,
    desk: &Desk,
) -> StatusLine {
    let mut shown = desk.session.status.clone();
    let of_motion = || desk.session.choice()?.performance.problem();
    if let Some((figure, status)) = body
        && let Some(problem) = models.problem(&figure.0).or(status.problem())
    {
        shown.problem(problem);
    } else if let Some(problem) = of_motion() {
        shown.problem(problem);
    }
    shown
}

fn place_canvas(canvas: &mut Mut<SketchCanvas>, rect: egui::Rect) {
    let area = CanvasArea::rect(Rect {
        min: Vec2::new(rect.min.x, rect.min.y),
        max: Vec2::new(rect.max.x, rect.max.y),
    });
    if canvas.area != area {
        canvas.area = area;
    }
}

fn show_cursor(ctx: &egui::Context, canvas: egui::Rect, drawing: &SketchDrawing) {
    let over = ctx
        .pointer_hover_pos()
        .is_some_and(|at| canvas.contains(at));
    if drawing.dragged().is_some() {
        ctx.set_cursor_icon(egui::CursorIcon::Grabbing);
    } else if over && drawing.hovered().is_some() {
        ctx.set_cursor_icon(egui::CursorIcon::Grab);
    } else if over && drawing.sketch().is_none() {
        ctx.set_cursor_icon(egui::CursorIcon::Crosshair);
    }
}

fn turn(orbit: &mut orbit::Orbit, rect: egui::Rect, input: ViewInput) {
    orbit.drag(
        Vec2::new(input.drag.x, input.drag.y),
        Vec2::new(rect.width(), rect.height()),
    );
    orbit.scroll(input.scroll);
    if input.reset {
        *orbit = orbit::Orbit::default();
    }
}
