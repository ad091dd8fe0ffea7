//! The ends of a body's limbs, and which of them are pairs: by distances along the surface and by how thick the limbs are,
//! both of which hardly change with the pose.

use super::surface::Surface;
use super::{LandmarkError, Tip};

/// How much the distances of two sides may differ, as a share of the longest distance.
const MOST_ASYMMETRY: f32 = 0.5;

/// How far a tip is at least from the others and from the body's middle, as a share of the farthest tip's way from there.
const LEAST_WAY: f32 = 0.25;

/// Tips of limbs, sorted into those of the middle and pairs.
#[derive(Debug)]
pub(super) struct Limbs {
    pub(super) tips: Vec<Tip>,
    /// Numbers of those without a partner.
    pub(super) middle: Vec<usize>,
    /// Numbers of those with one. The first of every pair are on one side.
    pub(super) pairs: [[usize; 2]; 2],
}

impl Limbs {
    /// The `count` points that stick out farthest, two pairs among them.
    pub(super) fn find(surface: &Surface<'_>, count: usize) -> Result<Self, LandmarkError> {
        let vertices = farthest(surface, count)?;
        let tips: Vec<Tip> = vertices
            .into_iter()
            .map(|vertex| Tip {
                vertex,
                distances: surface.distances(&[vertex]),
            })
            .collect();
        let girths = girths(surface, &tips);
        let mut limbs = Self {
            middle: vec![],
            pairs: [[0; 2]; 2],
            tips,
        };
        let mut best = f32::INFINITY;
        for pairs in pairings(count) {
            let unlike = |[a, b]: [usize; 2]| -> f32 {
                girths[a]
                    .iter()
                    .zip(&girths[b])
                    .map(|(a, b)| (a - b).abs())
                    .sum()
            };
            let asymmetry = limbs.asymmetry(&pairs) + pairs.into_iter().map(unlike).sum::<f32>();
            if asymmetry < best {
                best = asymmetry;
                limbs.pairs = pairs;
            }
        }
        limbs.middle = (0..count)
            .filter(|tip| !limbs.pairs.as_flattened().contains(tip))
            .collect();
        let [[a, b], [c, d]] = limbs.pairs;
        if limbs.between(a, d) + limbs.between(b, c) < limbs.between(a, c) + limbs.between(b, d) {
            limbs.pairs[1] = [d, c];
        }
        let longest = (0..count)
            .flat_map(|a| (0..count).map(move |b| (a, b)))
            .map(|(a, b)| limbs.between(a, b))
            .fold(0.0, f32::max);
        if best > MOST_ASYMMETRY * longest {
            return Err(LandmarkError::Asymmetric {
                tips: count,
                percent: 100.0 * best / longest,
            });
        }
        Ok(limbs)
    }

    /// The distance between two tips.
    pub(super) fn between(&self, a: usize, b: usize) -> f32 {
        self.tips[a].distances[self.tips[b].vertex as usize]
    }

    /// The distance from a tip to either of a pair, mean of both.
    pub(super) fn to_pair(&self, tip: usize, [a, b]: [usize; 2]) -> f32 {
        (self.between(tip, a) + self.between(tip, b)) / 2.0
    }

    /// How much the distances would differ that are alike if these were the pairs of a symmetric body.
    fn asymmetry(&self, pairs: &[[usize; 2]; 2]) -> f32 {
        let [[a, b], [c, d]] = *pairs;
        let alike = |p: (usize, usize), q: (usize, usize)| {
            (self.between(p.0, p.1) - self.between(q.0, q.1)).abs()
        };
        let across = alike((a, c), (b, d)) + alike((a, d), (b, c));
        (0..self.tips.len())
            .filter(|tip| !pairs.as_flattened().contains(tip))
            .map(|tip| alike((tip, a), (tip, b)) + alike((tip, c), (tip, d)))
            .sum::<f32>()
            + across
    }
}

/// The lengths of rings around every limb, from its tip on.
fn girths(surface: &Surface<'_>, tips: &[Tip]) -> Vec<Vec<f32>> {
    const RINGS: usize = 5;
    let ways = tips.iter().flat_map(|tip| {
        tips.iter()
            .map(|other| tip.distances[other.vertex as usize])
    });
    let shortest = ways.filter(|way| *way > 0.0).fold(f32::INFINITY, f32::min);
    let girths = |tip: &Tip| -> Vec<f32> {
        // Limbs that are next to each other meet half way.
        let levels = (1..=RINGS).map(|step| 0.4 * shortest * step as f32 / RINGS as f32);
        let ring = |level| surface.rings(&tip.distances, level).into_iter().next();
        levels
            .map(|level| ring(level).map_or(0.0, |ring| ring.length))
            .collect()
    };
    tips.iter().map(girths).collect()
}

/// All ways to take two pairs out of `count` things.
fn pairings(count: usize) -> Vec<[[usize; 2]; 2]> {
    let pairs: Vec<[usize; 2]> = (0..count)
        .flat_map(|b| (0..b).map(move |a| [a, b]))
        .collect();
    let mut both = vec![];
    for (i, first) in pairs.iter().enumerate() {
        for second in &pairs[..i] {
            if !second.iter().any(|tip| first.contains(tip)) {
                both.push([*first, *second]);
            }
        }
    }
    both
}

/// The summits of the distance from the body's middle that are farthest from it and from each other.
fn farthest(surface: &Surface<'_>, count: usize) -> Result<Vec<u32>, LandmarkError> {
    let start = surface.on_largest_piece().ok_or(LandmarkError::Pieces)?;
    // The middle is near to everything: here to points that lie far apart.
    let mut sum = vec![0.0_f32; surface.mesh.positions.len()];
    let mut far = vec![start];
    for _ in 0..2 * count {
        far.push(highest(&surface.distances(&far), |_| true)?);
    }
    for point in &far[1..] {
        for (sum, distance) in sum.iter_mut().zip(surface.distances(&[*point])) {
            *sum += distance;
        }
    }
    let middle = (0_u32..)
        .zip(&sum)
        .filter(|(_, sum)| sum.is_finite())
        .min_by(|a, b| a.1.total_cmp(b.1))
        .ok_or(LandmarkError::Pieces)?
        .0;
    let out = surface.distances(&[middle]);
    let mut chosen = vec![middle];
    for found in 0..count {
        let free = surface.distances(&chosen);
        let next = highest(&free, |vertex| surface.is_summit(vertex, &out))?;
        let [way, farthest] = [next, chosen.get(1).copied().unwrap_or(next)].map(|v| v as usize);
        if free[way] < LEAST_WAY * out[farthest] {
            let needed = count;
            return Err(LandmarkError::Limbs { found, needed });
        }
        chosen.push(next);
    }
    Ok(chosen.split_off(1))
}

fn highest(field: &[f32], allowed: impl Fn(u32) -> bool) -> Result<u32, LandmarkError> {
    (0_u32..)
        .zip(field)
        .filter(|(vertex, value)| value.is_finite() && allowed(*vertex))
        .max_by(|a, b| a.1.total_cmp(b.1))
        .map(|(vertex, _)| vertex)
        .ok_or(LandmarkError::Pieces)
}
