//! The search for the chains of a body on the lines of a drawing: one chain after the other, the trunk first, always
//! on from the reading that can still become the likeliest (A*).

use std::cell::{Cell, OnceCell};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

use glam::Vec2;

use super::body::Body;
use super::cost::LEFTOVER_COST;
use super::lines::{Line, Lines, Samples};
use super::marks::Marks;
use super::rest::Rest;
use super::ways::{Way, ways};
use crate::recognize::ink::Ink;

/// Ways and steps that are looked at before the search is given up; it bounds the work. Each takes about half a
/// microsecond, and half of all drawings of a figure need ten to twenty thousand.
pub(super) const MAX_WORK: u32 = 60_000;
/// When it is given up, so many of the likeliest are completed, each in so many ways.
const MAX_COMPLETED: usize = 2;
const BEAM: usize = 4;
/// How much a chain that is placed counts when the next reading is chosen: without it many drawings would have no whole
/// reading before the search is given up.
const HASTE: f32 = 1.0;
/// The search ends when all other readings are this much less likely than the best one.
const SETTLED: f32 = 2.0;

/// A reading of the first chains.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    /// Negative logarithm of its likelihood, leftover ink not counted.
    pub(super) cost: f32,
    /// The same with leftover ink.
    pub(super) total_cost: f32,
    pub(super) covered: Samples,
    /// The length of ink that no bone explains.
    pub(super) leftover: f32,
    /// Length of all bones so far, in the drawing and in the template.
    pub(super) drawn: f32,
    pub(super) template: f32,
    /// Which way round the template is: turned by this rotation after its x is multiplied by `facing`.
    pub(super) rotation: Vec2,
    pub(super) facing: f32,
    pub(super) start: usize,
    /// Per chain the way it takes; none where it is missing.
    pub(super) ways: Vec<Option<Rc<Way>>>,
}

/// One more chain: missing, or on a way.
pub(super) struct Step {
    pub(super) way: Option<Rc<Way>>,
    /// Of the first chain: which way the body faces.
    pub(super) facing: f32,
    pub(super) cost: f32,
    pub(super) leftover: f32,
    pub(super) total_cost: f32,
}

/// A reading that is not finished.
struct Open {
    /// What a whole reading that begins like this costs at least.
    least_cost: f32,
    /// How many chains it has.
    chains: usize,
    reading: Rc<Reading>,
    bound: Bound,
    /// Per chain what it can do at best.
    rest: Rc<[Rest]>,
}

/// How well the least cost of a reading is known.
enum Bound {
    /// As well as can be.
    Close,
    /// Roughly, for the reading with one more step.
    Step(Step),
    /// Roughly, for a reading of the first chain.
    Trunk,
}

// The heap gives its greatest first: that is the one of the least cost.
impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        let hasty = |open: &Self| open.least_cost - HASTE * open.chains as f32;
        let longer = self.chains.cmp(&other.chains);
        hasty(other).total_cmp(&hasty(self)).then(longer)
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

/// The search over one drawing.
pub(super) struct Search<'a> {
    pub(super) body: &'a Body,
    pub(super) ink: &'a Ink,
    pub(super) marks: &'a Marks,
    /// All of the ink.
    pub(super) all: Samples,
    pub(super) lines: Lines,
    pub(super) places: Vec<Vec2>,
    /// The mark in the middle of the head's loop.
    pub(super) head: Option<usize>,
    /// Per chain and mark, once they are needed: the ways of the chain from there.
    ways: Vec<OnceCell<Vec<Rc<Way>>>>,
    /// The same: what the best of them could do.
    pub(super) rough: Vec<OnceCell<Rest>>,
    /// How many ways and steps were looked at.
    work: Cell<u32>,
}

