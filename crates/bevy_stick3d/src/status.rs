//! Whether the plugin works: what a game asks before it blames the player.

use bevy::asset::UntypedAssetId;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

/// What is wrong with models and clips, if anything. A problem is logged once, when it appears.
///
/// What is wrong with a single figure, such as a sketch with a NaN in it, is in its
/// [`FigureStatus`](crate::FigureStatus).
#[derive(Resource, Clone, Debug, Default, Reflect)]
#[reflect(Resource, Debug, Default, Clone)]
pub struct Stick3dStatus {
    problems: HashMap<UntypedAssetId, String>,
}

impl Stick3dStatus {
    /// Whether every model and clip that is used works.
    pub fn is_ok(&self) -> bool {
        self.problems.is_empty()
    }

    /// Why a model or a clip does not work; `None` when it works or was not used yet.
    pub fn problem(&self, asset: impl Into<UntypedAssetId>) -> Option<&str> {
        self.problems.get(&asset.into()).map(String::as_str)
    }

    /// All problems, one sentence each, in alphabetical order.
    pub fn problems(&self) -> Vec<&str> {
        let mut messages: Vec<&str> = self.problems.values().map(String::as_str).collect();
        messages.sort_unstable();
        messages
    }

    /// Notes that a model or a clip does not work, and logs it unless that is known.
    pub fn fail(&mut self, asset: impl Into<UntypedAssetId>, message: impl Into<String>) {
        let message = message.into();
        let known = self.problems.insert(asset.into(), message.clone());
        if known.as_ref() != Some(&message) {
            error!("{message}");
        }
    }

    /// Notes that a model or a clip works.
    pub fn clear(&mut self, asset: impl Into<UntypedAssetId>) {
        self.problems.remove(&asset.into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_asset::StickModel;

    #[test]
    fn problems_come_and_go() {
        let mut status = Stick3dStatus::default();
        let id = AssetId::<StickModel>::default();
        assert!(status.is_ok());
        status.fail(id, "no such file");
        assert_eq!(status.problem(id), Some("no such file"));
        assert_eq!(status.problems(), ["no such file"]);
        status.clear(id);
        assert!(status.is_ok());
    }
}
