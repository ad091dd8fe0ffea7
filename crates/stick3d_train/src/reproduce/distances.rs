//! Generated bodies coloured by their distance to the truth (the paper's figure 7).

use glam::{Quat, Vec3};
use image::RgbaImage;
use stick3d_figure::sketch::Sketch;
use stick3d_model::Inference;

use super::color_map::{bar, viridis_linear};
use super::icp::aligned;
use super::pictures::{CELL_PX, FRONT, SIDE, Studio, blank};
use super::{Prepared, ReproduceError};
use crate::dataset::{drawn, rotation};
use crate::evaluate::EvalError;
use crate::paper::{PaperSet, decoded};
use crate::render::contact_sheet;

/// A turn between those of the paper: about y and z, degrees.
const BETWEEN_TURNS: (f32, f32) = (15.0, 22.0);
/// Cells of a row.
const COLUMNS: u32 = 8;

/// A case: what it is called, a key mesh, how it is turned, and whether what is generated is aligned first.
struct Case {
    label: String,
    mesh: usize,
    turn: Quat,
    aligned: bool,
}

/// What was generated for a case.
struct Found {
    truth: Vec<Vec3>,
    sketch: Sketch,
    /// The paper's, and the shipped model's where there is one.
    bodies: Vec<(&'static str, Vec<Vec3>)>,
}

/// Two poses and turns that were trained, a trained pose in a turn that was not, and a pose that was not: the truth, the
/// sketch, what the paper's model and the shipped one make of it, coloured by distance.
pub(super) fn picture(
    prepared: &Prepared<'_>,
    vae: &Inference,
) -> Result<RgbaImage, ReproduceError> {
    let set = &prepared.subject.set;
    let studio = Studio::new(set)?;
    let cases = cases(prepared);
    let found: Vec<Found> = cases
        .iter()
        .map(|case| find(prepared, vae, case))
        .collect::<Result<_, _>>()?;
    let top_m = top_m(&found);
    let mut cells = vec![];
    for (case, found) in cases.iter().zip(&found) {
        let mut bodies: Vec<&[Vec3]> = found.bodies.iter().map(|(_, b)| b.as_slice()).collect();
        bodies.push(&found.truth);
        let [front, side] = [FRONT, SIDE].map(|yaw_rad| studio.camera(&bodies, yaw_rad));
        let mut row = vec![
            (case.label.clone(), studio.sketch(&found.sketch, &front)),
            ("truth,_front".to_owned(), studio.body(&found.truth, &front)),
            ("truth,_side".to_owned(), studio.body(&found.truth, &side)),
        ];
        for (label, body) in &found.bodies {
            let distances = body.iter().zip(&found.truth).map(|(a, b)| a.distance(*b));
            let colors: Vec<[u8; 4]> = distances.map(|d| viridis_linear(d / top_m)).collect();
            for (seen, camera) in [("front", &front), ("side", &side)] {
                let image = studio.colored(body, &colors, camera);
                row.push((format!("{label},_{seen}"), image));
            }
        }
        let [width, height] = CELL_PX;
        row.push(("distance".to_owned(), bar(100.0 * top_m, width, height)));
        row.resize_with(COLUMNS as usize, blank);
        cells.extend(row);
    }
    Ok(contact_sheet(&cells, COLUMNS))
}

fn cases(prepared: &Prepared<'_>) -> Vec<Case> {
    let set = &prepared.subject.set;
    let samples = &prepared.samples;
    let trained = |share: usize| samples.train.get(samples.train.len() * share / 4).copied();
    let mut cases: Vec<Case> = [trained(1), trained(3)]
        .into_iter()
        .flatten()
        .map(|sample| Case {
            label: format!("{}_(trained)", set.meshes[sample.mesh].name),
            mesh: sample.mesh,
            turn: set.turns[sample.turn],
            aligned: false,
        })
        .collect();
    let (yaw_deg, roll_deg) = BETWEEN_TURNS;
    if let Some(sample) = trained(2) {
        cases.push(Case {
            label: format!("{}_(unseen turn,_after ICP)", set.meshes[sample.mesh].name),
            mesh: sample.mesh,
            turn: rotation(yaw_deg, 0.0, roll_deg),
            aligned: true,
        });
    }
    if let Some(sample) = samples.pose.get(samples.pose.len() / 2) {
        cases.push(Case {
            label: format!("{}_(unseen pose)", set.meshes[sample.mesh].name),
            mesh: sample.mesh,
            turn: Quat::IDENTITY,
            aligned: false,
        });
    }
    cases
}

fn find(prepared: &Prepared<'_>, vae: &Inference, case: &Case) -> Result<Found, EvalError> {
    let set: &PaperSet = &prepared.subject.set;
    let mesh = &set.meshes[case.mesh];
    let truth: Vec<Vec3> = mesh.positions.iter().map(|p| case.turn * *p).collect();
    let sketch = Sketch::new(&set.figure, drawn(case.turn, &mesh.joints))?;
    let place = |body: Vec<Vec3>| match case.aligned {
        true => aligned(&body, &truth),
        false => body,
    };
    let mut bodies = vec![("VAE", place(of_sketch(&mut vae.clone(), &sketch)?))];
    if let Some(shipped) = &prepared.shipped {
        let body = of_sketch(&mut shipped.clone(), &sketch)?;
        bodies.push(("ships", place(prepared.kept(&body))));
    }
    Ok(Found {
        bodies,
        truth,
        sketch,
    })
}

/// The mesh that a model makes of a sketch, metres.
pub(super) fn of_sketch(
    inference: &mut Inference,
    sketch: &Sketch,
) -> Result<Vec<Vec3>, EvalError> {
    let mut latent = vec![0.0; inference.latent_len()];
    inference.encode(sketch, &mut latent)?;
    decoded(inference, &latent)
}

/// The distance that has the last colour: all but one in twenty vertices of the paper's bodies are closer.
fn top_m(found: &[Found]) -> f32 {
    let mut distances: Vec<f32> = found
        .iter()
        .filter_map(|found| Some((found.bodies.first()?, &found.truth)))
        .flat_map(|((_, body), truth)| body.iter().zip(truth).map(|(a, b)| a.distance(*b)))
        .collect();
    if distances.is_empty() {
        return 1.0;
    }
    let index = (distances.len() - 1) * 95 / 100;
    let (_, top, _) = distances.select_nth_unstable_by(index, f32::total_cmp);
    top.max(1e-3)
}
