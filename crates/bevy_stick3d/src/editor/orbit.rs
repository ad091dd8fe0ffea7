//! The camera that goes round the figure: pure arithmetic.

use bevy::math::{Mat3, Quat, Vec2, Vec3};
use bevy::transform::components::Transform;

/// The vertical opening of the camera. A long lens flatters a body.
pub(super) const FOV_Y_RAD: f32 = 0.48;
/// How much of the view the framed box may fill.
const FILL: f32 = 0.86;
const PITCH_RANGE_RAD: [f32; 2] = [-0.08, 1.45];
const ZOOM_RANGE: [f32; 2] = [0.25, 3.0];

/// Where the camera looks from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orbit {
    /// Turn about the vertical; 0 sees the side that is drawn, positive from more to the right of it.
    pub(super) yaw_rad: f32,
    /// Height above the horizon.
    pub(super) pitch_rad: f32,
    /// Distance as a share of the one that frames the figure.
    pub(super) zoom: f32,
}

impl Default for Orbit {
    /// Three-quarter view, a little above the eyes.
    fn default() -> Self {
        Self {
            yaw_rad: 0.45,
            pitch_rad: 0.16,
            zoom: 1.0,
        }
    }
}

impl Orbit {
    /// Turns with a drag of so many points; half a turn across `size_px`.
    pub(super) fn drag(&mut self, delta_px: Vec2, size_px: Vec2) {
        if size_px.min_element() < 1.0 || !delta_px.is_finite() {
            return;
        }
        let turn = delta_px / size_px.min_element() * std::f32::consts::PI;
        self.yaw_rad = (self.yaw_rad - turn.x + std::f32::consts::PI)
            .rem_euclid(std::f32::consts::TAU)
            - std::f32::consts::PI;
        self.pitch_rad = (self.pitch_rad + turn.y).clamp(PITCH_RANGE_RAD[0], PITCH_RANGE_RAD[1]);
    }

    /// Comes nearer for positive `points` of scrolling.
    pub(super) fn scroll(&mut self, points: f32) {
        if points.is_finite() {
            self.zoom = (self.zoom * (-points * 0.0022).exp()).clamp(ZOOM_RANGE[0], ZOOM_RANGE[1]);
        }
    }

    fn rotation(&self) -> Quat {
        Quat::from_rotation_y(self.yaw_rad) * Quat::from_rotation_x(-self.pitch_rad)
    }
}

/// The least half extents of a box that is framed, as shares of the body's extent: a body that curls up should
/// not fill the screen.
const LEAST_HALF: Vec3 = Vec3::new(0.5, 0.5, 0.22);

/// What the camera keeps in view: a box, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Framing {
    /// The smallest coordinates.
    pub(super) low: Vec3,
    /// The largest coordinates.
    pub(super) high: Vec3,
}

impl Framing {
    /// The box round a body at this moment; `extent_m` is half of the body's largest extent at rest.
    pub(super) fn around(low: Vec3, high: Vec3, extent_m: f32) -> Self {
        let centre = (low + high) / 2.0;
        let half = ((high - low) / 2.0).max(LEAST_HALF * extent_m);
        Self {
            low: centre - half,
            high: centre + half,
        }
    }

    /// A place for a body of this size that is not there yet.
    pub(super) fn of_extent(extent_m: f32) -> Self {
        let top = Vec3::Y * 2.0 * extent_m;
        Self::around(Vec3::ZERO, top, extent_m)
    }

    /// Moves a share of the way toward `goal`.
    pub(super) fn approach(&mut self, goal: &Self, share: f32) {
        self.low = self.low.lerp(goal.low, share);
        self.high = self.high.lerp(goal.high, share);
    }

    fn centre(&self) -> Vec3 {
        (self.low + self.high) / 2.0
    }

    fn corners(&self) -> impl Iterator<Item = Vec3> {
        let (low, high) = (self.low, self.high);
        (0..8).map(move |i| {
            Vec3::new(
                if i & 1 == 0 { low.x } else { high.x },
                if i & 2 == 0 { low.y } else { high.y },
                if i & 4 == 0 { low.z } else { high.z },
            )
        })
    }

