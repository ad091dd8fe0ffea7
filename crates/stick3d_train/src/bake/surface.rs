//! A skinned triangle surface while it is being baked: closing holes, splitting edges, smoothing.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::makehuman::Influences;

/// Vertices, triangles and skin weights that grow and move together.
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
        self.influences.push(mean_influences(
            rim.iter().map(|&v| &self.influences[v as usize]),
        ));
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

    /// Splits the edge `a`-`b` at its middle; returns the new vertex.
    pub(super) fn split(&mut self, a: u32, b: u32) -> u32 {
        let middle = self.positions.len() as u32;
        self.positions
            .push((self.positions[a as usize] + self.positions[b as usize]) / 2.0);
        let ends = [a, b].map(|vertex| &self.influences[vertex as usize]);
        self.influences.push(mean_influences(ends.into_iter()));
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

    /// Splits the longest edge, `times` times over.
    pub(super) fn split_longest(&mut self, times: usize) {
        for _ in 0..times {
            let length = |&(a, b): &(u32, u32)| {
                self.positions[a as usize].distance_squared(self.positions[b as usize])
            };
            let edges = self.directed_edges().filter(|(a, b)| a < b);
            let longest = edges.max_by(|left, right| {
                length(left)
                    .total_cmp(&length(right))
                    .then_with(|| right.cmp(left))
            });
            if let Some((a, b)) = longest {
                self.split(a, b);
            }
        }
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

    fn directed_edges(&self) -> impl Iterator<Item = (u32, u32)> {
        self.triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
    }
}

/// The mean of some influence lists, bones ascending.
pub(super) fn mean_influences<'a>(
    lists: impl Iterator<Item = &'a Vec<(u16, f64)>>,
) -> Vec<(u16, f64)> {
    let mut sums: BTreeMap<u16, f64> = BTreeMap::new();
    let mut count = 0.0;
    for list in lists {
        count += 1.0;
        for &(bone, weight) in list {
            *sums.entry(bone).or_default() += weight;
        }
    }
    sums.into_iter()
        .map(|(bone, sum)| (bone, sum / count))
        .collect()
}
