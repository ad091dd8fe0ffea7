//! The `.stick3d` file: safetensors, with one metadata entry that says what the arrays are.
//!
//! The entry is called `stick3d`. Its first line is the SHA-256 of everything else (the rest of the entry and all
//! arrays with names, types and shapes), the rest is [`Metadata`](crate::Metadata) as JSON. So any program that reads
//! safetensors reads a model, and a damaged file is told from a whole one.

mod error;
mod read;
mod write;

pub use error::ModelError;
pub(crate) use read::read;
pub(crate) use write::write;

use safetensors::Dtype;

/// The key of the metadata entry.
const ENTRY: &str = "stick3d";

/// Starts the checksum with the metadata.
fn checksum_of_metadata(body: &str) -> sha2::Sha256 {
    use sha2::Digest as _;
    sha2::Sha256::new_with_prefix(body.as_bytes())
}

/// Adds one array; the order of the arrays is that of their names.
fn add_to_checksum(
    hasher: &mut sha2::Sha256,
    name: &str,
    dtype: Dtype,
    shape: &[usize],
    data: &[u8],
) {
    use sha2::Digest as _;
    hasher.update(format!("\n{name} {dtype:?} {shape:?}\n"));
    hasher.update(data);
}

#[cfg(test)]
mod tests;
