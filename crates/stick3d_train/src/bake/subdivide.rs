//! Loop's subdivision of a skinned surface: smooth, with creases where they are wanted.
//!
//! Loop, "Smooth Subdivision Surfaces Based on Triangles" (1987); creases after Hoppe and others,
//! "Piecewise Smooth Surface Reconstruction" (1994). Skin weights are subdivided like positions.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::surface::{Surface, weighted_sum};

/// An edge, its smaller vertex first.
pub(super) type Edge = (u32, u32);

/// The edge between two vertices.
pub(super) fn edge(a: u32, b: u32) -> Edge {
    (a.min(b), a.max(b))
}

/// Control mesh of a subdivision: a closed surface, one tag per triangle, and the edges that stay sharp.
#[derive(Clone)]
pub(super) struct Cage {
    pub(super) surface: Surface,
    /// Handed down to the four triangles that each is cut into.
    pub(super) tags: Vec<u8>,
    pub(super) creases: BTreeSet<Edge>,
}

/// Where a new vertex comes from: old ones with factors that sum to 1.
type Mask = Vec<(u32, f64)>;

impl Cage {
    /// Every triangle cut into four. Old vertices keep their numbers and move.
    pub(super) fn subdivided(&self) -> Self {
        let edges = self.edges();
        let count = self.surface.positions.len();
        let number: BTreeMap<Edge, u32> = edges
            .keys()
            .enumerate()
            .map(|(i, &edge)| (edge, (count + i) as u32))
            .collect();
        let old = self.old_vertices();
        let new = edges.iter().map(|(&edge, tips)| self.on_edge(edge, tips));
        let masks: Vec<Mask> = old.into_iter().chain(new).collect();
        let (positions, influences) = masks.iter().map(|mask| self.mixed(mask)).unzip();
        let mut triangles = Vec::with_capacity(4 * self.tags.len());
        for &[a, b, c] in &self.surface.triangles {
            let [x, y, z] = [(a, b), (b, c), (c, a)].map(|(from, to)| number[&edge(from, to)]);
            triangles.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
        }
        Self {
            surface: Surface {
                positions,
                triangles,
                influences,
            },
            tags: self.tags.iter().flat_map(|&tag| [tag; 4]).collect(),
            creases: self
                .creases
                .iter()
                .flat_map(|&(a, b)| [a, b].map(|end| edge(end, number[&(a, b)])))
                .collect(),
        }
    }

    /// Moves the vertices so that the surface after `levels` subdivisions passes them at `share` (0 to
    /// 1) of the distance that it would shrink away from them.
    pub(super) fn hold(&mut self, levels: usize, share: f64) {
        const ROUNDS: usize = 4;
        let wanted = self.surface.positions.clone();
        let shrunk = self.after(levels);
        let target: Vec<DVec3> = wanted
            .iter()
            .zip(&shrunk)
            .map(|(point, shrunk)| shrunk.lerp(*point, share))
            .collect();
        for _ in 0..ROUNDS {
            let reached = self.after(levels);
            for (vertex, point) in self.surface.positions.iter_mut().enumerate() {
                *point += target[vertex] - reached[vertex];
            }
        }
    }

    /// Where the vertices are after some subdivisions.
    fn after(&self, levels: usize) -> Vec<DVec3> {
        let mut cage = self.clone();
        for _ in 0..levels {
            cage = cage.subdivided();
        }
        cage.surface.positions[..self.surface.positions.len()].to_vec()
    }

    /// Per edge the vertices opposite to it.
    pub(super) fn edges(&self) -> BTreeMap<Edge, Vec<u32>> {
        let mut edges: BTreeMap<Edge, Vec<u32>> = BTreeMap::new();
        for &[a, b, c] in &self.surface.triangles {
            for (from, to, tip) in [(a, b, c), (b, c, a), (c, a, b)] {
                edges.entry(edge(from, to)).or_default().push(tip);
            }
        }
        edges
    }

    fn on_edge(&self, (a, b): Edge, tips: &[u32]) -> Mask {
        if self.creases.contains(&(a, b)) || tips.len() != 2 {
            return vec![(a, 0.5), (b, 0.5)];
        }
        let ends = [(a, 0.375), (b, 0.375)];
        ends.into_iter()
            .chain(tips.iter().map(|&tip| (tip, 0.125)))
            .collect()
    }

