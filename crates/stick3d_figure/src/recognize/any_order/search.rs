//! The search for the chains of a body on the lines of a drawing: chain after chain, the trunk first, with the
//! likeliest partial readings kept.

use std::cell::OnceCell;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

use glam::Vec2;

use super::body::{Body, Chain};
use super::lines::{Lines, Samples};
use super::marks::Marks;
use super::ways::{Way, ways};
use crate::recognize::ink::Ink;

/// Readings that are made longer before the search is given up; it bounds the work.
const MAX_EXPANSIONS: usize = 10000;
/// When it is given up, so many of the likeliest are completed, each in so many ways.
const MAX_COMPLETED: usize = 6;
const BEAM: usize = 6;
/// The search ends when all other readings are this much less likely than the best one.
const SETTLED: f32 = 3.0;
/// What ink costs that no bone explains, per tolerance length of it.
const LEFTOVER_COST: f32 = 60.0;
/// What a bone costs where its ink is that of another bone, per tolerance length of it.
const SHARED_COST: f32 = 45.0;
/// What a chain costs that is not drawn,
const MISSING_COST: f32 = 5.0;
/// and one of which only the beginning is.
const BEGUN_COST: f32 = 6.0;
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
    pub(super) ways: Vec<Option<Rc<Way>>>,
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

/// A reading that is not finished.
struct Open {
    /// What a whole reading that begins like this costs at least.
    least_cost: f32,
    reading: Reading,
    /// Per chain what it can do at best; none while there is only a rough guess.
    rest: Option<Rc<[Rest]>>,
}

impl Open {
    fn new(reading: Reading, rest: Option<Rc<[Rest]>>, search: &Search) -> Self {
        let least_cost = match &rest {
            Some(rest) => search.least_cost(&reading, rest),
            None => search.least_cost(&reading, &search.rough_rest(&reading)),
        };
        Self {
            least_cost,
            reading,
            rest,
        }
    }
}

/// What a chain can do for a reading at best, as if no other chain were there.
#[derive(Clone, Debug)]
struct Rest {
    /// What it adds to the cost with leftover ink,
    gain: f32,
    /// and the second best of its ways.
    second_gain: f32,
    /// What it adds to the cost without leftover ink.
    cost: f32,
    /// The ink that it may explain.
    reach: Samples,
}

impl Rest {
    const MISSING: Self = Self {
        gain: MISSING_COST,
        second_gain: MISSING_COST,
        cost: MISSING_COST,
        reach: Samples::NONE,
    };
    const ANYTHING: Self = Self {
        gain: f32::NEG_INFINITY,
        second_gain: f32::NEG_INFINITY,
        cost: 0.0,
        reach: Samples::ALL,
    };

    fn consider(&mut self, gain: f32, cost: f32) {
        if gain < self.gain {
            (self.gain, self.second_gain) = (gain, self.gain);
        } else {
            self.second_gain = self.second_gain.min(gain);
        }
        self.cost = self.cost.min(cost);
    }
}

// The heap gives its greatest first: that is the one of the least cost.
impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        let longer = self.reading.ways.len().cmp(&other.reading.ways.len());
        other.least_cost.total_cmp(&self.least_cost).then(longer)
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

