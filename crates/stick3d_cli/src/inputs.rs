//! Reading the files that several commands take.

use std::io::Read as _;
use std::path::Path;

use anyhow::Context as _;
use stick3d_model::Model;

use crate::failure::{Failure, Outcome};

/// The model of `path`, or the embedded human.
pub(crate) fn model(path: Option<&Path>) -> Outcome<Model> {
    match path {
        Some(path) => Model::load(path)
            .map_err(Failure::model)
            .map_err(|failure| failure.context(format!("cannot use the model {}", path.display()))),
        None => Model::from_bytes(stick3d_human::MODEL).map_err(Failure::model),
    }
}

/// The text of `path`.
pub(crate) fn text(path: &Path) -> Outcome<String> {
    std::fs::read_to_string(path)
        .with_context(|| format!("cannot read {}", path.display()))
        .map_err(Failure::input)
}

/// The bytes of `path`, or of standard input for `-`.
pub(crate) fn bytes(path: &Path) -> Outcome<Vec<u8>> {
    if path == Path::new("-") {
        let mut bytes = Vec::new();
        std::io::stdin()
            .read_to_end(&mut bytes)
            .context("cannot read standard input")
            .map_err(Failure::input)?;
        return Ok(bytes);
    }
    std::fs::read(path)
        .with_context(|| format!("cannot read {}", path.display()))
        .map_err(Failure::input)
}
