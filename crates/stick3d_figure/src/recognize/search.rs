//! The search for the samples at which the path's points were drawn: dynamic programming over the samples in
//! drawing order, with several hypotheses per state, since a joint drawn twice must be drawn at one place.

use glam::Vec2;

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
        beam: 24,
        beam_cost: 20.0,
        max_straightness_cost: 25.0,
    };
    /// For crooked ones, where the usual effort finds nothing.
    pub(super) const GREAT: Self = Self {
        beam: 40,
        beam_cost: 150.0,
        max_straightness_cost: 500.0,
    };
}

/// Two places of one joint within one stroke differ by about this part of the tolerance length.
const RETRACE_SPREAD: f32 = 0.025;
/// The same where the pen was lifted between: people aim less well.
const LIFT_SPREAD: f32 = 0.04;
/// What a corner costs that no lifted pen marks, in limbs and at their ends.
const LIMB_CORNER_COST: f32 = 1.5;
/// The same where limbs branch off: few people draw on from the torso into a leg, or from the head into an arm.
const BRANCH_CORNER_COST: f32 = 3.0;
/// What a way back costs that leaves out a joint (hand straight to neck).
const SHORTCUT_COST: f32 = 3.0;
/// What a bone costs that was not drawn, only its two ends.
const UNDRAWN_BONE_COST: f32 = 7.0;
/// Parameter of the Beta prior over habits: small when people are mostly true to theirs.
const OPEN_MIND: f32 = 0.25;
/// Logarithm by which the two sides of the body differ in drawn length.
const SYMMETRY_SPREAD: f32 = 0.6;
/// What a limb costs that is folded flat.
const FOLD_COST: f32 = 5.0;
/// Samples of one joint nearer than this count as one place when hypotheses are compared.
const SAME_PLACE_SAMPLES: u16 = 4;

const UNVISITED: u16 = u16::MAX;
const NO_NODE: u32 = u32::MAX;

/// Path points placed so far, the last of them at `sample`.
#[derive(Clone, Copy, Debug)]
struct Node {
    cost: f32,
    previous: u32,
    path_index: u16,
    sample: u16,
    /// Length of all bones drawn for the first time, in the drawing and in the template: their ratio is its scale.
    drawn_length: f32,
    drawn_template: f32,
    /// In how many middles of limbs the pen was lifted, and in how many not.
    lifts: u8,
    passes: u8,
    /// How many limbs were drawn back, and after how many the pen was lifted and the way back skipped.
    retraced: u8,
    skipped: u8,
}

/// A node and what of its past matters for its future: its path index and where its open joints are.
#[derive(Clone, Copy, Debug)]
struct Entry {
    key: u64,
    id: u32,
}

/// A path point and the sample it was drawn at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Visit {
    pub(super) path_index: usize,
    pub(super) sample: usize,
}

/// One reading of the ink.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    /// Negative logarithm of its likelihood.
    pub(super) cost: f32,
    /// The path points that were drawn, in order. Path points whose bone was skipped are left out.
    pub(super) visits: Vec<Visit>,
    /// How much of the next bone is drawn, from 0 to 1, while the pen is down.
    pub(super) begun: f32,
}

