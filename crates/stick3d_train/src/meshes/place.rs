//! Bringing a set of meshes to metres, up and toward the viewer.

use glam::Vec3;
use stick3d_figure::figure::Figure;

use super::{MeshSet, MeshSetError, joint_regressor};
use crate::placement::Placement;

/// Which axis of a mesh file points up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// +Y, as here.
    #[default]
    Y,
    /// +Z; what was -Y then points to the viewer.
    Z,
}

impl UpAxis {
    /// Turns positions so that +Y points up.
    pub fn turn(self, positions: &mut [Vec3]) {
        if self == Self::Z {
            positions
                .iter_mut()
                .for_each(|p| *p = Vec3::new(p.x, p.z, -p.y));
        }
    }
}

impl MeshSet {
    /// Brings all meshes to metres and to the heading of the figure's template, which is the figure at yaw 0: see
    /// [`Placement::of`], found on the pilot.
    ///
    /// # Errors
    /// [`MeshSetError::Joint`], [`MeshSetError::Scale`], [`MeshSetError::NoSize`].
    pub fn place(
        &mut self,
        figure: &Figure,
        scale: Option<f32>,
    ) -> Result<Placement, MeshSetError> {
        if let Some(bad) = scale.filter(|scale| !(scale.is_finite() && *scale > 0.0)) {
            return Err(MeshSetError::Scale(bad));
        }
        let regressor = joint_regressor(figure, self.vertex_count())?;
        let joints = regressor.joints(&self.meshes[self.pilot].positions);
        let placement = Placement::of(&joints, figure, scale).ok_or(MeshSetError::NoSize)?;
        if !placement.is_none() {
            let turn = placement.turn();
            for mesh in &mut self.meshes {
                let positions = mesh.positions.iter_mut();
                positions.for_each(|p| *p = turn * (placement.scale * *p));
            }
        }
        Ok(placement)
    }
}
