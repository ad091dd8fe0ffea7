//! What readings cost: negative logarithms of how likely people are to draw so.

use std::rc::Rc;

use glam::Vec2;

use super::body::Chain;
use super::lines::Samples;
use super::search::{Reading, Search, Step};
use super::ways::Way;

/// What ink costs that no bone explains, per tolerance length of it.
pub(in crate::recognize) const LEFTOVER_COST: f32 = 60.0;
/// What a bone costs where its ink is that of another bone, per tolerance length of it.
const SHARED_COST: f32 = 45.0;
/// What a chain costs that is not drawn,
pub(super) const MISSING_COST: f32 = 5.0;
/// and one of which only the beginning is.
const BEGUN_COST: f32 = 6.0;
/// What a body upside down costs, and a bone that points against its direction in the template: in the middle of
/// the body, at its sides, and for the later bones of a chain.
const ROLL_COST: f32 = 1.0;
const CENTER_COST: f32 = 1.5;
const SIDE_COST: f32 = 0.6;
const LATER_BONE_COST: f32 = 0.3;
/// Logarithms by which bones differ from the template's lengths, when longer and when shorter (foreshortened).
pub(in crate::recognize) const LONGER_SPREAD: f32 = 0.35;
pub(in crate::recognize) const SHORTER_SPREAD: f32 = 0.5;
/// The same for a head to the middle of its loop, which is drawn in any size.
const LOOP_SPREAD: f32 = 0.8;
/// Logarithm by which the two sides of the body differ.
const SYMMETRY_SPREAD: f32 = 0.6;
pub(in crate::recognize) const MAX_LENGTH_COST: f32 = 8.0;

