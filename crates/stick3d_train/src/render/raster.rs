//! Which triangle is in front at every pixel.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::{Camera, RenderMesh};

/// Rows that one task works on.
const BAND: usize = 32;

/// What is seen at a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Metres toward the camera, negative infinity where there is nothing.
    pub(super) depth: f32,
    pub(super) mesh: u32,
    pub(super) triangle: u32,
    /// Weights of the triangle's second and third corner.
    pub(super) weights: Vec2,
}

const NOTHING: Sample = Sample {
    depth: f32::NEG_INFINITY,
    mesh: 0,
    triangle: 0,
    weights: Vec2::ZERO,
};

/// A picture of samples.
pub(super) struct Visible {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) samples: Vec<Sample>,
}

/// A triangle in pixels, y down, third number toward the camera.
struct Projected {
    corners: [Vec3; 3],
    mesh: u32,
    triangle: u32,
}

/// Finds the frontmost triangle of every pixel.
pub(super) fn visible_triangles(
    meshes: &[RenderMesh<'_>],
    camera: &Camera,
    width: u32,
    height: u32,
) -> Visible {
    let axes = camera.axes();
    let project = |point: Vec3| camera.project(&axes, point, width, height);
    draw(meshes, project, width, height)
}

/// As [`visible_triangles`] with any projection to (pixel x, pixel y, nearness).
pub(super) fn draw(
    meshes: &[RenderMesh<'_>],
    project: impl Fn(Vec3) -> Vec3,
    width: u32,
    height: u32,
) -> Visible {
    let mut projected = Vec::new();
    for (mesh_index, mesh) in meshes.iter().enumerate() {
        let points: Vec<Vec3> = mesh.positions.iter().map(|p| project(*p)).collect();
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            let corner = |i: usize| points.get(triangle[i] as usize).copied();
            if let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) {
                let corners = [a, b, c];
                projected.push(Projected {
                    corners,
                    mesh: mesh_index as u32,
                    triangle: index as u32,
                });
            }
        }
    }
    let mut samples = vec![NOTHING; (width * height) as usize];
    samples
        .par_chunks_mut(width as usize * BAND)
        .enumerate()
        .for_each(|(band, rows)| {
            for triangle in &projected {
                triangle.fill(rows, band * BAND, width as usize);
            }
        });
    Visible {
        width,
        height,
        samples,
    }
}

impl Projected {
    fn fill(&self, rows: &mut [Sample], first_row: usize, width: usize) {
        let [a, b, c] = self.corners;
        let low = a.min(b).min(c);
        let high = a.max(b).max(c);
        let last_row = first_row + rows.len() / width;
        if !(low.y < last_row as f32 && high.y >= first_row as f32 && high.x >= 0.0) {
            return;
        }
        let (ab, ac) = ((b - a).truncate(), (c - a).truncate());
        let area = ab.perp_dot(ac);
        if area.abs() < 1e-9 {
            return;
        }
        let y_range = (low.y.floor().max(first_row as f32) as usize)
            ..((high.y.ceil() as usize + 1).min(last_row));
        let x_range = (low.x.floor().max(0.0) as usize)..((high.x.ceil() as usize + 1).min(width));
        for y in y_range {
            for x in x_range.clone() {
                let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - a.truncate();
                let v = p.perp_dot(ac) / area;
                let w = ab.perp_dot(p) / area;
                if v < 0.0 || w < 0.0 || v + w > 1.0 {
                    continue;
                }
                let depth = a.z + v * (b.z - a.z) + w * (c.z - a.z);
                let sample = &mut rows[(y - first_row) * width + x];
                if depth > sample.depth {
                    *sample = Sample {
                        depth,
                        mesh: self.mesh,
                        triangle: self.triangle,
                        weights: Vec2::new(v, w),
                    };
                }
            }
        }
    }
}
