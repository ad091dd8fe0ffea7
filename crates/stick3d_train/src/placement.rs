//! From a body's own unit and heading to those of a figure's template: metres, facing as the figure at yaw 0.

use glam::{Quat, Vec2, Vec3};
use stick3d_figure::figure::Figure;

/// What brings a body to the size and the heading of a figure's template.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Metres of one unit of the files.
    pub scale: f32,
    /// By how much the body is turned about +Y, degrees.
    pub yaw_deg: f32,
    /// Height of the joints over their width in the sketch plane, as a share of the template's: far below 1 for a body
    /// that lies on its side.
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

impl Placement {
    /// The placement of a body whose joints stand at `joints`; `None` if they have no size.
    ///
    /// The scale is `scale`; where none is given, that of the unit (metre, decimetre, inch, centimetre, millimetre) in
    /// which the figure on the body is about as large as the template; failing that, 1 if it is between half and twice as
    /// large, else what makes it as large. The heading is the turn about +Y that brings the joints closest to the
    /// template.
    #[must_use]
    pub fn of(joints: &[Vec3], figure: &Figure, scale: Option<f32>) -> Option<Self> {
        let scale = match scale {
            Some(scale) => scale,
            None => plausible_scale(joints, figure)?,
        };
        let yaw_deg = heading_deg(joints, &figure.template);
        let turn = Quat::from_rotation_y(yaw_deg.to_radians());
        let upright = slenderness(joints.iter().map(|joint| (turn * *joint).truncate()))
            / slenderness(figure.template.iter().copied());
        Some(Self {
            scale,
            yaw_deg,
            upright,
        })
    }

    /// Whether the body stands as it should already.
    #[must_use]
    pub fn is_none(&self) -> bool {
        (self.scale, self.yaw_deg) == (1.0, 0.0)
    }

    /// The turn about the upright.
    #[must_use]
    pub fn turn(&self) -> Quat {
        Quat::from_rotation_y(self.yaw_deg.to_radians())
    }
}

fn plausible_scale(joints: &[Vec3], figure: &Figure) -> Option<f32> {
    let share = spread(joints) / figure.template_extent_m();
    if !(share.is_finite() && share > 0.0) {
        return None;
    }
    let within = |unit: f32, least: f32| (least..=least.recip()).contains(&(unit * share));
    let unit = UNITS_M.into_iter().find(|unit| within(*unit, LIKELY));
    let metres = within(1.0, PLAUSIBLE).then_some(1.0);
    Some(unit.or(metres).unwrap_or(share.recip()))
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
