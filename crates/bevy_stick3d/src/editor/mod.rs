//! The pose editor: choose a figure, draw it on the left, see its body on the right.
//!
//! Parts that are only arithmetic or words (`layout`, `orbit`, `words`, `status_line`, `files`) know no Bevy
//! systems and are tested by themselves; so is `session`, which knows no user interface. [`run`] starts the
//! whole, in a window or to take a picture.

mod canvas;
mod files;
mod layout;
mod orbit;
mod panels;
mod session;
mod stage;
mod start;
mod status_line;
mod switch;
mod theme;
mod viewport;
mod words;

use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy::render::view::Msaa;
use bevy_egui::{
    EguiContexts, EguiGlobalSettings, EguiPostUpdateSet, EguiPrimaryContextPass,
    PrimaryEguiContext, egui,
};

pub use files::{SketchFileError, read_sketch, write_sketch};
pub use session::{EditorFigure, FirstSketch};
pub use start::{EditorError, EditorOptions, run};

use self::session::{Desk, Opening, SessionPlugin};
use self::status_line::StatusLine;
use self::viewport::View;
use crate::figure::{FigureStatus, StickFigure};
use crate::schedule::Stick3dSystems;
use crate::sketch_input::{CanvasArea, SketchCanvas, SketchDrawing};
use crate::status::Stick3dStatus;

/// The editor, for an app that has Bevy's default plugins, `EguiPlugin` and
/// [`Stick3dPlugin`](crate::Stick3dPlugin). It shows itself in the primary window.
pub struct PoseEditorPlugin {
    /// The figures to choose from.
    pub figures: Vec<EditorFigure>,
    /// The index of the one to begin with.
    pub first: usize,
    /// The sketch to begin with.
    pub sketch: Option<FirstSketch>,
    /// From where to look at the bodies: turned about the vertical, 0 for the side that is drawn.
    pub yaw_rad: Option<f32>,
    /// Whether a picture will be taken, in which nothing moves.
    pub is_picture: bool,
}

impl Plugin for PoseEditorPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(EditorClock {
            is_picture: self.is_picture,
            ..default()
        })
        .insert_resource(ClearColor(clear_color()))
        .add_plugins((
            SessionPlugin(Opening {
                figures: self.figures.clone(),
                first: self.first,
                sketch: self.sketch.clone(),
                yaw_rad: self.yaw_rad,
            }),
            viewport::ViewportPlugin,
        ))
        .add_systems(Startup, spawn_screen)
        .add_systems(First, tick.after(bevy::time::TimeSystems))
        .add_systems(EguiPrimaryContextPass, editor_ui)
        // What a button does is on screen in the same frame.
        .configure_sets(
            PostUpdate,
            Stick3dSystems::Tell.after(EguiPostUpdateSet::EndPass),
        );
    }
}

fn clear_color() -> Color {
    let [red, green, blue, _] = theme::DESK.to_array();
    Color::srgb_u8(red, green, blue)
}

/// The editor's sense of time. In pictures nothing moves.
#[derive(Resource, Default)]
struct EditorClock {
    is_picture: bool,
    seconds: f32,
    delta_s: f32,
}

impl EditorClock {
    /// From 0 to 1 and back, about once a second.
    fn pulse(&self) -> f32 {
        if self.is_picture {
            return 0.5;
        }
        0.5 - 0.5 * (self.seconds * std::f32::consts::TAU * 0.9).cos()
    }

    /// Which share of the way to go this frame, for a motion that takes about `time_s`.
    fn share_of_way(&self, time_s: f32) -> f32 {
        if self.is_picture {
            return 1.0;
        }
        1.0 - (-self.delta_s / time_s).exp()
    }
}

fn tick(mut clock: ResMut<EditorClock>, time: Res<Time>) {
    clock.seconds = time.elapsed_secs_wrapped();
    clock.delta_s = time.delta_secs();
}

fn spawn_screen(mut commands: Commands, mut egui_settings: ResMut<EguiGlobalSettings>) {
    egui_settings.auto_create_primary_context = false;
    commands.spawn((
        PrimaryEguiContext,
        Camera2d,
        Msaa::Off,
        RenderLayers::none(),
    ));
}

