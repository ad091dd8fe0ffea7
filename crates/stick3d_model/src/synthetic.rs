//! A small model made of arithmetic, for tests: sound in every respect, trained in none.

use stick3d_figure::figure::Figure;
use stick3d_figure::mesh::unique_edges;
use stick3d_figure::regressor::JointRegressor;

use crate::architecture::Architecture;
use crate::final_layer::{
    BasisLayer, DenseLayer, FinalLayer, Rotations, SkinnedLayer, SkinnedParts,
};
use crate::latent::TrainingStatistics;
use crate::metadata::{FORMAT_VERSION, Metadata, Normalisation, TOOL_VERSION, topology_hash};
use crate::model::{Model, ModelParts};
use crate::weights::{Encoder3dWeights, LinearWeights, MlpWeights};

/// Which final layer a [`model`] has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// As in the paper.
    Dense,
    /// A plain basis.
    Basis,
    /// A skinned one.
    Skinned,
    /// A skinned one whose head gives rotations.
    Rotations,
}

const RANK: usize = 5;
const LATENT: usize = 8;
/// Rings and points per ring of a closed tube.
const RINGS: usize = 9;
const ROUND: usize = 6;

/// A model of the human figure whose mesh is a torus of 54 vertices.
///
/// # Panics
/// Never: the parts fit together.
#[must_use]
pub(crate) fn model(kind: Kind) -> Model {
    let figure = Figure::human().clone();
    let (vertex_count, triangles) = torus();
    let architecture = match kind {
        Kind::Dense => Architecture::Paper { hidden: 7 },
        Kind::Rotations => Architecture::Basis {
            rank: 6,
            encoder3d: vec![12],
            head: vec![10],
            encoder2d: vec![16],
            hypotheses: 1,
        },
        Kind::Basis | Kind::Skinned => Architecture::Basis {
            rank: RANK,
            encoder3d: vec![12],
            head: vec![10, 9],
            encoder2d: vec![16, 11],
            hypotheses: 1,
        },
    };
    let sizes = architecture.sizes(figure.input_len(), LATENT, vertex_count);
    let mut numbers = Numbers(1);
    let encoder2d = mlp(&sizes.encoder2d, false, &mut numbers);
    let trunk = mlp(&sizes.encoder3d_trunk, true, &mut numbers);
    let width = sizes.encoder3d_trunk.last().copied().unwrap_or(0);
    let encoder3d = Encoder3dWeights {
        trunk,
        mean: linear(width, LATENT, &mut numbers),
        log_variance: linear(width, LATENT, &mut numbers),
    };
    let head = mlp(&sizes.head, sizes.relu_after_head, &mut numbers);
    let final_layer = final_layer(kind, sizes.coefficient_len(), vertex_count, &mut numbers);
    let rows = (0..figure.joint_count() as u32)
        .map(|j| vec![(j, 0.25), (j + 20, 0.75)])
        .collect();
    let metadata = Metadata {
        format_version: FORMAT_VERSION,
        tool_version: TOOL_VERSION.to_owned(),
        architecture,
        latent_len: LATENT,
        vertex_count,
        topology_hash: topology_hash(vertex_count, &triangles),
        normalisation: Normalisation {
            input: "synthetic".to_owned(),
            extent_m: 0.9,
            centre_joint: figure.joints[figure.root].name.clone(),
        },
        figure,
        recipe: serde_json::json!({ "seed": 1 }),
        data_hash: String::new(),
        metrics: serde_json::Value::Null,
        held_out_poses: vec!["kick".to_owned()],
    };
    let parts = ModelParts {
        metadata,
        triangles,
        colors: (0..vertex_count)
            .map(|v| [v as u8, 100, 200, 255])
            .collect(),
        regressor: JointRegressor { rows },
        encoder2d,
        encoder3d,
        head,
        final_layer,
        statistics: (kind == Kind::Rotations).then(|| statistics(&mut numbers)),
    };
    Model::new(parts).expect("the synthetic parts fit together")
}

