//! Reading a model's bytes, trusting none of them.

use half::f16;
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensorError, SafeTensors};
use serde::Deserialize;
use sha2::Digest as _;
use stick3d_figure::regressor::JointRegressor;

use super::{ENTRY, ModelError, add_to_checksum, checksum_of_metadata};
use crate::digest::hex;
use crate::final_layer::{
    BasisLayer, DenseLayer, FinalLayer, Rotations, SkinnedLayer, SkinnedParts,
};
use crate::latent::TrainingStatistics;
use crate::metadata::{FORMAT_VERSION, Metadata};
use crate::model::ModelParts;
use crate::weights::{Encoder3dWeights, LinearWeights, MlpWeights};

/// The parts of a model file. Whether they fit together is for [`Model::new`](crate::Model::new) to say.
pub(crate) fn read(bytes: &[u8]) -> Result<ModelParts, ModelError> {
    if bytes.is_empty() {
        return Err(ModelError::Empty);
    }
    let (tensors, entry) = open(bytes)?;
    let (checksum, body) = entry.split_once('\n').ok_or(ModelError::Foreign)?;
    require_known_version(body)?;
    let arrays = Arrays(tensors);
    if arrays.checksum(body) != checksum {
        return Err(ModelError::Checksum);
    }
    let metadata: Metadata =
        serde_json::from_str(body).map_err(|e| ModelError::Metadata(e.to_string()))?;
    arrays.parts(metadata)
}

/// The arrays, and the metadata entry.
fn open(bytes: &[u8]) -> Result<(SafeTensors<'_>, String), ModelError> {
    let explain = |error: SafeTensorError| {
        truncation(bytes, &error).unwrap_or_else(|| ModelError::NotSafetensors(error.to_string()))
    };
    let (_, header) = SafeTensors::read_metadata(bytes).map_err(explain)?;
    let entry = header
        .metadata()
        .as_ref()
        .and_then(|map| map.get(ENTRY))
        .ok_or(ModelError::Foreign)?
        .clone();
    Ok((SafeTensors::deserialize(bytes).map_err(explain)?, entry))
}

/// Says how much is missing, where the file begins like safetensors and ends too early.
fn truncation(bytes: &[u8], error: &SafeTensorError) -> Option<ModelError> {
    let found = bytes.len() as u64;
    let Some(prefix) = bytes.first_chunk::<8>() else {
        return Some(ModelError::Truncated { expected: 8, found });
    };
    let header_end = u64::from_le_bytes(*prefix).checked_add(8)?;
    match error {
        SafeTensorError::InvalidHeaderLength if bytes.get(8) == Some(&b'{') => {
            Some(ModelError::Truncated {
                expected: header_end,
                found,
            })
        }
        SafeTensorError::MetadataIncompleteBuffer => {
            let header = bytes.get(8..usize::try_from(header_end).ok()?)?;
            let end = last_offset(header)?;
            let expected = header_end.checked_add(end)?;
            (expected > found).then_some(ModelError::Truncated { expected, found })
        }
        _ => None,
    }
}

/// Where the last array of a safetensors header ends.
fn last_offset(header: &[u8]) -> Option<u64> {
    let header: serde_json::Value = serde_json::from_slice(header).ok()?;
    let ends = header
        .as_object()?
        .values()
        .filter_map(|array| array.get("data_offsets")?.get(1)?.as_u64());
    ends.max()
}

fn require_known_version(body: &str) -> Result<(), ModelError> {
    /// All that this program can count on in a file of a later version.
    #[derive(Deserialize)]
    struct Version {
        format_version: u32,
    }
    let version: Version =
        serde_json::from_str(body).map_err(|e| ModelError::Metadata(e.to_string()))?;
    if version.format_version > FORMAT_VERSION {
        return Err(ModelError::NewerVersion {
            found: version.format_version,
            supported: FORMAT_VERSION,
        });
    }
    Ok(())
}

struct Arrays<'a>(SafeTensors<'a>);

