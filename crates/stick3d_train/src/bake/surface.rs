//! A skinned triangle surface while it is being baked: closing holes, splitting edges, smoothing.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::makehuman::Influences;

/// Vertices, triangles and skin weights that grow and move together.
#[derive(Clone)]
pub(super) struct Surface {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) influences: Influences,
}

impl Surface {
    /// A surface of quads, each cut along its shorter diagonal.
    pub(super) fn from_quads(
        positions: Vec<DVec3>,
        quads: &[[u32; 4]],
        influences: Influences,
    ) -> Self {
        let length = |a: u32, b: u32| positions[a as usize].distance_squared(positions[b as usize]);
        let triangles = quads
            .iter()
            .flat_map(|&[a, b, c, d]| {
                if length(a, c) <= length(b, d) {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[b, c, d], [b, d, a]]
                }
            })
            .collect();
        Self {
            positions,
            triangles,
            influences,
        }
    }

    /// Closes the hole with this rim by a fan round a new vertex at `apex`; returns the new vertex.
    pub(super) fn fan_shut(&mut self, rim: &[u32], apex: DVec3) -> u32 {
        let top = self.positions.len() as u32;
        self.positions.push(apex);
        let lists = rim
            .iter()
            .map(|&v| (&self.influences[v as usize], 1.0 / rim.len() as f64));
        self.influences.push(weighted_sum(lists));
        let used: BTreeSet<(u32, u32)> = self.directed_edges().collect();
        for (index, &a) in rim.iter().enumerate() {
            let b = rim[(index + 1) % rim.len()];
            // The triangle outside the hole runs along the rim one way; the fan must run the other.
            self.triangles.push(if used.contains(&(a, b)) {
                [b, a, top]
            } else {
                [a, b, top]
            });
        }
        top
    }

    /// Splits the edge `a`-`b` at the share `t` of the way from `a`; returns the new vertex.
    pub(super) fn split_at(&mut self, a: u32, b: u32, t: f64) -> u32 {
        let middle = self.positions.len() as u32;
        let (from, to) = (a as usize, b as usize);
        self.positions
            .push(self.positions[from].lerp(self.positions[to], t));
        self.influences
            .push(mix(&self.influences[from], &self.influences[to], t));
        for index in 0..self.triangles.len() {
            let triangle = self.triangles[index];
            let side = (0..3).find(|&side| {
                let (from, to) = (triangle[side], triangle[(side + 1) % 3]);
                (from, to) == (a, b) || (from, to) == (b, a)
            });
            if let Some(side) = side {
                let [from, to, tip] = [0, 1, 2].map(|turn| triangle[(side + turn) % 3]);
                self.triangles[index] = [from, middle, tip];
                self.triangles.push([middle, to, tip]);
            }
        }
        middle
    }

    /// Splits the longest edge, `times` times over, the new vertices following the surface's curvature.
    /// An edge's length counts by `factor` at its middle. Returns the ends of each edge split.
    pub(super) fn split_longest(
        &mut self,
        times: usize,
        factor: impl Fn(DVec3) -> f64,
    ) -> Vec<(u32, u32)> {
        let mut split = Vec::with_capacity(times);
        for _ in 0..times {
            let normals = self.normals();
            let length = |&(a, b): &(u32, u32)| {
                let (from, to) = (self.positions[a as usize], self.positions[b as usize]);
                from.distance(to) * factor((from + to) / 2.0)
            };
            let edges = self.directed_edges().filter(|(a, b)| a < b);
            let longest = edges.max_by(|left, right| {
                length(left)
                    .total_cmp(&length(right))
                    .then_with(|| right.cmp(left))
            });
            if let Some((a, b)) = longest {
                let bulge = self.bulge(a, b, &normals);
                let middle = self.split_at(a, b, 0.5);
                self.positions[middle as usize] += bulge;
                split.push((a, b));
            }
        }
        split
    }

    /// How far the middle of a curved edge lies off the straight one: the cubic with the edge's
    /// projections on both tangent planes as end tangents.
    fn bulge(&self, a: u32, b: u32, normals: &[DVec3]) -> DVec3 {
        let straight = self.positions[b as usize] - self.positions[a as usize];
        let tangent = |vertex: u32| straight.reject_from_normalized(normals[vertex as usize]);
        (tangent(a) - tangent(b)) / 8.0
    }

    /// Per vertex its neighbours, ascending.
    pub(super) fn neighbors(&self) -> Vec<Vec<u32>> {
        let mut around = vec![BTreeSet::new(); self.positions.len()];
        for (a, b) in self.directed_edges() {
            around[a as usize].insert(b);
            around[b as usize].insert(a);
        }
        around
            .into_iter()
            .map(|set| set.into_iter().collect())
            .collect()
    }

    /// Moves every vertex `steps` times by `mask` (0 to 1) of the way to the mean of its neighbours.
    pub(super) fn smooth(&mut self, mask: &[f64], steps: usize) {
        let neighbors = self.neighbors();
        for _ in 0..steps {
            let before = self.positions.clone();
            for (vertex, around) in neighbors.iter().enumerate().filter(|(v, _)| mask[*v] > 0.0) {
                let mean = around.iter().map(|&v| before[v as usize]).sum::<DVec3>()
                    / around.len().max(1) as f64;
                self.positions[vertex] = before[vertex].lerp(mean, mask[vertex]);
            }
        }
    }

    /// Blends every vertex' influences `steps` times by `mask` (0 to 1) with the mean of its neighbours'.
    pub(super) fn smooth_influences(&mut self, mask: &[f64], steps: usize) {
        let neighbors = self.neighbors();
        for _ in 0..steps {
            let before = self.influences.clone();
            for (vertex, around) in neighbors.iter().enumerate().filter(|(v, _)| mask[*v] > 0.0) {
                let each = 1.0 / around.len().max(1) as f64;
                let mean = weighted_sum(around.iter().map(|&v| (&before[v as usize], each)));
                self.influences[vertex] = mix(&before[vertex], &mean, mask[vertex]);
            }
        }
    }

    /// Moves the vertices on either side of the line `field = 0` along their edges toward it, to a
    /// distance of `gap`, so that a change of colour there is sharp.
    ///
    /// `field` is a signed distance; a vertex moves at most two thirds of an edge.
    pub(super) fn pinch(&mut self, field: impl Fn(DVec3) -> f64, gap: f64) {
        let values: Vec<f64> = self.positions.iter().map(|&point| field(point)).collect();
        let steepness = |a: usize, b: usize| {
            (values[a] - values[b]).abs() / self.positions[a].distance(self.positions[b]).max(1e-9)
        };
        let mut moves = Vec::new();
        for (a, around) in self.neighbors().iter().enumerate() {
            let across = around
                .iter()
                .map(|&b| b as usize)
                .filter(|&b| values[a] * values[b] < 0.0);
            let steepest =
                across.max_by(|&b, &c| steepness(a, b).total_cmp(&steepness(a, c)).then(c.cmp(&b)));
            if let Some(b) = steepest.filter(|_| values[a].abs() > gap) {
                let t = (values[a].abs() - gap) / (values[a] - values[b]).abs();
                moves.push((a, b, t.min(0.67)));
            }
        }
        let (positions, influences) = (self.positions.clone(), self.influences.clone());
        for (a, b, t) in moves {
            self.positions[a] = positions[a].lerp(positions[b], t);
            self.influences[a] = mix(&influences[a], &influences[b], t);
        }
    }

    /// Per vertex its outward unit normal.
    pub(super) fn normals(&self) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| self.positions[corner as usize]);
            let area = (b - a).cross(c - a);
            for &corner in triangle {
                normals[corner as usize] += area;
            }
        }
        normals.into_iter().map(DVec3::normalize_or_zero).collect()
    }

    fn directed_edges(&self) -> impl Iterator<Item = (u32, u32)> {
        self.triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
    }
}

