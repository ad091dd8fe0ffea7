//! What can be wrong with a rig file.

use thiserror::Error;

/// Why a rig could not be read, written or used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RigError {
    /// The bytes are not a glTF binary that the reader accepts.
    #[error("the rig is not a valid binary glTF (.glb): {0}; export it again as glTF 2.0 binary")]
    Gltf(#[from] gltf::Error),
    /// The file's description is not the JSON that it should be, or could not be written.
    #[error("the rig's glTF description is not valid: {0}")]
    Json(#[from] serde_json::Error),
    /// The file lacks a part that a rig needs.
    #[error("the rig has no {what}; export the mesh together with its armature")]
    Missing {
        /// The part, in words.
        what: String,
    },
    /// The file uses a feature that is read nowhere in this crate.
    #[error("the rig uses {what}, which is not supported; export it without")]
    Unsupported {
        /// The feature, in words.
        what: String,
    },
    /// Parts of the rig contradict each other.
    #[error("the rig contradicts itself: {what}")]
    Inconsistent {
        /// What does not fit to what.
        what: String,
    },
    /// A bone was asked for that the skeleton does not have.
    #[error("the skeleton has no bone `{name}`{}", nearest_hint(.nearest))]
    UnknownBone {
        /// The name asked for.
        name: String,
        /// The bone whose name is most like it.
        nearest: Option<String>,
    },
    /// A joint of a figure cannot be found on the rig's surface.
    #[error("joint `{joint}` cannot be placed on the rig: {why}; choose another anchor for it")]
    Joint {
        /// The joint's name.
        joint: String,
        /// What went wrong.
        why: String,
    },
}

fn nearest_hint(nearest: &Option<String>) -> String {
    nearest
        .as_ref()
        .map(|name| format!("; did you mean `{name}`?"))
        .unwrap_or_default()
}
