//! From a file's unit and heading to metres, up and toward the viewer.

use glam::{Quat, Vec2, Vec3};
use stick3d_figure::figure::Figure;

use super::{MeshSet, MeshSetError, joint_regressor};

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

/// What was done to bring a set to size and heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Metres of one unit of the files.
    pub scale: f32,
    /// By how much every mesh was turned about +Y, degrees.
    pub yaw_deg: f32,
    /// Height of the pilot's joints over their width in the sketch plane, as a share of the template's: far below 1 for
    /// a set that lies on its side.
    pub upright: f32,
}

/// Metres of the units that files are in.
const UNITS_M: [f32; 5] = [1.0, 0.1, 0.0254, 0.01, 0.001];

/// A unit in which the figure is between this share and its inverse of the template's size is the file's. No two units
/// can be.
const LIKELY: f32 = 0.75;

/// Where none is, metres may still be, with a figure that is small or large.
const PLAUSIBLE: f32 = 0.5;

/// A heading closer than this to a quarter turn is meant as one, degrees.
const SQUARE_DEG: f32 = 15.0;

impl MeshSet {
    /// Brings all meshes to metres and to the heading of the figure's template, which is the figure at yaw 0.
    ///
    /// The scale is `scale`; where none is given, that of the unit (metre, decimetre, inch, centimetre, millimetre) in
    /// which the figure on the pilot is about as large as the template; failing that, 1 if it is between half and twice as
    /// large, else what makes it as large. The heading is the turn about +Y that brings the pilot's joints closest to the
    /// template.
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
        let scale = match scale {
            Some(scale) => scale,
            None => plausible_scale(&joints, &figure.template)?,
        };
        let yaw_deg = heading_deg(&joints, &figure.template);
        let turn = Quat::from_rotation_y(yaw_deg.to_radians());
        let upright = slenderness(joints.iter().map(|joint| (turn * *joint).truncate()))
            / slenderness(figure.template.iter().copied());
        if (scale, yaw_deg) != (1.0, 0.0) {
            for mesh in &mut self.meshes {
                let positions = mesh.positions.iter_mut();
                positions.for_each(|p| *p = turn * (scale * *p));
            }
        }
        Ok(Placement {
            scale,
            yaw_deg,
            upright,
        })
    }
}

fn plausible_scale(joints: &[Vec3], template: &[Vec2]) -> Result<f32, MeshSetError> {
    let template: Vec<Vec3> = template.iter().map(|point| point.extend(0.0)).collect();
    let share = spread(joints) / spread(&template);
    if !(share.is_finite() && share > 0.0) {
        return Err(MeshSetError::NoSize);
    }
    let within = |unit: f32, least: f32| (least..=least.recip()).contains(&(unit * share));
    let unit = UNITS_M.into_iter().find(|unit| within(*unit, LIKELY));
    let metres = within(1.0, PLAUSIBLE).then_some(1.0);
    Ok(unit.or(metres).unwrap_or(share.recip()))
}

/// The largest distance between two points.
fn spread(points: &[Vec3]) -> f32 {
    let pairs = points
        .iter()
        .flat_map(|a| points.iter().map(|b| a.distance(*b)));
    pairs.fold(0.0, f32::max)
}

fn slenderness(points: impl Iterator<Item = Vec2>) -> f32 {
    let (low, high) = points.fold((Vec2::MAX, Vec2::MIN), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    let size = high - low;
    size.y / size.x.max(1e-3 * size.y).max(f32::MIN_POSITIVE)
}

/// The turn about +Y after which the points' x is closest to the template's in the least squares sense, degrees.
fn heading_deg(joints: &[Vec3], template: &[Vec2]) -> f32 {
    let count = joints.len().max(1) as f32;
    let centre = joints.iter().sum::<Vec3>() / count;
    let middle = template.iter().map(|point| point.x).sum::<f32>() / count;
    // After a turn by t a point is at x · cos t + z · sin t.
    let (mut cos, mut sin) = (0.0, 0.0);
    for (joint, point) in joints.iter().zip(template) {
        cos += (point.x - middle) * (joint.x - centre.x);
        sin += (point.x - middle) * (joint.z - centre.z);
    }
    let degrees = sin.atan2(cos).to_degrees();
    let square = 90.0 * (degrees / 90.0).round();
    if (degrees - square).abs() <= SQUARE_DEG {
        square
    } else {
        degrees
    }
}
