//! Light and colour of every sample.

use glam::Vec3;
use image::{Rgba, RgbaImage};
use rayon::prelude::*;
use stick3d_model::color::srgb_byte;

use super::raster::{Sample, Visible};
use super::shadow::Shadows;
use super::{Camera, RenderMesh};

/// Toward the lights, unit vectors seen from the camera: right, up, toward the camera.
const KEY: Vec3 = Vec3::new(-0.457_496, 0.762_493, 0.457_496);
const FILL: Vec3 = Vec3::new(0.8, 0.2, 0.565_685);
const RIM: Vec3 = Vec3::new(0.5, 0.5, -std::f32::consts::FRAC_1_SQRT_2);
/// Brightness of the background, linear: top and bottom.
const BACKGROUND: [f32; 2] = [0.86, 0.74];

/// Directions toward the lights, model space. They turn with the camera, so that no view is dark.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lights {
    pub(super) key: Vec3,
    fill: Vec3,
    rim: Vec3,
    back: Vec3,
}

impl Lights {
    /// The lights of a camera.
    pub(super) fn of(camera: &Camera) -> Self {
        let [right, _, back] = camera.axes();
        let level = right.cross(Vec3::Y);
        let turned = |d: Vec3| right * d.x + Vec3::Y * d.y + level * d.z;
        Self {
            key: turned(KEY),
            fill: turned(FILL),
            rim: turned(RIM),
            back,
        }
    }
}

/// Colours every sample. Linear red, green, blue.
pub(super) fn shade(
    meshes: &[RenderMesh<'_>],
    camera: &Camera,
    visible: &Visible,
    shadows: &Shadows,
    lights: Lights,
) -> Visible3 {
    let axes = camera.axes();
    let (width, height) = (visible.width, visible.height);
    let mut colors = vec![Vec3::ZERO; visible.samples.len()];
    colors
        .par_chunks_mut(width as usize)
        .enumerate()
        .for_each(|(y, row)| {
            for (x, color) in row.iter_mut().enumerate() {
                let sample = &visible.samples[y * width as usize + x];
                let plane = camera.unproject(&axes, x as f32 + 0.5, y as f32 + 0.5, width, height);
                *color = if sample.depth.is_finite() {
                    surface(meshes, sample, shadows, lights)
                } else {
                    ground(plane, axes[2], y as f32 / height as f32, shadows)
                };
            }
        });
    Visible3 {
        width,
        height,
        colors,
    }
}

/// A picture of linear colours.
pub(super) struct Visible3 {
    width: u32,
    height: u32,
    colors: Vec<Vec3>,
}

/// The background: a vertical gradient, darker where the ground is in shadow.
fn ground(plane: Vec3, back: Vec3, down: f32, shadows: &Shadows) -> Vec3 {
    let light = BACKGROUND[0] + (BACKGROUND[1] - BACKGROUND[0]) * down;
    let base = Vec3::new(light * 0.985, light * 0.995, light);
    if back.y < 1e-3 {
        return base;
    }
    let point = plane - back * (plane.y / back.y);
    let cast = (1.0 - shadows.light_at(point)) * 0.22;
    base * (1.0 - cast) * (1.0 - shadows.dimness(point))
}

fn surface(meshes: &[RenderMesh<'_>], sample: &Sample, shadows: &Shadows, lights: Lights) -> Vec3 {
    let mesh = &meshes[sample.mesh as usize];
    let corners = mesh.triangles[sample.triangle as usize].map(|v| v as usize);
    let (v, w) = (sample.weights.x, sample.weights.y);
    let mix = |f: &dyn Fn(usize) -> Vec3| {
        f(corners[0]) * (1.0 - v - w) + f(corners[1]) * v + f(corners[2]) * w
    };
    let normal = mix(&|i| mesh.normals.get(i).copied().unwrap_or(Vec3::Y)).normalize_or(Vec3::Y);
    let albedo = mix(&|i| {
        let [r, g, b, _] = mesh.colors.get(i).copied().unwrap_or([150; 4]);
        Vec3::new(f32::from(r), f32::from(g), f32::from(b)) / 255.0
    });
    let point = mix(&|i| mesh.positions[i]);
    let lit = shadows.light_at(point + normal * 0.006);

    let key = normal.dot(lights.key).max(0.0) * lit;
    // The fill wraps round the form, so that no side is flat black.
    let fill = ((normal.dot(lights.fill) + 0.4) / 1.4).max(0.0);
    let sky = 0.5 + 0.5 * normal.y;
    let rim = normal.dot(lights.rim).max(0.0) * (1.0 - normal.dot(lights.back).max(0.0)).powi(2);
    let half = (lights.key + lights.back).normalize_or(Vec3::Y);
    let gloss = normal.dot(half).max(0.0).powi(28) * 0.06 * lit;
    albedo * (1.15 * key + 0.32 * fill + 0.16 + 0.16 * sky) + Vec3::splat(gloss + 0.18 * rim)
}

/// Averages 2 x 2 samples into a pixel and encodes as sRGB.
pub(super) fn downsample(fine: &Visible3, width: u32, height: u32) -> RgbaImage {
    debug_assert_eq!((fine.width, fine.height), (width * 2, height * 2));
    RgbaImage::from_fn(width, height, |x, y| {
        let at = |dx: u32, dy: u32| fine.colors[((2 * y + dy) * fine.width + 2 * x + dx) as usize];
        let mean = (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4.0;
        let [r, g, b] = mean.to_array().map(srgb_byte);
        Rgba([r, g, b, 255])
    })
}
