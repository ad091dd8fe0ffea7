//! Finding and opening the inner cavities of the base mesh: the mouth bag and the two eye sockets.
//!
//! The base mesh is all quads, so lips and eyelids are closed *edge loops*: at a vertex of four edges a
//! loop leaves by the edge opposite to the one it came by. Concentric loops of 28 edges run round
//! each eye and deep into its socket, loops of 38 round and into the mouth. Cutting along a loop takes
//! away what it encloses; only one choice of loops leaves the known size of the outer body.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

/// Edges round an eye, and round the mouth.
const EYE_EDGES: usize = 28;
const MOUTH_EDGES: usize = 38;

/// The outer skin: a closed body without what the eyelids and lips enclose.
pub(super) struct Opened {
    /// The remaining quads, vertices renumbered.
    pub(super) quads: Vec<[u32; 4]>,
    /// Per remaining vertex its number before.
    pub(super) kept: Vec<u32>,
    /// The rims of the holes, renumbered: right eye, left eye, mouth.
    pub(super) holes: [Vec<u32>; 3],
}

/// A closed edge loop and the smaller part of the surface on one side of it.
struct Loop {
    rim: Vec<u32>,
    enclosed: Vec<u32>,
    center: DVec3,
}

/// Cuts the cavities above the height `above` out, so that `remaining` vertices are left.
pub(super) fn open(
    quads: &[[u32; 4]],
    at: &[DVec3],
    above: f64,
    remaining: usize,
) -> Result<Opened, String> {
    let web = Web::new(quads);
    let vertices = web.neighbors.len();
    let loops = |edges: usize| -> Vec<Loop> {
        web.loops(edges)
            .into_iter()
            .map(|rim| web.enclose(rim, at))
            .filter(|l| l.center.y > above)
            .collect()
    };
    let (eyes, mouths) = (loops(EYE_EDGES), loops(MOUTH_EDGES));
    let removed = vertices
        .checked_sub(remaining)
        .ok_or("the base mesh is too small")?;
    let mut fits = Vec::new();
    for right in eyes.iter().filter(|eye| eye.center.x < 0.0) {
        for left in eyes.iter().filter(|eye| eye.center.x > 0.0) {
            for mouth in &mouths {
                let same = right.enclosed.len() == left.enclosed.len();
                if same && 2 * left.enclosed.len() + mouth.enclosed.len() == removed {
                    fits.push([right, left, mouth]);
                }
            }
        }
    }
    let [chosen] = fits.as_slice() else {
        return Err(format!(
            "{} ways to open eyes and mouth fit, not one",
            fits.len()
        ));
    };
    Ok(cut(quads, vertices, chosen))
}

fn cut(quads: &[[u32; 4]], vertices: usize, chosen: &[&Loop; 3]) -> Opened {
    let gone: BTreeSet<u32> = chosen
        .iter()
        .flat_map(|l| l.enclosed.iter().copied())
        .collect();
    let kept: Vec<u32> = (0..vertices as u32)
        .filter(|vertex| !gone.contains(vertex))
        .collect();
    let number: BTreeMap<u32, u32> = kept.iter().copied().zip(0u32..).collect();
    let renumber = |vertex: &u32| number.get(vertex).copied();
    let quads = quads
        .iter()
        .filter_map(|[a, b, c, d]| Some([renumber(a)?, renumber(b)?, renumber(c)?, renumber(d)?]))
        .collect();
    let holes = chosen.map(|l| l.rim.iter().filter_map(renumber).collect());
    Opened { quads, kept, holes }
}

/// Who neighbours whom in a mesh of quads.
struct Web {
    neighbors: BTreeMap<u32, BTreeSet<u32>>,
    faces: BTreeMap<(u32, u32), Vec<u32>>,
}

fn edge(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl Web {
    fn new(quads: &[[u32; 4]]) -> Self {
        let mut web = Self {
            neighbors: BTreeMap::new(),
            faces: BTreeMap::new(),
        };
        for (face, quad) in (0u32..).zip(quads) {
            for corner in 0..4 {
                let (a, b) = (quad[corner], quad[(corner + 1) % 4]);
                web.neighbors.entry(a).or_default().insert(b);
                web.neighbors.entry(b).or_default().insert(a);
                web.faces.entry(edge(a, b)).or_default().push(face);
            }
        }
        web
    }

    /// The end of the edge opposite to `from -> at`, if `at` has four edges.
    fn straight_on(&self, from: u32, at: u32) -> Option<u32> {
        let around = self.neighbors.get(&at).filter(|around| around.len() == 4)?;
        let beside = self.faces.get(&edge(from, at))?;
        around.iter().copied().find(|&next| {
            next != from
                && self.faces[&edge(at, next)]
                    .iter()
                    .all(|face| !beside.contains(face))
        })
    }

    /// Every closed edge loop of `edges` edges that does not cross itself.
    fn loops(&self, edges: usize) -> Vec<Vec<u32>> {
        let mut seen = BTreeSet::new();
        let mut found = Vec::new();
        for &(first, second) in self.faces.keys() {
            if seen.contains(&(first, second)) {
                continue;
            }
            let mut rim = vec![first, second];
            while rim.len() <= edges {
                match self.straight_on(rim[rim.len() - 2], rim[rim.len() - 1]) {
                    Some(next) if next != first => rim.push(next),
                    Some(_) if rim.len() == edges => {
                        seen.extend((0..edges).map(|i| edge(rim[i], rim[(i + 1) % edges])));
                        if rim.iter().collect::<BTreeSet<_>>().len() == edges {
                            found.push(rim);
                        }
                        break;
                    }
                    _ => break,
                }
            }
        }
        found
    }

    /// The smallest part of the surface that the loop cuts off, without the loop itself.
    fn enclose(&self, rim: Vec<u32>, at: &[DVec3]) -> Loop {
        let mut seen: BTreeSet<u32> = rim.iter().copied().collect();
        let mut parts: Vec<Vec<u32>> = Vec::new();
        for &start in self.neighbors.keys() {
            if !seen.insert(start) {
                continue;
            }
            let mut part = vec![start];
            let mut next = 0;
            while let Some(&vertex) = part.get(next) {
                next += 1;
                part.extend(
                    self.neighbors[&vertex]
                        .iter()
                        .filter(|&&other| seen.insert(other)),
                );
            }
            parts.push(part);
        }
        let center = rim.iter().map(|&v| at[v as usize]).sum::<DVec3>() / rim.len() as f64;
        parts.sort_by_key(Vec::len);
        let whole = parts.len() < 2;
        let enclosed = if whole {
            Vec::new()
        } else {
            parts.swap_remove(0)
        };
        Loop {
            rim,
            enclosed,
            center,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tube of `rings` rings of `around` vertices, closed by nothing.
    fn tube(rings: u32, around: u32) -> Vec<[u32; 4]> {
        let at = |ring: u32, step: u32| ring * around + step % around;
        (0..rings - 1)
            .flat_map(|r| {
                (0..around).map(move |s| [at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)])
            })
            .collect()
    }

    #[test]
    fn loops_of_a_tube_are_its_inner_rings() {
        let web = Web::new(&tube(6, 28));
        // The two end rings have vertices of three edges, which no loop passes.
        let loops = web.loops(28);
        assert_eq!(loops.len(), 4);
        assert!(web.loops(38).is_empty());
        let places = vec![DVec3::ZERO; 6 * 28];
        let sizes: Vec<usize> = loops
            .into_iter()
            .map(|rim| web.enclose(rim, &places).enclosed.len())
            .collect();
        assert_eq!(sizes, [28, 56, 56, 28]);
    }
}
