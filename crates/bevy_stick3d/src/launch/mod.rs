//! Starting an app: in a window, or without one to take a picture of it; and what to say when neither works.
//!
//! The pose editor and the examples start this way. A game needs none of it.

mod picture;

use std::fmt::Display;
use std::io::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
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
use picture::{PicturePlugin, Shot};

/// A frame of an app without a window.
const FRAME: Duration = Duration::from_millis(16);

/// How an app is started.
#[derive(Clone, Debug)]
pub struct Launch {
    /// What the window is called.
    pub title: String,
    /// Size of the window or of the picture, pixels.
    pub size_px: UVec2,
    /// Open no window: take a picture as soon as all figures are ready, write it here as PNG, and end.
    pub screenshot: Option<PathBuf>,
    /// Take the picture so long after all figures are ready, seconds; until then the app's time stands still. Else it is
    /// taken at once, and time has run since the start.
    pub at_s: Option<f32>,
    /// Take several pictures, from then on; `screenshot` is the folder of `frame_0000.png` and so on.
    pub series: Option<Series>,
    /// The folder that asset paths begin at; Bevy's own choice when `None`.
    pub asset_folder: Option<PathBuf>,
}

impl Default for Launch {
    fn default() -> Self {
        Self {
            title: "stick3d".to_owned(),
            size_px: UVec2::new(1600, 900),
            screenshot: None,
            at_s: None,
            series: None,
            asset_folder: None,
        }
    }
}

/// Several pictures, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Series {
    /// How many pictures.
    pub count: u32,
    /// How many frames of 16 ms are between two of them.
    pub every: u32,
}

/// The folder of a file, for [`Launch::asset_folder`], and the file's name in there, to load it as an asset.
///
/// # Errors
/// Whatever the file system answers; the message names the file.
pub fn asset_place(file: &Path) -> std::io::Result<(PathBuf, String)> {
    let whole = std::fs::canonicalize(file).map_err(|error| {
        std::io::Error::new(
            error.kind(),
            format!("cannot read {}: {error}", file.display()),
        )
    })?;
    match (whole.parent(), whole.file_name()) {
        (Some(folder), Some(name)) => Ok((folder.to_owned(), name.to_string_lossy().into_owned())),
        _ => Err(std::io::Error::other(format!(
            "{} is no file",
            file.display()
        ))),
    }
}

/// How a program ends: without a word, or with one sentence on standard error, its causes included, and the exit code that
/// `code` gives the error.
pub fn ended<E: Display>(
    program: &str,
    result: Result<(), E>,
    code: impl FnOnce(&E) -> u8,
) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // There is nowhere left to say it when this fails too.
            let _ = writeln!(std::io::stderr(), "{program}: {error:#}");
            ExitCode::from(code(&error))
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
        if let (Some(folder), Some(_)) = (&self.screenshot, self.series) {
            std::fs::create_dir_all(folder).map_err(PictureError::from)?;
        }
        let outcome = Arc::new(Mutex::new(None));
        let mut app = quietly(|| {
            let mut app = App::new();
            match &self.screenshot {
                None => self.add_window(&mut app),
                Some(path) => {
                    self.add_no_window(&mut app);
                    app.add_plugins(PicturePlugin {
                        shots: self.shots(path),
                        holds_time: self.at_s.is_some() || self.series.is_some(),
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
        .insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
    }

    /// The pictures to take, by the frame after everything is ready.
    fn shots(&self, path: &Path) -> Vec<Shot> {
        let first = (self.at_s.unwrap_or(0.0) / FRAME.as_secs_f32()).round() as u32;
        match self.series {
            None => vec![Shot {
                frame: first,
                path: path.to_owned(),
            }],
            Some(Series { count, every }) => (0..count.max(1))
                .map(|index| Shot {
                    frame: first + index * every,
                    path: path.join(format!("frame_{index:04}.png")),
                })
                .collect(),
        }
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
    fn pictures_are_taken_at_their_times() {
        let launch = Launch {
            at_s: Some(0.5),
            series: Some(Series {
                count: 3,
                every: 10,
            }),
            ..default()
        };
        let shots = launch.shots(Path::new("walk"));
        let frames: Vec<u32> = shots.iter().map(|shot| shot.frame).collect();
        assert_eq!(frames, [31, 41, 51]);
        assert!(shots[2].path.ends_with("walk/frame_0002.png"));
        assert_eq!(Launch::default().shots(Path::new("one.png"))[0].frame, 0);
    }

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
