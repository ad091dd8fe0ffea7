//! Bodies generated from sketches, from the front and from the side (the paper's figures 5, 8 and 9).

use glam::Vec3;
use image::RgbaImage;
use stick3d_model::Inference;

use super::pictures::{FRONT, SIDE, Studio, blank};
use super::{Prepared, ReproduceError};
use crate::evaluate::EvalError;
use crate::paper::{Sample, sketched};
use crate::render::contact_sheet;

/// Rows of the picture: as many poses that were seen, and that were not.
const SEEN: usize = 2;
const UNSEEN: usize = 2;

/// A row for each of some sketches: the sketch, the truth, and what each model makes of it.
pub(super) fn picture(
    prepared: &Prepared<'_>,
    vae: &Inference,
    plain: Option<&Inference>,
) -> Result<RgbaImage, ReproduceError> {
    let set = &prepared.subject.set;
    let studio = Studio::new(set)?;
    let (mut vae, mut plain) = (vae.clone(), plain.cloned());
    let mut shipped = prepared.shipped.clone();
    let (mut cells, mut columns) = (vec![], 1);
    for (what, sample) in rows(prepared) {
        let truth = set.vertices(sample);
        let mut bodies: Vec<(&str, Vec<Vec3>)> =
            vec![("truth", truth), ("VAE", sketched(&mut vae, set, sample)?)];
        if let Some(plain) = &mut plain {
            bodies.push(("AE", sketched(plain, set, sample)?));
        }
        if let Some(shipped) = &mut shipped {
            bodies.push(("ships", prepared.of_shipped(shipped, sample)?));
        }
        let all: Vec<&[Vec3]> = bodies.iter().map(|(_, body)| body.as_slice()).collect();
        let [front, side] = [FRONT, SIDE].map(|yaw_rad| studio.camera(&all, yaw_rad));
        let name = &set.meshes[sample.mesh].name;
        let sketch = set.sketch(sample).map_err(EvalError::from)?;
        let sketch = studio.sketch(&sketch, &front);
        cells.push((format!("{name}_({what})"), sketch));
        for (label, body) in &bodies {
            cells.push((format!("{label},_front"), studio.body(body, &front)));
            cells.push((format!("{label},_side"), studio.body(body, &side)));
        }
        columns = 1 + 2 * bodies.len();
    }
    if cells.is_empty() {
        cells.push(blank());
    }
    Ok(contact_sheet(&cells, columns as u32))
}

/// Some samples that face the viewer upright, evenly spread: what is seen of them, and the sample.
fn rows(prepared: &Prepared<'_>) -> Vec<(&'static str, Sample)> {
    let turn = prepared.subject.set.turns.len() / 2;
    let pick = |what: &'static str, list: &[Sample], count: usize| {
        let mut meshes: Vec<usize> = list.iter().map(|sample| sample.mesh).collect();
        meshes.sort_unstable();
        meshes.dedup();
        let count = count.min(meshes.len());
        (0..count)
            .map(|i| {
                let mesh = meshes[i * meshes.len() / count];
                (what, Sample { mesh, turn })
            })
            .collect::<Vec<_>>()
    };
    let samples = &prepared.samples;
    let mut rows = pick("pose seen", &samples.train, SEEN);
    rows.extend(pick("pose unseen", &samples.pose, UNSEEN));
    rows
}
