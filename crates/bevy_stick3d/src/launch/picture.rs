//! Taking pictures of an app that has no window, for scripts and tests.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::render_resource::{PipelineCache, TextureFormat};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::render::{Render, RenderApp, RenderSystems};
use stick3d_model::files::write_atomically;
use thiserror::Error;

use crate::figure::FigureStatus;

/// So many frames in a row nothing may be waited for: textures and shaders arrive a frame or two late.
const CALM_FRAMES: u32 = 10;
/// After so many frames something is wrong.
const MAX_FRAMES: u32 = 3_000;

/// Why no picture was taken.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The body could not be made.
    #[error("no picture was taken, for the body could not be made: {0}")]
    Body(String),
    /// The renderer never came to rest.
    #[error(
        "no picture was taken, for after {MAX_FRAMES} frames the renderer was still compiling {0} shaders"
    )]
    NeverReady(usize),
    /// The picture could not be encoded.
    #[error("the picture could not be encoded as PNG: {0}")]
    Encode(String),
    /// The picture could not be written.
    #[error(transparent)]
    Write(#[from] std::io::Error),
}

/// One picture to take.
#[derive(Clone, Debug)]
pub(super) struct Shot {
    /// How many frames after everything was there.
    pub(super) frame: u32,
    /// Where to write it.
    pub(super) path: PathBuf,
}

/// Takes pictures from when everything is there, writes them, and ends the app.
pub(super) struct PicturePlugin {
    /// Which.
    pub(super) shots: Vec<Shot>,
    /// Whether the app's time stands still until everything is there.
    pub(super) holds_time: bool,
    /// How large.
    pub(super) size_px: UVec2,
    /// What went wrong, for whoever runs the app.
    pub(super) outcome: Arc<Mutex<Option<PictureError>>>,
}

impl Plugin for PicturePlugin {
    fn build(&self, app: &mut App) {
        // Until the renderer has counted once, one is missing.
        let pending = Arc::new(AtomicUsize::new(1));
        let size_px = self.size_px.max(UVec2::splat(16));
        let image =
            Image::new_target_texture(size_px.x, size_px.y, TextureFormat::Rgba8UnormSrgb, None);
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        app.insert_resource(Shoot {
            target,
            shots: self.shots.clone(),
            unwritten: self.shots.len(),
            outcome: self.outcome.clone(),
            pending: pending.clone(),
            frames: 0,
            calm_frames: 0,
            running: None,
        })
        .add_systems(PostStartup, turn_cameras)
        .add_systems(Last, (wait_until_ready, shoot).chain());
        if self.holds_time {
            app.add_systems(PreStartup, |mut time: ResMut<Time<Virtual>>| time.pause());
        }
        if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
            render_app
                .insert_resource(Pending(pending))
                .add_systems(Render, count_pending_pipelines.after(RenderSystems::Render));
        }
    }
}

/// How many pipelines the renderer still compiles.
#[derive(Resource)]
struct Pending(Arc<AtomicUsize>);

fn count_pending_pipelines(cache: Res<PipelineCache>, pending: Res<Pending>) {
    pending
        .0
        .store(cache.waiting_pipelines().count(), Ordering::Relaxed);
}

#[derive(Resource)]
struct Shoot {
    /// What stands for the screen.
    target: Handle<Image>,
    /// Those to be taken.
    shots: Vec<Shot>,
    /// How many are not written.
    unwritten: usize,
    outcome: Arc<Mutex<Option<PictureError>>>,
    pending: Arc<AtomicUsize>,
    frames: u32,
    calm_frames: u32,
    /// How many frames ago everything was there.
    running: Option<u32>,
}

impl Shoot {
    fn end(&self, result: Result<(), PictureError>, exit: &mut MessageWriter<AppExit>) {
        match result {
            Ok(()) => exit.write(AppExit::Success),
            Err(error) => {
                *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                exit.write(AppExit::error())
            }
        };
    }
}

/// Cameras of a window that does not exist look into the picture.
fn turn_cameras(mut targets: Query<&mut RenderTarget>, shoot: Res<Shoot>) {
    for mut target in &mut targets {
        if matches!(*target, RenderTarget::Window(_)) {
            *target = shoot.target.clone().into();
        }
    }
}

/// Finds out when everything is there, and lets time run from then on.
fn wait_until_ready(
    mut shoot: ResMut<Shoot>,
    mut time: ResMut<Time<Virtual>>,
    figures: Query<&FigureStatus>,
    mut exit: MessageWriter<AppExit>,
) {
    if let Some(problem) = figures.iter().find_map(FigureStatus::problem) {
        shoot.end(Err(PictureError::Body(problem.to_owned())), &mut exit);
        return;
    }
    if let Some(running) = &mut shoot.running {
        *running += 1;
        return;
    }
    shoot.frames += 1;
    let pending = shoot.pending.load(Ordering::Relaxed);
    if shoot.frames > MAX_FRAMES {
        shoot.end(Err(PictureError::NeverReady(pending)), &mut exit);
        return;
    }
    let waiting = pending > 0
        || figures
            .iter()
            .any(|status| *status == FigureStatus::Waiting);
    shoot.calm_frames = if waiting { 0 } else { shoot.calm_frames + 1 };
    if shoot.calm_frames >= CALM_FRAMES {
        shoot.running = Some(0);
        time.unpause();
    }
}

/// Takes the pictures of this frame.
fn shoot(mut commands: Commands, mut shoot: ResMut<Shoot>) {
    let Some(running) = shoot.running else {
        return;
    };
    let target = shoot.target.clone();
    for Shot { path, .. } in shoot.shots.extract_if(.., |shot| shot.frame == running) {
        commands.spawn(Screenshot::image(target.clone())).observe(
            move |captured: On<ScreenshotCaptured>,
                  mut shoot: ResMut<Shoot>,
                  mut exit: MessageWriter<AppExit>| {
                shoot.unwritten -= 1;
                let written = write_picture(&captured.image, &path);
                if written.is_err() || shoot.unwritten == 0 {
                    shoot.end(written, &mut exit);
                }
            },
        );
    }
}

fn write_picture(image: &Image, path: &Path) -> Result<(), PictureError> {
    Ok(write_atomically(path, &png_bytes(image)?)?)
}

fn png_bytes(image: &Image) -> Result<Vec<u8>, PictureError> {
    let encode = |message: String| PictureError::Encode(message);
    let picture = image
        .clone()
        .try_into_dynamic()
        .map_err(|error| encode(error.to_string()))?
        .to_rgb8();
    let mut bytes = Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, image::ImageFormat::Png)
        .map_err(|error| encode(error.to_string()))?;
    Ok(bytes.into_inner())
}
