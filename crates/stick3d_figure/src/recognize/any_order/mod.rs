//! Recognition in any order: the strokes of a drawing, however many, in whatever order and direction, become the
//! joints of a figure.
//!
//! The ink is cut into straight lines. Its ends, corners and crossings are *marks*, the places where joints may be; the
//! lines between marks along which there is ink may be bones. The figure's tree of bones is a trunk with limbs: chains
//! of bones between branchings and ends. Chain after chain is laid on the lines, and the reading is sought that leaves
//! least ink over with bones as long and directed as those of the template.

mod body;
pub(super) mod cost;
mod lines;
mod marks;
mod rest;
mod search;
mod settle;
pub(crate) mod sides;
mod ways;

use glam::Vec2;
use serde::{Deserialize, Serialize};

use super::RecognizeError;
use super::ink::{Ink, MAX_STROKES};
use crate::figure::Figure;
use crate::sketch::Sketch;
use crate::stroke::Stroke;
use body::Body;
use marks::Marks;
use search::{Reading, Search};

/// Joints nearer than this part of the drawing's diagonal are at one place when readings are compared.
const SAME_READING: f32 = 0.05;

/// What strokes in any order show of a figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnyOrder {
    /// Per joint: where it is drawn, canvas pixels, y up; none where it is not.
    pub joints: Vec<Option<Vec2>>,
    /// The limbs of which something is not drawn: the joints without a place, from the trunk outwards.
    pub missing: Vec<Vec<usize>>,
    /// Pairs of limbs that lie too close together to tell left from right: the left and the right joint nearest to the
    /// trunk. [`AnyOrder::swap_pair`] exchanges them, and [`swap_pair`](crate::edit::swap_pair) in a sketch.
    pub ambiguous: Vec<[usize; 2]>,
    /// Negative logarithm of the reading's likelihood, without unit: 10 is a neat whole drawing, 40 hardly one.
    pub cost: f32,
    /// How sure it is that no other reading is meant, from 0 to 1. Exchanged limbs of a pair are no other reading.
    pub confidence: f32,
    /// The part of the ink that no bone explains, from 0 to 1.
    pub leftover: f32,
}

impl AnyOrder {
    /// Whether every joint has its place.
    pub fn is_complete(&self) -> bool {
        self.joints.iter().all(Option::is_some)
    }

    /// Exchanges the limb of a joint with the one of the other side. Says whether the joint belongs to a pair.
    pub fn swap_pair(&mut self, figure: &Figure, joint: usize) -> bool {
        let Some(pair) = sides::pair_of(figure, joint) else {
            return false;
        };
        sides::swap(&pair, &mut self.joints);
        let exchanged = |joint: &mut usize| {
            if pair.left.contains(joint) || pair.right.contains(joint) {
                *joint = figure.mirror_of(*joint);
            }
        };
        self.missing.iter_mut().flatten().for_each(exchanged);
        true
    }

    /// The sketch, when every joint has its place.
    pub fn sketch(&self, figure: &Figure) -> Option<Sketch> {
        let points: Option<Vec<Vec2>> = self.joints.iter().copied().collect();
        Sketch::new(figure, points?).ok()
    }
}