    fn old_vertices(&self) -> Vec<Mask> {
        let mut sharp = vec![Vec::new(); self.surface.positions.len()];
        for &(a, b) in &self.creases {
            sharp[a as usize].push(b);
            sharp[b as usize].push(a);
        }
        let neighbors = self.surface.neighbors();
        (0u32..)
            .zip(neighbors.iter().zip(&sharp))
            .map(|(vertex, (around, sharp))| match sharp[..] {
                [] | [_] => smooth_mask(vertex, around),
                [before, after] => vec![(vertex, 0.75), (before, 0.125), (after, 0.125)],
                _ => vec![(vertex, 1.0)],
            })
            .collect()
    }

    fn mixed(&self, mask: &Mask) -> (DVec3, Vec<(u16, f64)>) {
        let point = mask
            .iter()
            .map(|&(vertex, factor)| factor * self.surface.positions[vertex as usize])
            .sum();
        let lists = mask
            .iter()
            .map(|&(vertex, factor)| (&self.surface.influences[vertex as usize], factor));
        (point, weighted_sum(lists))
    }
}

fn smooth_mask(vertex: u32, around: &[u32]) -> Mask {
    let count = around.len().max(1) as f64;
    let spread = 0.375 + (std::f64::consts::TAU / count).cos() / 4.0;
    let each = (0.625 - spread * spread) / count;
    let own = (vertex, 1.0 - count * each);
    std::iter::once(own)
        .chain(around.iter().map(|&other| (other, each)))
        .collect()
}

#[cfg(test)]
mod tests {
    use stick3d_figure::TriangleMesh;

    use super::*;

    fn octahedron() -> Cage {
        let points = [
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            DVec3::NEG_X,
            DVec3::NEG_Y,
            DVec3::NEG_Z,
        ];
        let triangles = vec![
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ];
        let bone = |i: usize| vec![(i as u16 % 2, 1.0)];
        Cage {
            surface: Surface {
                positions: points.to_vec(),
                triangles,
                influences: (0..6).map(bone).collect(),
            },
            tags: (0..8).collect(),
            creases: BTreeSet::new(),
        }
    }

    #[test]
    fn four_triangles_for_one_closed_with_whole_weights() {
        let fine = octahedron().subdivided().subdivided();
        assert_eq!(fine.surface.triangles.len(), 8 * 16);
        assert_eq!(fine.tags.iter().filter(|&&tag| tag == 5).count(), 16);
        let mesh = TriangleMesh {
            positions: fine.surface.positions.iter().map(|p| p.as_vec3()).collect(),
            triangles: fine.surface.triangles.clone(),
        };
        let report = mesh.topology();
        assert!(report.closed && report.consistently_wound, "{report:?}");
        assert_eq!(report.euler_characteristic, 2);
        for list in &fine.surface.influences {
            let sum: f64 = list.iter().map(|&(_, weight)| weight).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
        // It approaches a sphere: all vertices at nearly one distance, and the corners are gone.
        let radii: Vec<f64> = fine.surface.positions.iter().map(|p| p.length()).collect();
        let (low, high) = (
            radii.iter().copied().fold(f64::INFINITY, f64::min),
            radii.iter().copied().fold(0.0, f64::max),
        );
        assert!(high < 0.75 && low / high > 0.8, "{low} {high}");
    }

    #[test]
    fn a_ring_of_creases_stays_a_sharp_curve_in_its_plane() {
        let mut cage = octahedron();
        cage.creases = [(0, 1), (1, 3), (3, 4), (0, 4)].into();
        let fine = cage.subdivided().subdivided();
        assert_eq!(fine.creases.len(), 16);
        for &(a, b) in &fine.creases {
            for end in [a, b] {
                assert!(fine.surface.positions[end as usize].z.abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_held_cage_keeps_its_size() {
        let mut cage = octahedron();
        cage.hold(2, 1.0);
        let (held, plain) = (cage.after(2), octahedron().after(2));
        for (vertex, point) in octahedron().surface.positions.iter().enumerate() {
            // So sharp a corner is not reached at once, but nearly.
            let (near, far) = (
                held[vertex].distance(*point),
                plain[vertex].distance(*point),
            );
            assert!(near < 0.2 * far, "{near} {far}");
        }
    }
}
