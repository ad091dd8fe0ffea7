//! What light does not reach: a shadow map for the key light, and the dimness under what is near the ground.

use glam::Vec3;

use super::RenderMesh;
use super::raster::{self, Visible};

/// Pixels along one side of the maps.
const SIZE: u32 = 512;
/// How far a surface must be behind the map's to be in shadow, metres.
const BIAS_M: f32 = 0.012;
/// Heights above the ground (metres) that dim it, how much, and over how many map pixels it spreads.
const CONTACT_LAYERS: [(f32, f32, i32); 3] = [(0.05, 0.5, 3), (0.2, 0.35, 10), (0.9, 0.25, 28)];

/// Shadows cast by meshes.
pub(super) struct Shadows {
    toward_light: [Vec3; 3],
    middle: Vec3,
    metres: f32,
    lit: Visible,
    contact: Vec<f32>,
}

impl Shadows {
    /// Looks at the meshes from the light, and from below.
    pub(super) fn cast(meshes: &[RenderMesh<'_>], toward_light: Vec3) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for point in meshes
            .iter()
            .flat_map(|mesh| mesh.positions)
            .filter(|p| p.is_finite())
        {
            (low, high) = (low.min(*point), high.max(*point));
        }
        if !low.is_finite() {
            (low, high) = (Vec3::ZERO, Vec3::ONE);
        }
        let middle = (low + high) / 2.0;
        let metres = (high - low).length().max(0.1) + 0.6;
        let right = Vec3::Y.cross(toward_light).normalize_or(Vec3::X);
        let axes = [right, toward_light.cross(right), toward_light];
        let scale = SIZE as f32 / metres;
        let half = SIZE as f32 / 2.0;
        let from_light = |p: Vec3| {
            let d = p - middle;
            Vec3::new(
                half + axes[0].dot(d) * scale,
                half + axes[1].dot(d) * scale,
                axes[2].dot(d),
            )
        };
        let from_below = |p: Vec3| {
            Vec3::new(
                half + (p.x - middle.x) * scale,
                half + (p.z - middle.z) * scale,
                -p.y,
            )
        };
        let lit = raster::draw(meshes, from_light, SIZE, SIZE);
        let below = raster::draw(meshes, from_below, SIZE, SIZE);
        Self {
            toward_light: axes,
            middle,
            metres,
            lit,
            contact: contact(&below),
        }
    }

    /// How much of the key light reaches a point: 1 all, 0 none.
    pub(super) fn light_at(&self, point: Vec3) -> f32 {
        let d = point - self.middle;
        let [right, up, toward] = self.toward_light;
        let scale = SIZE as f32 / self.metres;
        let half = SIZE as f32 / 2.0;
        let (x, y) = (half + right.dot(d) * scale, half + up.dot(d) * scale);
        let depth = toward.dot(d) + BIAS_M;
        let mut seen = 0;
        for dy in -2..=2 {
            for dx in -2..=2 {
                let at = index(x as i32 + dx, y as i32 + dy);
                let blocked = at.is_some_and(|at| self.lit.samples[at].depth > depth);
                seen += i32::from(!blocked);
            }
        }
        seen as f32 / 25.0
    }

    /// How dim the ground is at a point of it: 0 open, toward 1 under the body.
    pub(super) fn dimness(&self, ground: Vec3) -> f32 {
        let scale = SIZE as f32 / self.metres;
        let half = SIZE as f32 / 2.0;
        let x = half + (ground.x - self.middle.x) * scale;
        let z = half + (ground.z - self.middle.z) * scale;
        index(x as i32, z as i32).map_or(0.0, |at| self.contact[at])
    }
}

fn index(x: i32, y: i32) -> Option<usize> {
    let inside = 0..SIZE as i32;
    (inside.contains(&x) && inside.contains(&y)).then(|| (y * SIZE as i32 + x) as usize)
}

/// The nearer to the ground, the darker and the sharper.
fn contact(below: &Visible) -> Vec<f32> {
    let mut dimness = vec![0.0_f32; below.samples.len()];
    for (height_m, strength, radius) in CONTACT_LAYERS {
        let mut layer: Vec<f32> = below
            .samples
            .iter()
            .map(|s| if -s.depth < height_m { strength } else { 0.0 })
            .collect();
        for _ in 0..2 {
            layer = blur(&layer, radius, true);
            layer = blur(&layer, radius, false);
        }
        for (sum, value) in dimness.iter_mut().zip(layer) {
            *sum = 1.0 - (1.0 - *sum) * (1.0 - value);
        }
    }
    dimness
}

/// Mean over `radius` pixels to both sides, along rows or columns.
fn blur(values: &[f32], radius: i32, along_rows: bool) -> Vec<f32> {
    let mut out = vec![0.0; values.len()];
    let size = SIZE as i32;
    let at = |line: i32, i: i32| {
        if along_rows {
            line * size + i
        } else {
            i * size + line
        }
    };
    for line in 0..size {
        let value = |i: i32| {
            if (0..size).contains(&i) {
                values[at(line, i) as usize]
            } else {
                0.0
            }
        };
        let mut sum: f32 = (-radius..radius).map(value).sum();
        for i in 0..size {
            sum += value(i + radius);
            out[at(line, i) as usize] = sum / (2 * radius + 1) as f32;
            sum -= value(i - radius);
        }
    }
    out
}