/// Statistics that stretch nothing and hold every latent near.
fn statistics(numbers: &mut Numbers) -> TrainingStatistics {
    let (_, triangles) = torus();
    let mut statistics = TrainingStatistics {
        mean: (0..LATENT).map(|_| 0.1 * numbers.next()).collect(),
        whitening: (0..LATENT)
            .flat_map(|row| (0..=row).map(move |column| if row == column { 1.0 } else { 0.1 }))
            .collect(),
        far: 2.0,
        longest_edges_m: unique_edges(&triangles).iter().map(|_| 50.0).collect(),
        answer_ways: vec![],
        exact_from: 1.5,
    };
    statistics.round_to_half();
    statistics
}

fn final_layer(kind: Kind, len: usize, vertex_count: usize, numbers: &mut Numbers) -> FinalLayer {
    let sound = "the synthetic layer fits together";
    match kind {
        Kind::Dense => FinalLayer::Dense(
            DenseLayer::new(linear(len, 3 * vertex_count, numbers), 0.9).expect(sound),
        ),
        Kind::Basis => {
            let columns = (0..RANK * vertex_count).map(|_| numbers.next()).collect();
            FinalLayer::Basis(BasisLayer::new(vertex_count, columns).expect(sound))
        }
        Kind::Skinned | Kind::Rotations => {
            let bone_count = 4;
            let turning = Rotations {
                bone_count: 3,
                halves: vec![[0, 1], [2, 1]],
            };
            let rotations = (kind == Kind::Rotations).then_some(turning);
            let rank = rotations.as_ref().map_or(RANK, Rotations::feature_columns);
            let row = |v: usize| (0..=(v % 3)).map(move |i| ((v + i) % bone_count) as u16);
            let offsets = (0..=vertex_count)
                .map(|v| (0..v).map(|v| v % 3 + 1).sum::<usize>() as u32)
                .collect();
            let bones: Vec<u16> = (0..vertex_count).flat_map(row).collect();
            let parts = SkinnedParts {
                rest: (0..vertex_count)
                    .map(|_| [numbers.next(), numbers.next(), numbers.next()])
                    .collect(),
                offsets,
                weights: bones.iter().map(|_| numbers.next().abs()).collect(),
                bones,
                bone_count,
                rotations,
                expansion: (0..rank * 4 * bone_count).map(|_| numbers.next()).collect(),
            };
            FinalLayer::Skinned(SkinnedLayer::new(parts).expect(sound))
        }
    }
}

fn torus() -> (usize, Vec<[u32; 3]>) {
    let vertex = |ring: usize, point: usize| ((ring % RINGS) * ROUND + point % ROUND) as u32;
    let triangles = (0..RINGS)
        .flat_map(|r| (0..ROUND).map(move |p| (r, p)))
        .flat_map(|(r, p)| {
            let [a, b, c, d] = [
                vertex(r, p),
                vertex(r + 1, p),
                vertex(r + 1, p + 1),
                vertex(r, p + 1),
            ];
            [[a, b, c], [a, c, d]]
        });
    (RINGS * ROUND, triangles.collect())
}

fn mlp(widths: &[usize], relu_after_last: bool, numbers: &mut Numbers) -> MlpWeights {
    let mut mlp = MlpWeights::zeros(widths, relu_after_last);
    mlp.layers
        .iter_mut()
        .for_each(|layer| *layer = linear(layer.input_len, layer.output_len, numbers));
    mlp
}

fn linear(input_len: usize, output_len: usize, numbers: &mut Numbers) -> LinearWeights {
    let mut layer = LinearWeights::zeros(input_len, output_len);
    let scale = 1.5 / (input_len as f32).sqrt();
    layer
        .weight
        .iter_mut()
        .for_each(|weight| *weight = scale * numbers.next());
    layer
        .bias
        .iter_mut()
        .for_each(|bias| *bias = 0.1 * numbers.next());
    layer.round_to_half();
    layer
}

/// Numbers in -1..1 by a small generator (SplitMix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 23) as f32 - 1.0
    }
}