impl<'a> Search<'a> {
    pub(super) fn new(body: &'a Body, ink: &'a Ink, marks: &'a Marks) -> Self {
        let mut all = Samples::NONE;
        (0..ink.samples.len()).for_each(|sample| all.insert(sample));
        let mut places = marks.places.clone();
        places.extend(marks.head.iter().map(|head| head.center));
        Self {
            body,
            ink,
            marks,
            all,
            lines: Lines::new(ink, marks),
            rough: vec![OnceCell::new(); body.chains.len() * places.len()],
            ways: vec![OnceCell::new(); body.chains.len() * places.len()],
            places,
            head: marks.head.as_ref().map(|_| marks.places.len()),
            work: Cell::new(0),
        }
    }

    /// Counts what was looked at.
    pub(super) fn count(&self, looks: usize) {
        self.work.set(self.work.get().saturating_add(looks as u32));
    }

    /// How many ways and steps were looked at so far.
    pub(super) fn work(&self) -> u32 {
        self.work.get()
    }

    /// Readings of the whole drawing, the likeliest first. None when not even the first chain is there.
    pub(super) fn run(&self) -> Vec<Reading> {
        let mut open: BinaryHeap<Open> = self.trunks().into_iter().collect();
        let mut found: Vec<Reading> = Vec::new();
        let mut best = f32::INFINITY;
        while let Some(next) = open.pop() {
            if self.work() > MAX_WORK {
                open.push(next);
                break;
            }
            if next.least_cost > best + SETTLED {
                continue;
            }
            // A rough bound is made a close one only when it is needed.
            match next.bound {
                Bound::Step(step) => {
                    open.push(self.close(self.grown(&next.reading, &step).into(), next.rest));
                }
                Bound::Trunk => {
                    let rest = self.rest(&next.reading).into();
                    open.push(self.close(next.reading, rest));
                }
                Bound::Close if next.chains == self.body.chains.len() => {
                    best = best.min(next.reading.total_cost);
                    found.push((*next.reading).clone());
                }
                Bound::Close => {
                    let longer = self.longer(&next);
                    open.extend(longer.filter(|longer| longer.least_cost <= best + SETTLED));
                }
            }
        }
        if found.is_empty() {
            found = self.completed(open);
        }
        found.sort_by(|a, b| a.total_cost.total_cmp(&b.total_cost));
        found
    }

    fn close(&self, reading: Rc<Reading>, rest: Rc<[Rest]>) -> Open {
        Open {
            least_cost: self.least_cost(&reading, &rest),
            chains: reading.ways.len(),
            reading,
            bound: Bound::Close,
            rest,
        }
    }

    /// All ways to go on from a reading by one chain.
    fn longer(&self, next: &Open) -> impl Iterator<Item = Open> {
        let gain: f32 = next.rest[next.chains + 1..]
            .iter()
            .map(|chain| chain.gain)
            .sum();
        let all = || self.ways_of(next.chains, &next.reading);
        let ways = next.rest[next.chains].ways.as_deref().unwrap_or_else(all);
        self.steps(next.chains, &next.reading, ways)
            .into_iter()
            .map(move |step| Open {
                least_cost: next.least_cost.max(step.total_cost + gain),
                chains: next.chains + 1,
                reading: next.reading.clone(),
                bound: Bound::Step(step),
                rest: next.rest.clone(),
            })
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
        let mut trunks = Vec::new();
        for start in (0..self.marks.places.len()).map(blank) {
            let steps = self.steps(0, &start, self.ways_from(0, start.start));
            trunks.extend(steps.iter().map(|step| self.grown(&start, step)));
        }
        // The likeliest first: for the others there may be no time.
        trunks.sort_by(|a, b| a.total_cost.total_cmp(&b.total_cost));
        let in_time = |_: &Reading| self.work() < MAX_WORK / 3;
        let bounded = trunks.into_iter().take_while(in_time);
        bounded
            .map(|trunk| Open {
                least_cost: self.least_cost(&trunk, &self.rough_rest(&trunk)),
                chains: 1,
                reading: trunk.into(),
                bound: Bound::Trunk,
                rest: Rc::new([]),
            })
            .collect()
    }

