//! The trained model as a Bevy asset, and its loader.

use std::sync::Arc;

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext};
use bevy::prelude::*;
use stick3d_figure::Figure;
use stick3d_model::{Model, ModelError};
use thiserror::Error;

use crate::embedded::EMBEDDED_MODELS;
use crate::status::Stick3dStatus;

/// A trained model: everything of one kind of figure. The files end in `.stick3d`.
#[derive(Asset, Clone, Reflect)]
#[reflect(opaque, Clone)]
pub struct StickModel {
    model: Arc<Model>,
    /// The model's own, to be shared with drawings.
    figure: Arc<Figure>,
}

impl StickModel {
    /// A model as an asset.
    pub fn new(model: Model) -> Self {
        Self {
            figure: Arc::new(model.figure().clone()),
            model: Arc::new(model),
        }
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
        &self.model
    }

    /// The figure that the model draws.
    pub fn figure(&self) -> &Arc<Figure> {
        &self.figure
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

/// The model asset, its loader, and the embedded models under their constant handles.
#[derive(Debug, Default, Clone, Copy)]
pub struct Stick3dModelPlugin;

impl Plugin for Stick3dModelPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<StickModel>()
            .init_asset_loader::<StickModelLoader>()
            .register_type::<StickModel>()
            .init_resource::<Stick3dStatus>();
        for embedded in &EMBEDDED_MODELS {
            let handle = embedded.handle();
            let mut assets = app.world_mut().resource_mut::<Assets<StickModel>>();
            let problem = match embedded.model() {
                Ok(model) => assets
                    .insert(handle.id(), model.clone())
                    .err()
                    .map(|error| error.to_string()),
                Err(error) => Some(error.to_string()),
            };
            // A damaged build goes on without the model and says so.
            if let Some(problem) = problem {
                let message = format!("an embedded model is unusable: {problem}");
                app.world_mut()
                    .resource_mut::<Stick3dStatus>()
                    .fail(handle.id(), message);
            }
        }
    }
}