/// Lays the window out, paints it, and does what the user asks.
fn editor_ui(
    mut contexts: EguiContexts,
    mut desk: Desk,
    mut view: ResMut<View>,
    bodies: Query<(&StickFigure, &FigureStatus)>,
    models: Res<Stick3dStatus>,
    clock: Res<EditorClock>,
    mut is_dressed: Local<bool>,
) -> Result {
    let ctx = contexts.ctx_mut()?;
    if !*is_dressed {
        theme::apply(ctx);
        *is_dressed = true;
    }
    desk.session.status.tick(clock.delta_s);
    let window = ctx.viewport_rect();
    let mut ui = egui::Ui::new(
        ctx.clone(),
        "editor".into(),
        egui::UiBuilder::new()
            .layer_id(egui::LayerId::background())
            .max_rect(window),
    );
    let choices_width = switch::width(&ui, desk.session.choices());
    let layout = layout::Layout::of(window, choices_width);

    // First what the user asks, then the painting, so that both sides of the window show the same.
    let (choices, active) = (desk.session.choices(), desk.session.active());
    let chosen = switch::show(&mut ui, layout.choices, choices, active);
    let asked = asked_of_panels(&mut ui, &layout, &mut desk);
    if let Some(action) = chosen.or(asked).or_else(|| panels::shortcut(ctx)) {
        desk.act(action);
    }
    if let Some(mut canvas) = desk.canvas_mut() {
        place_canvas(&mut canvas, canvas::drawing_area(layout.canvas));
    }
    let is_blank = match desk.drawing() {
        Some(drawing) => {
            let words = words::next_step(drawing);
            canvas::paint(ui.painter(), layout.canvas, drawing, &words, clock.pulse());
            show_cursor(ctx, canvas::drawing_area(layout.canvas), drawing);
            drawing.joints().iter().all(Option::is_none)
        }
        None => true,
    };
    let body = desk.session.body().and_then(|body| bodies.get(body).ok());
    let status = standing_problem(&models, body, &desk.session.status);
    panels::status_text(&ui, layout.canvas, &status);
    if desk.session.is_drop_hovering {
        panels::drop_hint(&ui, layout.canvas);
    }
    let note = is_blank.then_some("The body appears here");
    let input = panels::view(&mut ui, layout.view, view.texture, note);
    let size_px = layout.view.size() * ctx.pixels_per_point();
    view.set_size(UVec2::new(size_px.x as u32, size_px.y as u32));
    if let Some(mut edited) = desk.edited_mut()
        && input != panels::ViewInput::default()
    {
        turn(&mut edited.orbit, layout.view, input);
    }
    Ok(())
}

fn asked_of_panels(
    ui: &mut egui::Ui,
    layout: &layout::Layout,
    desk: &mut Desk,
) -> Option<session::Action> {
    let mut file = desk.session.file()?.to_owned();
    let drawing = desk.drawing()?;
    let of_tools = panels::tools(ui, layout.tools, drawing);
    let of_file = panels::file(ui, layout.files, drawing, &mut file);
    desk.session.set_file(file);
    of_tools.or(of_file)
}

/// What is wrong with the body that is shown comes before what was last done.
fn standing_problem(
    models: &Stick3dStatus,
    body: Option<(&StickFigure, &FigureStatus)>,
    status: &StatusLine,
) -> StatusLine {
    let mut shown = status.clone();
    if let Some((figure, status)) = body
        && let Some(problem) = models.problem(&figure.0).or(status.problem())
    {
        shown.problem(problem);
    }
    shown
}

fn place_canvas(canvas: &mut Mut<SketchCanvas>, rect: egui::Rect) {
    let area = CanvasArea::rect(Rect::new(rect.min.x, rect.min.y, rect.max.x, rect.max.y));
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

fn turn(orbit: &mut orbit::Orbit, rect: egui::Rect, input: panels::ViewInput) {
    orbit.drag(
        Vec2::new(input.drag.x, input.drag.y),
        Vec2::new(rect.width(), rect.height()),
    );
    orbit.scroll(input.scroll);
    if input.reset {
        *orbit = orbit::Orbit::default();
    }
}
