//! `stick3d pose`: from a sketch file to a posed mesh.

use std::path::Path;
use std::time::Instant;

use glam::Vec3;
use serde_json::{Value, json};
use stick3d_figure::figure::{Figure, Limb};
use stick3d_figure::sketch::Sketch;
use stick3d_model::export::{ExportError, ExportMesh, MeshFormat, save_mesh};
use stick3d_model::{Alternative, Alternatives, Inference, Model};

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
    let answer = Answer::of(&model, &sketch)?;
    if let Some(output) = output {
        output.write(&model, answer.body(arguments.alternative)?)?;
    }
    if arguments.json {
        println!("{}", answer.to_json(model.figure()));
    }
    Ok(())
}

/// All bodies that a sketch may mean, the likeliest first, and how long they took.
struct Answer {
    alternatives: Alternatives,
    bodies: Vec<Body>,
    encode_s: f64,
    infer_s: f64,
    decode_s: f64,
}

/// A posed body, its lowest vertex at height 0.
struct Body {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    joints: Vec<Vec3>,
}

impl Answer {
    fn of(model: &Model, sketch: &Sketch) -> Outcome<Self> {
        let mut inference = Inference::new(model).map_err(Failure::model)?;
        let mut alternatives = Alternatives::default();
        let mut latent = vec![0.0; inference.latent_len()];
        let start = Instant::now();
        inference
            .encode(sketch, &mut latent)
            .map_err(Failure::input)?;
        let encode_s = start.elapsed().as_secs_f64();
        let start = Instant::now();
        inference
            .infer(sketch, &mut alternatives)
            .map_err(Failure::input)?;
        let infer_s = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let all = alternatives.as_slice().iter();
        let bodies: Vec<Body> = all
            .map(|alternative| Body::of(alternative, &mut inference))
            .collect::<Outcome<_>>()?;
        // One body's share: what a game has to wait for.
        let decode_s = start.elapsed().as_secs_f64() / bodies.len().max(1) as f64;
        Ok(Self {
            alternatives,
            bodies,
            encode_s,
            infer_s,
            decode_s,
        })
    }

    /// The body of an alternative; they count from 1.
    fn body(&self, number: usize) -> Outcome<&Body> {
        let body = number.checked_sub(1).and_then(|at| self.bodies.get(at));
        body.ok_or_else(|| {
            Failure::usage(anyhow::anyhow!(
                "there is no alternative {number}: this sketch may mean {} in all; give --alternative a number from 1 to {}",
                match self.bodies.len() {
                    1 => "one body".to_owned(),
                    count => format!("{count} bodies"),
                },
                self.bodies.len(),
            ))
        })
    }

    /// The first alternative, with all of them after it.
    fn to_json(&self, figure: &Figure) -> Value {
        let limbs = figure.limbs();
        let all = self.alternatives.as_slice().iter().zip(&self.bodies);
        let alternatives: Vec<Value> = all
            .map(|(alternative, body)| {
                json!({
                    "probability": alternative.probability,
                    "joints": named(figure, &body.joints),
                    "limbs": pointing(figure, &limbs, alternative),
                    "latent": alternative.latent,
                })
            })
            .collect();
        let of_first = |key: &str| alternatives.first().map(|first| first[key].clone());
        json!({
            "figure": figure.name,
            "joints": of_first("joints"),
            "limbs": of_first("limbs"),
            "latent": of_first("latent"),
            "seconds": {"encode": self.encode_s, "infer": self.infer_s, "decode": self.decode_s},
            "alternatives": alternatives,
        })
    }
}

/// Joints by their names, metres.
fn named(figure: &Figure, joints: &[Vec3]) -> Value {
    let joints = figure.joints.iter().zip(joints);
    let joints = joints.map(|(joint, at)| (joint.name.clone(), json!(at.to_array())));
    Value::Object(joints.collect())
}

/// For every limb, by the name of the joint at its end, whether it points toward the viewer or away.
fn pointing(figure: &Figure, limbs: &[Limb], alternative: &Alternative) -> Value {
    let limbs = limbs.iter().map(|limb| {
        let toward = alternative.toward_viewer_m(limb) >= 0.0;
        let says = if toward { "toward" } else { "away" };
        (figure.joints[limb.end()].name.clone(), json!(says))
    });
    Value::Object(limbs.collect())
}

impl Body {
    fn of(alternative: &Alternative, inference: &mut Inference) -> Outcome<Self> {
        let vertex_count = inference.vertex_count();
        let mut body = Self {
            positions: vec![[0.0; 3]; vertex_count],
            normals: vec![[0.0; 3]; vertex_count],
            joints: alternative.joints.clone(),
        };
        inference
            .decode(&alternative.latent, &mut body.positions, &mut body.normals)
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
