//! Starting the editor: in a window, or without one to take a picture; and what to say when neither works.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use bevy::app::ScheduleRunnerPlugin;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::time::TimeUpdateStrategy;
use bevy::window::{ExitCondition, WindowResolution};
use bevy::winit::WinitPlugin;
use bevy_egui::EguiPlugin;
use thiserror::Error;

use super::files::{SketchFileError, read_sketch};
use super::screenshot::{ScreenshotError, ScreenshotPlugin};
use super::{EditorSurface, PoseEditorPlugin};
use crate::Stick3dPlugin;

/// What the editor is started with.
#[derive(Clone, Debug)]
pub struct EditorOptions {
    /// A sketch file to begin with.
    pub sketch: Option<PathBuf>,
    /// Take a picture of the editor without a window, write it here as PNG, and end.
    pub screenshot: Option<PathBuf>,
    /// Size of the window or of the picture, pixels.
    pub size_px: UVec2,
}

impl Default for EditorOptions {
    fn default() -> Self {
        Self {
            sketch: None,
            screenshot: None,
            size_px: UVec2::new(1600, 900),
        }
    }
}

/// Why the editor ended.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EditorError {
    /// The sketch to begin with cannot be used.
    #[error(transparent)]
    Sketch(#[from] SketchFileError),
    /// The picture could not be taken or written.
    #[error(transparent)]
    Screenshot(#[from] ScreenshotError),
    /// There is no screen to open a window on.
    #[error(
        "there is no display to open a window on; start the editor from a desktop session, or use --screenshot, which needs none"
    )]
    NoDisplay,
    /// There is no graphics adapter, not even one in software.
    #[error(
        "no usable graphics adapter was found; install a Vulkan driver (Mesa's software one will do)"
    )]
    NoGpu,
    /// The app ended of itself with this code.
    #[error("the editor ended early with code {0}; the log above says why")]
    Ended(u8),
    /// The app could not be set up.
    #[error("the editor could not be started: {0}")]
    Start(String),
}

impl EditorError {
    /// The exit code of the process: 1 for files and everything else, 3 without a display, 4 without a
    /// graphics adapter. (2 is what command line parsers end with.)
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::NoDisplay => 3,
            Self::NoGpu => 4,
            Self::Sketch(_) | Self::Screenshot(_) | Self::Ended(_) | Self::Start(_) => 1,
        }
    }
}

/// Runs the editor until its window is closed or its picture is taken.
///
/// # Errors
/// [`EditorError`]: one sentence for the user, and an exit code.
pub fn run(options: &EditorOptions) -> Result<(), EditorError> {
    let sketch = options.sketch.as_deref().map(read_sketch).transpose()?;
    let outcome = Arc::new(Mutex::new(None));
    let mut app = quietly(|| {
        let mut app = App::new();
        match &options.screenshot {
            None => add_window(&mut app, options.size_px),
            Some(path) => {
                add_no_window(&mut app);
                app.add_plugins(ScreenshotPlugin {
                    path: path.clone(),
                    outcome: outcome.clone(),
                });
            }
        }
        app.add_plugins((
            EguiPlugin::default(),
            Stick3dPlugin,
            PoseEditorPlugin {
                sketch,
                surface: match options.screenshot {
                    None => EditorSurface::Window,
                    Some(_) => EditorSurface::Picture(options.size_px),
                },
                file: options.sketch.clone(),
            },
        ));
        app
    })?;
    let exit = app.run();
    if let Some(error) = outcome
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .take()
    {
        return Err(EditorError::Screenshot(error));
    }
    match exit {
        AppExit::Success => Ok(()),
        AppExit::Error(code) => Err(EditorError::Ended(code.get())),
    }
}

fn add_window(app: &mut App, size_px: UVec2) {
    let window = Window {
        title: "stick3d pose editor".to_owned(),
        resolution: WindowResolution::new(size_px.x, size_px.y),
        ..default()
    };
    app.add_plugins(DefaultPlugins.set(log()).set(WindowPlugin {
        primary_window: Some(window),
        ..default()
    }));
}

fn add_no_window(app: &mut App) {
    app.add_plugins(
        DefaultPlugins
            .set(log())
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(RenderPlugin {
                synchronous_pipeline_compilation: true,
                ..default()
            })
            .disable::<WinitPlugin>(),
    )
    .add_plugins(ScheduleRunnerPlugin::run_loop(Duration::ZERO))
    // The picture must not depend on how fast the machine is.
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
        16,
    )));
}

fn log() -> LogPlugin {
    LogPlugin {
        filter: "warn,bevy_stick3d=info,wgpu=error,wgpu_hal=off,naga=error,bevy_render=error,bevy_winit=error,bevy_egui=error"
            .to_owned(),
        ..default()
    }
}

/// Bevy panics when it finds neither screen nor adapter; that is a sentence here, not a backtrace.
fn quietly(build: impl FnOnce() -> App) -> Result<App, EditorError> {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let built = catch_unwind(AssertUnwindSafe(build));
    std::panic::set_hook(hook);
    built.map_err(|payload| {
        let message = payload
            .downcast_ref::<String>()
            .cloned()
            .or_else(|| {
                payload
                    .downcast_ref::<&str>()
                    .map(|text| (*text).to_owned())
            })
            .unwrap_or_default();
        start_error(&message)
    })
}

/// What a panic during the set-up means.
fn start_error(message: &str) -> EditorError {
    if message.contains("event loop") {
        EditorError::NoDisplay
    } else if message.contains("GPU")
        || message.contains("adapter")
        || message.contains("RequestDevice")
    {
        EditorError::NoGpu
    } else {
        EditorError::Start(message.lines().next().unwrap_or_default().to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_of_the_set_up_become_sentences_with_codes() {
        let display = start_error("Failed to build event loop: Os(OsError { .. })");
        assert_eq!(display.exit_code(), 3);
        let gpu =
            start_error("Unable to find a GPU! Make sure you have installed required drivers!");
        assert_eq!(gpu.exit_code(), 4);
        let other = quietly(|| panic!("a plugin was added twice"))
            .err()
            .unwrap();
        assert_eq!(other.exit_code(), 1);
        assert!(other.to_string().contains("a plugin was added twice"));
    }
}
