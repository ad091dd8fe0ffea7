//! Where joints may be: ends, corners and crossings of the ink, and the loop of a head.

use std::ops::Range;

use glam::Vec2;

use crate::recognize::ink::Ink;

/// More marks than any drawing of a figure needs; it bounds the work.
const MAX_MARKS: usize = 40;
/// Ends and corners within this part of the tolerance length are meant as one place.
pub(super) const SAME_PLACE: f32 = 0.03;
/// What a corner costs when a stroke is cut into straight pieces.
const CORNER_COST: f32 = 1.5;
/// Pieces of ink bent more than this are cut.
const MAX_STRAIGHTNESS_COST: f32 = 40.0;
/// How round a loop is, as area over that of a circle of its length: a square has 0.785.
const MIN_ROUNDNESS: f32 = 0.8;
/// How much a loop's radius varies, at most, in parts of it.
const MAX_RADIUS_SPREAD: f32 = 0.22;
/// How far a loop may stay open, in parts of its radius.
const MAX_OPENING: f32 = 0.8;
/// Fewer samples are no loop.
const MIN_LOOP_SAMPLES: usize = 7;
/// A head's radius in parts of the tolerance length.
const HEAD_RADIUS: Range<f32> = 0.02..0.37;
/// Less ink than this part of the tolerance length before or after a loop is how the pen came and went.
const LOOP_TAIL: f32 = 0.035;

/// A head drawn as a loop.
#[derive(Clone, Debug)]
pub(super) struct Head {
    pub(super) center: Vec2,
    pub(super) radius: f32,
    pub(super) samples: Range<usize>,
}

/// What of the ink may be a joint.
#[derive(Clone, Debug)]
pub(super) struct Marks {
    pub(super) places: Vec<Vec2>,
    pub(super) head: Option<Head>,
    /// Per sample the length of ink it stands for.
    pub(super) weights: Vec<f32>,
    /// Per sample the direction of the ink.
    pub(super) tangents: Vec<Vec2>,
}

impl Marks {
    pub(super) fn new(ink: &Ink) -> Self {
        let head = find_head(ink);
        let pieces = without_head(ink, head.as_ref());
        let mut ends = Vec::new();
        let mut lines = Vec::new();
        for piece in &pieces {
            let corners = corners(ink, piece.clone());
            lines.extend(corners.windows(2).map(|w| [w[0], w[1]]));
            ends.extend(corners.into_iter().map(|sample| ink.samples[sample]));
        }
        let crossings = crossings(ink, &lines);
        let (weights, tangents) = along(ink);
        Self {
            places: merged(&ends, &crossings, SAME_PLACE * ink.tolerance_length),
            head,
            weights,
            tangents,
        }
    }
}

/// Per sample the length of ink it stands for, and its direction.
fn along(ink: &Ink) -> (Vec<f32>, Vec<Vec2>) {
    let mut weights = vec![0.0; ink.samples.len()];
    let mut tangents = vec![Vec2::ZERO; ink.samples.len()];
    for stroke in &ink.strokes {
        for i in stroke.clone() {
            let (before, after) = (
                i.saturating_sub(1).max(stroke.start),
                (i + 1).min(stroke.end - 1),
            );
            weights[i] = 0.5 * ink.arc_between(before, after);
            tangents[i] = (ink.samples[after] - ink.samples[before]).normalize_or_zero();
        }
    }
    (weights, tangents)
}

/// The roundest loop of the size of a head, in one stroke or a part of it.
fn find_head(ink: &Ink) -> Option<Head> {
    let mut best: Option<(f32, Head)> = None;
    for stroke in &ink.strokes {
        for from in stroke.clone() {
            let mut doubled_area = 0.0;
            let origin = ink.samples[from];
            for to in from + 1..stroke.end {
                doubled_area += (ink.samples[to - 1] - origin).perp_dot(ink.samples[to] - origin);
                let opening = origin.distance(ink.samples[to]);
                let length = ink.arc_between(from, to) + opening;
                let roundness = std::f32::consts::TAU * doubled_area.abs() / (length * length);
                if to - from < MIN_LOOP_SAMPLES || roundness < MIN_ROUNDNESS {
                    continue;
                }
                if best
                    .as_ref()
                    .is_some_and(|(rounder, _)| *rounder >= roundness)
                {
                    continue;
                }
                if let Some(head) = as_head(ink, from..to + 1, opening) {
                    best = Some((roundness, head));
                }
            }
        }
    }
    best.map(|(_, head)| head)
}

fn as_head(ink: &Ink, samples: Range<usize>, opening: f32) -> Option<Head> {
    let points = &ink.samples[samples.clone()];
    let count = points.len() as f32;
    let center = points.iter().sum::<Vec2>() / count;
    let radius = points.iter().map(|p| p.distance(center)).sum::<f32>() / count;
    let variance = points
        .iter()
        .map(|p| (p.distance(center) - radius).powi(2))
        .sum::<f32>()
        / count;
    let is_head = HEAD_RADIUS.contains(&(radius / ink.tolerance_length))
        && variance.sqrt() < MAX_RADIUS_SPREAD * radius
        && opening < MAX_OPENING * radius;
    is_head.then_some(Head {
        center,
        radius,
        samples,
    })
}

