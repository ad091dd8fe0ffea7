//! What holds of a mesh as a surface: edges, Euler characteristic, closedness, winding, components, genus.

use std::collections::HashMap;

use super::TriangleMesh;

/// How the edges of a mesh are shared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EdgeReport {
    /// Different edges.
    pub edges: usize,
    /// Edges of one triangle only: the rim of a hole.
    pub boundary: usize,
    /// Edges of more than two triangles.
    pub non_manifold: usize,
    /// Edges of two triangles that run through them in the same direction: one of them is turned inside out.
    pub flipped: usize,
    /// Triangles that name a vertex twice.
    pub degenerate_triangles: usize,
}

/// A mesh as a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TopologyReport {
    /// How edges are shared.
    pub edges: EdgeReport,
    /// Vertices that some triangle names.
    pub used_vertices: usize,
    /// Pieces that no edge joins; vertices outside any triangle are not counted.
    pub components: usize,
    /// Vertices minus edges plus faces, over the used vertices.
    pub euler_characteristic: i64,
    /// Vertices whose triangles do not form one fan (two sheets that touch in a point).
    pub pinched_vertices: usize,
    /// No boundary, no non-manifold edge, no degenerate triangle.
    pub closed: bool,
    /// No edge is run through twice in one direction.
    pub consistently_wound: bool,
    /// Handles of the surface, for a closed, consistently wound mesh: `components - euler / 2`.
    pub genus: Option<i64>,
}

impl TriangleMesh {
    /// Counts how edges are shared.
    pub fn edge_report(&self) -> EdgeReport {
        // Per undirected edge: how often it is run through upward and downward.
        let mut uses: HashMap<(u32, u32), (u32, u32)> =
            HashMap::with_capacity(self.triangles.len() * 2);
        let mut report = EdgeReport::default();
        for &[a, b, c] in &self.triangles {
            if a == b || b == c || c == a {
                report.degenerate_triangles += 1;
                continue;
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let entry = uses.entry((from.min(to), from.max(to))).or_default();
                if from < to {
                    entry.0 += 1;
                } else {
                    entry.1 += 1;
                }
            }
        }
        report.edges = uses.len();
        for (up, down) in uses.into_values() {
            match up + down {
                1 => report.boundary += 1,
                2 if up == down => {}
                2 => report.flipped += 1,
                _ => report.non_manifold += 1,
            }
        }
        report
    }

    /// Everything that can be said of the mesh as a surface.
    pub fn topology(&self) -> TopologyReport {
        let edges = self.edge_report();
        let faces = self.triangles.len() - edges.degenerate_triangles;
        let (used_vertices, components) = self.components();
        let euler_characteristic = used_vertices as i64 - edges.edges as i64 + faces as i64;
        let closed = !self.triangles.is_empty()
            && edges.boundary + edges.non_manifold + edges.degenerate_triangles == 0;
        let consistently_wound = edges.flipped == 0;
        let genus =
            (closed && consistently_wound).then(|| components as i64 - euler_characteristic / 2);
        TopologyReport {
            edges,
            used_vertices,
            components,
            euler_characteristic,
            pinched_vertices: self.pinched_vertices(),
            closed,
            consistently_wound,
            genus,
        }
    }

    /// Every edge has exactly two triangles.
    pub fn is_closed(&self) -> bool {
        self.topology().closed
    }

    /// Vertices minus edges plus faces.
    pub fn euler_characteristic(&self) -> i64 {
        self.topology().euler_characteristic
    }

    /// Used vertices and connected pieces.
    fn components(&self) -> (usize, usize) {
        let size = self
            .triangles
            .iter()
            .flatten()
            .max()
            .map_or(0, |&v| v as usize + 1);
        let mut groups = Groups::new(size);
        let mut used = vec![false; size];
        for t in &self.triangles {
            for &v in t {
                used[v as usize] = true;
            }
            groups.join(t[0] as usize, t[1] as usize);
            groups.join(t[0] as usize, t[2] as usize);
        }
        let used_count = used.iter().filter(|u| **u).count();
        let roots = (0..size)
            .filter(|&v| used[v] && groups.root(v) == v)
            .count();
        (used_count, roots)
    }

