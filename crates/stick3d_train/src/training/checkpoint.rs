//! Where a run stands, in one file.

use std::collections::HashMap;
use std::path::Path;

use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use serde::{Deserialize, Serialize};

use super::TrainError;
use super::adam::Adam;
use super::log::LossLog;
use super::networks::NetworkWeights;

/// Weights that a checkpoint can hold.
pub(crate) trait NamedArrays {
    /// Every array with a name, in a fixed order.
    fn arrays(&mut self) -> Vec<(String, &mut Vec<f32>)>;
}

impl NamedArrays for NetworkWeights {
    fn arrays(&mut self) -> Vec<(String, &mut Vec<f32>)> {
        Self::arrays(self)
    }
}

/// The state of a run between two epochs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Checkpoint<W = NetworkWeights> {
    /// All weights.
    pub(crate) weights: W,
    /// The optimiser of the stage.
    pub(crate) adam: Adam,
    /// Index of the stage.
    pub(crate) stage: usize,
    /// The next epoch of it.
    pub(crate) epoch: usize,
    /// The losses so far.
    pub(crate) log: LossLog,
}

/// The metadata entry of the file.
#[derive(Serialize, Deserialize)]
struct Entry {
    identity: String,
    stage: usize,
    epoch: usize,
    adam_steps: u64,
    adam_arrays: usize,
    log: LossLog,
}

const ENTRY: &str = "stick3d_checkpoint";

impl<W: NamedArrays> Checkpoint<W> {
    /// The beginning of a run.
    pub(crate) fn start(weights: W) -> Self {
        Self {
            weights,
            adam: Adam::default(),
            stage: 0,
            epoch: 0,
            log: LossLog::default(),
        }
    }

    /// Writes the file atomically. `identity` tells runs apart.
    pub(crate) fn save(&mut self, path: &Path, identity: &str) -> Result<(), TrainError> {
        let entry = Entry {
            identity: identity.to_owned(),
            stage: self.stage,
            epoch: self.epoch,
            adam_steps: self.adam.steps,
            adam_arrays: self.adam.means.len(),
            log: self.log.clone(),
        };
        let fault = |problem: String| TrainError::Checkpoint {
            path: path.to_owned(),
            problem,
        };
        let text = serde_json::to_string(&entry).map_err(|e| fault(e.to_string()))?;
        let mut arrays: Vec<(String, &[f32])> = self
            .weights
            .arrays()
            .into_iter()
            .map(|(name, array)| (name, &**array))
            .collect();
        for (i, (mean, square)) in self.adam.means.iter().zip(&self.adam.squares).enumerate() {
            arrays.push((format!("adam.{i}.mean"), mean));
            arrays.push((format!("adam.{i}.square"), square));
        }
        let views: Vec<(String, TensorView<'_>)> = arrays
            .into_iter()
            .map(|(name, array)| {
                let view =
                    TensorView::new(Dtype::F32, vec![array.len()], bytemuck::cast_slice(array));
                view.map(|view| (name, view))
            })
            .collect::<Result<_, _>>()
            .map_err(|e| fault(e.to_string()))?;
        let metadata = HashMap::from([(ENTRY.to_owned(), text)]);
        let bytes =
            safetensors::serialize(views, Some(metadata)).map_err(|e| fault(e.to_string()))?;
        stick3d_model::files::write_atomically(path, &bytes).map_err(|source| TrainError::Io {
            path: path.to_owned(),
            source,
        })
    }

    /// Reads the file of the run `identity` into the shapes of `start`.
    pub(crate) fn load(path: &Path, identity: &str, start: Self) -> Result<Self, TrainError> {
        let bytes = std::fs::read(path).map_err(|source| TrainError::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&bytes, identity, start).map_err(|problem| TrainError::Checkpoint {
            path: path.to_owned(),
            problem,
        })
    }

    fn parse(bytes: &[u8], identity: &str, mut checkpoint: Self) -> Result<Self, String> {
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(|e| e.to_string())?;
        let arrays = SafeTensors::deserialize(bytes).map_err(|e| e.to_string())?;
        let text = header
            .metadata()
            .as_ref()
            .and_then(|map| map.get(ENTRY))
            .ok_or("it has no checkpoint entry")?;
        let entry: Entry = serde_json::from_str(text).map_err(|e| e.to_string())?;
        if entry.identity != identity {
            return Err("it was written with another configuration or other data".to_owned());
        }
        let read = |name: &str| -> Result<Vec<f32>, String> {
            let array = arrays
                .tensor(name)
                .map_err(|_| format!("it lacks {name}"))?;
            let (numbers, rest) = array.data().as_chunks::<4>();
            if array.dtype() != Dtype::F32 || !rest.is_empty() {
                return Err(format!("{name} is no array of 32-bit numbers"));
            }
            Ok(numbers
                .iter()
                .map(|bytes| f32::from_le_bytes(*bytes))
                .collect())
        };
        for (name, array) in checkpoint.weights.arrays() {
            let numbers = read(&name)?;
            if numbers.len() != array.len() {
                return Err(format!(
                    "{name} has {} numbers, {} are needed",
                    numbers.len(),
                    array.len()
                ));
            }
            *array = numbers;
        }
        checkpoint.adam = Adam {
            steps: entry.adam_steps,
            means: vec![],
            squares: vec![],
        };
        for i in 0..entry.adam_arrays {
            checkpoint.adam.means.push(read(&format!("adam.{i}.mean"))?);
            checkpoint
                .adam
                .squares
                .push(read(&format!("adam.{i}.square"))?);
        }
        (checkpoint.stage, checkpoint.epoch, checkpoint.log) =
            (entry.stage, entry.epoch, entry.log);
        Ok(checkpoint)
    }
}
