//! The search for the chains of a body on the lines of a drawing: chain after chain, the trunk first, with the
//! likeliest partial readings kept.

use glam::Vec2;

use super::body::{Body, Chain};
use super::lines::{Lines, Samples};
use super::marks::Marks;
use super::ways::{Way, ways};
use crate::recognize::ink::Ink;

/// Partial readings kept after each chain.
const BEAM: usize = 100;
/// Those this much less likely than the best are dropped.
const BEAM_COST: f32 = 40.0;
/// What ink costs that no bone explains, per tolerance length of it.
const LEFTOVER_COST: f32 = 60.0;
/// What a bone costs where its ink is that of another bone, per tolerance length of it.
const SHARED_COST: f32 = 45.0;
/// What a chain costs that is not drawn,
const MISSING_COST: f32 = 5.0;
/// and one of which only the beginning is.
const BEGUN_COST: f32 = 4.0;
/// What a body upside down costs, and a bone that points against its direction in the template: in the middle of
/// the body, at its sides, and for the later bones of a chain.
const ROLL_COST: f32 = 1.0;
const CENTER_COST: f32 = 1.5;
const SIDE_COST: f32 = 0.6;
const LATER_BONE_COST: f32 = 0.3;
/// Logarithms by which bones differ from the template's lengths, when longer and when shorter (foreshortened).
const LONGER_SPREAD: f32 = 0.35;
const SHORTER_SPREAD: f32 = 0.5;
/// The same for a head to the middle of its loop, which is drawn in any size.
const LOOP_SPREAD: f32 = 0.8;
/// Logarithm by which the two sides of the body differ.
const SYMMETRY_SPREAD: f32 = 0.6;
const MAX_LENGTH_COST: f32 = 8.0;

/// A reading of the first chains.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    /// Negative logarithm of its likelihood, leftover ink not counted.
    cost: f32,
    /// The same with leftover ink.
    pub(super) total_cost: f32,
    covered: Samples,
    /// The length of ink that no bone explains.
    pub(super) leftover: f32,
    /// Length of all bones so far, in the drawing and in the template.
    drawn: f32,
    template: f32,
    /// Which way round the template is: turned by this rotation after its x is multiplied by `facing`.
    rotation: Vec2,
    facing: f32,
    start: usize,
    /// Per chain the way it takes; none where it is missing.
    pub(super) ways: Vec<Option<Way>>,
}

/// One step from a reading to a longer one.
struct Step {
    from: usize,
    way: Option<usize>,
    facing: f32,
    cost: f32,
    leftover: f32,
    total_cost: f32,
}

pub(super) struct Search<'a> {
    pub(super) body: &'a Body,
    ink: &'a Ink,
    marks: &'a Marks,
    lines: Lines,
    places: Vec<Vec2>,
    /// The mark in the middle of the head's loop.
    head: Option<usize>,
}

impl<'a> Search<'a> {
    pub(super) fn new(body: &'a Body, ink: &'a Ink, marks: &'a Marks) -> Self {
        let mut places = marks.places.clone();
        places.extend(marks.head.iter().map(|head| head.center));
        Self {
            body,
            ink,
            marks,
            lines: Lines::new(ink, marks),
            places,
            head: marks.head.as_ref().map(|_| marks.places.len()),
        }
    }

    /// Readings of the whole drawing, the likeliest first. None when not even the first chain is there.
    pub(super) fn run(&self) -> Vec<Reading> {
        let all: f32 = self.marks.weights.iter().sum();
        let mut readings: Vec<Reading> = (0..self.marks.places.len())
            .map(|start| Reading {
                cost: 0.0,
                total_cost: 0.0,
                covered: Samples::NONE,
                leftover: all,
                drawn: 0.0,
                template: 0.0,
                rotation: Vec2::X,
                facing: 1.0,
                start,
                ways: Vec::new(),
            })
            .collect();
        for chain in 0..self.body.chains.len() {
            readings = self.with_chain(chain, &readings);
        }
        readings
    }

