//! The ways in which a chain of bones may lie on the lines between marks.

use glam::Vec2;

use super::body::Chain;
use super::lines::Lines;

/// Ways kept per number of bones; it bounds the work for figures with long chains.
const MAX_WAYS: usize = 160;
/// Lines that are less likely are no bones.
const MAX_LINE_COST: f32 = 12.0;
/// What a joint costs at which nothing bends,
const STRAIGHT_COST: f32 = 1.5;
/// and the angle, radians, at which that is over.
const STRAIGHT_RAD: f32 = 0.22;
/// What a limb costs that is folded flat.
const FOLD_COST: f32 = 5.0;
/// What a line is worth, per its length in parts of the tolerance length, when ways are compared before the search.
const WORTH: f32 = 30.0;

/// A chain of bones, or its beginning, on the ink.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Way {
    /// The marks it passes, the one where it starts included.
    pub(super) marks: Vec<u16>,
    /// Where its bones end.
    pub(super) places: Vec<Vec2>,
    /// Per bone from where to where.
    pub(super) bones: Vec<Vec2>,
    /// What it costs by itself: crooked and undrawn lines, bends that cannot be.
    pub(super) cost: f32,
}

/// The ways that were found, and how many were looked at.
pub(super) struct Ways {
    pub(super) ways: Vec<Way>,
    pub(super) looks: usize,
}

/// All likely ways of a chain from a mark: those of all its bones first, then those of its first bones alone.
pub(super) fn ways(
    chain: &Chain,
    from: usize,
    places: &[Vec2],
    head: Option<usize>,
    lines: &Lines,
    unit: f32,
) -> Ways {
    let count = chain.lengths.len();
    let mut looks = 0;
    let mut by_bones: Vec<Vec<Way>> = vec![Vec::new(); count + 1];
    by_bones[0].push(Way {
        marks: vec![from as u16],
        places: Vec::new(),
        bones: Vec::new(),
        cost: 0.0,
    });
    for drawn in 0..count {
        keep_likely(&mut by_bones[drawn], unit);
        let (before, after) = by_bones.split_at_mut(drawn + 1);
        for way in &before[drawn] {
            for next in 0..lines.marks {
                for bones in 1..=count - drawn {
                    let ends = drawn + bones == count;
                    if head == Some(next) && !(ends && chain.head) {
                        continue;
                    }
                    let lengths = &chain.lengths[drawn..drawn + bones];
                    if let Some(longer) = extended(way, next, lengths, places, lines) {
                        looks += 1;
                        after[bones - 1].push(longer);
                    }
                }
            }
        }
    }
    keep_likely(&mut by_bones[count], unit);
    let begun = if chain.branches { 0..0 } else { 1..count };
    let mut ways = std::mem::take(&mut by_bones[count]);
    ways.extend(by_bones[begun].iter_mut().flat_map(std::mem::take));
    Ways { ways, looks }
}

fn keep_likely(ways: &mut Vec<Way>, unit: f32) {
    let score = |way: &Way| {
        let length: f32 = way.bones.iter().map(|bone| bone.length()).sum();
        way.cost - WORTH * length / unit
    };
    if ways.len() > MAX_WAYS {
        ways.sort_by(|a, b| score(a).total_cmp(&score(b)));
        ways.truncate(MAX_WAYS);
    }
}

/// A way that goes on to the mark `next` by bones of these template lengths, all in one straight line.
fn extended(
    way: &Way,
    next: usize,
    lengths: &[f32],
    places: &[Vec2],
    lines: &Lines,
) -> Option<Way> {
    let at = usize::from(*way.marks.last()?);
    if way.marks.contains(&(next as u16)) {
        return None;
    }
    let line = lines.between(at, next)?;
    if line.cost > MAX_LINE_COST {
        return None;
    }
    let whole = places[next] - places[at];
    let mut longer = way.clone();
    longer.cost += line.cost + STRAIGHT_COST * (lengths.len() - 1) as f32;
    if let Some(before) = way.bones.last() {
        longer.cost += bend_cost(*before, whole);
    }
    longer.marks.push(next as u16);
    let template: f32 = lengths.iter().sum();
    let mut walked = 0.0;
    for length in lengths {
        walked += length;
        longer.places.push(places[at] + whole * (walked / template));
        longer.bones.push(whole * (length / template));
    }
    Some(longer)
}

fn bend_cost(before: Vec2, after: Vec2) -> f32 {
    let bend = before.angle_to(after).abs();
    let straight = (-(bend / STRAIGHT_RAD).powi(2)).exp();
    let folded = ((-bend.cos() - 0.9) / 0.08).clamp(0.0, 1.0);
    STRAIGHT_COST * straight + FOLD_COST * folded
}
