//! The pose editor: draw a stick figure on the left, see the body on the right.
//!
//! Parts that are only arithmetic or words (`layout`, `orbit`, `words`, `status_line`, `files`) know no Bevy
//! systems and are tested by themselves; [`run`] starts the whole, in a window or to take a picture.

mod canvas;
mod files;
mod launch;
mod layout;
mod orbit;
mod panels;
mod screenshot;
mod stage;
mod status_line;
mod theme;
mod viewport;
mod words;

use std::path::{Path, PathBuf};

use bevy::camera::RenderTarget;
use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::Msaa;
use bevy::window::FileDragAndDrop;
use bevy_egui::{
    EguiContexts, EguiGlobalSettings, EguiPostUpdateSet, EguiPrimaryContextPass,
    PrimaryEguiContext, egui,
};
use stick3d_figure::Sketch;

pub use files::{SketchFileError, read_sketch, write_sketch};
pub use launch::{EditorError, EditorOptions, run};
pub use screenshot::ScreenshotError;

use self::panels::Action;
use self::status_line::StatusLine;
use self::viewport::{EditedFigure, View};
use crate::figure::{FigureStatus, StickFigure};
use crate::schedule::Stick3dSystems;
use crate::sketch_input::{CanvasArea, SketchCanvas, SketchDrawing};
use crate::status::Stick3dStatus;

/// Where a sketch is saved when nothing else is said.
const DEFAULT_FILE: &str = "sketch.json";

/// Where the editor is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditorSurface {
    /// The primary window.
    Window,
    /// An image of this size in pixels, which nobody sees; see [`EditorOptions::screenshot`].
    Picture(UVec2),
}

/// The editor, for an app that has Bevy's default plugins, `EguiPlugin` and
/// [`Stick3dPlugin`](crate::Stick3dPlugin).
pub struct PoseEditorPlugin {
    /// The sketch to begin with.
    pub sketch: Option<Sketch>,
    /// Where to show it.
    pub surface: EditorSurface,
    /// The file that Save and Open begin with.
    pub file: Option<PathBuf>,
}