    /// Vertices round which the triangles fall into several fans.
    fn pinched_vertices(&self) -> usize {
        // Corners are joined where two triangles share an edge at the vertex; more than one group is a pinch.
        let mut groups = Groups::new(self.triangles.len() * 3);
        let mut seen: HashMap<(u32, u32), usize> = HashMap::with_capacity(self.triangles.len() * 6);
        for (t, corners) in self.triangles.iter().enumerate() {
            for k in 0..3 {
                for other in [(k + 1) % 3, (k + 2) % 3] {
                    let corner = 3 * t + k;
                    let first = *seen.entry((corners[k], corners[other])).or_insert(corner);
                    groups.join(first, corner);
                }
            }
        }
        let mut fans: HashMap<u32, usize> = HashMap::new();
        for corner in 0..self.triangles.len() * 3 {
            if groups.root(corner) == corner {
                *fans
                    .entry(self.triangles[corner / 3][corner % 3])
                    .or_default() += 1;
            }
        }
        fans.into_values().filter(|count| *count > 1).count()
    }
}

/// Disjoint sets with path halving.
struct Groups {
    parent: Vec<usize>,
}

impl Groups {
    fn new(size: usize) -> Self {
        Self {
            parent: (0..size).collect(),
        }
    }

    fn root(&mut self, mut at: usize) -> usize {
        while self.parent[at] != at {
            self.parent[at] = self.parent[self.parent[at]];
            at = self.parent[at];
        }
        at
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples;
    use super::*;

    #[test]
    fn a_tetrahedron_is_a_sphere_and_a_torus_has_a_handle() {
        let report = samples::tetrahedron().topology();
        assert!(report.closed && report.consistently_wound);
        assert_eq!(
            (report.euler_characteristic, report.genus, report.components),
            (2, Some(0), 1)
        );
        assert_eq!(
            (
                report.edges.edges,
                report.used_vertices,
                report.pinched_vertices
            ),
            (6, 4, 0)
        );
        let torus = samples::torus(8, 6).topology();
        assert_eq!(
            (torus.euler_characteristic, torus.genus, torus.components),
            (0, Some(1), 1)
        );
    }

    #[test]
    fn faults_are_counted() {
        let mut open = samples::tetrahedron();
        open.triangles.pop();
        let report = open.topology();
        assert_eq!(
            (report.edges.boundary, report.closed, report.genus),
            (3, false, None)
        );
        let mut flipped = samples::tetrahedron();
        flipped.triangles[0].swap(0, 1);
        let report = flipped.topology();
        assert_eq!(
            (
                report.edges.flipped,
                report.closed,
                report.consistently_wound
            ),
            (3, true, false)
        );
        let mut doubled = samples::tetrahedron();
        doubled.triangles.push([0, 1, 0]);
        doubled.triangles.push([0, 2, 1]);
        let report = doubled.edge_report();
        assert_eq!((report.degenerate_triangles, report.non_manifold), (1, 3));
    }

    #[test]
    fn two_solids_touching_in_a_point_are_one_pinched_component() {
        let mut mesh = samples::tetrahedron();
        let second = samples::tetrahedron();
        mesh.positions
            .extend(second.positions[1..].iter().map(|p| -*p));
        // Negating turns the winding round, so corners are exchanged.
        mesh.triangles.extend(second.triangles.iter().map(|t| {
            let moved = t.map(|v| if v == 0 { 0 } else { v + 3 });
            [moved[0], moved[2], moved[1]]
        }));
        let report = mesh.topology();
        assert!(report.closed && report.consistently_wound);
        assert_eq!((report.components, report.pinched_vertices), (1, 1));
        assert_eq!(TriangleMesh::default().topology().components, 0);
    }
}
