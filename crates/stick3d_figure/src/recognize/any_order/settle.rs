//! Elbows and knees put where the ink and the template agree best. A limb that is hardly bent has no corner that could
//! be found before it is known to be a limb; where two strokes of it meet, its joint is likely to be.

use std::ops::Range;

use glam::Vec2;

use super::body::Chain;
use super::search::{Reading, Search};
use crate::edit::distance_to_line;

/// Logarithm by which the two bones of a limb differ from the template's ratio.
const RATIO_SPREAD: f32 = 0.25;
/// How far from straight a bone is drawn, in parts of the tolerance length,
const STRAIGHTNESS: f32 = 0.006;
/// and in parts of the limb's length.
const BOW: f32 = 0.012;
/// Deviations along a line are alike over about this part of the tolerance length.
const CORRELATION: f32 = 0.08;
/// Stroke ends so near to one another, in parts of the tolerance length, are where one stroke went on for the other,
const MEETING: f32 = 0.04;
/// and so near to the joint that is meant there: standard deviation.
const AIM: f32 = 0.012;
/// What a limb costs whose strokes meet elsewhere than at its joint, in a drawing of a stroke per bone.
const CUT_COST: f32 = 4.0;
/// How often all joints of a limb are settled, each between its neighbours.
const ROUNDS: usize = 2;

/// Where a reading puts the joints of the figure, those in the middle of limbs settled on the ink.
pub(super) fn settled(search: &Search, reading: &Reading) -> Vec<Option<Vec2>> {
    let mut joints = search.joints(reading);
    let meetings = meetings(search);
    let cut_cost = CUT_COST * lifted_share(search, &joints, &meetings).powi(2);
    for (chain, way) in search.body.chains.iter().zip(&reading.ways) {
        let Some(way) = way else { continue };
        let ink = search.points_of(way);
        let row: Vec<usize> = std::iter::once(chain.from)
            .chain(chain.joints.iter().copied())
            .collect();
        for _ in 0..ROUNDS {
            for (middle, three) in row.windows(3).enumerate() {
                if let (Some(before), Some(at), Some(after)) =
                    (joints[three[0]], joints[three[1]], joints[three[2]])
                {
                    joints[three[1]] = Some(settle(
                        chain,
                        middle,
                        [before, at, after],
                        &ink,
                        (&meetings, cut_cost),
                        search.unit(),
                    ));
                }
            }
        }
    }
    joints
}

/// Where the ends of two strokes meet; places that are hardly apart once.
fn meetings(search: &Search) -> Vec<Vec2> {
    let ink = search.ink;
    let ends_of = |stroke: &Range<usize>| [ink.samples[stroke.start], ink.samples[stroke.end - 1]];
    let mut meetings: Vec<Vec2> = vec![];
    for (i, one) in ink.strokes.iter().enumerate() {
        let later: Vec<Vec2> = ink.strokes[i + 1..].iter().flat_map(ends_of).collect();
        for end in ends_of(one) {
            let is_near = |p: &&Vec2| p.distance(end) < MEETING * search.unit();
            for place in later.iter().filter(is_near).map(|p| p.midpoint(end)) {
                let apart = 0.5 * AIM * search.unit();
                if meetings.iter().all(|other| other.distance(place) > apart) {
                    meetings.push(place);
                }
            }
        }
    }
    meetings
}

/// The share of elbows and knees whose limb is two strokes: who draws some of them in one stroke, or in three, lifts the pen
/// anywhere.
fn lifted_share(search: &Search, joints: &[Option<Vec2>], meetings: &[Vec2]) -> f32 {
    let (mut inner, mut lifted) = (0, 0);
    for chain in &search.body.chains {
        let row: Vec<Option<Vec2>> = std::iter::once(chain.from)
            .chain(chain.joints.iter().copied())
            .map(|joint| joints[joint])
            .collect();
        for three in row.windows(3) {
            let [Some(before), Some(at), Some(after)] = three[..] else {
                continue;
            };
            inner += 1;
            let here = between(meetings, [before, at, after], search.unit());
            lifted += usize::from(here.count() == 1);
        }
    }
    lifted as f32 / inner.max(1) as f32
}

/// Those of some places that are on a limb, away from its ends.
fn between(places: &[Vec2], limb: [Vec2; 3], unit: f32) -> impl Iterator<Item = Vec2> + '_ {
    let [before, _, after] = limb;
    places.iter().copied().filter(move |p| {
        aside(*p, limb) < near(limb) && p.distance(before).min(p.distance(after)) > MEETING * unit
    })
}

/// How far a place is beside a limb.
fn aside(place: Vec2, [before, at, after]: [Vec2; 3]) -> f32 {
    distance_to_line(place, before, at).min(distance_to_line(place, at, after))
}

/// How far ink may be beside a limb: in a longer chain the ink of other bones is none of a joint's business.
fn near([before, at, after]: [Vec2; 3]) -> f32 {
    0.1 * (before.distance(at) + at.distance(after))
}

/// The best place of the joint after bone `middle`, of those on the ink and the one where it is.
fn settle(
    chain: &Chain,
    middle: usize,
    [before, at, after]: [Vec2; 3],
    ink: &[(Vec2, f32)],
    (meetings, cut_cost): (&[Vec2], f32),
    unit: f32,
) -> Vec2 {
    let ratio = chain.lengths[middle] / chain.lengths[middle + 1];
    let length = before.distance(at) + at.distance(after);
    let limb = [before, at, after];
    let is_near = |(p, _): &(Vec2, f32)| aside(*p, limb) < near(limb);
    let ink: Vec<(Vec2, f32)> = ink.iter().copied().filter(is_near).collect();
    let meetings: Vec<Vec2> = between(meetings, limb, unit).collect();
    let weight: f32 = ink.iter().map(|(_, weight)| weight).sum();
    let sigma = STRAIGHTNESS * unit + BOW * length;
    let independent = length / (CORRELATION * unit);
    let cost = |place: Vec2| {
        let squares: f32 = ink
            .iter()
            .map(|(p, weight)| weight * aside(*p, [before, place, after]).powi(2))
            .sum();
        let bend = 0.5 * independent * squares / weight.max(f32::MIN_POSITIVE) / (sigma * sigma);
        let drawn = before.distance(place) / place.distance(after).max(f32::MIN_POSITIVE);
        let missed = meetings
            .iter()
            .map(|p| 0.5 * (p.distance(place) / (AIM * unit)).powi(2));
        let cut = missed.fold(cut_cost, f32::min);
        bend + cut + 0.5 * ((drawn / ratio).max(1.0e-3).ln() / RATIO_SPREAD).powi(2)
    };
    let places = ink
        .iter()
        .map(|(place, _)| *place)
        .chain(meetings.iter().copied())
        .chain([at]);
    places
        .map(|place| (cost(place), place))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(at, |(_, place)| place)
}
