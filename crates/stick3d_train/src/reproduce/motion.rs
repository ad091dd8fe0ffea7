//! Motions between two sketches and past the second (the paper's figures 10 and 11).

use glam::Vec3;
use image::RgbaImage;
use stick3d_model::Inference;

use super::distances::of_sketch;
use super::pictures::{Studio, blank};
use super::{Prepared, ReproduceError};
use crate::evaluate::{EvalError, sketch_between};
use crate::paper::{PaperSet, Sample, decoded};
use crate::render::contact_sheet;

/// Frames of a row.
const FRAMES: usize = 7;
/// What extrapolated bodies are coloured, linear: the paper has them red.
const RED: [u8; 4] = [150, 40, 34, 255];
/// From where they are seen, radians: a little from the side, where depth shows.
const YAW_RAD: f32 = 0.6;

/// Rows of frames from one sketch to another: through latent space, every vertex straight, bone by bone in the sketch; and
/// on through latent space.
pub(super) fn picture(
    prepared: &Prepared<'_>,
    vae: &Inference,
) -> Result<RgbaImage, ReproduceError> {
    let set = &prepared.subject.set;
    let studio = Studio::new(set)?;
    let Some(keys) = keys(prepared) else {
        return Ok(contact_sheet(&[blank()], 1));
    };
    let rows = frames(set, &mut vae.clone(), keys)?;
    let all: Vec<&[Vec3]> = rows[..3]
        .iter()
        .flatten()
        .map(|(_, body)| body.as_slice())
        .collect();
    let camera = studio.camera(&all, YAW_RAD);
    let red = vec![RED; set.vertex_count()];
    let beyond = rows.len() - 1;
    let cells: Vec<(String, RgbaImage)> = rows
        .iter()
        .enumerate()
        .flat_map(|(row, frames)| frames.iter().map(move |frame| (row, frame)))
        .map(|(row, (label, body))| {
            let image = match row == beyond {
                true => studio.colored(body, &red, &camera),
                false => studio.body(body, &camera),
            };
            (label.clone(), image)
        })
        .collect();
    Ok(contact_sheet(&cells, FRAMES as u32))
}

type Frame = (String, Vec<Vec3>);

/// All rows, from above.
fn frames(
    set: &PaperSet,
    vae: &mut Inference,
    keys: [Sample; 2],
) -> Result<[Vec<Frame>; 4], EvalError> {
    let sketches = [set.sketch(keys[0])?, set.sketch(keys[1])?];
    let mut latents = [vec![0.0; vae.latent_len()], vec![0.0; vae.latent_len()]];
    for (sketch, latent) in sketches.iter().zip(&mut latents) {
        vae.encode(sketch, latent)?;
    }
    let [from, to] = &latents;
    let ends = [decoded(vae, from)?, decoded(vae, to)?];
    let mut rows: [Vec<Frame>; 4] = Default::default();
    for frame in 0..FRAMES {
        let share = frame as f32 / (FRAMES - 1) as f32;
        let mut through_latents = |share: f32| {
            let latent: Vec<f32> = from
                .iter()
                .zip(to)
                .map(|(a, b)| a + share * (b - a))
                .collect();
            decoded(vae, &latent)
        };
        rows[0].push((format!("latent_{share:.2}"), through_latents(share)?));
        let beyond = 1.0 + share;
        rows[3].push((format!("beyond_{beyond:.2}"), through_latents(beyond)?));
        let straight = ends[0].iter().zip(&ends[1]).map(|(a, b)| a.lerp(*b, share));
        rows[1].push((format!("vertices_{share:.2}"), straight.collect()));
        let sketch = sketch_between(&set.figure, &sketches[0], &sketches[1], share)?;
        rows[2].push((format!("sketch_{share:.2}"), of_sketch(vae, &sketch)?));
    }
    Ok(rows)
}

/// Two trained poses facing the viewer: the first, and the one that is farther from it than three of four of the others.
fn keys(prepared: &Prepared<'_>) -> Option<[Sample; 2]> {
    let set = &prepared.subject.set;
    let turn = set.turns.len() / 2;
    let mut meshes: Vec<usize> = prepared.samples.train.iter().map(|s| s.mesh).collect();
    meshes.dedup();
    let first = *meshes.first()?;
    let distance = |mesh: usize| -> f32 {
        let pairs = set.meshes[first]
            .positions
            .iter()
            .zip(&set.meshes[mesh].positions);
        pairs.map(|(a, b)| a.distance(*b)).sum()
    };
    let mut others = meshes.split_off(1);
    others.sort_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    let second = *others.get(others.len() * 3 / 4)?;
    Some([first, second].map(|mesh| Sample { mesh, turn }))
}
