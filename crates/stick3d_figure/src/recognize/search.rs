//! The search for the samples at which the path's points were drawn: dynamic programming over the samples in
//! drawing order, with several hypotheses per state, since a joint drawn twice must be drawn at one place.

use super::cost::{LIFT_SPREAD, RETRACE_SPREAD, SHORTCUT_COST, UNDRAWN_BONE_COST, habit_cost};
use super::ink::Ink;
use super::plan::Plan;

/// How much is tried.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Hypotheses kept per sample.
    beam: usize,
    /// Hypotheses this much less likely than the best of their sample are dropped.
    beam_cost: f32,
    /// Pieces of ink bent more than this are no bone.
    max_straightness_cost: f32,
}

impl Effort {
    /// For drawings as people make them.
    pub(super) const USUAL: Self = Self {
        beam: 18,
        beam_cost: 20.0,
        max_straightness_cost: 25.0,
    };
    /// For crooked ones, where the usual effort finds nothing.
    pub(super) const GREAT: Self = Self {
        beam: 8,
        beam_cost: 150.0,
        max_straightness_cost: 500.0,
    };
}

/// Samples of one joint nearer than this count as one place when hypotheses are compared.
const SAME_PLACE_SAMPLES: u16 = 4;

const UNVISITED: u16 = u16::MAX;
const NO_NODE: u32 = u32::MAX;

/// Path points placed so far, the last of them at `sample`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) cost: f32,
    pub(super) previous: u32,
    pub(super) path_index: u16,
    pub(super) sample: u16,
    /// Length of all bones drawn for the first time, in the drawing and in the template: their ratio is its scale.
    pub(super) drawn_length: f32,
    pub(super) drawn_template: f32,
    /// In how many middles of limbs the pen was lifted, and in how many not.
    pub(super) lifts: u8,
    pub(super) passes: u8,
    /// How many limbs were drawn back, and after how many the pen was lifted and the way back skipped.
    pub(super) retraced: u8,
    pub(super) skipped: u8,
}

/// A node and what of its past matters for its future: its path index and where its open joints are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) key: u64,
    pub(super) id: u32,
}

/// The search over one drawing.
pub(super) struct Search<'a> {
    pub(super) plan: &'a Plan,
    pub(super) ink: &'a Ink,
    effort: Effort,
    pub(super) nodes: Vec<Node>,
    /// Per node and joint: the sample of the latest visit.
    latest: Vec<u16>,
    /// Per sample: nodes whose last path point lies there.
    pub(super) at_sample: Vec<Vec<Entry>>,
    /// Per sample: the fewest path steps that the ink after it needs, one per stroke. Who has fewer left is lost.
    steps_needed: Vec<usize>,
    /// Per sample: the least cost of them.
    cheapest: Vec<f32>,
}

impl<'a> Search<'a> {
    pub(super) fn run(plan: &'a Plan, ink: &'a Ink, effort: Effort) -> Self {
        let mut search = Self {
            plan,
            ink,
            effort,
            nodes: Vec::new(),
            latest: Vec::new(),
            at_sample: vec![Vec::new(); ink.samples.len()],
            steps_needed: steps_needed(ink),
            cheapest: vec![f32::INFINITY; ink.samples.len()],
        };
        let start = Node {
            cost: 0.0,
            previous: NO_NODE,
            path_index: 0,
            sample: 0,
            drawn_length: 0.0,
            drawn_template: 0.0,
            lifts: 0,
            passes: 0,
            retraced: 0,
            skipped: 0,
        };
        search.insert(start, None);
        for stroke in 0..ink.strokes.len() {
            search.expand_stroke(stroke);
        }
        search
    }

    fn expand_stroke(&mut self, stroke: usize) {
        let range = self.ink.strokes[stroke].clone();
        let last = range.end - 1;
        for from in range {
            self.prune(from);
            let alive = self.at_sample[from].clone();
            if alive.is_empty() {
                continue;
            }
            let mut too_bent = 0;
            for to in from + 1..=last {
                let cost = self.ink.straightness_cost(from, to);
                if cost > self.effort.max_straightness_cost {
                    too_bent += 1;
                    if too_bent > 4 {
                        break;
                    }
                    continue;
                }
                let limit = self.limit(to);
                for entry in &alive {
                    // Sorted by cost: whatever follows is dearer still.
                    if self.nodes[entry.id as usize].cost + cost > limit {
                        break;
                    }
                    self.draw(entry.id, to, cost);
                }
            }
            if from == last && stroke + 1 < self.ink.strokes.len() {
                for entry in &alive {
                    self.lift(entry.id);
                }
            }
        }
    }

    /// Keeps the best hypotheses whose last path point lies at `sample`.
    fn prune(&mut self, sample: usize) {
        let nodes = &self.nodes;
        let alive = &mut self.at_sample[sample];
        let limit = self.cheapest[sample] + self.effort.beam_cost;
        alive.retain(|entry| nodes[entry.id as usize].cost <= limit);
        alive.sort_by(|a, b| {
            nodes[a.id as usize]
                .cost
                .total_cmp(&nodes[b.id as usize].cost)
        });
        alive.truncate(self.effort.beam);
    }

    pub(super) fn latest_of(&self, id: u32) -> &[u16] {
        let count = self.plan.joint_count;
        &self.latest[id as usize * count..][..count]
    }