    /// The least distance at which all corners are in the middle of a view of this width by height.
    fn distance(&self, rotation: Quat, aspect: f32) -> f32 {
        let view_from_world = Mat3::from_quat(rotation).transpose();
        let tan_y = (FOV_Y_RAD / 2.0).tan() * FILL;
        let tan_x = tan_y * aspect.max(0.05);
        self.corners()
            .map(|corner| view_from_world * (corner - self.centre()))
            .map(|p| (p.x.abs() / tan_x).max(p.y.abs() / tan_y) + p.z)
            .fold(0.1, f32::max)
    }
}

/// Where the camera is for an orbit, a box to frame and a view of `aspect` = width / height.
pub(super) fn camera_transform(orbit: &Orbit, framing: &Framing, aspect: f32) -> Transform {
    let rotation = orbit.rotation();
    let distance = framing.distance(rotation, aspect) * orbit.zoom;
    let eye = framing.centre() + rotation * Vec3::Z * distance;
    Transform::from_translation(eye.with_y(eye.y.max(0.05))).with_rotation(rotation)
}

/// Where a point is on a view of `aspect` = width / height: -1..1 both ways, y up. None behind the camera.
pub(super) fn on_view(point: Vec3, camera: &Transform, aspect: f32) -> Option<Vec2> {
    let p = camera.compute_affine().inverse().transform_point3(point);
    let tan = (FOV_Y_RAD / 2.0).tan();
    (p.z < 0.0).then(|| Vec2::new(p.x / (-p.z * tan * aspect), p.y / (-p.z * tan)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_corner_is_framed_from_everywhere() {
        for box_ in [
            Framing::of_extent(0.9),
            Framing::around(Vec3::new(-1.2, 0.0, -0.3), Vec3::new(0.9, 0.5, 1.1), 0.9),
            Framing::around(Vec3::new(-1.2, 0.0, -0.4), Vec3::new(1.2, 2.1, 0.4), 1.2),
        ] {
            for aspect in [0.5, 1.0, 2.0] {
                for yaw in 0..8 {
                    let orbit = Orbit {
                        yaw_rad: yaw as f32 * 0.8,
                        ..Orbit::default()
                    };
                    let camera = camera_transform(&orbit, &box_, aspect);
                    let largest = box_
                        .corners()
                        .map(|corner| {
                            on_view(corner, &camera, aspect)
                                .unwrap()
                                .abs()
                                .max_element()
                        })
                        .fold(0.0, f32::max);
                    assert!(largest < FILL + 0.01, "corner at {largest}");
                    assert!(largest > FILL - 0.15, "too far away: {largest}");
                }
            }
        }
    }

    #[test]
    fn dragging_right_turns_the_figure_right_and_stays_above_ground() {
        let size = Vec2::new(800.0, 600.0);
        let mut orbit = Orbit::default();
        orbit.drag(Vec2::new(100.0, 0.0), size);
        assert!(orbit.yaw_rad < Orbit::default().yaw_rad);
        orbit.drag(Vec2::new(0.0, -1.0e6), size);
        assert_eq!(orbit.pitch_rad, PITCH_RANGE_RAD[0]);
        orbit.drag(Vec2::new(f32::NAN, 0.0), size);
        assert!(orbit.yaw_rad.is_finite());
        let camera = camera_transform(&orbit, &Framing::of_extent(0.9), 1.3);
        assert!(camera.translation.y >= 0.05);
    }

    #[test]
    fn zoom_stays_in_range() {
        let mut orbit = Orbit::default();
        orbit.scroll(1.0e9);
        assert_eq!(orbit.zoom, ZOOM_RANGE[0]);
        orbit.scroll(-1.0e9);
        assert_eq!(orbit.zoom, ZOOM_RANGE[1]);
        orbit.scroll(f32::NAN);
        assert_eq!(orbit.zoom, ZOOM_RANGE[1]);
    }
}
