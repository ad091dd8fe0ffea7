//! The pose editor: choose a figure, draw it on the left, see its body on the right. Or draw several keys, and see
//! the motion through them.
//!
//! Parts that are only arithmetic or words (`layout`, `orbit`, `words`, `status_line`, `files`, most of `timeline`) know
//! no Bevy systems and are tested by themselves; so is `session`, which knows no user interface. [`run`] starts the
//! whole, in a window or to take a picture.

mod canvas;
mod files;
mod gallery;
mod header;
mod layout;
mod orbit;
mod panels;
mod picking;
mod screen;
mod segments;
mod session;
mod stage;
mod start;
mod status_line;
mod switch;
mod theme;
mod timeline;
mod viewport;
mod words;

use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy::render::view::Msaa;
use bevy_egui::{
    EguiGlobalSettings, EguiPostUpdateSet, EguiPrimaryContextPass, PrimaryEguiContext,
};

pub use files::{SketchFileError, read_sketch, write_sketch};
pub use session::{EditorFigure, FirstClip, FirstSketch};
pub use start::{EditorError, EditorOptions, run};
pub use timeline::clip::ClipFileError;

use self::session::{Opening, SessionPlugin, SettleDrawings};
use crate::schedule::Stick3dSystems;
use crate::sketch_input::DrawingOrder;

/// The editor, for an app that has Bevy's default plugins, `EguiPlugin` and
/// [`Stick3dPlugin`](crate::Stick3dPlugin). It shows itself in the primary window.
pub struct PoseEditorPlugin {
    /// The figures to choose from.
    pub figures: Vec<EditorFigure>,
    /// The index of the one to begin with.
    pub first: usize,
    /// The sketch to begin with.
    pub sketch: Option<FirstSketch>,
    /// The clip to begin with.
    pub clip: Option<FirstClip>,
    /// From where to look at the bodies: turned about the vertical, 0 for the side that is drawn.
    pub yaw_rad: Option<f32>,
    /// In which order strokes are expected.
    pub order: DrawingOrder,
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
                clip: self.clip.clone(),
                yaw_rad: self.yaw_rad,
                order: self.order,
            }),
            viewport::ViewportPlugin,
        ))
        .add_systems(Startup, spawn_screen)
        .add_systems(First, tick.after(bevy::time::TimeSystems))
        .add_systems(EguiPrimaryContextPass, screen::show)
        // What a button does is on screen in the same frame.
        .configure_sets(
            PostUpdate,
            (SettleDrawings, Stick3dSystems::Tell).after(EguiPostUpdateSet::EndPass),
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
