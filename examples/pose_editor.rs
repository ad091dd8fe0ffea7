//! The pose editor: draw a stick figure, lift the pen, see the body.
//!
//! `cargo run --release --example pose_editor`
//! `cargo run --release --example pose_editor -- --sketch assets/sketches/wave.json --screenshot wave.png`

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use bevy::math::UVec2;
use bevy_stick3d::editor::{self, EditorOptions};
use clap::Parser;

/// Draw a stick figure, see the body.
///
/// Exit codes: 0 all is well; 1 a file cannot be read or written; 2 the command line is wrong;
/// 3 there is no display; 4 there is no graphics adapter.
#[derive(Parser)]
struct Arguments {
    /// A sketch file to begin with.
    #[arg(long, value_name = "FILE")]
    sketch: Option<PathBuf>,
    /// Take a picture of the editor without opening a window, and end.
    #[arg(long, value_name = "OUT.png")]
    screenshot: Option<PathBuf>,
    /// Size of the window or of the picture, in pixels.
    #[arg(long, value_name = "WxH", default_value = "1600x900", value_parser = parse_size)]
    size: UVec2,
}

fn parse_size(text: &str) -> Result<UVec2, String> {
    let explain = || format!("\"{text}\" is no size; write it as 1600x900, each from 64 to 8192");
    let (width, height) = text.split_once('x').ok_or_else(explain)?;
    match (width.parse(), height.parse()) {
        (Ok(width @ 64..=8192), Ok(height @ 64..=8192)) => Ok(UVec2::new(width, height)),
        _ => Err(explain()),
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let options = EditorOptions {
        sketch: arguments.sketch,
        screenshot: arguments.screenshot,
        size_px: arguments.size,
    };
    match editor::run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // There is nowhere left to say it when this fails too.
            let _ = writeln!(std::io::stderr(), "pose_editor: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
