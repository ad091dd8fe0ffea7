//! The pose editor: choose a figure, draw it, lift the pen, see the body.
//!
//! `cargo run --example pose_editor`
//! `cargo run --example pose_editor -- --figure horse`
//! `cargo run --example pose_editor -- --sketch assets/sketches/wave.json --screenshot wave.png`
//! `cargo run --example pose_editor -- --clip assets/clips/wave.clip.ron`
//! `cargo run --example pose_editor -- --order guided`

use std::path::PathBuf;
use std::process::ExitCode;

use bevy::math::UVec2;
use bevy_stick3d::editor::{self, EditorError, EditorOptions};
use bevy_stick3d::launch;
use bevy_stick3d::prelude::DrawingOrder;
use clap::Parser;

/// Draw a stick figure, see the body.
///
/// Exit codes: 0 all is well; 1 a file cannot be read or written; 2 the command line is wrong or there is no such figure;
/// 3 there is no display; 4 there is no graphics adapter.
#[derive(Parser)]
struct Arguments {
    /// The figure to begin with, such as human or horse; without it that of the sketch or of the model.
    #[arg(long, value_name = "NAME")]
    figure: Option<String>,
    /// A model file: its figure can be chosen too. May be given several times.
    #[arg(long, value_name = "FILE")]
    model: Vec<PathBuf>,
    /// From where to look at the body, degrees: 0 for the side that is drawn, 90 from the right of it.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = parse_degrees)]
    yaw: Option<f32>,
    /// In which order to draw: any, in which limbs are told apart by a rule, or guided, bone by bone. O changes it.
    #[arg(long, value_name = "any|guided", default_value = "any", value_parser = parse_order)]
    order: DrawingOrder,
    /// A sketch file to begin with.
    #[arg(long, value_name = "FILE")]
    sketch: Option<PathBuf>,
    /// A clip file to begin with: the editor starts in its animation mode.
    #[arg(long, value_name = "FILE.clip.ron")]
    clip: Option<PathBuf>,
    /// Stand still at this time of the clip, seconds; else it plays.
    #[arg(long, value_name = "SECONDS", requires = "clip", value_parser = parse_seconds)]
    at: Option<f32>,
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

fn parse_order(text: &str) -> Result<DrawingOrder, String> {
    match text {
        "any" => Ok(DrawingOrder::Any),
        "guided" => Ok(DrawingOrder::Guided),
        _ => Err(format!("\"{text}\" is no order; write any or guided")),
    }
}

fn parse_degrees(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(degrees) if degrees.abs() <= 360.0 => Ok(degrees),
        _ => Err(format!("\"{text}\" is no angle from -360 to 360 degrees")),
    }
}

fn parse_seconds(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(seconds) if (0.0..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err(format!("\"{text}\" is no time from 0 to 3600 seconds")),
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let options = EditorOptions {
        figure: arguments.figure,
        models: arguments.model,
        yaw_rad: arguments.yaw.map(f32::to_radians),
        order: arguments.order,
        sketch: arguments.sketch,
        clip: arguments.clip,
        at_s: arguments.at,
        screenshot: arguments.screenshot,
        size_px: Some(arguments.size),
    };
    launch::ended("pose_editor", editor::run(&options), EditorError::exit_code)
}
