//! What can be wrong with a rig file.

use thiserror::Error;

/// Why a rig could not be read, written or used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RigError {
    /// The bytes are not a glTF binary that the reader accepts.
    #[error("the rig is not a valid binary glTF (.glb): {0}; export it again as glTF 2.0")]
    Gltf(#[from] gltf::Error),
    /// The file's description is not the JSON that it should be, or could not be written.
    #[error("the rig's glTF description is not valid: {0}")]
    Json(#[from] serde_json::Error),
    /// No mesh of the file follows a skeleton.
    #[error("the rig has no mesh with a skin ({}); export the mesh together with its armature", meshes_seen(.meshes))]
    NoSkin {
        /// The nodes that show a mesh, all without skin.
        meshes: Vec<String>,
    },
    /// Meshes of the file follow different skeletons.
    #[error(
        "the rig has two bodies: {first}, and {second}, which follows the bone {bone} that the first \
         does not have; export one body at a time"
    )]
    TwoSkins {
        /// The node of the mesh with the larger skeleton.
        first: String,
        /// A node of another one.
        second: String,
        /// A bone of the second skeleton that is not in the first.
        bone: String,
    },
    /// Data of the file cannot be used.
    #[error("the rig's accessor {accessor} ({place}) is unusable: {why}")]
    Accessor {
        /// Its number in the file.
        accessor: usize,
        /// What it is for, and where.
        place: String,
        /// What is wrong with it.
        why: String,
    },
    /// A file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: std::path::PathBuf,
        /// Why not.
        source: std::io::Error,
    },
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

fn meshes_seen(meshes: &[String]) -> String {
    if meshes.is_empty() {
        "and no mesh at all".to_owned()
    } else {
        format!("the meshes are {}", meshes.join(", "))
    }
}

fn nearest_hint(nearest: &Option<String>) -> String {
    nearest
        .as_ref()
        .map(|name| format!("; did you mean `{name}`?"))
        .unwrap_or_default()
}
