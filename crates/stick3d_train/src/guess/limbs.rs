//! The limbs of a body: pairs of chains that leave its middle plane.

use stick3d_figure::Side;

use super::body::Body;
use super::symmetry::Symmetry;

/// A limb that comes this near to the ground stands on it, as a share of the body's height.
const STANDS: f32 = 0.12;

/// A leg is at least this long, as a share of the longest.
const LEG: f32 = 0.5;

/// The mirror images of one limb.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LimbPair {
    /// From the trunk outward, the left one and the right one.
    pub(super) chains: [Vec<usize>; 2],
    /// How long it is along its bones, metres: the shorter of both.
    pub(super) length_m: f32,
    /// How high the lowest point of the higher one is above the ground, metres.
    pub(super) above_ground_m: f32,
}

impl LimbPair {
    /// The limb of a side.
    pub(super) fn of(&self, side: Side) -> &[usize] {
        &self.chains[usize::from(side == Side::Right)]
    }

    /// Both chains.
    pub(super) fn bones(&self) -> impl Iterator<Item = usize> + '_ {
        self.chains.iter().flatten().copied()
    }

    /// The first bones of both.
    pub(super) fn roots(&self) -> [usize; 2] {
        [self.chains[0][0], self.chains[1][0]]
    }
}

/// All limbs of a body, sorted by what they do.
#[derive(Debug, Clone, Default)]
pub(super) struct Limbs {
    /// Those that the body stands on, longest first.
    pub(super) legs: Vec<LimbPair>,
    /// The others, longest first.
    pub(super) free: Vec<LimbPair>,
}

impl Limbs {
    /// Finds the pairs of chains whose first bones hang on the middle of the body.
    pub(super) fn find(body: &Body, symmetry: &Symmetry) -> Self {
        let middle = |bone: usize| symmetry.sides[bone] == Side::Center;
        let leaves_middle =
            |bone: &usize| !middle(*bone) && body.bones[*bone].parent.is_none_or(middle);
        let mut limbs = Self::default();
        let lefts = body.living().filter(leaves_middle);
        for left in lefts.filter(|&bone| symmetry.sides[bone] == Side::Left) {
            let partner = symmetry.partners[left].filter(leaves_middle);
            let Some(right) = partner.filter(|&bone| body.bones[bone].lives) else {
                continue;
            };
            let both = [left, right];
            let trimming = both.iter().any(|&bone| body.bones[bone].says.trimming);
            let pair = LimbPair {
                chains: both.map(|bone| body.chain(bone)),
                length_m: both
                    .map(|b| body.bones[b].reach_m)
                    .into_iter()
                    .fold(f32::INFINITY, f32::min),
                above_ground_m: both
                    .map(|b| body.low_m(b) - body.ground_m)
                    .into_iter()
                    .fold(f32::NEG_INFINITY, f32::max),
            };
            let stands = pair.above_ground_m <= STANDS * body.height_m;
            if trimming {
                continue;
            }
            if stands {
                limbs.legs.push(pair);
            } else {
                limbs.free.push(pair);
            }
        }
        let longest_first = |a: &LimbPair, b: &LimbPair| b.length_m.total_cmp(&a.length_m);
        limbs.legs.sort_by(longest_first);
        limbs.free.sort_by(longest_first);
        let longest_m = limbs.legs.first().map_or(0.0, |leg| leg.length_m);
        limbs.legs.retain(|leg| leg.length_m >= LEG * longest_m);
        limbs
    }
}
