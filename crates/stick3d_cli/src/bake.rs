//! `stick3d bake`: the shipped bodies and pictures from their sources.

use std::path::Path;

use stick3d_train::bake::{BakeError, BakeReport, bake_horse, bake_human};
use stick3d_train::pose::pose_sheet;

use crate::args::BakeCommand;
use crate::corpus::Corpus;
use crate::failure::{Failure, Outcome};
use crate::pictures::write_png;

/// Edge of one picture of the contact sheet, pixels.
const SHEET_PICTURE_PX: u32 = 100;
/// Poses in a row of the contact sheet.
const SHEET_COLUMNS: u32 = 15;

/// Runs `stick3d bake`.
pub(crate) fn run(command: &BakeCommand) -> Outcome {
    match command {
        BakeCommand::Human { wheel, out } => told(out, bake_human(wheel, out)),
        BakeCommand::Horse { wheel, out } => told(out, bake_horse(wheel, out)),
        BakeCommand::Poses { body, out, yaw_deg } => {
            let corpus = Corpus::read(body)?;
            let sheet = pose_sheet(
                &corpus.rig,
                &corpus.controls,
                &corpus.library,
                &[*yaw_deg],
                SHEET_PICTURE_PX,
                SHEET_COLUMNS,
            )
            .map_err(Failure::input)?;
            write_png(out, &sheet)?;
            println!("{}: {} poses", out.display(), corpus.library.poses.len());
            Ok(())
        }
    }
}

fn told(out: &Path, baked: Result<BakeReport, BakeError>) -> Outcome {
    let report = baked.map_err(Failure::input)?;
    println!("{}: {report:?}", out.display());
    Ok(())
}
