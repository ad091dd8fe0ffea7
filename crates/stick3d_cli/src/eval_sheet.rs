//! `stick3d eval --sheet`: sketches and the bodies that they may mean, in one picture.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use stick3d_figure::interchange::figure_name;
use stick3d_figure::sketch::Sketch;
use stick3d_model::Model;
use stick3d_train::evaluate::{EvalConfig, answer_sheet, test_sketches};

use crate::args::EvalArguments;
use crate::corpus::Corpus;
use crate::eval::test_poses;
use crate::failure::{Failure, Outcome};
use crate::inputs;
use crate::pictures::write_png;

/// How many of the test sketches are drawn.
const SKETCHES: usize = 24;

/// Draws the sheet.
pub(crate) fn run(model: &Model, arguments: &EvalArguments, out: &Path) -> Outcome {
    let sketches = match &arguments.sketches {
        Some(folder) => of_folder(model, folder)?,
        None => {
            let corpus = Corpus::read(&arguments.body, Some(model.figure()))?;
            let (_, held_out) = corpus.split_of(model)?;
            let input = test_poses(&corpus, &[], &held_out);
            test_sketches(model, input, &EvalConfig::default(), SKETCHES).map_err(Failure::model)?
        }
    };
    let sheet = answer_sheet(model, &sketches).map_err(Failure::model)?;
    write_png(out, &sheet)
}

/// The sketches of the model's figure in a folder, by file name.
fn of_folder(model: &Model, folder: &Path) -> Outcome<Vec<(String, Sketch)>> {
    let unreadable = || format!("cannot read the folder {}", folder.display());
    let files: Vec<PathBuf> = std::fs::read_dir(folder)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
        .with_context(unreadable)
        .map_err(Failure::input)?;
    let is_sketch = |file: &PathBuf| file.extension().is_some_and(|ending| ending == "json");
    let mut files: Vec<PathBuf> = files.into_iter().filter(is_sketch).collect();
    files.sort();
    let mut sketches = vec![];
    let mut others = 0;
    for file in &files {
        let bytes = inputs::bytes(file)?;
        let unusable =
            |error| Failure::input(error).context(format!("cannot use {}", file.display()));
        if figure_name(&bytes).map_err(unusable)? != model.figure().name {
            others += 1;
            continue;
        }
        let sketch = Sketch::from_json(model.figure(), &bytes).map_err(unusable)?;
        let name = file.file_stem().unwrap_or_default();
        sketches.push((name.to_string_lossy().into_owned(), sketch));
    }
    if sketches.is_empty() {
        return Err(Failure::input(anyhow::anyhow!(
            "{} holds no sketch of figure \"{}\" (files that end with .json); {others} are of other figures",
            folder.display(),
            model.figure().name
        )));
    }
    Ok(sketches)
}