    /// Where a reading puts the joints of the figure.
    pub(super) fn joints(&self, reading: &Reading) -> Vec<Option<Vec2>> {
        let mut joints = vec![None; self.body.joint_count];
        joints[self.body.start] = self.places.get(reading.start).copied();
        for (chain, way) in self.body.chains.iter().zip(&reading.ways) {
            for (joint, place) in chain.joints.iter().zip(way.iter().flat_map(|way| &way.places)) {
                joints[*joint] = Some(*place);
            }
        }
        joints
    }

    /// All readings with one more chain, the likeliest of them kept.
    fn with_chain(&self, index: usize, readings: &[Reading]) -> Vec<Reading> {
        let chain = &self.body.chains[index];
        let mut ways_from: Vec<Option<Vec<Way>>> = vec![None; self.places.len()];
        let mut steps = Vec::new();
        for (from, reading) in readings.iter().enumerate() {
            if index > 0 {
                steps.push(self.step(index, reading, from, None, reading.facing, None));
            }
            let Some(mark) = self.mark_of(reading, chain.from) else {
                continue;
            };
            let ways = ways_from[mark].get_or_insert_with(|| {
                let unit = self.ink.tolerance_length;
                ways(chain, mark, &self.places, self.head, &self.lines, unit)
            });
            // Twins are told apart later, so one order of the two is enough.
            let twin = chain.twin.map(|twin| reading.ways[twin].as_ref());
            if matches!(twin, Some(None)) {
                continue;
            }
            let twin = twin.flatten();
            for (i, way) in ways.iter().enumerate() {
                if twin.is_some_and(|twin| twin.marks > way.marks) {
                    continue;
                }
                steps.push(self.step(index, reading, from, Some((i, way)), 1.0, twin));
                if index == 0 && self.body.both_ways {
                    steps.push(self.step(index, reading, from, Some((i, way)), -1.0, twin));
                }
            }
        }
        steps.sort_by(|a, b| a.total_cost.total_cmp(&b.total_cost));
        let limit = steps.first().map_or(0.0, |best| best.total_cost + BEAM_COST);
        steps.truncate(if index == 0 { 4 * BEAM } else { BEAM });
        steps.retain(|step| step.total_cost <= limit);
        steps
            .into_iter()
            .map(|step| {
                let reading = &readings[step.from];
                let mark = self.mark_of(reading, chain.from);
                let ways = mark.and_then(|mark| ways_from[mark].as_ref());
                let way = step.way.and_then(|way| ways.and_then(|ways| ways.get(way)));
                self.grown(chain, reading, &step, way)
            })
            .collect()
    }

    fn mark_of(&self, reading: &Reading, joint: usize) -> Option<usize> {
        if joint == self.body.start {
            return Some(reading.start);
        }
        let chain = self.body.chains.iter().position(|chain| chain.end() == joint)?;
        let way = reading.ways.get(chain)?.as_ref()?;
        way.marks.last().map(|mark| usize::from(*mark))
    }

    /// A reading with one more chain that is missing, or lies on a way.
    fn step(
        &self,
        index: usize,
        reading: &Reading,
        from: usize,
        way: Option<(usize, &Way)>,
        facing: f32,
        twin: Option<&Way>,
    ) -> Step {
        let chain = &self.body.chains[index];
        let unit = self.ink.tolerance_length;
        let (mut cost, mut leftover) = (reading.cost, reading.leftover);
        if let Some((_, way)) = way {
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
            cost += direction_cost(chain, way, rotation, facing);
            if way.bones.len() < chain.lengths.len() {
                cost += BEGUN_COST;
            }
        } else {
            cost += MISSING_COST;
        }
        Step {
            from,
            way: way.map(|(i, _)| i),
            facing,
            cost,
            leftover,
            total_cost: cost + LEFTOVER_COST * leftover / unit,
        }
    }

