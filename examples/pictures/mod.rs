//! What the moving examples share: pictures from the command line, and a pause.

use std::path::PathBuf;

use bevy::prelude::*;
use bevy_stick3d::launch::{Launch, Series};

/// Pictures without a window.
#[derive(clap::Args)]
pub(crate) struct Pictures {
    /// Take a picture without opening a window, and end. With --frames, the folder for several.
    #[arg(long, value_name = "OUT")]
    screenshot: Option<PathBuf>,
    /// When to take it, or the first: seconds after everything is ready.
    #[arg(long, value_name = "SECONDS", default_value = "0.5", value_parser = parse_seconds)]
    at: f32,
    /// Take so many pictures, frame_0000.png and so on.
    #[arg(long, value_name = "N", requires = "screenshot")]
    frames: Option<u32>,
    /// Frames of 16 ms from one picture to the next.
    #[arg(long, value_name = "K", default_value_t = 10)]
    every: u32,
}

fn parse_seconds(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(seconds) if (0.0..=600.0).contains(&seconds) => Ok(seconds),
        _ => Err(format!("\"{text}\" is no time from 0 to 600 seconds")),
    }
}

impl Pictures {
    /// How the example is started. Its assets are those of this repository.
    pub(crate) fn launch(self, title: &str) -> Launch {
        Launch {
            title: format!("stick3d: {title}"),
            size_px: UVec2::new(1280, 720),
            at_s: self.screenshot.is_some().then_some(self.at),
            screenshot: self.screenshot,
            series: self.frames.map(|count| Series {
                count,
                every: self.every,
            }),
            asset_folder: Some(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets").into()),
        }
    }
}

/// Space stops the time, and lets it run again.
pub(crate) fn pause_on_space(keys: Res<ButtonInput<KeyCode>>, mut time: ResMut<Time<Virtual>>) {
    if !keys.just_pressed(KeyCode::Space) {
        return;
    }
    if time.is_paused() {
        time.unpause();
    } else {
        time.pause();
    }
}