/// The strokes without the head's loop. What is left of the loop's own stroke is added to the loop when it is short.
fn without_head(ink: &Ink, head: Option<&Head>) -> Vec<Range<usize>> {
    let Some(head) = head else {
        return ink.strokes.clone();
    };
    let mut pieces = Vec::new();
    for stroke in &ink.strokes {
        if !stroke.contains(&head.samples.start) {
            pieces.push(stroke.clone());
            continue;
        }
        let rest = [
            stroke.start..head.samples.start + 1,
            head.samples.end - 1..stroke.end,
        ];
        pieces.extend(rest.into_iter().filter(|piece| {
            piece.len() > 1
                && ink.arc_between(piece.start, piece.end - 1) > LOOP_TAIL * ink.tolerance_length
        }));
    }
    pieces
}

/// The samples at which a piece of ink is best cut into straight lines, both ends among them.
fn corners(ink: &Ink, piece: Range<usize>) -> Vec<usize> {
    let start = piece.start;
    let mut best = vec![(f32::INFINITY, start); piece.len()];
    best[0].0 = 0.0;
    for to in start + 1..piece.end {
        for from in start..to {
            let straight = ink.straightness_cost(from, to);
            // One step is always a line, so that every sample is reached.
            if straight > MAX_STRAIGHTNESS_COST && from + 1 < to {
                continue;
            }
            let cost = best[from - start].0 + straight + CORNER_COST;
            if cost < best[to - start].0 {
                best[to - start] = (cost, from);
            }
        }
    }
    let mut corners = vec![piece.end - 1];
    let mut at = piece.end - 1;
    while at > start {
        at = best[at - start].1;
        corners.push(at);
    }
    corners.reverse();
    corners
}

/// Where straight lines of ink cross away from their ends.
fn crossings(ink: &Ink, lines: &[[usize; 2]]) -> Vec<Vec2> {
    let mut crossings = Vec::new();
    for (i, &[a, b]) in lines.iter().enumerate() {
        for &[c, d] in &lines[i + 1..] {
            let (a, b) = (ink.samples[a], ink.samples[b]);
            let (c, d) = (ink.samples[c], ink.samples[d]);
            let (one, other) = (b - a, d - c);
            let area = one.perp_dot(other);
            if area.abs() < 0.05 * one.length() * other.length() {
                continue;
            }
            let along_one = (c - a).perp_dot(other) / area;
            let along_other = (c - a).perp_dot(one) / area;
            if (0.0..=1.0).contains(&along_one) && (0.0..=1.0).contains(&along_other) {
                crossings.push(a + one * along_one);
            }
        }
        if crossings.len() > 4 * MAX_MARKS {
            break;
        }
    }
    crossings
}

/// The middles of groups of places that are within `radius`. Crossings count only where no end or corner is. With too
/// many groups the radius grows.
fn merged(ends: &[Vec2], crossings: &[Vec2], radius: f32) -> Vec<Vec2> {
    let mut radius = radius.max(f32::MIN_POSITIVE);
    loop {
        let mut groups = grouped(ends, radius);
        let away = |p: &Vec2| groups.iter().all(|group| group.distance(*p) > 1.2 * radius);
        let apart: Vec<Vec2> = crossings.iter().copied().filter(away).collect();
        groups.extend(grouped(&apart, radius));
        if groups.len() <= MAX_MARKS {
            return groups;
        }
        radius *= 1.4;
    }
}

/// The middles of groups of places: gathered in their order, then each place once more to the nearest middle, so that
/// the order hardly matters.
fn grouped(places: &[Vec2], radius: f32) -> Vec<Vec2> {
    let nearest = |sums: &[(Vec2, f32)], place: Vec2| {
        let away = sums
            .iter()
            .map(|(sum, count)| (*sum / *count).distance(place));
        away.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let mut gathered: Vec<(Vec2, f32)> = Vec::new();
    for &place in places {
        match nearest(&gathered, place) {
            Some((i, distance)) if distance <= radius => {
                gathered[i].0 += place;
                gathered[i].1 += 1.0;
            }
            _ => gathered.push((place, 1.0)),
        }
    }
    let mut settled = vec![(Vec2::ZERO, 0.0); gathered.len()];
    for &place in places {
        if let Some((i, _)) = nearest(&gathered, place) {
            settled[i].0 += place;
            settled[i].1 += 1.0;
        }
    }
    settled.retain(|(_, count)| *count > 0.0);
    settled
        .into_iter()
        .map(|(sum, count)| sum / count)
        .collect()
}
