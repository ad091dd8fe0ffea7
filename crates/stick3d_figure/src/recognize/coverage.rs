//! How well bones explain the ink: which of it lies beside them all, and along which of them there is none.

use glam::Vec2;

use super::any_order::cost::LEFTOVER_COST;
use crate::edit::distance_to_line;
use crate::figure::Figure;
use crate::stroke::{Stroke, bounds_px};

/// Ink farther from all bones than this part of the drawing's diagonal is not explained by them.
const NEAR_BONE: f32 = 0.05;
/// From one point of the ink to the next, in parts of the diagonal.
const INK_SPACING: f32 = 0.025;
/// Where no ink is nearer to a bone than this, there is none along it;
const NEAR_INK: f32 = 0.035;
/// a bone with less ink along it than the rest of it is not drawn.
const MAX_BARE: f32 = 0.3;

/// Points along the ink, as if it were drawn evenly.
pub(super) struct EvenInk {
    points: Vec<Vec2>,
    length: f32,
    diagonal: f32,
}

impl EvenInk {
    /// Of strokes, slips included.
    pub(super) fn of(strokes: &[Stroke]) -> Self {
        let (low, high) = bounds_px(strokes).unwrap_or_default();
        let diagonal = low.distance(high).max(f32::MIN_POSITIVE);
        let spacing = INK_SPACING * diagonal;
        let even = |stroke: &Stroke| {
            let count = (stroke.length_px() / spacing).round() as usize + 2;
            stroke.resampled(count)
        };
        Self {
            points: strokes
                .iter()
                .flat_map(even)
                .map(|point| point.position_px)
                .collect(),
            length: strokes.iter().map(Stroke::length_px).sum(),
            diagonal,
        }
    }

    /// The share of the ink that is beside all bones.
    pub(super) fn left_over(&self, figure: &Figure, placed: &[Option<Vec2>]) -> f32 {
        let bones: Vec<[Vec2; 2]> = bones(figure, placed).collect();
        let beside = |point: &&Vec2| {
            let away = bones.iter().map(|&[a, b]| distance_to_line(**point, a, b));
            away.fold(f32::INFINITY, f32::min) > NEAR_BONE * self.diagonal
        };
        self.points.iter().filter(beside).count() as f32 / self.points.len().max(1) as f32
    }

    /// What a reading costs that leaves this share of the ink over.
    pub(super) fn cost_beyond(&self, share: f32) -> f32 {
        LEFTOVER_COST * share * self.length / self.diagonal
    }

    /// The length of a bone along which there is no ink.
    fn bare_length(&self, bone: [Vec2; 2]) -> f32 {
        let (near, spacing) = (NEAR_INK * self.diagonal, NEAR_BONE * self.diagonal);
        let is_bare = |at: Vec2| {
            let mut points = self.points.iter();
            points.all(|point| point.distance_squared(at) > near * near)
        };
        let [a, b] = bone;
        let count = (a.distance(b) / spacing).ceil().max(1.0);
        let at = |i: usize| a.lerp(b, (i as f32 + 0.5) / count);
        let bare = (0..count as usize).filter(|&i| is_bare(at(i))).count();
        a.distance(b) * bare as f32 / count
    }

    /// What the bones cost along which there is no ink.
    pub(super) fn cost_without(&self, figure: &Figure, placed: &[Option<Vec2>]) -> f32 {
        let length: f32 = bones(figure, placed)
            .map(|bone| self.bare_length(bone))
            .sum();
        LEFTOVER_COST * length / self.diagonal
    }

    /// Whether a bone was put where nothing is drawn, to reach what is drawn beyond it. (Limbs end where there is ink, or in
    /// the middle of a loop.)
    pub(super) fn misses_a_bone(&self, figure: &Figure, placed: &[Option<Vec2>]) -> bool {
        let inner = figure
            .bones
            .iter()
            .filter(|bone| bone.iter().all(|&joint| figure.bones_at(joint) > 1));
        let ends = |&[a, b]: &[usize; 2]| Some([placed[a]?, placed[b]?]);
        inner
            .filter_map(ends)
            .any(|bone| self.bare_length(bone) > MAX_BARE * bone[0].distance(bone[1]))
    }
}

/// The bones both of whose joints have a place.
fn bones<'a>(
    figure: &'a Figure,
    placed: &'a [Option<Vec2>],
) -> impl Iterator<Item = [Vec2; 2]> + 'a {
    let ends = move |&[a, b]: &[usize; 2]| Some([placed[a]?, placed[b]?]);
    figure.bones.iter().filter_map(ends)
}
