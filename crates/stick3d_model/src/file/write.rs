//! Writing a model's bytes.

use std::collections::{BTreeMap, HashMap};

use half::f16;
use safetensors::Dtype;
use safetensors::tensor::TensorView;
use sha2::Digest as _;

use super::{ENTRY, ModelError, add_to_checksum, checksum_of_metadata};
use crate::digest::hex;
use crate::final_layer::FinalLayer;
use crate::latent::TrainingStatistics;
use crate::model::ModelParts;
use crate::weights::{LinearWeights, MlpWeights};

struct Array {
    dtype: Dtype,
    shape: Vec<usize>,
    data: Vec<u8>,
}

/// The arrays of a file by name; the order is part of the checksum.
#[derive(Default)]
struct Arrays(BTreeMap<String, Array>);

impl Arrays {
    fn put<T: bytemuck::NoUninit>(
        &mut self,
        name: &str,
        dtype: Dtype,
        shape: &[usize],
        numbers: &[T],
    ) {
        // Every machine that this runs on in practice is little-endian, as the format is.
        let data = bytemuck::cast_slice(numbers).to_vec();
        self.0.insert(
            name.to_owned(),
            Array {
                dtype,
                shape: shape.to_vec(),
                data,
            },
        );
    }

    fn put_f32(&mut self, name: &str, shape: &[usize], numbers: &[f32]) {
        self.put(name, Dtype::F32, shape, numbers);
    }

    fn put_half(&mut self, name: &str, shape: &[usize], numbers: &[f32]) {
        let halves: Vec<f16> = numbers.iter().map(|x| f16::from_f32(*x)).collect();
        self.put(name, Dtype::F16, shape, &halves);
    }

    fn put_u32(&mut self, name: &str, shape: &[usize], numbers: &[u32]) {
        self.put(name, Dtype::U32, shape, numbers);
    }

    fn put_linear(&mut self, name: &str, layer: &LinearWeights) {
        self.put_half(
            &format!("{name}.weight"),
            &[layer.input_len, layer.output_len],
            &layer.weight,
        );
        self.put_f32(&format!("{name}.bias"), &[layer.output_len], &layer.bias);
    }

    fn put_mlp(&mut self, name: &str, mlp: &MlpWeights) {
        for (index, layer) in mlp.layers.iter().enumerate() {
            self.put_linear(&format!("{name}.{index}"), layer);
        }
    }

    fn put_final_layer(&mut self, layer: &FinalLayer) {
        match layer {
            FinalLayer::Dense(dense) => {
                self.put_linear("final.dense", dense.linear());
                self.put_f32("final.dense.extent", &[1], &[dense.extent_m()]);
            }
            FinalLayer::Basis(basis) => {
                let shape = [basis.rank(), basis.vertex_count()];
                self.put_f32("final.basis.columns", &shape, basis.columns());
            }
            FinalLayer::Skinned(skinned) => {
                let parts = skinned.parts();
                self.put_f32(
                    "final.skinned.rest",
                    &[parts.rest.len(), 3],
                    parts.rest.as_flattened(),
                );
                self.put_u32(
                    "final.skinned.offsets",
                    &[parts.offsets.len()],
                    &parts.offsets,
                );
                self.put(
                    "final.skinned.bones",
                    Dtype::U16,
                    &[parts.bones.len()],
                    &parts.bones,
                );
                self.put_f32(
                    "final.skinned.weights",
                    &[parts.weights.len()],
                    &parts.weights,
                );
                if let Some(rotations) = &parts.rotations {
                    let shape = [rotations.halves.len(), 2];
                    self.put(
                        "final.skinned.halves",
                        Dtype::U16,
                        &shape,
                        rotations.halves.as_flattened(),
                    );
                }
                let shape = [skinned.rank(), 4 * parts.bone_count];
                self.put_f32("final.skinned.expansion", &shape, &parts.expansion);
            }
        }
    }

    fn put_statistics(&mut self, statistics: &TrainingStatistics) {
        let TrainingStatistics {
            mean,
            whitening,
            far,
            longest_edges_m,
            answer_ways,
            exact_from,
        } = statistics;
        self.put_f32("statistics.mean", &[mean.len()], mean);
        self.put_half("statistics.whitening", &[whitening.len()], whitening);
        self.put_f32("statistics.far", &[1], &[*far]);
        self.put_half(
            "statistics.longest_edges",
            &[longest_edges_m.len()],
            longest_edges_m,
        );
        if !answer_ways.is_empty() {
            self.put_half("statistics.answer_ways", &[answer_ways.len()], answer_ways);
        }
        if *exact_from != 0.0 {
            self.put_f32("statistics.exact_from", &[1], &[*exact_from]);
        }
    }

    fn put_mesh(&mut self, parts: &ModelParts) {
        self.put_u32(
            "mesh.triangles",
            &[parts.triangles.len(), 3],
            parts.triangles.as_flattened(),
        );
        self.put(
            "mesh.colors",
            Dtype::U8,
            &[parts.colors.len(), 4],
            parts.colors.as_flattened(),
        );
        let rows = &parts.regressor.rows;
        let ends = rows.iter().scan(0_u32, |end, row| {
            *end += row.len() as u32;
            Some(*end)
        });
        let offsets: Vec<u32> = std::iter::once(0).chain(ends).collect();
        let (vertices, weights): (Vec<u32>, Vec<f32>) = rows.iter().flatten().copied().unzip();
        self.put_u32("regressor.offsets", &[offsets.len()], &offsets);
        self.put_u32("regressor.vertices", &[vertices.len()], &vertices);
        self.put_f32("regressor.weights", &[weights.len()], &weights);
    }
}

/// The bytes of a model file; equal parts give equal bytes.
pub(crate) fn write(parts: &ModelParts) -> Result<Vec<u8>, ModelError> {
    let mut arrays = Arrays::default();
    arrays.put_mesh(parts);
    arrays.put_mlp("encoder2d", &parts.encoder2d);
    arrays.put_mlp("encoder3d.trunk", &parts.encoder3d.trunk);
    arrays.put_linear("encoder3d.mean", &parts.encoder3d.mean);
    arrays.put_linear("encoder3d.log_variance", &parts.encoder3d.log_variance);
    arrays.put_mlp("head", &parts.head);
    arrays.put_final_layer(&parts.final_layer);
    if let Some(statistics) = &parts.statistics {
        arrays.put_statistics(statistics);
    }

    let failed = |error: &dyn std::fmt::Display| ModelError::Write(error.to_string());
    let body = serde_json::to_string(&parts.metadata).map_err(|e| failed(&e))?;
    let mut hasher = checksum_of_metadata(&body);
    for (name, array) in &arrays.0 {
        add_to_checksum(&mut hasher, name, array.dtype, &array.shape, &array.data);
    }
    let entry = format!("{}\n{body}", hex(&hasher.finalize()));
    let views: Vec<(&String, TensorView<'_>)> = arrays
        .0
        .iter()
        .map(|(name, array)| {
            TensorView::new(array.dtype, array.shape.clone(), &array.data).map(|view| (name, view))
        })
        .collect::<Result<_, _>>()
        .map_err(|e| failed(&e))?;
    // One entry only: the crate writes them in the order of a hash map, which differs from run to run.
    let metadata = HashMap::from([(ENTRY.to_owned(), entry)]);
    safetensors::serialize(views, Some(metadata)).map_err(|e| failed(&e))
}
