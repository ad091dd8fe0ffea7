//! Ways on a surface: how far its points are from each other along it, and the rings of equal distance.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use glam::Vec3;
use stick3d_figure::mesh::TriangleMesh;

/// How many vertices a ring is told by.
const RING_VERTICES: usize = 24;

/// A mesh with the ways between its vertices: along edges, and across each edge between the corners opposite to it, which
/// takes most of the zigzag out.
pub(super) struct Surface<'m> {
    pub(super) mesh: &'m TriangleMesh,
    neighbours: Vec<Vec<(u32, f32)>>,
}

/// A closed line on the surface along which a field has one value.
#[derive(Debug, Clone)]
pub(super) struct Ring {
    /// Mean of its points.
    pub(super) centre: Vec3,
    /// How long it is.
    pub(super) length: f32,
    /// Vertices next to it, evenly spread along it: their mean is close to its centre in every pose.
    pub(super) vertices: Vec<u32>,
}

/// What [`Surface::rings`] gathers a ring from: a stretch inside one triangle and the triangle's vertex nearest to it.
struct Stretch {
    middle: Vec3,
    length: f32,
    vertex: u32,
}

impl<'m> Surface<'m> {
    pub(super) fn new(mesh: &'m TriangleMesh) -> Self {
        let mut opposite: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
        for &[a, b, c] in &mesh.triangles {
            for (from, to, corner) in [(a, b, c), (b, c, a), (c, a, b)] {
                if from != to {
                    opposite
                        .entry((from.min(to), from.max(to)))
                        .or_default()
                        .push(corner);
                }
            }
        }
        let mut neighbours = vec![vec![]; mesh.positions.len()];
        let mut join = |a: u32, b: u32| {
            let (at_a, at_b) = (mesh.positions[a as usize], mesh.positions[b as usize]);
            let length = at_a.distance(at_b);
            neighbours[a as usize].push((b, length));
            neighbours[b as usize].push((a, length));
        };
        for ((a, b), corners) in opposite {
            join(a, b);
            if let [c, d] = corners[..] {
                join(c, d);
            }
        }
        Self { mesh, neighbours }
    }

    /// The distance of every vertex from the nearest of `sources` along the surface (Dijkstra); infinite on other pieces.
    pub(super) fn distances(&self, sources: &[u32]) -> Vec<f32> {
        let mut distances = vec![f32::INFINITY; self.neighbours.len()];
        // Bits of positive numbers are ordered as the numbers are.
        let mut queue: BinaryHeap<Reverse<(u32, u32)>> = BinaryHeap::new();
        for source in sources {
            distances[*source as usize] = 0.0;
            queue.push(Reverse((0, *source)));
        }
        while let Some(Reverse((bits, vertex))) = queue.pop() {
            let distance = f32::from_bits(bits);
            if distance > distances[vertex as usize] {
                continue;
            }
            for (next, length) in &self.neighbours[vertex as usize] {
                let through = distance + length;
                if through < distances[*next as usize] {
                    distances[*next as usize] = through;
                    queue.push(Reverse((through.to_bits(), *next)));
                }
            }
        }
        distances
    }

    /// A vertex of the piece that has the most of them.
    pub(super) fn on_largest_piece(&self) -> Option<u32> {
        let mut seen = vec![false; self.neighbours.len()];
        let mut largest = (0, None);
        for &[first, ..] in &self.mesh.triangles {
            if seen[first as usize] {
                continue;
            }
            let mut size = 0;
            for (seen, distance) in seen.iter_mut().zip(self.distances(&[first])) {
                size += usize::from(distance.is_finite());
                *seen |= distance.is_finite();
            }
            if size > largest.0 {
                largest = (size, Some(first));
            }
        }
        largest.1
    }

    /// Whether no neighbour of the vertex has a larger value.
    pub(super) fn is_summit(&self, vertex: u32, field: &[f32]) -> bool {
        let value = field[vertex as usize];
        self.neighbours[vertex as usize]
            .iter()
            .all(|(next, _)| field[*next as usize] <= value)
    }

