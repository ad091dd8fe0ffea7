//! Readings: what a finished search says of the ink.

use glam::Vec2;

use super::cost::{RETRACE_SPREAD, habit_cost};
use super::plan::Step;
use super::search::{Entry, Search};

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

impl Search<'_> {
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
                let (whole, too_far_cost) = self.bone_begun(id, step, end);
                let chord = self.ink.samples[from].distance(self.ink.samples[end]);
                let begun = if whole > 0.0 {
                    (chord / whole).min(1.0)
                } else {
                    1.0
                };
                consider(&mut best, node.cost + straight + too_far_cost, id, begun);
            }
        }
        best.map(|(cost, id, begun)| self.reading(id, cost, begun))
    }

    /// For a bone that is drawn from where node `id` is as far as sample `end`: how long it will be, and how unlikely it
    /// is that it has not ended before.
    fn bone_begun(&self, id: u32, step: &Step, end: usize) -> (f32, f32) {
        let node = &self.nodes[id as usize];
        let (from, to) = (
            self.ink.samples[usize::from(node.sample)],
            self.ink.samples[end],
        );
        if step.retrace {
            let target = self
                .ink
                .samples
                .get(usize::from(self.latest_of(id)[step.joint]));
            let target = target.copied().unwrap_or(from);
            let away = overshoot(from, target, to) / (RETRACE_SPREAD * self.ink.tolerance_length);
            return (target.distance(from), 0.5 * away * away);
        }
        let scale = if node.drawn_template > 0.0 {
            node.drawn_length / node.drawn_template
        } else {
            self.ink.diagonal / self.plan.reach
        };
        let (whole, chord) = (scale * step.template_length, from.distance(to));
        let too_long = chord > whole;
        (
            whole,
            if too_long {
                self.length_cost(node, chord, step.template_length)
            } else {
                0.0
            },
        )
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
