//! Starting an app: in a window, or without one to take a picture of it; and what to say when neither works.
//!
//! The pose editor and the examples start this way. A game needs none of it.

mod picture;

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
use thiserror::Error;

pub use picture::PictureError;
use picture::PicturePlugin;

/// How an app is started.
#[derive(Clone, Debug)]
pub struct Launch {
    /// What the window is called.
    pub title: String,
    /// Size of the window or of the picture, pixels.
    pub size_px: UVec2,
    /// Open no window: take a picture as soon as all figures are ready, write it here as PNG, and end.
    pub screenshot: Option<PathBuf>,
    /// The folder that asset paths begin at; Bevy's own choice when `None`.
    pub asset_folder: Option<PathBuf>,
}

impl Default for Launch {
    fn default() -> Self {
        Self {
            title: "stick3d".to_owned(),
            size_px: UVec2::new(1600, 900),
            screenshot: None,
            asset_folder: None,
        }
    }
}

/// Why an app did not start, or ended early.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LaunchError {
    /// The picture could not be taken or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// There is no screen to open a window on.
    #[error(
        "there is no display to open a window on; start it from a desktop session, or use --screenshot, which needs none"
    )]
    NoDisplay,
    /// There is no graphics adapter, not even one in software.
    #[error(
        "no usable graphics adapter was found; install a Vulkan driver (Mesa's software one will do)"
    )]
    NoGpu,
    /// The app ended of itself with this code.
    #[error("it ended early with code {0}; the log above says why")]
    Ended(u8),
    /// The app could not be set up.
    #[error("it could not be started: {0}")]
    Start(String),
}

impl LaunchError {
    /// The exit code of the process: 1 for files and everything else, 3 without a display, 4 without a
    /// graphics adapter. (2 is what command line parsers end with.)
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::NoDisplay => 3,
            Self::NoGpu => 4,
            Self::Picture(_) | Self::Ended(_) | Self::Start(_) => 1,
        }
    }
}

impl Launch {
    /// Runs an app with Bevy's default plugins, and with what `build` adds, until it ends or its picture is taken.
    ///
    /// In a picture, cameras that look into the window look into the picture, and time goes in steps of 16 ms,
    /// however fast the machine is.
    ///
    /// # Errors
    /// [`LaunchError`]: one sentence for the user, and an exit code.
    pub fn run(&self, build: impl FnOnce(&mut App)) -> Result<(), LaunchError> {
        let outcome = Arc::new(Mutex::new(None));
        let mut app = quietly(|| {
            let mut app = App::new();
            match &self.screenshot {
                None => self.add_window(&mut app),
                Some(path) => {
                    self.add_no_window(&mut app);
                    app.add_plugins(PicturePlugin {
                        path: path.clone(),
                        size_px: self.size_px,
                        outcome: outcome.clone(),
                    });
                }
            }
            build(&mut app);
            app
        })?;
        let exit = app.run();
        let failed = outcome
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        match (failed, exit) {
            (Some(error), _) => Err(LaunchError::Picture(error)),
            (None, AppExit::Success) => Ok(()),
            (None, AppExit::Error(code)) => Err(LaunchError::Ended(code.get())),
        }
    }

    fn add_window(&self, app: &mut App) {
        let window = Window {
            title: self.title.clone(),
            resolution: WindowResolution::new(self.size_px.x, self.size_px.y),
            ..default()
        };
        app.add_plugins(
            DefaultPlugins
                .set(log())
                .set(self.assets())
                .set(WindowPlugin {
                    primary_window: Some(window),
                    ..default()
                }),
        );
    }

    fn add_no_window(&self, app: &mut App) {
        app.add_plugins(
            DefaultPlugins
                .set(log())
                .set(self.assets())
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

    fn assets(&self) -> AssetPlugin {
        let usual = AssetPlugin::default();
        AssetPlugin {
            file_path: self
                .asset_folder
                .as_ref()
                .map_or(usual.file_path, |folder| folder.display().to_string()),
            ..default()
        }
    }
}

fn log() -> LogPlugin {
    LogPlugin {
        filter: "warn,bevy_stick3d=info,wgpu=error,wgpu_hal=off,naga=error,bevy_render=error,bevy_winit=error,bevy_egui=error"
            .to_owned(),
        ..default()
    }
}

/// Bevy panics when it finds neither screen nor adapter; that is a sentence here, not a backtrace.
fn quietly(build: impl FnOnce() -> App) -> Result<App, LaunchError> {
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
fn start_error(message: &str) -> LaunchError {
    if message.contains("event loop") {
        LaunchError::NoDisplay
    } else if message.contains("GPU")
        || message.contains("adapter")
        || message.contains("RequestDevice")
    {
        LaunchError::NoGpu
    } else {
        LaunchError::Start(message.lines().next().unwrap_or_default().to_owned())
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
