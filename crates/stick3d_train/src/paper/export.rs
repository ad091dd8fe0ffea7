//! From trained networks to a model.

use glam::Vec3;
use rayon::prelude::*;
use stick3d_figure::mesh::unique_edges;
use stick3d_model::final_layer::DenseLayer;
use stick3d_model::metadata::{FORMAT_VERSION, Metadata, Normalisation, TOOL_VERSION};
use stick3d_model::{FinalLayer, Model, ModelError, ModelParts};

use super::networks::PaperWeights;
use super::{PaperConfig, PaperKind, PaperSet, Samples};
use crate::training::statistics::of_latents;
use crate::training::{INPUT_NORMALISATION, TrainError};

/// A variance of latents that is none, as a logarithm: the plain autoencoder's.
const NO_VARIANCE: f32 = -20.0;

/// The model: the scale folded into Encoder3D, so that it reads metres; weights rounded as the file stores them.
pub(super) fn model(
    set: &PaperSet,
    samples: &Samples,
    config: &PaperConfig,
    weights: PaperWeights,
    latents: &[Vec<f32>],
    data_hash: String,
) -> Result<Model, TrainError> {
    let PaperWeights {
        mut encoder3d,
        decoder: mut head,
        mut encoder2d,
    } = weights;
    let scale_m = set.scale_m();
    if let Some(first) = encoder3d.trunk.layers.first_mut() {
        first
            .weight
            .iter_mut()
            .for_each(|weight| *weight /= scale_m);
    }
    if config.kind == PaperKind::Plain {
        encoder3d.log_variance.weight.fill(0.0);
        encoder3d.log_variance.bias.fill(NO_VARIANCE);
    }
    let mut last = head.layers.pop().ok_or_else(|| {
        TrainError::Config("the decoder has no last layer to take apart".to_owned())
    })?;
    head.relu_after_last = true;
    encoder3d.round_to_half();
    encoder2d.round_to_half();
    head.round_to_half();
    last.round_to_half();
    let layer = DenseLayer::new(last, scale_m).map_err(ModelError::from)?;
    let figure = &set.figure;
    let metadata = Metadata {
        format_version: FORMAT_VERSION,
        tool_version: TOOL_VERSION.to_owned(),
        figure: figure.clone(),
        architecture: config.architecture(),
        latent_len: config.latent_len,
        vertex_count: set.vertex_count(),
        topology_hash: set.topology_hash(),
        normalisation: Normalisation {
            input: INPUT_NORMALISATION.to_owned(),
            extent_m: set.extent_m,
            centre_joint: figure.joints[figure.root].name.clone(),
        },
        recipe: serde_json::to_value(config).map_err(|e| TrainError::Config(e.to_string()))?,
        data_hash,
        metrics: serde_json::json!({}),
        held_out_poses: names_held_out(set, samples),
    };
    let parts = ModelParts {
        metadata,
        triangles: set.triangles.clone(),
        colors: set.colors.clone(),
        regressor: set.regressor.clone(),
        encoder2d,
        encoder3d,
        head,
        final_layer: FinalLayer::Dense(layer),
        statistics: Some(of_latents(latents, longest_edges(set, samples), vec![])?),
    };
    Ok(Model::new(parts)?)
}

/// The key meshes that are learnt from in no turn.
fn names_held_out(set: &PaperSet, samples: &Samples) -> Vec<String> {
    let mut meshes: Vec<usize> = samples.pose.iter().map(|sample| sample.mesh).collect();
    meshes.dedup();
    meshes
        .into_iter()
        .map(|mesh| set.meshes[mesh].name.clone())
        .collect()
}

/// The longest that each edge is on a mesh that is learnt from, metres.
fn longest_edges(set: &PaperSet, samples: &Samples) -> Vec<f32> {
    let mut learnt: Vec<usize> = samples.train.iter().map(|sample| sample.mesh).collect();
    learnt.sort_unstable();
    learnt.dedup();
    let longest = |&[a, b]: &[u32; 2]| {
        let length = |mesh: &usize| {
            let at = |v: u32| -> Vec3 { set.meshes[*mesh].positions[v as usize] };
            at(a).distance(at(b))
        };
        learnt.iter().map(length).fold(0.0, f32::max)
    };
    unique_edges(&set.triangles)
        .par_iter()
        .map(longest)
        .collect()
}
