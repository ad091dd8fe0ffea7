//! A motion as binary glTF 2.0: a mesh with morph targets, and an animation of their weights and of the node.

use std::path::Path;

use gltf::json;
use gltf::json::animation::Property;
use gltf::json::mesh::MorphTarget;

use super::reduce::{Morphs, Shape, Target, reduce};
use super::{AnimationError, AnimationMesh, Frame, LEAST_TOLERANCE_M};
use crate::export::gltf_file::{GltfFile, Track};
use crate::export::{ExportError, ExportMesh, check, glb};
use crate::files::write_atomically;

/// How far a vertex may be from where it was in the frame, if nothing else is said, metres.
pub const DEFAULT_TOLERANCE_M: f32 = 1e-3;

/// The most morph targets of one mesh that Bevy draws (`MAX_MORPH_WEIGHTS`).
pub const MOST_TARGETS: usize = 256;

/// What was written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnimationReport {
    /// How many frames the animation has.
    pub frame_count: usize,
    /// How many morph targets they were reduced to.
    pub target_count: usize,
    /// How long the animation takes, seconds.
    pub duration_s: f32,
    /// How far the farthest vertex of any frame is from where it was, metres: measured. More than the tolerance only where
    /// [`MOST_TARGETS`] were not enough.
    pub worst_m: f32,
    /// The size of the file.
    pub byte_count: usize,
}

/// A motion as the bytes of a `.glb` file.
#[derive(Debug, Clone, PartialEq)]
pub struct GlbAnimation {
    /// The file.
    pub bytes: Vec<u8>,
    /// What is in it.
    pub report: AnimationReport,
}

/// The frames of a motion as a binary glTF; see the [module](super). The same frames give the same bytes.
///
/// The node of a grounded motion is moved over the ground; its mesh keeps the root joint at the origin.
///
/// # Errors
/// [`AnimationError::NoFrames`], [`AnimationError::Tolerance`], and [`AnimationError::Export`] when a frame is no sound mesh.
pub fn glb_animation(
    mesh: &AnimationMesh<'_>,
    frames: Vec<Frame>,
    tolerance_m: f32,
) -> Result<GlbAnimation, AnimationError> {
    if !(tolerance_m.is_finite() && tolerance_m >= LEAST_TOLERANCE_M) {
        return Err(AnimationError::Tolerance { tolerance_m });
    }
    for frame in &frames {
        check(&mesh.with(frame))?;
    }
    let times_s: Vec<f32> = frames.iter().map(|frame| frame.time_s).collect();
    let roots: Option<Vec<[f32; 3]>> = frames
        .iter()
        .map(|frame| frame.root.map(|root| root.to_array()))
        .collect();
    let Some(morphs) = reduce(frames, tolerance_m, MOST_TARGETS) else {
        return Err(AnimationError::NoFrames);
    };
    let bytes = write(mesh, &times_s, roots, &morphs)
        .map_err(|error| ExportError::Mesh(error.to_string()))?;
    let report = AnimationReport {
        frame_count: times_s.len(),
        target_count: morphs.targets.len(),
        duration_s: times_s.last().copied().unwrap_or(0.0),
        worst_m: morphs.worst_m,
        byte_count: bytes.len(),
    };
    Ok(GlbAnimation { bytes, report })
}

/// Writes [`glb_animation`] to a file: to a temporary one beside it, then renamed.
///
/// # Errors
/// Those of [`glb_animation`]; [`ExportError::Io`]. What stood at `path` before is then untouched.
pub fn save_glb_animation(
    path: &Path,
    mesh: &AnimationMesh<'_>,
    frames: Vec<Frame>,
    tolerance_m: f32,
) -> Result<AnimationReport, AnimationError> {
    let GlbAnimation { bytes, report } = glb_animation(mesh, frames, tolerance_m)?;
    write_atomically(path, &bytes).map_err(ExportError::from)?;
    Ok(report)
}

fn write(
    mesh: &AnimationMesh<'_>,
    times_s: &[f32],
    roots: Option<Vec<[f32; 3]>>,
    morphs: &Morphs,
) -> Result<Vec<u8>, gltf::Error> {
    let mut file = GltfFile::default();
    let base = ExportMesh {
        name: mesh.name,
        positions: &morphs.base.positions,
        normals: &morphs.base.normals,
        colors: mesh.colors,
        triangles: mesh.triangles,
    };
    let body = glb::write_mesh(&mut file, &base);
    let node = file.root.push(json::Node {
        name: Some(mesh.name.to_owned()),
        mesh: Some(body),
        translation: roots.as_ref().and_then(|roots| roots.first().copied()),
        ..Default::default()
    });
    let mut tracks = vec![];
    if !morphs.targets.is_empty() {
        write_targets(&mut file, body, morphs);
        let of_frame = |frame: usize| morphs.targets.iter().map(move |t| t.weights[frame]);
        tracks.push(Track {
            node,
            property: Property::MorphTargetWeights,
            values: (0..times_s.len()).flat_map(of_frame).collect(),
        });
    }
    if let Some(roots) = roots {
        tracks.push(Track {
            node,
            property: Property::Translation,
            values: roots.into_flattened(),
        });
    }
    file.animation(mesh.name, times_s, tracks);
    file.scene(vec![node]);
    file.finish()
}

fn write_targets(file: &mut GltfFile, body: json::Index<json::Mesh>, morphs: &Morphs) {
    let target = |shape: &Shape, file: &mut GltfFile| MorphTarget {
        positions: Some(file.positions(&shape.positions)),
        normals: Some(file.normals(&shape.normals)),
        tangents: None,
    };
    let targets = morphs.targets.iter();
    let targets: Vec<_> = targets.map(|t| target(&t.shape, file)).collect();
    let name = |target: &Target| match target.frame {
        Some(frame) => format!("frame {}", frame + 1),
        None => "lowest".to_owned(),
    };
    let names: Vec<_> = morphs.targets.iter().map(name).collect();
    file.morph(body, targets, &names);
}