/// The influences at the share `t` of the way from one list to another.
pub(super) fn mix(from: &[(u16, f64)], to: &[(u16, f64)], t: f64) -> Vec<(u16, f64)> {
    weighted_sum([(from, 1.0 - t), (to, t)].into_iter())
}

/// The sum of some influence lists, each times a factor, bones ascending.
pub(super) fn weighted_sum<'a, List>(lists: impl Iterator<Item = (List, f64)>) -> Vec<(u16, f64)>
where
    List: IntoIterator<Item = &'a (u16, f64)>,
{
    let mut sums: BTreeMap<u16, f64> = BTreeMap::new();
    for (list, factor) in lists {
        for &(bone, weight) in list {
            *sums.entry(bone).or_default() += weight * factor;
        }
    }
    sums.into_iter().collect()
}

/// The strongest `limit` influences, scaled to sum to 1.
pub(super) fn strongest(list: &[(u16, f64)], limit: usize) -> Vec<(u16, f32)> {
    let mut list = list.to_vec();
    list.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    list.truncate(limit);
    let sum: f64 = list.iter().map(|&(_, weight)| weight).sum();
    list.into_iter()
        .map(|(bone, weight)| (bone, (weight / sum) as f32))
        .collect()
}

#[cfg(test)]
mod tests {
    use stick3d_figure::TriangleMesh;

