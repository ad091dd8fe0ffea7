//! What the search takes for likely: the costs of bones, corners and lifted pens, as negative logarithms of
//! probabilities.

use super::search::{Node, Search};

/// Two places of one joint within one stroke differ by about this part of the tolerance length.
pub(super) const RETRACE_SPREAD: f32 = 0.025;
/// The same where the pen was lifted between: people aim less well.
pub(super) const LIFT_SPREAD: f32 = 0.04;
/// What a corner costs that no lifted pen marks, in limbs and at their ends.
const LIMB_CORNER_COST: f32 = 1.5;
/// The same where limbs branch off: few people draw on from the torso into a leg, or from the head into an arm.
const BRANCH_CORNER_COST: f32 = 3.0;
/// What a way back costs that leaves out a joint (hand straight to neck).
pub(super) const SHORTCUT_COST: f32 = 3.0;
/// What a bone costs that was not drawn, only its two ends.
pub(super) const UNDRAWN_BONE_COST: f32 = 7.0;
/// Parameter of the Beta prior over habits: small when people are mostly true to theirs.
const OPEN_MIND: f32 = 0.25;
/// Logarithm by which the two sides of the body differ in drawn length.
const SYMMETRY_SPREAD: f32 = 0.6;
/// What a limb costs that is folded flat.
const FOLD_COST: f32 = 5.0;

impl Search<'_> {
    /// Two visits of one joint at two places: a Gaussian near, a heavy tail far.
    pub(super) fn distance_cost(&self, before: u16, now: usize, spread: f32) -> f32 {
        let Some(&before) = self.ink.samples.get(usize::from(before)) else {
            return 0.0;
        };
        let sigma = spread * self.ink.tolerance_length;
        let squared = before.distance_squared(self.ink.samples[now]) / (sigma * sigma);
        8.0 * (squared / 16.0).ln_1p()
    }

    /// A bone of this length beside what has been drawn: shorter is foreshortening, longer is a worse drawing.
    pub(super) fn length_cost(&self, node: &Node, length: f32, template_length: f32) -> f32 {
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
    pub(super) fn corner_cost(&self, node: &Node) -> f32 {
        let k = usize::from(node.path_index);
        let lifted = self.ink.starts[usize::from(node.sample)];
        match (lifted, self.plan.branches[k]) {
            (true, _) => 0.0,
            (false, true) => BRANCH_CORNER_COST,
            (false, false) => LIMB_CORNER_COST,
        }
    }

    /// A bone beside the same bone of the other side, where that was drawn.
    pub(super) fn symmetry_cost(&self, id: u32, k: usize, length: f32) -> f32 {
        let step = &self.plan.steps[k];
        let [from_joint, to_joint] = step.mirrored;
        let latest = self.latest_of(id);
        let at = |joint: usize| self.ink.samples.get(usize::from(latest[joint]));
        match (at(from_joint), at(to_joint)) {
            (Some(from), Some(to)) if step.joint != to_joint => {
                let other = from.distance(*to).max(1.0e-3 * self.ink.diagonal);
                (0.5 * ((length / other).ln() / SYMMETRY_SPREAD).powi(2)).min(2.5)
            }
            _ => 0.0,
        }
    }

    /// A new bone that lies on the one before: a way back mistaken for a bone, since limbs do not fold flat.
    pub(super) fn fold_cost(&self, node: &Node, to: usize) -> f32 {
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
}

/// What it costs to do once more what was done `same` times, and otherwise `other` times (a Beta prior).
///
/// [`OPEN_MIND`] says how soon a habit is taken for one.
pub(super) fn habit_cost(same: u8, other: u8) -> f32 {
    let (same, other) = (f32::from(same), f32::from(other));
    ((same + other + 2.0 * OPEN_MIND) / (same + OPEN_MIND)).ln()
}