impl Arrays<'_> {
    fn checksum(&self, body: &str) -> String {
        let mut arrays: Vec<(String, TensorView<'_>)> = self.0.tensors();
        arrays.sort_by(|a, b| a.0.cmp(&b.0));
        let mut hasher = checksum_of_metadata(body);
        for (name, array) in &arrays {
            add_to_checksum(
                &mut hasher,
                name,
                array.dtype(),
                array.shape(),
                array.data(),
            );
        }
        hex(&hasher.finalize())
    }

    /// The bytes of an array of a given type, with its shape if it has as many dimensions as `rank`.
    fn get(&self, name: &str, dtype: Dtype, rank: usize) -> Result<TensorView<'_>, ModelError> {
        let array = self.0.tensor(name).map_err(|_| ModelError::MissingArray {
            name: name.to_owned(),
        })?;
        if array.dtype() != dtype || array.shape().len() != rank {
            return Err(ModelError::Array {
                name: name.to_owned(),
                expected: format!("{dtype:?} with {rank} dimensions"),
                found: format!("{:?} {:?}", array.dtype(), array.shape()),
            });
        }
        Ok(array)
    }

    fn f32(&self, name: &str, rank: usize) -> Result<(Vec<usize>, Vec<f32>), ModelError> {
        let array = self.get(name, Dtype::F32, rank)?;
        let numbers = numbers(array.data(), f32::from_le_bytes);
        Ok((array.shape().to_vec(), finite(name, numbers)?))
    }

    fn half(&self, name: &str, rank: usize) -> Result<(Vec<usize>, Vec<f32>), ModelError> {
        let array = self.get(name, Dtype::F16, rank)?;
        let numbers = numbers(array.data(), |bytes| f16::from_le_bytes(bytes).to_f32());
        Ok((array.shape().to_vec(), finite(name, numbers)?))
    }

    fn u32(&self, name: &str, rank: usize) -> Result<Vec<u32>, ModelError> {
        Ok(numbers(
            self.get(name, Dtype::U32, rank)?.data(),
            u32::from_le_bytes,
        ))
    }

    /// An array of rows of `WIDTH` numbers.
    fn rows<T: Copy, const WIDTH: usize>(
        &self,
        name: &str,
        dtype: Dtype,
        flat: Vec<T>,
    ) -> Result<Vec<[T; WIDTH]>, ModelError> {
        let array = self.get(name, dtype, 2)?;
        let (rows, rest) = flat.as_chunks::<WIDTH>();
        if array.shape()[1] != WIDTH || !rest.is_empty() {
            return Err(ModelError::Array {
                name: name.to_owned(),
                expected: format!("{dtype:?} [_, {WIDTH}]"),
                found: format!("{:?} {:?}", array.dtype(), array.shape()),
            });
        }
        Ok(rows.to_vec())
    }

    fn linear(&self, name: &str) -> Result<LinearWeights, ModelError> {
        let (shape, weight) = self.half(&format!("{name}.weight"), 2)?;
        let (_, bias) = self.f32(&format!("{name}.bias"), 1)?;
        Ok(LinearWeights {
            input_len: shape[0],
            output_len: shape[1],
            weight,
            bias,
        })
    }

    fn mlp(
        &self,
        name: &str,
        layer_count: usize,
        relu_after_last: bool,
    ) -> Result<MlpWeights, ModelError> {
        let layers = (0..layer_count)
            .map(|i| self.linear(&format!("{name}.{i}")))
            .collect::<Result<_, _>>()?;
        Ok(MlpWeights {
            layers,
            relu_after_last,
        })
    }

    fn has(&self, name: &str) -> bool {
        self.0.tensor(name).is_ok()
    }

    fn final_layer(&self) -> Result<FinalLayer, ModelError> {
        if self.has("final.skinned.rest") {
            return Ok(FinalLayer::Skinned(self.skinned()?));
        }
        if self.has("final.basis.columns") {
            let (shape, columns) = self.f32("final.basis.columns", 2)?;
            return Ok(FinalLayer::Basis(BasisLayer::new(shape[1], columns)?));
        }
        let linear = self.linear("final.dense")?;
        let (_, extent) = self.f32("final.dense.extent", 1)?;
        Ok(FinalLayer::Dense(DenseLayer::new(
            linear,
            extent.first().copied().unwrap_or(f32::NAN),
        )?))
    }

    fn skinned(&self) -> Result<SkinnedLayer, ModelError> {
        let (_, rest) = self.f32("final.skinned.rest", 2)?;
        let (shape, expansion) = self.f32("final.skinned.expansion", 2)?;
        let bones = self.get("final.skinned.bones", Dtype::U16, 1)?;
        let rotations = self.rotations(shape[0])?;
        Ok(SkinnedLayer::new(SkinnedParts {
            rotations,
            rest: self.rows("final.skinned.rest", Dtype::F32, rest)?,
            offsets: self.u32("final.skinned.offsets", 1)?,
            bones: numbers(bones.data(), u16::from_le_bytes),
            weights: self.f32("final.skinned.weights", 1)?.1,
            bone_count: shape[1] / 4,
            expansion,
        })?)
    }

    /// The rotations of a skinned layer whose expansion has `rank` rows.
    fn rotations(&self, rank: usize) -> Result<Option<Rotations>, ModelError> {
        const NAME: &str = "final.skinned.halves";
        if !self.has(NAME) {
            return Ok(None);
        }
        let flat = numbers(self.get(NAME, Dtype::U16, 2)?.data(), u16::from_le_bytes);
        let halves: Vec<[u16; 2]> = self.rows(NAME, Dtype::U16, flat)?;
        let bone_count = (rank / 3).saturating_sub(halves.len());
        Ok(Some(Rotations { bone_count, halves }))
    }

    fn regressor(&self) -> Result<JointRegressor, ModelError> {
        let offsets = self.u32("regressor.offsets", 1)?;
        let vertices = self.u32("regressor.vertices", 1)?;
        let (_, weights) = self.f32("regressor.weights", 1)?;
        let row = |range: &[u32]| -> Option<Vec<(u32, f32)>> {
            let range = range[0] as usize..range[1] as usize;
            let row = vertices
                .get(range.clone())?
                .iter()
                .copied()
                .zip(weights.get(range)?.iter().copied());
            Some(row.collect())
        };
        let rows = offsets.windows(2).map(row).collect::<Option<Vec<_>>>();
        let rows = rows.ok_or_else(|| ModelError::Array {
            name: "regressor.offsets".to_owned(),
            expected: "offsets that rise to the number of weights".to_owned(),
            found: format!("{offsets:?}"),
        })?;
        Ok(JointRegressor { rows })
    }

    /// Models had none at first; programs of that time do not look for the arrays.
    fn statistics(&self) -> Result<Option<TrainingStatistics>, ModelError> {
        if !self.has("statistics.mean") {
            return Ok(None);
        }
        let (_, far) = self.f32("statistics.far", 1)?;
        Ok(Some(TrainingStatistics {
            mean: self.f32("statistics.mean", 1)?.1,
            whitening: self.half("statistics.whitening", 1)?.1,
            far: far.first().copied().unwrap_or(f32::NAN),
            longest_edges_m: self.half("statistics.longest_edges", 1)?.1,
            answer_ways: match self.has("statistics.answer_ways") {
                true => self.half("statistics.answer_ways", 1)?.1,
                false => vec![],
            },
            exact_from: match self.has("statistics.exact_from") {
                true => self.f32("statistics.exact_from", 1)?.1.first().copied(),
                false => None,
            }
            .unwrap_or_default(),
        }))
    }

    fn parts(&self, metadata: Metadata) -> Result<ModelParts, ModelError> {
        let input_len = metadata.figure.input_len();
        let sizes =
            metadata
                .architecture
                .sizes(input_len, metadata.latent_len, metadata.vertex_count);
        let layers = |widths: &[usize]| widths.len().saturating_sub(1);
        let triangles = self.u32("mesh.triangles", 2)?;
        let colors = self.get("mesh.colors", Dtype::U8, 2)?.data().to_vec();
        Ok(ModelParts {
            triangles: self.rows("mesh.triangles", Dtype::U32, triangles)?,
            colors: self.rows("mesh.colors", Dtype::U8, colors)?,
            regressor: self.regressor()?,
            encoder2d: self.mlp("encoder2d", layers(&sizes.encoder2d), false)?,
            encoder3d: Encoder3dWeights {
                trunk: self.mlp("encoder3d.trunk", layers(&sizes.encoder3d_trunk), true)?,
                mean: self.linear("encoder3d.mean")?,
                log_variance: self.linear("encoder3d.log_variance")?,
            },
            head: self.mlp("head", layers(&sizes.head), sizes.relu_after_head)?,
            final_layer: self.final_layer()?,
            statistics: self.statistics()?,
            metadata,
        })
    }
}

fn numbers<T, const BYTES: usize>(data: &[u8], number: impl Fn([u8; BYTES]) -> T) -> Vec<T> {
    data.as_chunks::<BYTES>()
        .0
        .iter()
        .map(|bytes| number(*bytes))
        .collect()
}

fn finite(name: &str, numbers: Vec<f32>) -> Result<Vec<f32>, ModelError> {
    match numbers.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(ModelError::NotFinite {
            name: name.to_owned(),
            index,
        }),
        None => Ok(numbers),
    }
}
