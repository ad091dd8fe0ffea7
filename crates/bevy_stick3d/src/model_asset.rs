//! The trained model as a Bevy asset: its loader, and the man that is embedded.

use std::sync::Arc;

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext};
use bevy::prelude::*;
use stick3d_model::{Model, ModelError};
use thiserror::Error;

/// The handle of the embedded man, the same in every app.
#[cfg(feature = "human")]
pub const HUMAN_MODEL: Handle<StickModel> =
    bevy::asset::uuid_handle!("7f0c2b52-4a1e-4d0b-9a63-5f6a3d1e9c40");

/// A trained model: everything of one kind of figure. The files end in `.stick3d`.
#[derive(Asset, Clone, Reflect)]
#[reflect(opaque, Clone)]
pub struct StickModel(Arc<Model>);

impl StickModel {
    /// A model as an asset.
    pub fn new(model: Model) -> Self {
        Self(Arc::new(model))
    }

    /// A model from the bytes of a `.stick3d` file.
    ///
    /// # Errors
    /// As [`Model::from_bytes`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ModelError> {
        Model::from_bytes(bytes).map(Self::new)
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.0
    }
}

/// Why a `.stick3d` file could not be loaded.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StickModelLoaderError {
    /// The file could not be read.
    #[error("the model file could not be read: {0}")]
    Io(#[from] std::io::Error),
    /// The file was read, and is no model.
    #[error("the file is no usable model: {0}")]
    Model(#[from] ModelError),
}

/// Loads `.stick3d` files.
#[derive(Debug, Default, Clone, Copy, TypePath)]
pub struct StickModelLoader;

impl AssetLoader for StickModelLoader {
    type Asset = StickModel;
    type Settings = ();
    type Error = StickModelLoaderError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        _context: &mut LoadContext<'_>,
    ) -> Result<StickModel, StickModelLoaderError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        Ok(StickModel::from_bytes(&bytes)?)
    }

    fn extensions(&self) -> &[&str] {
        &["stick3d"]
    }
}

/// The model asset, its loader, and the embedded man.
#[derive(Debug, Default, Clone, Copy)]
pub struct Stick3dModelPlugin;

impl Plugin for Stick3dModelPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<StickModel>()
            .init_asset_loader::<StickModelLoader>()
            .register_type::<StickModel>();
        #[cfg(feature = "human")]
        embed_human(app);
    }
}

/// Puts the embedded man under his constant handle; a damaged build goes on without him and says so.
#[cfg(feature = "human")]
fn embed_human(app: &mut App) {
    let problem = match StickModel::from_bytes(stick3d_human::MODEL) {
        Ok(model) => app
            .world_mut()
            .resource_mut::<Assets<StickModel>>()
            .insert(HUMAN_MODEL.id(), model)
            .err()
            .map(|error| error.to_string()),
        Err(error) => Some(error.to_string()),
    };
    if let Some(problem) = problem {
        app.init_resource::<crate::status::Stick3dStatus>();
        app.world_mut()
            .resource_mut::<crate::status::Stick3dStatus>()
            .fail(
                HUMAN_MODEL.id(),
                format!("the embedded human is unusable: {problem}"),
            );
    }
}