    fn grown(&self, chain: &Chain, reading: &Reading, step: &Step, way: Option<&Way>) -> Reading {
        let mut grown = Reading {
            cost: step.cost,
            total_cost: step.total_cost,
            leftover: step.leftover,
            ..reading.clone()
        };
        if let Some(way) = way {
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
        grown.ways.push(way.cloned());
        grown
    }

    fn ends_in_loop(&self, way: &Way) -> bool {
        self.head.is_some() && way.marks.last().map(|mark| usize::from(*mark)) == self.head
    }

    /// Covers the ink of a way. Gives the length of ink that it covers first, and the length of its lines whose only ink
    /// is covered already: ink drawn twice there counts for two lines.
    fn ink_of(&self, way: &Way, covered: &mut Samples) -> (f32, f32) {
        let (mut new, mut shared) = (0.0, 0.0);
        for pair in way.marks.windows(2) {
            let Some(line) = self.lines.between(usize::from(pair[0]), usize::from(pair[1])) else {
                continue;
            };
            let bin_length = line.bin_length();
            // Per bin the length of new ink and of ink that was covered before.
            let mut bins = [(0.0_f32, 0.0_f32); 64];
            for touch in &line.touches {
                let weight = self.marks.weights[usize::from(touch.sample)];
                let is_new = covered.insert(usize::from(touch.sample));
                new += if is_new { weight } else { 0.0 };
                if let Some(bin) = touch.bin.and_then(|bin| bins.get_mut(usize::from(bin))) {
                    if is_new {
                        bin.0 += weight;
                    } else {
                        bin.1 += weight;
                    }
                }
            }
            let (mut fresh, mut used, mut needed) = (0.0, 0.0, 0.0);
            for (bin, free) in bins.iter().zip(&line.free) {
                if !free {
                    needed += bin_length;
                    fresh += bin.0;
                    used += bin.1;
                }
            }
            let short: f32 = (needed - fresh).max(0.0);
            shared += (2.0 * short - used).clamp(0.0, short.min(used));
        }
        (new, shared)
    }

    fn length_cost(&self, chain: &Chain, reading: &Reading, way: &Way) -> f32 {
        let least_scale = self.ink.diagonal / self.body.reach;
        let is_first = reading.template <= 0.0;
        let scale = if is_first { least_scale } else { reading.drawn / reading.template };
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
}

/// How the template is turned when the first chain lies on this way.
fn rotation(chain: &Chain, way: &Way, facing: f32) -> Vec2 {
    let bones = chain.directions.iter().zip(&chain.lengths);
    let there: Vec2 = bones.map(|(direction, length)| *direction * *length).sum();
    let there = there * Vec2::new(facing, 1.0);
    let here: Vec2 = way.bones.iter().sum();
    Vec2::new(there.dot(here), there.perp_dot(here)).normalize_or(Vec2::X)
}

fn direction_cost(chain: &Chain, way: &Way, rotation: Vec2, facing: f32) -> f32 {
    let weight = if chain.center { CENTER_COST } else { SIDE_COST };
    let bones = way.bones.iter().zip(&chain.directions).enumerate();
    bones
        .map(|(i, (bone, direction))| {
            let there = rotation.rotate(*direction * Vec2::new(facing, 1.0));
            let weight = if i == 0 { weight } else { LATER_BONE_COST };
            weight * (1.0 - there.dot(bone.normalize_or_zero()))
        })
        .sum()
}

/// A limb beside the one of the other side.
fn symmetry_cost(way: &Way, twin: Option<&Way>) -> f32 {
    let Some(twin) = twin else { return 0.0 };
    let bones = way.bones.iter().zip(&twin.bones);
    bones
        .map(|(a, b)| {
            let ratio = (a.length() / b.length().max(f32::MIN_POSITIVE)).max(1.0e-3).ln();
            (0.5 * (ratio / SYMMETRY_SPREAD).powi(2)).min(2.5)
        })
        .sum()
}
