//! Where a picture is taken from.

use glam::{Vec2, Vec3};

/// An orthographic camera: nothing is foreshortened by distance, sizes can be compared between pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The point in the middle of the picture, metres.
    pub target: Vec3,
    /// Turn about the vertical axis: 0 sees the figure's front, positive its left side.
    pub yaw_rad: f32,
    /// Downward tilt: 0 is level, positive looks down.
    pub pitch_rad: f32,
    /// Height of the picture, metres.
    pub height_m: f32,
}

impl Camera {
    /// The camera's axes in model space: right, up, and back toward the camera.
    pub fn axes(&self) -> [Vec3; 3] {
        let (yaw_sin, yaw_cos) = self.yaw_rad.sin_cos();
        let (pitch_sin, pitch_cos) = self.pitch_rad.sin_cos();
        let right = Vec3::new(yaw_cos, 0.0, -yaw_sin);
        let back = Vec3::new(yaw_sin * pitch_cos, pitch_sin, yaw_cos * pitch_cos);
        [right, back.cross(right), back]
    }

    /// A camera whose picture of the given shape just holds all points, with a margin.
    #[must_use]
    pub fn framing(points: &[Vec3], yaw_rad: f32, pitch_rad: f32, aspect: f32) -> Self {
        let mut camera = Self {
            target: Vec3::ZERO,
            yaw_rad,
            pitch_rad,
            height_m: 1.0,
        };
        let axes = camera.axes();
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for point in points.iter().filter(|point| point.is_finite()) {
            let seen = Vec3::from_array(axes.map(|axis| axis.dot(*point)));
            (low, high) = (low.min(seen), high.max(seen));
        }
        if !low.is_finite() || !high.is_finite() {
            return camera;
        }
        let middle = (low + high) / 2.0;
        camera.target = axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z;
        let size = high - low;
        camera.height_m = (size.y.max(size.x / aspect.max(1e-3)) * 1.12).max(0.1);
        camera
    }

    /// Where a point appears: pixels from the top left corner, y down.
    pub fn project_px(&self, point: Vec3, width: u32, height: u32) -> Vec2 {
        self.project(&self.axes(), point, width, height).truncate()
    }

    /// As [`Camera::project_px`], with metres toward the camera as third number.
    pub(super) fn project(&self, axes: &[Vec3; 3], point: Vec3, width: u32, height: u32) -> Vec3 {
        let scale = height as f32 / self.height_m;
        let d = point - self.target;
        Vec3::new(
            width as f32 / 2.0 + axes[0].dot(d) * scale,
            height as f32 / 2.0 - axes[1].dot(d) * scale,
            axes[2].dot(d),
        )
    }

    /// The point on the plane through the target, facing the camera, that appears at a pixel.
    pub(super) fn unproject(
        &self,
        axes: &[Vec3; 3],
        x: f32,
        y: f32,
        width: u32,
        height: u32,
    ) -> Vec3 {
        let scale = self.height_m / height as f32;
        self.target
            + axes[0] * ((x - width as f32 / 2.0) * scale)
            + axes[1] * ((height as f32 / 2.0 - y) * scale)
    }
}