pub(super) struct Search<'a> {
    pub(super) body: &'a Body,
    ink: &'a Ink,
    marks: &'a Marks,
    pub(super) lines: Lines,
    places: Vec<Vec2>,
    /// The mark in the middle of the head's loop.
    head: Option<usize>,
    /// Per chain and mark, once they are needed: the ways of the chain from there.
    ways: Vec<OnceCell<Vec<Rc<Way>>>>,
    /// The same: what the best of them could do.
    rough: Vec<OnceCell<Rest>>,
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
            rough: vec![OnceCell::new(); body.chains.len() * places.len()],
            ways: vec![OnceCell::new(); body.chains.len() * places.len()],
            places,
            head: marks.head.as_ref().map(|_| marks.places.len()),
        }
    }

    /// Readings of the whole drawing, the likeliest first. None when not even the first chain is there.
    ///
    /// The first chain is tried everywhere. Readings are made longer by one chain at a time, always the one whose least
    /// cost is the lowest (A*), until no other can do better than what was found.
    pub(super) fn run(&self) -> Vec<Reading> {
        let mut open: BinaryHeap<Open> = self.trunks().into_iter().collect();
        let mut found: Vec<Reading> = Vec::new();
        let mut best = f32::INFINITY;
        let mut expansions = 0;
        while let Some(next) = open.pop() {
            if next.least_cost > best + SETTLED || expansions > MAX_EXPANSIONS {
                open.push(next);
                break;
            }
            let index = next.reading.ways.len();
            if index == self.body.chains.len() {
                best = best.min(next.reading.total_cost);
                found.push(next.reading);
                continue;
            }
            let Some(rest) = next.rest else {
                // A rough guess of what the rest of the body costs is made a better one only when it is needed.
                let rest: Rc<[Rest]> = self.rest(&next.reading).into();
                open.push(Open::new(next.reading, Some(rest), self));
                continue;
            };
            expansions += 1;
            for longer in self.with_chain(index, std::slice::from_ref(&next.reading), usize::MAX) {
                let longer = Open::new(longer, Some(rest.clone()), self);
                if longer.least_cost <= best + SETTLED {
                    open.push(longer);
                }
            }
        }
        if found.is_empty() {
            found = self.completed(open);
        }
        #[cfg(test)]
        super::EXPANSIONS.with(|e| e.set(e.get() + expansions));
        found.sort_by(|a, b| a.total_cost.total_cmp(&b.total_cost));
        found
    }

    /// All places of the first chain.
    fn trunks(&self) -> Vec<Open> {
        let all: f32 = self.marks.weights.iter().sum();
        let blank = |start| Reading {
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
        };
        let starts: Vec<Reading> = (0..self.marks.places.len()).map(blank).collect();
        let trunks = self.with_chain(0, &starts, usize::MAX);
        trunks
            .into_iter()
            .map(|trunk| Open::new(trunk, None, self))
            .collect()
    }

    /// The likeliest of the unfinished readings, finished.
    fn completed(&self, mut open: BinaryHeap<Open>) -> Vec<Reading> {
        let mut found = Vec::new();
        for _ in 0..MAX_COMPLETED {
            let Some(next) = open.pop() else { break };
            let mut readings = vec![next.reading];
            for index in readings[0].ways.len()..self.body.chains.len() {
                readings = self.with_chain(index, &readings, BEAM);
            }
            found.append(&mut readings);
        }
        found
    }

    /// What the other chains can do for a reading of the first one at best.
    fn rest(&self, trunk: &Reading) -> Vec<Rest> {
        let best_of = |index: usize, mark: usize| {
            let mut rest = Rest::MISSING;
            for (i, way) in self.ways_from(index, mark).iter().enumerate() {
                let step = self.step(index, trunk, 0, Some((i, way)), 1.0, None);
                let gain = step.total_cost - trunk.total_cost;
                rest.consider(gain, step.cost - trunk.cost);
                if gain < MISSING_COST {
                    self.ink_of(way, &mut rest.reach);
                }
            }
            rest
        };
        self.rest_of(trunk, best_of)
    }

    /// The same without regard to the trunk.
    fn rough_rest(&self, trunk: &Reading) -> Vec<Rest> {
        let unit = self.ink.tolerance_length;
        let best_of = |index: usize, mark: usize| {
            let rest = self.rough[index * self.places.len() + mark].get_or_init(|| {
                let mut rest = Rest::MISSING;
                for way in self.ways_from(index, mark) {
                    self.ink_of(way, &mut rest.reach);
                    let ink = self.ink_of(way, &mut Samples::NONE.clone()).0;
                    rest.consider(way.cost - LEFTOVER_COST * ink / unit, way.cost);
                }
                rest
            });
            rest.clone()
        };
        self.rest_of(trunk, best_of)
    }

    fn rest_of(&self, trunk: &Reading, best_of: impl Fn(usize, usize) -> Rest) -> Vec<Rest> {
        let chains = self.body.chains.iter().enumerate();
        chains
            .map(
                |(index, chain)| match (index, self.mark_of(trunk, chain.from)) {
                    (0, _) => Rest::MISSING,
                    (_, Some(mark)) => {
                        let mut rest = best_of(index, mark);
                        if chain.twin.is_some() {
                            rest.gain = rest.second_gain;
                        }
                        rest
                    }
                    // It hangs on a chain that is not placed yet, and may explain anything.
                    (_, None) => Rest::ANYTHING,
                },
            )
            .collect()
    }

    /// What a whole reading that begins like this one costs at least.
    fn least_cost(&self, reading: &Reading, rest: &[Rest]) -> f32 {
        let rest = &rest[reading.ways.len()..];
        let unit = self.ink.tolerance_length;
        let gain: f32 = rest.iter().map(|chain| chain.gain).sum();
        let cost: f32 = rest.iter().map(|chain| chain.cost).sum();
        let mut reached = reading.covered;
        for chain in rest {
            reached.add(&chain.reach);
        }
        let weights = self.marks.weights.iter().enumerate();
        let out_of_reach: f32 = weights
            .filter(|(sample, _)| !reached.contains(*sample))
            .map(|(_, weight)| weight)
            .sum();
        let alone = reading.total_cost + gain;
        alone.max(reading.cost + cost + LEFTOVER_COST * out_of_reach / unit)
    }

    fn ways_from(&self, chain: usize, mark: usize) -> &[Rc<Way>] {
        self.ways[chain * self.places.len() + mark].get_or_init(|| {
            let unit = self.ink.tolerance_length;
            let chain = &self.body.chains[chain];
            let ways = ways(chain, mark, &self.places, self.head, &self.lines, unit);
            ways.into_iter().map(Rc::new).collect()
        })
    }

    /// The length that tolerances are parts of.
    pub(super) fn unit(&self) -> f32 {
        self.ink.tolerance_length
    }

    /// The ink of a way and the lengths it stands for.
    pub(super) fn points_of(&self, way: &Way) -> Vec<(Vec2, f32)> {
        let lines = way.marks.windows(2).filter_map(|pair| {
            self.lines
                .between(usize::from(pair[0]), usize::from(pair[1]))
        });
        let touches = lines
            .flat_map(|line| &line.touches)
            .filter(|touch| touch.bin.is_some());
        touches
            .map(|touch| usize::from(touch.sample))
            .map(|sample| (self.ink.samples[sample], self.marks.weights[sample]))
            .collect()
    }

    /// Where a reading puts the joints of the figure.
    pub(super) fn joints(&self, reading: &Reading) -> Vec<Option<Vec2>> {
        let mut joints = vec![None; self.body.joint_count];
        joints[self.body.start] = self.places.get(reading.start).copied();
        for (chain, way) in self.body.chains.iter().zip(&reading.ways) {
            for (joint, place) in chain
                .joints
                .iter()
                .zip(way.iter().flat_map(|way| &way.places))
            {
                joints[*joint] = Some(*place);
            }
        }
        joints
    }

    /// All readings with one more chain, the likeliest of them kept.
    fn with_chain(&self, index: usize, readings: &[Reading], keep: usize) -> Vec<Reading> {
        let chain = &self.body.chains[index];
        let mut steps = Vec::new();
        for (from, reading) in readings.iter().enumerate() {
            if index > 0 {
                steps.push(self.step(index, reading, from, None, reading.facing, None));
            }
            let Some(mark) = self.mark_of(reading, chain.from) else {
                continue;
            };
            // Twins are told apart later, so one order of the two is enough.
            let twin = chain.twin.map(|twin| reading.ways[twin].as_deref());
            if matches!(twin, Some(None)) {
                continue;
            }
            let twin = twin.flatten();
            for (i, way) in self.ways_from(index, mark).iter().enumerate() {
                if twin.is_some_and(|twin| twin.marks > way.marks) {
                    continue;
                }
                steps.push(self.step(index, reading, from, Some((i, way)), 1.0, twin));
                if index == 0 && self.body.both_ways {
                    steps.push(self.step(index, reading, from, Some((i, way)), -1.0, twin));
                }
            }
        }
        if keep < steps.len() {
            steps.sort_by(|a, b| a.total_cost.total_cmp(&b.total_cost));
            steps.truncate(keep);
        }
        steps
            .into_iter()
            .map(|step| {
                let reading = &readings[step.from];
                let way = step.way.zip(self.mark_of(reading, chain.from));
                let way = way.and_then(|(way, mark)| self.ways_from(index, mark).get(way));
                self.grown(chain, reading, &step, way)
            })
            .collect()
    }

    fn mark_of(&self, reading: &Reading, joint: usize) -> Option<usize> {
        if joint == self.body.start {
            return Some(reading.start);
        }
        let chain = self
            .body
            .chains
            .iter()
            .position(|chain| chain.end() == joint)?;
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

    fn grown(
        &self,
        chain: &Chain,
        reading: &Reading,
        step: &Step,
        way: Option<&Rc<Way>>,
    ) -> Reading {
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
            let Some(line) = self
                .lines
                .between(usize::from(pair[0]), usize::from(pair[1]))
            else {
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
            let ratio = (a.length() / b.length().max(f32::MIN_POSITIVE))
                .max(1.0e-3)
                .ln();
            (0.5 * (ratio / SYMMETRY_SPREAD).powi(2)).min(2.5)
        })
        .sum()
}