    /// One more bone, or a shortcut over several that were drawn before, from where node `id` is to sample `to`.
    fn draw(&mut self, id: u32, to: usize, straightness_cost: f32) {
        let from = self.nodes[id as usize];
        let k = usize::from(from.path_index);
        let mut shortcut_cost = 0.0;
        for next in k + 1..=self.plan.end() {
            let step = &self.plan.steps[next - 1];
            if next > k + 1 && !step.retrace {
                break;
            }
            let chord = self.ink.samples[usize::from(from.sample)].distance(self.ink.samples[to]);
            let mut node = Node {
                cost: from.cost + straightness_cost + self.corner_cost(&from) + shortcut_cost,
                previous: id,
                path_index: next as u16,
                sample: to as u16,
                ..from
            };
            if self.plan.mid_limb[k] {
                node.cost += habit_cost(from.passes, from.lifts);
                node.passes = node.passes.saturating_add(1);
            }
            if step.retrace {
                let before = self.latest_of(id)[step.joint];
                node.cost += self.distance_cost(before, to, RETRACE_SPREAD);
                if self.plan.turns_back(k) {
                    node.cost += habit_cost(from.retraced, from.skipped);
                    node.retraced = node.retraced.saturating_add(1);
                }
            } else {
                node.cost += self.length_cost(&from, chord, step.template_length);
                node.cost += self.symmetry_cost(id, k, chord);
                if self.plan.mid_limb[k] {
                    node.cost += self.fold_cost(&from, to);
                }
                node.drawn_length += chord;
                node.drawn_template += step.template_length;
            }
            self.insert(node, Some(id));
            if !step.retrace {
                break;
            }
            shortcut_cost += SHORTCUT_COST;
        }
    }

    /// The pen was lifted where node `id` is; the next stroke starts at the same joint, or at a later one when the
    /// bones between were drawn before.
    fn lift(&mut self, id: u32) {
        let from = self.nodes[id as usize];
        let k = usize::from(from.path_index);
        let to = usize::from(from.sample) + 1;
        let mut base = Node {
            previous: id,
            sample: to as u16,
            ..from
        };
        if self.plan.mid_limb[k] {
            base.cost += habit_cost(from.lifts, from.passes);
            base.lifts = base.lifts.saturating_add(1);
        }
        // `end` itself has nothing left to draw.
        for next in k..self.plan.end() {
            let mut node = Node {
                path_index: next as u16,
                ..base
            };
            let new_bone = next > k && !self.plan.steps[next - 1].retrace;
            if new_bone {
                let length = self.plan.steps[next - 1].template_length;
                let start = self.latest_of(id)[self.plan.path[next - 1]];
                let chord = self.ink.samples[usize::from(start)].distance(self.ink.samples[to]);
                node.cost += UNDRAWN_BONE_COST + self.length_cost(&from, chord, length);
                node.drawn_length += chord;
                node.drawn_template += length;
            } else {
                let before = self.latest_of(id)[self.plan.path[next]];
                node.cost += self.distance_cost(before, to, LIFT_SPREAD);
                if next > k && self.plan.turns_back(k) {
                    node.cost += habit_cost(from.skipped, from.retraced);
                    node.skipped = node.skipped.saturating_add(1);
                }
            }
            self.insert(node, Some(id));
            if new_bone {
                break;
            }
        }
    }

    /// The dearest node that is still worth a place at `sample`.
    fn limit(&self, sample: usize) -> f32 {
        self.cheapest[sample] + self.effort.beam_cost
    }

    /// Adds a node that follows the one whose latest visits are those of `from`, unless a cheaper one leaves the same
    /// future open.
    fn insert(&mut self, node: Node, from: Option<u32>) {
        let (k, sample) = (usize::from(node.path_index), usize::from(node.sample));
        if node.cost > self.limit(sample) || k + self.steps_needed[sample] > self.plan.end() {
            return;
        }
        let count = self.plan.joint_count;
        let here = self.plan.path[k];
        let key = {
            let before = from.map(|id| self.latest_of(id));
            self.plan.open[k].iter().fold(k as u64, |key, &joint| {
                let visit = if joint == here {
                    node.sample
                } else {
                    before.map_or(UNVISITED, |before| before[joint])
                };
                (key ^ u64::from(visit / SAME_PLACE_SAMPLES))
                    .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                    .rotate_left(23)
            })
        };
        self.cheapest[sample] = self.cheapest[sample].min(node.cost);
        let id = match self.at_sample[sample].iter().find(|entry| entry.key == key) {
            // Nodes of this sample have no followers yet, so one can be overwritten.
            Some(entry) if self.nodes[entry.id as usize].cost > node.cost => {
                self.nodes[entry.id as usize] = node;
                entry.id as usize
            }
            Some(_) => return,
            None => {
                let id = self.nodes.len();
                self.at_sample[sample].push(Entry { key, id: id as u32 });
                self.nodes.push(node);
                self.latest.resize((id + 1) * count, UNVISITED);
                id
            }
        };
        if let Some(from) = from {
            let from = from as usize * count;
            self.latest.copy_within(from..from + count, id * count);
        }
        self.latest[id * count + here] = node.sample;
        if self.at_sample[sample].len() > 4 * self.effort.beam {
            self.prune(sample);
        }
    }
}

fn steps_needed(ink: &Ink) -> Vec<usize> {
    let strokes = ink.strokes.iter().enumerate();
    strokes
        .flat_map(|(i, stroke)| {
            let after = ink.strokes.len() - 1 - i;
            stroke
                .clone()
                .map(move |sample| after + usize::from(sample + 1 < stroke.end))
        })
        .collect()
}