impl Plugin for PoseEditorPlugin {
    fn build(&self, app: &mut App) {
        let file = self.file.as_deref().unwrap_or(Path::new(DEFAULT_FILE));
        app.insert_resource(Editor {
            surface: self.surface,
            first_sketch: self.sketch.clone(),
            file: file.display().to_string(),
            status: StatusLine::default(),
            is_drop_hovering: false,
        })
        .insert_resource(EditorClock {
            is_picture: self.surface != EditorSurface::Window,
            ..default()
        })
        .insert_resource(ClearColor(clear_color()))
        .add_plugins(viewport::ViewportPlugin)
        .add_systems(Startup, spawn_editor)
        .add_systems(First, tick.after(bevy::time::TimeSystems))
        .add_systems(Update, take_dropped_files)
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

/// What the editor remembers.
#[derive(Resource)]
struct Editor {
    surface: EditorSurface,
    first_sketch: Option<Sketch>,
    file: String,
    status: StatusLine,
    is_drop_hovering: bool,
}

/// The image that is the editor's screen when there is no window.
#[derive(Resource)]
struct PictureTarget(Handle<Image>);

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

fn spawn_editor(
    mut commands: Commands,
    mut editor: ResMut<Editor>,
    mut images: ResMut<Assets<Image>>,
    mut egui_settings: ResMut<EguiGlobalSettings>,
) {
    egui_settings.auto_create_primary_context = false;
    let figure = commands
        .spawn((EditedFigure, StickFigure::human(), Visibility::Hidden))
        .id();
    let mut drawing = SketchDrawing::default();
    if let Some(sketch) = editor.first_sketch.take()
        && let Err(error) = drawing.load(&sketch)
    {
        editor.status.problem(error.to_string());
    }
    commands.spawn((
        SketchCanvas::new(CanvasArea::rect(Rect::default()), figure).with_preview(),
        drawing,
    ));
    let mut camera = commands.spawn((
        PrimaryEguiContext,
        Camera2d,
        Msaa::Off,
        RenderLayers::none(),
    ));
    if let EditorSurface::Picture(size_px) = editor.surface {
        let image = images.add(Image::new_target_texture(
            size_px.x.max(16),
            size_px.y.max(16),
            TextureFormat::Rgba8UnormSrgb,
            None,
        ));
        camera.insert(RenderTarget::Image(image.clone().into()));
        commands.insert_resource(PictureTarget(image));
    }
}

/// Lays the window out, paints it, and does what the user asks.
fn editor_ui(
    mut contexts: EguiContexts,
    mut editor: ResMut<Editor>,
    mut view: ResMut<View>,
    mut canvases: Query<(&mut SketchCanvas, &mut SketchDrawing)>,
    figures: Query<&FigureStatus, With<EditedFigure>>,
    models: Res<Stick3dStatus>,
    clock: Res<EditorClock>,
    mut is_dressed: Local<bool>,
) -> Result {
    let ctx = contexts.ctx_mut()?;
    if !*is_dressed {
        theme::apply(ctx);
        *is_dressed = true;
    }
    let Ok((mut canvas, mut drawing)) = canvases.single_mut() else {
        return Ok(());
    };
    editor.status.tick(clock.delta_s);
    let window = ctx.viewport_rect();
    let layout = layout::Layout::of(window);
    let mut ui = egui::Ui::new(
        ctx.clone(),
        "editor".into(),
        egui::UiBuilder::new()
            .layer_id(egui::LayerId::background())
            .max_rect(window),
    );

    place_canvas(&mut canvas, layout.canvas);
    // First what the user asks, then the painting, so that both sides of the window show the same.
    let asked = panels::toolbar(&mut ui, layout.toolbar, &drawing, &mut editor.file);
    if let Some(action) = asked.or_else(|| panels::shortcut(ctx)) {
        act(action, &mut editor, &mut drawing);
    }
    let words = words::next_step(&drawing);
    canvas::paint(ui.painter(), layout.canvas, &drawing, &words, clock.pulse());
    show_cursor(ctx, layout.canvas, &drawing);
    let status = standing_problem(&models, &figures, &editor.status);
    panels::status_text(&ui, layout.canvas, &status);
    if editor.is_drop_hovering {
        panels::drop_hint(&ui, layout.canvas);
    }
    let note = drawing
        .joints()
        .iter()
        .all(Option::is_none)
        .then_some("The body appears here");
    let input = panels::view(&mut ui, layout.view, view.texture, note);
    turn_view(&mut view, layout.view, input, ctx.pixels_per_point());
    Ok(())
}

/// What is wrong with the body comes before what was last done.
fn standing_problem(
    models: &Stick3dStatus,
    figures: &Query<&FigureStatus, With<EditedFigure>>,
    status: &StatusLine,
) -> StatusLine {
    let mut shown = status.clone();
    let body = figures.iter().find_map(FigureStatus::problem);
    if let Some(problem) = models.problems().first().copied().or(body) {
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

fn turn_view(view: &mut View, rect: egui::Rect, input: panels::ViewInput, pixels_per_point: f32) {
    let size_px = rect.size() * pixels_per_point;
    view.set_size(UVec2::new(size_px.x as u32, size_px.y as u32));
    view.orbit.drag(
        Vec2::new(input.drag.x, input.drag.y),
        Vec2::new(rect.width(), rect.height()),
    );
    view.orbit.scroll(input.scroll);
    if input.reset {
        view.orbit = orbit::Orbit::default();
    }
}

fn act(action: Action, editor: &mut Editor, drawing: &mut SketchDrawing) {
    match action {
        Action::Undo => drawing.undo(),
        Action::Redo => drawing.redo(),
        Action::Clear => drawing.clear(),
        Action::Mirror => {
            if !drawing.mirror() {
                editor.status.note("There is nothing to mirror yet");
            }
            return;
        }
        Action::Save => return save(editor, drawing),
        Action::Open => {
            let path = chosen_file(editor);
            return open(&path, editor, drawing);
        }
    }
    editor.status.clear();
}

fn chosen_file(editor: &Editor) -> PathBuf {
    match editor.file.trim() {
        "" => PathBuf::from(DEFAULT_FILE),
        file => PathBuf::from(file),
    }
}

fn save(editor: &mut Editor, drawing: &SketchDrawing) {
    let Some(sketch) = drawing.sketch() else {
        editor
            .status
            .note("There is nothing to save until the figure is complete");
        return;
    };
    let path = chosen_file(editor);
    match write_sketch(&path, drawing.figure(), sketch) {
        Ok(()) => editor.status.note(format!("Saved {}", path.display())),
        Err(error) => editor.status.problem(error.to_string()),
    }
}

fn open(path: &Path, editor: &mut Editor, drawing: &mut SketchDrawing) {
    let opened = read_sketch(path)
        .map_err(|error| error.to_string())
        .and_then(|sketch| drawing.load(&sketch).map_err(|error| error.to_string()));
    match opened {
        Ok(()) => {
            editor.file = path.display().to_string();
            editor.status.note(format!("Opened {}", path.display()));
        }
        Err(problem) => editor.status.problem(problem),
    }
}

fn take_dropped_files(
    mut drops: MessageReader<FileDragAndDrop>,
    mut editor: ResMut<Editor>,
    mut drawings: Query<&mut SketchDrawing>,
) {
    for drop in drops.read() {
        editor.is_drop_hovering = matches!(drop, FileDragAndDrop::HoveredFile { .. });
        if let FileDragAndDrop::DroppedFile { path_buf, .. } = drop
            && let Ok(mut drawing) = drawings.single_mut()
        {
            open(path_buf, &mut editor, &mut drawing);
        }
    }
}