/// The search over one drawing.
pub(super) struct Search<'a> {
    plan: &'a Plan,
    ink: &'a Ink,
    effort: Effort,
    nodes: Vec<Node>,
    /// Per node and joint: the sample of the latest visit.
    latest: Vec<u16>,
    /// Per sample: nodes whose last path point lies there.
    at_sample: Vec<Vec<Entry>>,
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

    fn latest_of(&self, id: u32) -> &[u16] {
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

    /// Two visits of one joint at two places: a Gaussian near, a heavy tail far.
    fn distance_cost(&self, before: u16, now: usize, spread: f32) -> f32 {
        let Some(&before) = self.ink.samples.get(usize::from(before)) else {
            return 0.0;
        };
        let sigma = spread * self.ink.tolerance_length;
        let squared = before.distance_squared(self.ink.samples[now]) / (sigma * sigma);
        8.0 * (squared / 16.0).ln_1p()
    }

    /// A bone of this length beside what has been drawn: shorter is foreshortening, longer is a worse drawing.
    fn length_cost(&self, node: &Node, length: f32, template_length: f32) -> f32 {
        let least_scale = self.ink.diagonal / self.plan.reach;
        let scale = if node.drawn_template > 0.0 {
            (node.drawn_length / node.drawn_template).max(least_scale)
        } else {
            least_scale
        };
        let ratio = (length / (scale * template_length)).max(1.0e-3).ln();
        let spread = match (node.drawn_template > 0.0, ratio > 0.0) {
            // The first bone sets the scale and may be longer than the extent tells.
            (false, true) => 2.0,
            (_, true) => 0.35,
            (_, false) => 0.8,
        };
        // Directions in space that are all alike make a projected length of `r` as frequent as `r^2` (per ln r).
        let foreshortening = (-ratio).max(0.0);
        (0.5 * (ratio / spread).powi(2) + foreshortening).min(8.0)
    }

    /// Going on from a path point without lifting the pen.
    fn corner_cost(&self, node: &Node) -> f32 {
        let k = usize::from(node.path_index);
        match (
            self.ink.starts[usize::from(node.sample)],
            self.plan.branches[k],
        ) {
            (true, _) => 0.0,
            (false, true) => BRANCH_CORNER_COST,
            (false, false) => LIMB_CORNER_COST,
        }
    }

    /// A bone beside the same bone of the other side, where that was drawn.
    fn symmetry_cost(&self, id: u32, k: usize, length: f32) -> f32 {
        let [from, to] = self.plan.steps[k].mirrored;
        let latest = self.latest_of(id);
        let at = |joint: usize| self.ink.samples.get(usize::from(latest[joint]));
        match (at(from), at(to)) {
            (Some(from), Some(to))
                if self.plan.steps[k].joint != self.plan.steps[k].mirrored[1] =>
            {
                let other = from.distance(*to).max(1.0e-3 * self.ink.diagonal);
                (0.5 * ((length / other).ln() / SYMMETRY_SPREAD).powi(2)).min(2.5)
            }
            _ => 0.0,
        }
    }

    /// A new bone that lies on the one before: a way back mistaken for a bone, since limbs do not fold flat.
    fn fold_cost(&self, node: &Node, to: usize) -> f32 {
        let mut previous = node;
        // A lifted pen is a node of its own at the same path point.
        while previous.path_index == node.path_index {
            match self.nodes.get(previous.previous as usize) {
                Some(earlier) => previous = earlier,
                None => return 0.0,
            }
        }
        let at = |sample: u16| self.ink.samples[usize::from(sample)];
        let before = at(node.sample) - at(previous.sample);
        let after = self.ink.samples[to] - at(node.sample);
        let cosine = before.dot(after) / (before.length() * after.length()).max(f32::MIN_POSITIVE);
        FOLD_COST * ((-cosine - 0.9) / 0.08).clamp(0.0, 1.0)
    }

    /// The dearest node that is still worth a place at `sample`.
    fn limit(&self, sample: usize) -> f32 {
        self.cheapest[sample] + self.effort.beam_cost
    }

    /// Adds a node that follows the one whose latest visits are those of `from`, unless a cheaper one leaves the same
    /// future open.
    fn insert(&mut self, node: Node, from: Option<u32>) {
        let (k, sample) = (usize::from(node.path_index), usize::from(node.sample));
        if node.cost > self.limit(sample) {
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

    /// The best reading that ends at the path's last point.
    pub(super) fn complete(&self) -> Option<Reading> {
        self.best_at_end(|k| k == self.plan.end())
    }

    /// The best reading, wherever on the path it ends.
    pub(super) fn any(&self) -> Option<Reading> {
        self.best_at_end(|_| true)
    }

    fn best_at_end(&self, wanted: impl Fn(usize) -> bool) -> Option<Reading> {
        let mut best = None;
        for &Entry { id, .. } in self.at_sample.last()? {
            let node = &self.nodes[id as usize];
            let k = usize::from(node.path_index);
            if wanted(k) {
                let lifted = if self.plan.mid_limb[k] {
                    habit_cost(node.lifts, node.passes)
                } else {
                    0.0
                };
                consider(&mut best, node.cost + lifted, id, 0.0);
            }
        }
        best.map(|(cost, id, begun)| self.reading(id, cost, begun))
    }

    /// The best reading of a drawing whose last bone is still being drawn.
    pub(super) fn unfinished(&self) -> Option<Reading> {
        let stroke = self.ink.strokes.last()?.clone();
        let end = stroke.end - 1;
        let mut best: Option<(f32, u32, f32)> = None;
        for from in stroke {
            let straight = self.ink.straightness_cost(from, end);
            for &Entry { id, .. } in &self.at_sample[from] {
                let node = &self.nodes[id as usize];
                let k = usize::from(node.path_index);
                let Some(step) = self.plan.steps.get(k) else {
                    if from == end {
                        consider(&mut best, node.cost, id, 0.0);
                    }
                    continue;
                };
                let chord = self.ink.samples[from].distance(self.ink.samples[end]);
                let (whole, too_long_cost) = if step.retrace {
                    let target = self.latest_of(id)[step.joint];
                    let target = self.ink.samples.get(usize::from(target)).copied();
                    let from_px = self.ink.samples[from];
                    let away = overshoot(from_px, target.unwrap_or(from_px), self.ink.samples[end]);
                    let sigma = RETRACE_SPREAD * self.ink.tolerance_length;
                    (
                        target.map_or(0.0, |t| t.distance(from_px)),
                        0.5 * (away / sigma).powi(2),
                    )
                } else {
                    let scale = if node.drawn_template > 0.0 {
                        node.drawn_length / node.drawn_template
                    } else {
                        self.ink.diagonal / self.plan.reach
                    };
                    let whole = scale * step.template_length;
                    let cost = if chord > whole {
                        self.length_cost(node, chord, step.template_length)
                    } else {
                        0.0
                    };
                    (whole, cost)
                };
                let begun = if whole > 0.0 {
                    (chord / whole).min(1.0)
                } else {
                    1.0
                };
                consider(&mut best, node.cost + straight + too_long_cost, id, begun);
            }
        }
        best.map(|(cost, id, begun)| self.reading(id, cost, begun))
    }

    fn reading(&self, id: u32, cost: f32, begun: f32) -> Reading {
        let mut visits = Vec::new();
        let mut at = id;
        while let Some(node) = self.nodes.get(at as usize) {
            visits.push(Visit {
                path_index: usize::from(node.path_index),
                sample: usize::from(node.sample),
            });
            at = node.previous;
        }
        visits.reverse();
        Reading {
            cost,
            visits,
            begun,
        }
    }
}

fn consider(best: &mut Option<(f32, u32, f32)>, cost: f32, id: u32, begun: f32) {
    if best.is_none_or(|(cheapest, ..)| cost < cheapest) {
        *best = Some((cost, id, begun));
    }
}

/// How far `end` lies from the line from `start` to `target`, or beyond its end.
fn overshoot(start: Vec2, target: Vec2, end: Vec2) -> f32 {
    let line = target - start;
    let along =
        ((end - start).dot(line) / line.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    (start + line * along).distance(end)
}

/// What it costs to do once more what was done `same` times, and otherwise `other` times (a Beta prior).
///
/// [`OPEN_MIND`] says how soon a habit is taken for one.
fn habit_cost(same: u8, other: u8) -> f32 {
    let (same, other) = (f32::from(same), f32::from(other));
    ((same + other + 2.0 * OPEN_MIND) / (same + OPEN_MIND)).ln()
}
