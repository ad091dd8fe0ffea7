//! `stick3d pose`: from a sketch file to a posed mesh.

use std::path::Path;
use std::time::Instant;

use glam::Vec3;
use serde_json::{Map, Value, json};
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::Sketch;
use stick3d_model::export::{ExportError, ExportMesh, MeshFormat, save_mesh};
use stick3d_model::{Inference, Model};

use crate::args::PoseArguments;
use crate::failure::{Failure, Outcome};
use crate::inputs;
use crate::pictures::{Stage, write_png};

/// Runs `stick3d pose`.
pub(crate) fn run(arguments: &PoseArguments) -> Outcome {
    // A name that says no format is found before any work is done.
    let output = arguments.out.as_deref().map(Output::of).transpose()?;
    let bytes = inputs::bytes(&arguments.sketch)?;
    let unusable =
        |failure: Failure| failure.context(format!("cannot use {}", arguments.sketch.display()));
    let model = match &arguments.model {
        Some(path) => inputs::model(Some(path))?,
        None => inputs::embedded_model_of_sketch(&bytes).map_err(unusable)?,
    };
    let sketch = Sketch::from_json(model.figure(), &bytes)
        .map_err(|error| unusable(Failure::input(error)))?;
    let body = Body::pose(&model, &sketch)?;
    if let Some(output) = output {
        output.write(&model, &body)?;
    }
    if arguments.json {
        println!("{}", body.to_json(model.figure()));
    }
    Ok(())
}

/// A posed body, its lowest vertex at height 0.
struct Body {
    latent: Vec<f32>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    joints: Vec<Vec3>,
    encode_s: f64,
    decode_s: f64,
}

impl Body {
    fn pose(model: &Model, sketch: &Sketch) -> Outcome<Self> {
        let mut inference = Inference::new(model).map_err(Failure::model)?;
        let vertex_count = inference.vertex_count();
        let mut body = Self {
            latent: vec![0.0; inference.latent_len()],
            positions: vec![[0.0; 3]; vertex_count],
            normals: vec![[0.0; 3]; vertex_count],
            joints: vec![Vec3::ZERO; model.figure().joint_count()],
            encode_s: 0.0,
            decode_s: 0.0,
        };
        let start = Instant::now();
        inference
            .encode(sketch, &mut body.latent)
            .map_err(Failure::input)?;
        body.encode_s = start.elapsed().as_secs_f64();
        let start = Instant::now();
        inference
            .decode(&body.latent, &mut body.positions, &mut body.normals)
            .map_err(Failure::model)?;
        body.decode_s = start.elapsed().as_secs_f64();
        inference
            .joints(&body.latent, &mut body.joints)
            .map_err(Failure::model)?;
        body.stand_on_ground();
        Ok(body)
    }

    fn stand_on_ground(&mut self) {
        let lowest = self
            .positions
            .iter()
            .map(|p| p[1])
            .fold(f32::INFINITY, f32::min);
        self.positions
            .iter_mut()
            .for_each(|position| position[1] -= lowest);
        self.joints.iter_mut().for_each(|joint| joint.y -= lowest);
    }

    fn to_json(&self, figure: &Figure) -> Value {
        let joints: Map<String, Value> = figure
            .joints
            .iter()
            .zip(&self.joints)
            .map(|(joint, at)| (joint.name.clone(), json!(at.to_array())))
            .collect();
        json!({
            "figure": figure.name,
            "joints": joints,
            "latent": self.latent,
            "seconds": {"encode": self.encode_s, "decode": self.decode_s},
        })
    }
}

/// Where the body goes, and as what.
enum Output<'a> {
    Mesh(&'a Path),
    Picture(&'a Path),
}

impl<'a> Output<'a> {
    fn of(path: &'a Path) -> Outcome<Self> {
        if path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("png"))
        {
            return Ok(Self::Picture(path));
        }
        MeshFormat::of_path(path).map_err(Failure::output)?;
        Ok(Self::Mesh(path))
    }

    fn write(&self, model: &Model, body: &Body) -> Outcome {
        match *self {
            Self::Mesh(path) => {
                let mesh = ExportMesh {
                    name: &model.figure().name,
                    positions: &body.positions,
                    normals: &body.normals,
                    colors: model.colors(),
                    triangles: model.triangles(),
                };
                save_mesh(&mesh, path).map_err(|error| match error {
                    ExportError::Mesh(_) => Failure::model(error),
                    other => Failure::output(other),
                })
            }
            Self::Picture(path) => {
                let stage = Stage::holding(&body.positions);
                write_png(path, &stage.picture(model, &body.positions, &body.normals))
            }
        }
    }
}