    /// The rings along which a field has the value `level`, the longest first.
    pub(super) fn rings(&self, field: &[f32], level: f32) -> Vec<Ring> {
        let mut stretches: Vec<Stretch> = vec![];
        let mut ends: Vec<[(u32, u32); 2]> = vec![];
        for triangle in &self.mesh.triangles {
            let values = triangle.map(|corner| field[corner as usize]);
            if values.iter().any(|value| !value.is_finite()) {
                continue;
            }
            let crossed: Vec<((u32, u32), Vec3)> = [(0, 1), (1, 2), (2, 0)]
                .into_iter()
                .filter(|(i, j)| (values[*i] < level) != (values[*j] < level))
                .map(|(i, j)| {
                    let (a, b) = (triangle[i], triangle[j]);
                    let share = (level - values[i]) / (values[j] - values[i]);
                    let at = |v: u32| self.mesh.positions[v as usize];
                    ((a.min(b), a.max(b)), at(a).lerp(at(b), share))
                })
                .collect();
            let [(from, start), (to, end)] = crossed[..] else {
                continue;
            };
            let off = |corner: &u32| (field[*corner as usize] - level).abs();
            let nearest = triangle
                .iter()
                .copied()
                .min_by(|a, b| off(a).total_cmp(&off(b)));
            stretches.push(Stretch {
                middle: (start + end) / 2.0,
                length: start.distance(end),
                vertex: nearest.unwrap_or(triangle[0]),
            });
            ends.push([from, to]);
        }
        let mut rings: Vec<Ring> = connected(&ends)
            .into_iter()
            .map(|members| ring(members.into_iter().map(|i| &stretches[i]).collect()))
            .collect();
        rings.sort_by(|a, b| b.length.total_cmp(&a.length));
        rings
    }
}

/// Groups of pairs that share ends, by number.
fn connected(pairs: &[[(u32, u32); 2]]) -> Vec<Vec<usize>> {
    let mut at_end: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for (i, pair) in pairs.iter().enumerate() {
        for end in pair {
            at_end.entry(*end).or_default().push(i);
        }
    }
    let mut groups = vec![];
    let mut taken = vec![false; pairs.len()];
    for first in 0..pairs.len() {
        if std::mem::replace(&mut taken[first], true) {
            continue;
        }
        let (mut group, mut open) = (vec![], vec![first]);
        while let Some(i) = open.pop() {
            group.push(i);
            for next in pairs[i].iter().filter_map(|end| at_end.get(end)).flatten() {
                if !std::mem::replace(&mut taken[*next], true) {
                    open.push(*next);
                }
            }
        }
        groups.push(group);
    }
    groups
}

fn ring(stretches: Vec<&Stretch>) -> Ring {
    let length: f32 = stretches.iter().map(|s| s.length).sum();
    let sum: Vec3 = stretches.iter().map(|s| s.length * s.middle).sum();
    let centre = sum / length.max(f32::MIN_POSITIVE);
    // Farthest point after farthest point: evenly along the line, however fine the mesh is on one side of it.
    let mut distances: Vec<f32> = stretches
        .iter()
        .map(|s| s.middle.distance(centre))
        .collect();
    let mut vertices = vec![];
    for _ in 0..RING_VERTICES.min(stretches.len()) {
        let farthest = (0..distances.len()).max_by(|a, b| distances[*a].total_cmp(&distances[*b]));
        let Some(chosen) = farthest.map(|i| stretches[i]) else {
            break;
        };
        // The first is at the centre's farthest; from then on what counts is how far the chosen ones are.
        if vertices.is_empty() {
            distances.fill(f32::INFINITY);
        }
        for (distance, stretch) in distances.iter_mut().zip(&stretches) {
            *distance = distance.min(stretch.middle.distance(chosen.middle));
        }
        vertices.push(chosen.vertex);
    }
    vertices.sort_unstable();
    vertices.dedup();
    Ring {
        centre,
        length,
        vertices,
    }
}