    use super::*;

    /// A cube without its top, one bone.
    fn open_cube() -> Surface {
        let corner = |v: u32| {
            DVec3::new(
                f64::from(v & 1),
                f64::from(v >> 1 & 1),
                f64::from(v >> 2 & 1),
            )
        };
        let quads = [
            [0, 1, 5, 4],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        Surface::from_quads(
            (0..8).map(corner).collect(),
            &quads,
            vec![vec![(0, 1.0)]; 8],
        )
    }

    fn mesh(surface: &Surface) -> TriangleMesh {
        TriangleMesh {
            positions: surface
                .positions
                .iter()
                .map(|point| point.as_vec3())
                .collect(),
            triangles: surface.triangles.clone(),
        }
    }

    #[test]
    fn a_fan_closes_a_hole_with_the_right_winding() {
        for rim in [[2, 3, 7, 6], [6, 7, 3, 2]] {
            let mut cube = open_cube();
            assert!(!mesh(&cube).topology().closed);
            cube.fan_shut(&rim, DVec3::new(0.5, 1.0, 0.5));
            let report = mesh(&cube).topology();
            assert!(report.closed && report.consistently_wound, "{report:?}");
            assert!((mesh(&cube).volume() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn splits_keep_the_surface_closed_and_the_weights_whole() {
        let mut cube = open_cube();
        let top = cube.fan_shut(&[2, 3, 7, 6], DVec3::new(0.5, 1.0, 0.5));
        cube.influences[top as usize] = vec![(1, 1.0)];
        let middle = cube.split_at(top, 2, 0.25);
        assert_eq!(cube.influences[middle as usize], [(0, 0.25), (1, 0.75)]);
        cube.split_longest(30, |_| 1.0);
        assert_eq!(cube.positions.len(), 8 + 1 + 1 + 30);
        let report = mesh(&cube).topology();
        assert!(report.closed && report.consistently_wound, "{report:?}");
        assert_eq!(report.euler_characteristic, 2);
        for list in &cube.influences {
            let sum: f64 = list.iter().map(|&(_, weight)| weight).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn pinching_pulls_both_sides_to_the_line_and_keeps_the_rest() {
        let mut cube = open_cube();
        cube.pinch(|point| point.x - 0.5, 0.01);
        for point in &cube.positions {
            // The line is half an edge away, which is less than the furthest that a vertex may go.
            assert!(((point.x - 0.5).abs() - 0.01).abs() < 1e-9, "{point}");
        }
        let mut other = open_cube();
        other.pinch(|point| point.x - 2.0, 0.01);
        assert_eq!(other.positions, open_cube().positions);
    }

    #[test]
    fn smoothing_moves_only_what_the_mask_names() {
        let mut cube = open_cube();
        let mut mask = vec![0.0; 8];
        mask[7] = 1.0;
        cube.smooth(&mask, 1);
        assert_eq!(cube.positions[..7], open_cube().positions[..7]);
        assert!(cube.positions[7] != open_cube().positions[7]);
    }
}
