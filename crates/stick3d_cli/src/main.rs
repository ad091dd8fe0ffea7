//! The `stick3d` command: poses and moves bodies after sketches; bakes, trains and measures what it needs for that.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command talks to its terminal"
)]

mod animate;
mod args;
mod bake;
mod corpus;
mod eval;
mod eval_motion;
mod eval_sheet;
mod failure;
mod figure;
mod inputs;
mod mesh_set;
mod paper;
mod pictures;
mod pose;
mod progress;
mod recipe;
mod reproduce;
mod train;

use std::process::ExitCode;

use clap::Parser as _;

use args::{Arguments, Command};

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Pose(arguments) => pose::run(&arguments),
        Command::Animate(arguments) => animate::run(&arguments),
        Command::Train(arguments) => train::run(&arguments),
        Command::Eval(arguments) => eval::run(&arguments),
        Command::Reproduce(arguments) => reproduce::run(&arguments),
        Command::Figure(command) => figure::run(&command),
        Command::Bake(command) => bake::run(&command),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("stick3d: {}", failure.message());
            failure.exit_code()
        }
    }
}
