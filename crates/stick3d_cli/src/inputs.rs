//! Reading the files that several commands take.

use std::io::Read as _;
use std::path::Path;

use anyhow::Context as _;
use stick3d_figure::interchange::figure_name;
use stick3d_figure::names::nearest;
use stick3d_model::Model;

use crate::failure::{Failure, Outcome};

/// The models that are built in, by the names of their figures.
const EMBEDDED: [(&str, &[u8]); 2] = [
    (stick3d_human::FIGURE, stick3d_human::MODEL),
    (stick3d_horse::FIGURE, stick3d_horse::MODEL),
];

/// The built-in model of the figure that the bytes of a sketch file name.
pub(crate) fn embedded_model_of_sketch(sketch: &[u8]) -> Outcome<Model> {
    embedded_model(&figure_name(sketch).map_err(Failure::input)?)
}

/// The built-in model of a figure.
pub(crate) fn embedded_model(figure: &str) -> Outcome<Model> {
    let known = EMBEDDED.map(|(name, _)| name);
    match EMBEDDED.iter().find(|(name, _)| *name == figure) {
        Some((_, bytes)) => Model::from_bytes(bytes).map_err(Failure::model),
        None => Err(Failure::input(anyhow::anyhow!(
            "no model of figure \"{}\" is built in; {} For a figure of your own, name its model file with --model",
            figure.chars().take(64).collect::<String>(),
            match nearest(figure, known) {
                Some(name) => format!("did you mean \"{name}\"?"),
                None => format!("there are: {}.", known.join(", ")),
            },
        ))),
    }
}

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
