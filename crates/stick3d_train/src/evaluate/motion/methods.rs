//! The ways from key to key that are compared.

use glam::Vec3;
use stick3d_model::Inference;
use stick3d_model::latent::{Interpolation, LatentKey, LatentPath, Repeat};

use super::cases::DrawnMotion;
use super::sketch_level;
use crate::evaluate::EvalError;

/// A way from key to key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    /// Through latent space.
    Latent(Interpolation),
    /// Every vertex straight from where it is in one key's mesh to where it is in the next.
    VertexLinear,
    /// Every bone of the sketch turned, and the sketch encoded.
    SketchLevel,
}

impl Method {
    pub(super) const ALL: [Self; 4] = [
        Self::Latent(Interpolation::Linear),
        Self::Latent(Interpolation::Cubic),
        Self::VertexLinear,
        Self::SketchLevel,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Latent(Interpolation::Linear) => "latent, straight",
            Self::Latent(Interpolation::Cubic) => "latent, cubic",
            Self::VertexLinear => "vertex-linear",
            Self::SketchLevel => "sketch-level",
        }
    }

    /// The meshes at the frames of a motion, metres, centred on the root joint.
    pub(super) fn meshes(
        self,
        drawn: &DrawnMotion,
        keys: &[LatentKey],
        inference: &mut Inference,
    ) -> Result<Vec<Vec<Vec3>>, EvalError> {
        let mut latent = vec![0.0; inference.latent_len()];
        let times_s = drawn.frames.iter().map(|frame| frame.time_s);
        match self {
            Self::Latent(interpolation) => {
                let path = LatentPath::new(keys, interpolation, Repeat::Once)?;
                times_s
                    .map(|time_s| {
                        path.sample_into(time_s, &mut latent)?;
                        mesh(&latent, inference)
                    })
                    .collect()
            }
            Self::VertexLinear => {
                let ends = keys
                    .iter()
                    .map(|key| mesh(&key.latent, inference))
                    .collect::<Result<Vec<_>, _>>()?;
                let straight = |time_s: f32| {
                    let (segment, share) = segment(keys, time_s);
                    let pairs = ends[segment].iter().zip(&ends[segment + 1]);
                    pairs.map(|(a, b)| a.lerp(*b, share)).collect()
                };
                Ok(times_s.map(straight).collect())
            }
            Self::SketchLevel => times_s
                .map(|time_s| {
                    let (segment, share) = segment(keys, time_s);
                    let figure = inference.figure().clone();
                    let (_, from) = &drawn.keys[segment];
                    let (_, to) = &drawn.keys[segment + 1];
                    let sketch = sketch_level::between(&figure, from, to, share)?;
                    inference.encode(&sketch, &mut latent)?;
                    mesh(&latent, inference)
                })
                .collect(),
        }
    }
}

/// Between which two keys a time is, and the share of the way.
fn segment(keys: &[LatentKey], time_s: f32) -> (usize, f32) {
    let after = keys.partition_point(|key| key.time_s <= time_s);
    let segment = after.clamp(1, keys.len() - 1) - 1;
    let (from_s, to_s) = (keys[segment].time_s, keys[segment + 1].time_s);
    (
        segment,
        ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0),
    )
}

/// The mesh of a latent.
pub(super) fn mesh(latent: &[f32], inference: &mut Inference) -> Result<Vec<Vec3>, EvalError> {
    let mut positions = vec![[0.0; 3]; inference.vertex_count()];
    inference.decode_positions(latent, &mut positions)?;
    Ok(positions.into_iter().map(Vec3::from).collect())
}
