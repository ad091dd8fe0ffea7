//! `stick3d pose`: from a sketch file to a posed mesh.

use std::path::Path;
use std::time::Instant;

use anyhow::anyhow;
use glam::Vec3;
use serde_json::{Map, Value, json};
use stick3d_figure::figure::Figure;
use stick3d_figure::interchange;
use stick3d_figure::sketch::Sketch;
use stick3d_model::export::{MeshFormat, MeshView};
use stick3d_model::{Inference, Model};

use crate::args::PoseArguments;
use crate::failure::{Failure, Outcome};
use crate::inputs;

/// Runs `stick3d pose`.
pub(crate) fn run(arguments: &PoseArguments) -> Outcome {
    // A wrong ending is found before any work is done.
    let format = arguments.out.as_deref().map(OutputFormat::of).transpose()?;
    let model = inputs::model(arguments.model.as_deref())?;
    let sketch = read_sketch(&arguments.sketch, model.figure())?;
    let body = Body::pose(&model, &sketch)?;
    if let (Some(path), Some(format)) = (&arguments.out, format) {
        format.write(path, &model, &body)?;
    }
    if arguments.json {
        println!("{}", body.to_json(model.figure()));
    }
    Ok(())
}