impl Search<'_> {
    /// One more chain on a reading: missing, or on a way, beside its twin's way where there is one. `facing` is asked
    /// of the first chain alone.
    pub(super) fn step(
        &self,
        index: usize,
        reading: &Reading,
        way: Option<&Rc<Way>>,
        facing: f32,
        twin: Option<&Way>,
    ) -> Step {
        self.count(1);
        let chain = &self.body.chains[index];
        let unit = self.ink.tolerance_length;
        let (mut cost, mut leftover) = (reading.cost, reading.leftover);
        if let Some(way) = way {
            let (new, shared) = self.ink_of(way, &mut reading.covered.clone());
            leftover -= new;
            cost += way.cost + SHARED_COST * shared / unit;
            cost += self.length_cost(chain, reading, way) + symmetry_cost(way, twin);
            let (rotation, facing) = if index == 0 {
                let rotation = rotation(chain, way, facing);
                cost += ROLL_COST * (1.0 - rotation.x);
                (rotation, facing)
            } else {
                (reading.rotation, reading.facing)
            };
            cost += self.direction_cost(chain, way, rotation, facing);
            if way.bones.len() < chain.lengths.len() {
                cost += BEGUN_COST;
            }
        } else {
            cost += MISSING_COST;
        }
        Step {
            way: way.cloned(),
            facing,
            cost,
            leftover,
            total_cost: cost + LEFTOVER_COST * leftover / unit,
        }
    }

    /// A reading with one more chain.
    pub(super) fn grown(&self, reading: &Reading, step: &Step) -> Reading {
        self.count(1);
        let chain = &self.body.chains[reading.ways.len()];
        let mut grown = Reading {
            cost: step.cost,
            total_cost: step.total_cost,
            leftover: step.leftover,
            ..reading.clone()
        };
        if let Some(way) = &step.way {
            self.ink_of(way, &mut grown.covered);
            if grown.ways.is_empty() {
                grown.facing = step.facing;
                grown.rotation = rotation(chain, way, step.facing);
            }
            if !self.ends_in_loop(way) {
                for (bone, length) in way.bones.iter().zip(&chain.lengths) {
                    grown.drawn += bone.length();
                    grown.template += length;
                }
            }
        }
        grown.ways.push(step.way.clone());
        grown
    }

    fn ends_in_loop(&self, way: &Way) -> bool {
        self.head.is_some() && way.marks.last().map(|mark| usize::from(*mark)) == self.head
    }

    /// Covers the ink of a way. Gives the length of ink that it covers first, and the length of its lines whose only ink
    /// is covered already: ink drawn twice there counts for two lines.
    pub(super) fn ink_of(&self, way: &Way, covered: &mut Samples) -> (f32, f32) {
        let weights = &self.marks.weights;
        let (mut new, mut shared) = (0.0, 0.0);
        for line in self.lines_of(way) {
            let fresh = line.inner.sum_without(covered, weights);
            let used = line.drawn - fresh;
            let short = (line.needed - fresh).max(0.0);
            shared += (2.0 * short - used).clamp(0.0, short.min(used).max(0.0));
            new += line.ink.sum_without(covered, weights);
            covered.add(&line.ink);
        }
        (new, shared)
    }

    fn length_cost(&self, chain: &Chain, reading: &Reading, way: &Way) -> f32 {
        let least_scale = self.ink.diagonal / self.body.reach;
        let is_first = reading.template <= 0.0;
        let scale = if is_first {
            least_scale
        } else {
            reading.drawn / reading.template
        };
        let count = way.bones.len();
        let mut cost = 0.0;
        for (i, (bone, length)) in way.bones.iter().zip(&chain.lengths).enumerate() {
            let ratio = (bone.length() / (scale * length)).max(1.0e-3).ln();
            let spread = match (is_first, ratio > 0.0) {
                // The first bone sets the scale and may be longer than the extent tells.
                (true, true) => 2.0,
                _ if i + 1 == count && self.ends_in_loop(way) => LOOP_SPREAD,
                (_, true) => LONGER_SPREAD,
                (_, false) => SHORTER_SPREAD,
            };
            cost += (0.5 * (ratio / spread).powi(2)).min(MAX_LENGTH_COST);
        }
        cost
    }

    /// What the directions of a chain's bones cost beside the template's, turned as the trunk is turned. Neck and tail of a body
    /// seen from its side may also point as if it stood level: a horse that rears keeps its head up, and its tail hangs.
    fn direction_cost(&self, chain: &Chain, way: &Way, rotation: Vec2, facing: f32) -> f32 {
        let weight = if chain.center { CENTER_COST } else { SIDE_COST };
        let keeps_level = chain.center && self.body.both_ways;
        let bones = way.bones.iter().zip(&chain.directions).enumerate();
        bones
            .map(|(i, (bone, direction))| {
                let level = *direction * Vec2::new(facing, 1.0);
                let bone = bone.normalize_or_zero();
                let turned = rotation.rotate(level).dot(bone);
                let along = if keeps_level {
                    turned.max(level.dot(bone))
                } else {
                    turned
                };
                let weight = if i == 0 { weight } else { LATER_BONE_COST };
                weight * (1.0 - along)
            })
            .sum()
    }
}

/// How the template is turned when the first chain lies on this way.
fn rotation(chain: &Chain, way: &Way, facing: f32) -> Vec2 {
    let bones = chain.directions.iter().zip(&chain.lengths);
    let there: Vec2 = bones.map(|(direction, length)| *direction * *length).sum();
    let there = there * Vec2::new(facing, 1.0);
    let here: Vec2 = way.bones.iter().sum();
    Vec2::new(there.dot(here), there.perp_dot(here)).normalize_or(Vec2::X)
}

/// A limb beside the one of the other side.
fn symmetry_cost(way: &Way, twin: Option<&Way>) -> f32 {
    let Some(twin) = twin else { return 0.0 };
    let bones = way.bones.iter().zip(&twin.bones);
    bones
        .map(|(a, b)| {
            let ratio = (a.length() / b.length().max(f32::MIN_POSITIVE))
                .max(1.0e-3)
                .ln();
            (0.5 * (ratio / SYMMETRY_SPREAD).powi(2)).min(2.5)
        })
        .sum()
}
