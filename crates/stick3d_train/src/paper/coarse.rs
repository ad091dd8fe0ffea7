//! The same meshes with fewer vertices, for quick runs.

use std::collections::BTreeMap;

use glam::Vec3;
use stick3d_figure::regressor::JointRegressor;

use super::set::{KeyMesh, PaperSet};
use crate::dataset::centre;

impl PaperSet {
    /// The set on about `target` vertices: those of the first mesh in one cell of a grid that hang together become one.
    /// What is kept of each is the vertex nearest to their middle.
    #[must_use]
    pub fn coarsened(&self, target: usize) -> Self {
        let Some(first) = self.meshes.first() else {
            return self.clone();
        };
        let clusters = Clusters::of(
            &first.positions,
            &self.triangles,
            cell_m(first, &self.triangles, target),
        );
        let regressor = clusters.regressor(&self.regressor);
        let meshes = self.meshes.iter().map(|mesh| {
            let mut positions = clusters.pick(&mesh.positions);
            let joints = centre(&regressor, self.figure.root, &mut positions);
            KeyMesh {
                name: mesh.name.clone(),
                positions,
                joints,
            }
        });
        Self {
            figure: self.figure.clone(),
            meshes: meshes.collect(),
            triangles: clusters.triangles(&self.triangles),
            colors: clusters.pick(&self.colors),
            extent_m: self.extent_m,
            regressor,
            kept: Some(clusters.kept),
            turns: self.turns.clone(),
        }
    }
}

/// The edge of the grid's cells: each takes about one vertex from a surface that is cut along it.
fn cell_m(mesh: &KeyMesh, triangles: &[[u32; 3]], target: usize) -> f32 {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        (b - a).cross(c - a).length() / 2.0
    };
    let area: f32 = triangles.iter().map(area).sum();
    (area / target.max(1) as f32).sqrt().max(f32::MIN_POSITIVE)
}

/// Vertices that become one.
struct Clusters {
    /// Per vertex its cluster.
    of_vertex: Vec<u32>,
    /// Per cluster the vertex that is kept, rising.
    kept: Vec<u32>,
}

impl Clusters {
    fn of(positions: &[Vec3], triangles: &[[u32; 3]], cell_m: f32) -> Self {
        let cell: Vec<_> = positions
            .iter()
            .map(|p| (*p / cell_m).floor().as_ivec3())
            .collect();
        let mut root: Vec<u32> = (0..positions.len() as u32).collect();
        for [a, b, c] in triangles {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                if cell[*a as usize] == cell[*b as usize] {
                    let (a, b) = (find(&mut root, *a), find(&mut root, *b));
                    root[a.max(b) as usize] = a.min(b);
                }
            }
        }
        let mut members: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for vertex in 0..positions.len() as u32 {
            members
                .entry(find(&mut root, vertex))
                .or_default()
                .push(vertex);
        }
        let mut groups: Vec<(u32, Vec<u32>)> = members
            .into_values()
            .map(|group| (most_central(positions, &group), group))
            .collect();
        groups.sort_unstable();
        let mut of_vertex = vec![0; positions.len()];
        for (cluster, (_, group)) in (0_u32..).zip(&groups) {
            group
                .iter()
                .for_each(|vertex| of_vertex[*vertex as usize] = cluster);
        }
        Self {
            of_vertex,
            kept: groups.into_iter().map(|(kept, _)| kept).collect(),
        }
    }

    fn pick<T: Copy>(&self, list: &[T]) -> Vec<T> {
        self.kept.iter().map(|v| list[*v as usize]).collect()
    }

    fn triangles(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let mut coarse: Vec<[u32; 3]> = triangles
            .iter()
            .map(|triangle| triangle.map(|v| self.of_vertex[v as usize]))
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        // The same three corners the same way round are one triangle.
        let canonical = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
        coarse.sort_unstable_by_key(|t| canonical(*t));
        coarse.dedup_by_key(|t| canonical(*t));
        coarse
    }

    fn regressor(&self, regressor: &JointRegressor) -> JointRegressor {
        let row = |row: &Vec<(u32, f32)>| {
            let mut weights: BTreeMap<u32, f32> = BTreeMap::new();
            for (vertex, weight) in row {
                *weights.entry(self.of_vertex[*vertex as usize]).or_default() += weight;
            }
            weights.into_iter().collect()
        };
        JointRegressor {
            rows: regressor.rows.iter().map(row).collect(),
        }
    }
}

/// The first of the vertices that hang together with one, as far as is known.
fn find(root: &mut [u32], vertex: u32) -> u32 {
    let mut at = vertex;
    while root[at as usize] != at {
        root[at as usize] = root[root[at as usize] as usize];
        at = root[at as usize];
    }
    at
}

fn most_central(positions: &[Vec3], group: &[u32]) -> u32 {
    let at = |v: &u32| positions[*v as usize];
    let middle = group.iter().map(at).sum::<Vec3>() / group.len().max(1) as f32;
    let distance = |v: &u32| at(v).distance_squared(middle);
    let nearest = group
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.copied().unwrap_or_default()
}
