//! What a model file says about itself, beside its numbers.

use serde::{Deserialize, Serialize};
use stick3d_figure::figure::Figure;

use crate::architecture::Architecture;
use crate::digest::hex;

/// The version of the file format that this code writes, and the newest that it reads.
pub const FORMAT_VERSION: u32 = 1;

/// The version of the tool that writes.
pub const TOOL_VERSION: &str = env!("CARGO_PKG_VERSION");

/// Everything about a model that is no array.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// Version of the file format.
    pub format_version: u32,
    /// Version of the stick3d that made the file.
    pub tool_version: String,
    /// The figure, in full.
    pub figure: Figure,
    /// Which networks, how large.
    pub architecture: Architecture,
    /// Length of the latent.
    pub latent_len: usize,
    /// Number of vertices.
    pub vertex_count: usize,
    /// SHA-256 of the vertex count and the triangles; see [`topology_hash`].
    pub topology_hash: String,
    /// What was done to inputs and outputs.
    pub normalisation: Normalisation,
    /// How the model was trained, as the trainer put it.
    pub recipe: serde_json::Value,
    /// SHA-256 of the training data.
    pub data_hash: String,
    /// What the trained model was measured to do, as the trainer put it.
    pub metrics: serde_json::Value,
    /// Names of library poses that were kept out of training.
    pub held_out_poses: Vec<String>,
}

/// How sketches and meshes were scaled and placed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Normalisation {
    /// What was done to the sketch's input vector, in words.
    pub input: String,
    /// Half of the rest mesh's largest extent, metres: the unit of "normalised" distances.
    pub extent_m: f32,
    /// The joint that sits at the origin of every decoded mesh.
    pub centre_joint: String,
}

/// SHA-256 over the vertex count and all triangle indices (little-endian 32 bits), in hexadecimal digits.
#[must_use]
pub fn topology_hash(vertex_count: usize, triangles: &[[u32; 3]]) -> String {
    use sha2::Digest as _;
    let mut hasher = sha2::Sha256::new();
    hasher.update((vertex_count as u64).to_le_bytes());
    for index in triangles.as_flattened() {
        hasher.update(index.to_le_bytes());
    }
    hex(&hasher.finalize())
}

#[cfg(test)]
mod tests {
    use super::topology_hash;

    #[test]
    fn the_hash_tells_topologies_apart() {
        let triangles = [[0, 1, 2], [2, 1, 3]];
        let hash = topology_hash(4, &triangles);
        assert_eq!(hash.len(), 64);
        assert_eq!(hash, topology_hash(4, &triangles));
        assert_ne!(hash, topology_hash(5, &triangles));
        assert_ne!(hash, topology_hash(4, &[[0, 1, 2], [2, 3, 1]]));
    }
}
