//! Skinned meshes with a skeleton: reading, writing and posing them.
//!
//! A [`Rig`] is a triangle mesh at rest, a [`Skeleton`], and for every vertex the bones it follows.
//! [`Rig::skin`] moves the mesh into a [`Pose`], each vertex about a centre of rotation of its own, which
//! keeps the volume of shoulders, hips and knees where linear blending would collapse it.
//!
//! Spaces: everything is in *model space*: right-handed, metres, +Y up, the figure faces +Z.
//! Colours are linear (not sRGB) bytes, exactly as glTF's `COLOR_0` defines them.

mod animation;
mod centers;
mod clips;
mod error;
#[cfg(test)]
mod foreign_tests;
mod hang;
mod joints;
mod nodes;
mod open;
mod place;
mod read;
mod regressor;
mod report;
mod skeleton;
mod skinning;
mod surface;
#[cfg(test)]
mod tests;
mod weld;
mod write;
mod write_clips;

pub use clips::Clip;
pub use error::RigError;
use glam::Vec3;
pub use read::RigFile;
pub(crate) use regressor::mean_of;
pub use regressor::regressor;
pub use report::RigReport;
pub use skeleton::{Bone, Pose, Skeleton};
pub use skinning::Skinning;
use stick3d_figure::mesh::{NormalAdjacency, TriangleMesh};
pub use weld::Weld;

/// The largest number of bones that one vertex may follow: two glTF attribute sets of four.
pub const MAX_INFLUENCES: usize = 8;

/// A mesh at rest, its skeleton, and which bones move which vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// The name of the body, as it stands in the file.
    pub name: String,
    /// Who made the body and under which licence, as it stands in the file.
    pub copyright: Option<String>,
    /// The bones, parents before children.
    pub skeleton: Skeleton,
    /// The surface at rest, model space, metres.
    pub mesh: TriangleMesh,
    /// One colour per vertex: linear red, green, blue and coverage, 255 = 1 (glTF `COLOR_0`).
    pub colors: Vec<[u8; 4]>,
    /// Per vertex: (bone, weight), strongest first, at most [`MAX_INFLUENCES`], weights summing to 1.
    pub influences: Vec<Vec<(u16, f32)>>,
    /// Motions that came with the body; none unless they are set.
    pub clips: Vec<Clip>,
    /// Per vertex the point that it turns about, model space at rest: see [`Rig::new`].
    centers: Vec<Vec3>,
}

impl Rig {
    /// Puts a rig together and finds every vertex' centre of rotation (about a second for 12,500 vertices).
    ///
    /// # Errors
    /// [`RigError::Inconsistent`] names the first part that does not fit to the others.
    pub fn new(
        name: String,
        copyright: Option<String>,
        skeleton: Skeleton,
        mesh: TriangleMesh,
        colors: Vec<[u8; 4]>,
        influences: Vec<Vec<(u16, f32)>>,
    ) -> Result<Self, RigError> {
        let mut rig = Self {
            name,
            copyright,
            skeleton,
            mesh,
            colors,
            influences,
            clips: Vec::new(),
            centers: Vec::new(),
        };
        rig.validate()?;
        rig.centers = centers::centers_of_rotation(&rig.mesh, &rig.influences);
        Ok(rig)
    }

    /// Checks that the parts fit together: lengths, bone numbers, vertex numbers, weights.
    ///
    /// # Errors
    /// [`RigError::Inconsistent`] names the first part that does not fit.
    pub fn validate(&self) -> Result<(), RigError> {
        let inconsistent = |what: String| Err(RigError::Inconsistent { what });
        let vertices = self.mesh.positions.len();
        if self.colors.len() != vertices || self.influences.len() != vertices {
            return inconsistent(format!(
                "{vertices} positions, {} colours and {} influence lists: the numbers must agree",
                self.colors.len(),
                self.influences.len()
            ));
        }
        if let Some(vertex) = self.mesh.positions.iter().position(|p| !p.is_finite()) {
            return inconsistent(format!("vertex {vertex} is not at a finite position"));
        }
        if let Some(triangle) = self
            .mesh
            .triangles
            .iter()
            .position(|t| t.iter().any(|&v| v as usize >= vertices))
        {
            return inconsistent(format!(
                "triangle {triangle} uses a vertex past the last one, {vertices}"
            ));
        }
        self.skeleton.validate()?;
        let bones = self.skeleton.bones.len();
        for clip in &self.clips {
            if clip.times_s.len() != clip.poses.len()
                || clip.poses.iter().any(|pose| pose.rotations.len() != bones)
            {
                return inconsistent(format!(
                    "clip `{}` must have one pose per time and one rotation per bone",
                    clip.name
                ));
            }
        }
        for (vertex, list) in self.influences.iter().enumerate() {
            let sum: f32 = list.iter().map(|&(_, weight)| weight).sum();
            if list.is_empty()
                || list.len() > MAX_INFLUENCES
                || (sum - 1.0).abs() > 1e-3
                || list
                    .iter()
                    .any(|&(b, w)| b as usize >= bones || !w.is_finite() || w < 0.0)
            {
                return inconsistent(format!(
                    "vertex {vertex}: influences must be 1 to {MAX_INFLUENCES} existing bones \
                     with weights summing to 1, but are {list:?}"
                ));
            }
        }
        Ok(())
    }

    /// The unit normals of the rig's surface with its vertices at `positions`.
    ///
    /// # Errors
    /// [`RigError::Inconsistent`] when a triangle names a vertex that has no position.
    pub fn vertex_normals(&self, positions: &[Vec3]) -> Result<Vec<Vec3>, RigError> {
        let adjacency =
            NormalAdjacency::new(&self.mesh.triangles, positions.len()).map_err(|fault| {
                RigError::Inconsistent {
                    what: fault.to_string(),
                }
            })?;
        let positions: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
        let mut normals = vec![[0.0; 3]; positions.len()];
        adjacency.vertex_normals(&positions, &mut normals);
        Ok(normals.into_iter().map(Vec3::from).collect())
    }
}
