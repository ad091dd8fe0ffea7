//! From trained networks to a model.

use stick3d_model::metadata::{
    FORMAT_VERSION, Metadata, Normalisation, TOOL_VERSION, topology_hash,
};
use stick3d_model::weights::LinearWeights;
use stick3d_model::{Model, ModelParts};

use super::drawn_bodies::DrawnBodies;
use super::exactness::exact_from;
use super::losses::CodeScale;
use super::networks::NetworkWeights;
use super::run::Run;
use super::statistics::statistics;
use super::{TrainConfig, TrainError};

/// What is done to a sketch's input vector.
pub(crate) const INPUT_NORMALISATION: &str =
    "offsets along the sketch path, divided by their root mean square length";

/// The model: normalisation folded into the networks, weights rounded as the file stores them.
pub(super) fn model(
    config: &TrainConfig,
    run: &Run<'_>,
    weights: NetworkWeights,
) -> Result<Model, TrainError> {
    let NetworkWeights {
        mut encoder3d,
        mut head,
        mut encoder2d,
    } = weights;
    if let Some(last) = head.layers.last_mut() {
        fold_into_output(last, &run.scale);
    }
    if let Some(first) = encoder3d.trunk.layers.first_mut() {
        fold_into_input(first, &run.scale);
    }
    encoder3d.round_to_half();
    head.round_to_half();
    encoder2d.round_to_half();
    let material = &run.material;
    let figure = material.figure;
    let vertex_count = material.shape.layer().vertex_count();
    let metadata = Metadata {
        format_version: FORMAT_VERSION,
        tool_version: TOOL_VERSION.to_owned(),
        figure: figure.clone(),
        architecture: config.architecture(material.shape.code_columns()),
        latent_len: config.latent_len,
        vertex_count,
        topology_hash: topology_hash(vertex_count, material.triangles),
        normalisation: Normalisation {
            input: INPUT_NORMALISATION.to_owned(),
            extent_m: material.extent_m,
            centre_joint: figure.joints[figure.root].name.clone(),
        },
        recipe: serde_json::to_value(config).map_err(|e| TrainError::Config(e.to_string()))?,
        data_hash: run.data_hash.clone(),
        metrics: serde_json::json!({ "basis_fit": material.basis_fit }),
        held_out_poses: material.held_out.to_vec(),
    };
    let mut parts = ModelParts {
        metadata,
        triangles: material.triangles.to_vec(),
        colors: material.colors.to_vec(),
        regressor: material.regressor.clone(),
        encoder2d,
        encoder3d,
        head,
        final_layer: material.shape.layer().clone(),
        statistics: None,
    };
    let drawn = DrawnBodies {
        bodies: &material.bodies,
        rotations: config.rotations,
        augmentation: config.augmentation,
        seed: config.seed,
    };
    let mut statistics = statistics(&parts, drawn)?;
    parts.statistics = Some(statistics.clone());
    statistics.exact_from = exact_from(&Model::new(parts.clone())?, drawn)?;
    parts.statistics = Some(statistics);
    Ok(Model::new(parts)?)
}

/// Makes a layer that wrote normalised codes write codes as they are.
fn fold_into_output(layer: &mut LinearWeights, scale: &CodeScale) {
    layer
        .weight
        .iter_mut()
        .for_each(|weight| *weight *= scale.scale);
    for (bias, mean) in layer.bias.iter_mut().zip(&scale.mean) {
        *bias = mean + scale.scale * *bias;
    }
}

/// Makes a layer that read normalised codes read codes as they are.
fn fold_into_input(layer: &mut LinearWeights, scale: &CodeScale) {
    layer
        .weight
        .iter_mut()
        .for_each(|weight| *weight /= scale.scale);
    let rows = layer.weight.chunks_exact(layer.output_len);
    for (mean, row) in scale.mean.iter().zip(rows) {
        layer
            .bias
            .iter_mut()
            .zip(row)
            .for_each(|(bias, weight)| *bias -= mean * weight);
    }
}
