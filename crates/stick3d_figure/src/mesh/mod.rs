//! Triangle meshes: positions and triangles, their checks, and their vertex normals.

mod check;
mod normals;

use glam::Vec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use check::{EdgeReport, TopologyReport};
pub use normals::NormalAdjacency;

/// Why numbers are no mesh.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but the mesh has {vertex_count} vertices")]
    VertexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        vertex_count: usize,
    },
    /// A position is NaN or infinite.
    #[error("vertex {vertex} is at {position}; positions must be finite")]
    Position {
        /// Index of the vertex.
        vertex: usize,
        /// As given.
        position: Vec3,
    },
}

/// A mesh of triangles: right-handed, y up, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TriangleMesh {
    /// One per vertex, metres unless its owner says otherwise.
    pub positions: Vec<Vec3>,
    /// Three vertex indices each.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// Checks that positions are finite and that triangles name existing vertices. All other methods of
    /// a mesh that fails this take no harm but skip what is wrong.
    ///
    /// # Errors
    /// [`MeshError`] for the first fault.
    pub fn validate(&self) -> Result<(), MeshError> {
        if let Some((vertex, position)) = self
            .positions
            .iter()
            .enumerate()
            .find(|(_, p)| !p.is_finite())
        {
            return Err(MeshError::Position {
                vertex,
                position: *position,
            });
        }
        check_triangles(&self.triangles, self.positions.len())
    }

    /// The lowest and highest corner of the bounding box; both zero for an empty mesh.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let first = self.positions.first().copied().unwrap_or_default();
        self.positions
            .iter()
            .fold((first, first), |(low, high), p| (low.min(*p), high.max(*p)))
    }

    /// The enclosed volume: positive where triangles wind counter-clockwise seen from outside. Meaningful for closed meshes.
    pub fn volume(&self) -> f64 {
        self.corners()
            .map(|[a, b, c]| a.as_dvec3().dot(b.as_dvec3().cross(c.as_dvec3())) / 6.0)
            .sum()
    }

    /// The total area of the triangles.
    pub fn area(&self) -> f64 {
        self.corners()
            .map(|[a, b, c]| f64::from((b - a).cross(c - a).length()) / 2.0)
            .sum()
    }

    /// The corner positions of each triangle, skipping those that name missing vertices.
    pub fn corners(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        let position = |v: u32| self.positions.get(v as usize).copied();
        self.triangles
            .iter()
            .filter_map(move |t| Some([position(t[0])?, position(t[1])?, position(t[2])?]))
    }
}

/// Every edge of some triangles once, the smaller vertex first, sorted. A triangle that names a vertex twice has fewer.
#[must_use]
pub fn unique_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let of_triangle = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(of_triangle)
        .filter(|[a, b]| a != b)
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn check_triangles(triangles: &[[u32; 3]], vertex_count: usize) -> Result<(), MeshError> {
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|v| **v as usize >= vertex_count) {
            return Err(MeshError::VertexOutOfRange {
                triangle,
                vertex,
                vertex_count,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
pub(crate) mod samples {
    //! Small meshes for tests.
    use super::*;

    /// A tetrahedron of volume 1/6, closed and outward.
    pub(crate) fn tetrahedron() -> TriangleMesh {
        TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        }
    }

    /// A torus of `around` x `tube` vertices.
    pub(crate) fn torus(around: u32, tube: u32) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        for i in 0..around {
            let (s, c) = (i as f32 / around as f32 * std::f32::consts::TAU).sin_cos();
            for j in 0..tube {
                let (ts, tc) = (j as f32 / tube as f32 * std::f32::consts::TAU).sin_cos();
                let radius = 2.0 + 0.5 * tc;
                mesh.positions
                    .push(Vec3::new(radius * c, 0.5 * ts, radius * s));
                let at = |i: u32, j: u32| (i % around) * tube + j % tube;
                let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                mesh.triangles.extend([[a, d, c], [a, c, b]]);
            }
        }
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volume_area_and_bounds() {
        let mesh = samples::tetrahedron();
        mesh.validate().unwrap();
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1.0e-9);
        assert!((mesh.area() - (1.5 + 0.75_f64.sqrt())).abs() < 1.0e-6);
        assert_eq!(mesh.bounds(), (Vec3::ZERO, Vec3::ONE));
        let torus = samples::torus(64, 32);
        // 2 pi^2 R r^2, less what flat triangles cut off.
        let ideal = 2.0 * std::f64::consts::PI.powi(2) * 2.0 * 0.25;
        assert!(
            torus.volume() > 0.98 * ideal && torus.volume() < ideal,
            "{}",
            torus.volume()
        );
    }

    #[test]
    fn every_edge_comes_once() {
        let mesh = samples::torus(8, 6);
        let edges = unique_edges(&mesh.triangles);
        assert_eq!(edges.len(), mesh.edge_report().edges);
        assert!(edges.is_sorted() && edges.iter().all(|[a, b]| a < b));
        assert_eq!(unique_edges(&[[3, 3, 1]]), [[1, 3]]);
    }

    #[test]
    fn faults_are_named() {
        let mut mesh = samples::tetrahedron();
        mesh.triangles[2][1] = 9;
        assert_eq!(
            mesh.validate(),
            Err(MeshError::VertexOutOfRange {
                triangle: 2,
                vertex: 9,
                vertex_count: 4
            })
        );
        mesh.positions[3].y = f32::NAN;
        assert!(matches!(
            mesh.validate(),
            Err(MeshError::Position { vertex: 3, .. })
        ));
    }
}