/// The joints that strokes show in whatever order, direction and pieces they were drawn, also while the drawing is
/// unfinished.
///
/// - A stroke may run through several bones, a bone may consist of several strokes, bones may be drawn twice; strokes
///   may overlap or leave gaps of 3 % of the drawing's size where they meet. Limbs may cross.
/// - A joint at which nothing bends (a straight arm) is put where two strokes meet, if they do so near the place where the
///   template has it, and there otherwise.
/// - A head may be a loop drawn without lifting the pen, alone or with more of the body: the joint at which the figure's
///   path starts is then its middle. (The man's forehead is at 1.70 m of his 1.80 m: nearer to the middle of his head
///   than to its top.)
/// - As soon as the trunk is there (the bones between branchings: neck to abdomen, shoulder to hip), what hangs on it is
///   placed too. Limbs that are not drawn are [`missing`](AnyOrder::missing), for the caller to fill in;
///   [`complete_from_template`](crate::complete_from_template) does. More ink can change how it is all read.
///
/// **Left and right.** Ink does not say which limb of a pair is which. The two are taken to lie to one another as in the
/// template, turned as the drawn middle of the body is turned: along the line between the template's two limbs, the
/// one whose joints lie farther left on average is the left one. So the man faces the viewer: of two arms that one is the
/// right one that is farther to the viewer's left (when he stands on his hands, to the viewer's right), also where both
/// are on the same side of the body. Of two legs of the horse the left one is ahead, whichever way it goes. A limb
/// without its pair is on the side of the template's limb that it is nearer to.
///
/// # Errors
/// [`RecognizeError::Empty`] without ink, [`RecognizeError::TooManyStrokes`] with too much of it.
pub fn recognize_any(figure: &Figure, strokes: &[Stroke]) -> Result<AnyOrder, RecognizeError> {
    if strokes.len() > MAX_STROKES {
        return Err(RecognizeError::TooManyStrokes {
            strokes: strokes.len(),
        });
    }
    let Some(ink) = Ink::new(strokes) else {
        return Err(RecognizeError::Empty {
            strokes: strokes.len(),
        });
    };
    let body = Body::new(figure);
    let marks = Marks::new(&ink);
    let search = Search::new(&body, &ink, &marks);
    let readings = search.run();
    let mut joints = match readings.first() {
        Some(best) => settle::settled(&search, best),
        None => head_alone(&body, &marks),
    };
    let pairs = sides::put_on_sides(figure, &mut joints);
    let ambiguous = pairs
        .iter()
        .filter_map(|pair| Some([*pair.left.first()?, *pair.right.first()?]));
    let total: f32 = marks.weights.iter().sum();
    let best = readings.first();
    Ok(AnyOrder {
        missing: missing(&body, &joints),
        ambiguous: ambiguous.collect(),
        cost: best.map_or_else(|| search.cost_of_nothing(), |best| best.total_cost),
        confidence: confidence(figure, &search, &readings, SAME_READING * ink.diagonal),
        leftover: best.map_or(1.0, |best| (best.leftover / total).clamp(0.0, 1.0)),
        joints,
    })
}

/// Before there is a trunk, a loop is a head.
fn head_alone(body: &Body, marks: &Marks) -> Vec<Option<Vec2>> {
    let mut joints = vec![None; body.joint_count];
    let chain = body.chains.iter().find(|chain| chain.head);
    if let (Some(chain), Some(head)) = (chain, &marks.head) {
        joints[chain.end()] = Some(head.center);
    }
    joints
}

fn missing(body: &Body, joints: &[Option<Vec2>]) -> Vec<Vec<usize>> {
    let undrawn = body.chains.iter().enumerate().map(|(index, chain)| {
        // The joint at which the search starts is on no chain, but before the first one.
        let start = (index == 0).then_some(body.start);
        let all = start.into_iter().chain(chain.joints.iter().copied());
        all.filter(|&joint| joints[joint].is_none())
            .collect::<Vec<usize>>()
    });
    undrawn.filter(|chain| !chain.is_empty()).collect()
}

/// The share of the best reading among all that are as good, those left out that put the same joints elsewhere by a
/// hair.
fn confidence(figure: &Figure, search: &Search, readings: &[Reading], near: f32) -> f32 {
    let Some(best) = readings.first() else {
        return 0.0;
    };
    let joints = |reading: &Reading| {
        let mut joints = search.joints(reading);
        sides::put_on_sides(figure, &mut joints);
        joints
    };
    let expected = joints(best);
    let is_same = |reading: &Reading| {
        joints(reading)
            .iter()
            .zip(&expected)
            .all(|pair| match pair {
                (Some(a), Some(b)) => a.distance(*b) <= near,
                (a, b) => a.is_none() == b.is_none(),
            })
    };
    // Readings come in the order of their likelihood, so the first other one is the strongest rival.
    let rival = readings.iter().skip(1).find(|reading| !is_same(reading));
    let margin = rival.map_or(f32::INFINITY, |rival| rival.total_cost - best.total_cost);
    1.0 / (1.0 + (-margin).exp())
}

#[cfg(test)]
mod tests;