    /// The likeliest of the unfinished readings, finished.
    fn completed(&self, mut open: BinaryHeap<Open>) -> Vec<Reading> {
        let mut found = Vec::new();
        for _ in 0..MAX_COMPLETED {
            let Some(next) = open.pop() else { break };
            let mut readings = vec![match &next.bound {
                Bound::Step(step) => self.grown(&next.reading, step),
                _ => (*next.reading).clone(),
            }];
            for index in next.chains..self.body.chains.len() {
                let mut longer: Vec<(usize, Step)> = Vec::new();
                for (from, reading) in readings.iter().enumerate() {
                    let steps = self.steps(index, reading, self.ways_of(index, reading));
                    longer.extend(steps.into_iter().map(|step| (from, step)));
                }
                longer.sort_by(|a, b| a.1.total_cost.total_cmp(&b.1.total_cost));
                let longer = longer.iter().take(BEAM);
                readings = longer
                    .map(|(from, step)| self.grown(&readings[*from], step))
                    .collect();
            }
            found.append(&mut readings);
        }
        found
    }

    /// All that one more chain can do: be missing, or lie on one of these ways. The first chain is never missing.
    fn steps(&self, index: usize, reading: &Reading, ways: &[Rc<Way>]) -> Vec<Step> {
        let chain = &self.body.chains[index];
        let mut steps = Vec::new();
        if index > 0 {
            steps.push(self.step(index, reading, None, 1.0, None));
        }
        // Twins are told apart later, so one order of the two is enough, and a single one is the first.
        let twin = chain.twin.map(|twin| reading.ways[twin].as_deref());
        if matches!(twin, Some(None)) {
            return steps;
        }
        let twin = twin.flatten();
        for way in ways {
            if twin.is_some_and(|twin| twin.marks > way.marks) {
                continue;
            }
            steps.push(self.step(index, reading, Some(way), 1.0, twin));
            if index == 0 && self.body.both_ways {
                steps.push(self.step(index, reading, Some(way), -1.0, twin));
            }
        }
        steps
    }

    /// The ways of a chain from where a reading has the joint on which it hangs.
    fn ways_of(&self, chain: usize, reading: &Reading) -> &[Rc<Way>] {
        let mark = self.mark_of(reading, self.body.chains[chain].from);
        mark.map_or(&[], |mark| self.ways_from(chain, mark))
    }

    /// The ways of a chain from a mark.
    pub(super) fn ways_from(&self, chain: usize, mark: usize) -> &[Rc<Way>] {
        self.ways[chain * self.places.len() + mark].get_or_init(|| {
            let unit = self.ink.tolerance_length;
            let chain = &self.body.chains[chain];
            let found = ways(chain, mark, &self.places, self.head, &self.lines, unit);
            self.count(found.looks);
            found.ways.into_iter().map(Rc::new).collect()
        })
    }

    /// The mark where a reading has a joint in which chains meet.
    pub(super) fn mark_of(&self, reading: &Reading, joint: usize) -> Option<usize> {
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

    /// What it costs to explain none of the ink.
    pub(super) fn cost_of_nothing(&self) -> f32 {
        LEFTOVER_COST * self.marks.weights.iter().sum::<f32>() / self.unit()
    }

    /// The length that tolerances are parts of.
    pub(super) fn unit(&self) -> f32 {
        self.ink.tolerance_length
    }

    /// The ink of a way and the lengths it stands for.
    pub(super) fn points_of(&self, way: &Way) -> Vec<(Vec2, f32)> {
        let ink = |sample: &usize| self.lines_of(way).any(|line| line.ink.contains(*sample));
        let samples = (0..self.ink.samples.len()).filter(ink);
        samples
            .map(|sample| (self.ink.samples[sample], self.marks.weights[sample]))
            .collect()
    }

    /// The lines of a way.
    pub(super) fn lines_of(&self, way: &Way) -> impl Iterator<Item = &Line> {
        let pairs = way.marks.windows(2);
        pairs.filter_map(|pair| {
            self.lines
                .between(usize::from(pair[0]), usize::from(pair[1]))
        })
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
}
