//! A picture of every pose of a library.

use image::RgbaImage;
use rayon::prelude::*;

use super::controls::Controls;
use super::library::PoseLibrary;
use crate::render::{Camera, RenderMesh, contact_sheet, render};
use crate::rig::{Rig, RigError};

/// Draws all poses of a library, each seen from several directions `views` (yaw of the camera, degrees;
/// 0 looks along -Z, 90 along -X), every picture `size` pixels square, `columns` poses in a row.
///
/// # Errors
/// [`RigError::Inconsistent`] for a rig that [`Rig::validate`] refuses.
pub fn pose_sheet(
    rig: &Rig,
    controls: &Controls,
    library: &PoseLibrary,
    views: &[f32],
    size: u32,
    columns: u32,
) -> Result<RgbaImage, RigError> {
    let draw = |pose: &super::NamedPose| {
        let posed = controls.pose_on_ground(&pose.values, rig);
        let mut positions = Vec::new();
        rig.skin(&posed, &mut positions);
        let normals = rig.vertex_normals(&positions)?;
        let mesh = RenderMesh {
            positions: &positions,
            normals: &normals,
            colors: &rig.colors,
            triangles: &rig.mesh.triangles,
        };
        let mut strip = RgbaImage::new(size * views.len() as u32, size);
        for (i, yaw_deg) in (0_u32..).zip(views) {
            let camera = Camera::framing(&positions, yaw_deg.to_radians(), 0.16, 1.0);
            let image = render(&[mesh], &camera, size, size);
            image::imageops::replace(&mut strip, &image, i64::from(i * size), 0);
        }
        Ok((pose.name.clone(), strip))
    };
    let items: Result<Vec<_>, RigError> = library.poses.par_iter().map(draw).collect();
    Ok(contact_sheet(&items?, columns))
}
