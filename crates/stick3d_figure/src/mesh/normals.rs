//! Vertex normals of a mesh whose triangles stay while its positions change every frame.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::{MeshError, check_triangles};

/// The triangles of a mesh, checked once, so that normals need no checks and no memory per frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NormalAdjacency {
    triangles: Vec<[u32; 3]>,
    vertex_count: usize,
}

impl NormalAdjacency {
    /// Prepares the triangles of a mesh of `vertex_count` vertices.
    ///
    /// # Errors
    /// [`MeshError::VertexOutOfRange`].
    pub fn new(triangles: &[[u32; 3]], vertex_count: usize) -> Result<Self, MeshError> {
        check_triangles(triangles, vertex_count)?;
        Ok(Self {
            triangles: triangles.to_vec(),
            vertex_count,
        })
    }

    /// How many vertices the mesh has.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Writes the unit normal of every vertex: the sum of its triangles' normals, weighted by area. A vertex without
    /// area round it gets +y. Allocates nothing.
    ///
    /// # Panics
    /// When a slice has another length than the mesh has vertices, as copying between slices does.
    pub fn vertex_normals(&self, positions: &[[f32; 3]], normals: &mut [[f32; 3]]) {
        assert_eq!(
            positions.len(),
            self.vertex_count,
            "one position per vertex"
        );
        assert_eq!(normals.len(), self.vertex_count, "one normal per vertex");
        normals.fill([0.0; 3]);
        for triangle in &self.triangles {
            let [i, j, k] = triangle.map(|v| v as usize);
            let a = Vec3::from(positions[i]);
            let doubled_area_normal =
                (Vec3::from(positions[j]) - a).cross(Vec3::from(positions[k]) - a);
            for v in [i, j, k] {
                let normal = &mut normals[v];
                normal[0] += doubled_area_normal.x;
                normal[1] += doubled_area_normal.y;
                normal[2] += doubled_area_normal.z;
            }
        }
        for normal in normals {
            *normal = unit_or_up(Vec3::from(*normal)).to_array();
        }
    }
}

fn unit_or_up(v: Vec3) -> Vec3 {
    v.try_normalize().unwrap_or(Vec3::Y)
}

#[cfg(test)]
mod tests {
    use super::super::samples;
    use super::*;

    #[test]
    fn a_round_tube_has_radial_normals() {
        let torus = samples::torus(96, 48);
        let adjacency = NormalAdjacency::new(&torus.triangles, torus.positions.len()).unwrap();
        let positions: Vec<[f32; 3]> = torus.positions.iter().map(|p| p.to_array()).collect();
        let mut normals = vec![[0.0; 3]; positions.len()];
        adjacency.vertex_normals(&positions, &mut normals);
        for (p, n) in torus.positions.iter().zip(&normals) {
            let centre_of_tube = Vec3::new(p.x, 0.0, p.z).normalize() * 2.0;
            let radial = (*p - centre_of_tube).normalize();
            assert!(radial.dot(Vec3::from(*n)) > 0.999);
        }
    }

    #[test]
    fn area_weighs_and_lonely_vertices_point_up() {
        // A large triangle facing +z and a small one facing +x share vertex 0; vertex 5 has none.
        let positions = [
            [0., 0., 0.],
            [2., 0., 0.],
            [0., 2., 0.],
            [0., 0.5, 0.],
            [0., 0., 0.5],
            [9., 9., 9.],
        ];
        let adjacency = NormalAdjacency::new(&[[0, 1, 2], [0, 3, 4]], 6).unwrap();
        let mut normals = [[0.0; 3]; 6];
        adjacency.vertex_normals(&positions, &mut normals);
        let shared = Vec3::new(0.25, 0.0, 4.0).normalize();
        assert!(Vec3::from(normals[0]).distance(shared) < 1.0e-6);
        assert_eq!(normals[5], [0.0, 1.0, 0.0]);
        assert!(NormalAdjacency::new(&[[0, 1, 2]], 2).is_err());
    }
}
