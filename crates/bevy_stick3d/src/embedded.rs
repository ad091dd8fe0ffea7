//! The models that are compiled in: one per feature of this crate, under handles that are the same in every app.

use std::sync::OnceLock;

use bevy::prelude::*;
use stick3d_model::ModelError;

use crate::model_asset::StickModel;

/// The handle of the embedded man.
#[cfg(feature = "human")]
pub const HUMAN_MODEL: Handle<StickModel> =
    bevy::asset::uuid_handle!("7f0c2b52-4a1e-4d0b-9a63-5f6a3d1e9c40");

/// The handle of the embedded horse.
#[cfg(feature = "horse")]
pub const HORSE_MODEL: Handle<StickModel> =
    bevy::asset::uuid_handle!("c1b7a9de-2f64-4f0c-8a35-90d3e8b7642f");

const COUNT: usize = cfg!(feature = "human") as usize + cfg!(feature = "horse") as usize;

/// All embedded models, in the order in which an editor offers them.
pub static EMBEDDED_MODELS: [EmbeddedModel; COUNT] = [
    #[cfg(feature = "human")]
    EmbeddedModel::new(HUMAN_MODEL, stick3d_human::MODEL),
    #[cfg(feature = "horse")]
    EmbeddedModel::new(HORSE_MODEL, stick3d_horse::MODEL),
];

/// A model that is compiled in.
pub struct EmbeddedModel {
    handle: Handle<StickModel>,
    bytes: &'static [u8],
    /// Read once, however many apps a process has.
    model: OnceLock<Result<StickModel, ModelError>>,
}

impl EmbeddedModel {
    const fn new(handle: Handle<StickModel>, bytes: &'static [u8]) -> Self {
        Self {
            handle,
            bytes,
            model: OnceLock::new(),
        }
    }

    /// The handle under which [`Stick3dModelPlugin`](crate::Stick3dModelPlugin) adds it.
    pub fn handle(&self) -> Handle<StickModel> {
        self.handle.clone()
    }

    /// The model, read at the first call.
    ///
    /// # Errors
    /// As [`StickModel::from_bytes`], when the build is damaged.
    pub fn model(&self) -> Result<&StickModel, &ModelError> {
        self.model
            .get_or_init(|| StickModel::from_bytes(self.bytes))
            .as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embedded_models_are_sound_and_differ() {
        let figures: Vec<&str> = EMBEDDED_MODELS
            .iter()
            .map(|embedded| &*embedded.model().unwrap().figure().name)
            .collect();
        let mut distinct = figures.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(distinct.len(), figures.len(), "{figures:?}");
    }
}
