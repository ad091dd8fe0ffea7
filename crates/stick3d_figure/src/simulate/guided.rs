//! A person who follows the figure's path, with the pen lifted here and there.

use glam::Vec2;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Hand, line, wobble};
use crate::figure::Figure;
use crate::stroke::Stroke;

/// How a drawing is cut into strokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Style {
    OneLine,
    StrokePerBone,
    StrokePerBoneWithRetraces,
    StrokePerLimb,
    Mix,
}

pub(crate) const STYLES: [Style; 5] = [
    Style::OneLine,
    Style::StrokePerBone,
    Style::StrokePerBoneWithRetraces,
    Style::StrokePerLimb,
    Style::Mix,
];

/// The path indices of each stroke, first and last included.
pub(crate) fn cuts(figure: &Figure, rng: &mut impl Rng, style: Style) -> Vec<(usize, usize)> {
    let path = &figure.path;
    let last = path.len() - 1;
    let degree = |k: usize| {
        figure
            .bones
            .iter()
            .filter(|bone| bone.contains(&path[k]))
            .count()
    };
    // A step is a way back when its far end was visited before.
    let forth = |k: usize| !path[..=k].contains(&path[k + 1]);
    match style {
        Style::OneLine => vec![(0, last)],
        Style::StrokePerBone => (0..last)
            .filter(|&k| forth(k))
            .map(|k| (k, k + 1))
            .collect(),
        Style::StrokePerBoneWithRetraces => (0..last).map(|k| (k, k + 1)).collect(),
        Style::StrokePerLimb => {
            let mut strokes: Vec<(usize, usize)> = Vec::new();
            for k in (0..last).filter(|&k| forth(k)) {
                match strokes.last_mut() {
                    Some((_, end)) if *end == k && degree(k) <= 2 => *end = k + 1,
                    _ => strokes.push((k, k + 1)),
                }
            }
            strokes
        }
        Style::Mix => {
            // Lift at random joints; skip a way back only after lifting at the end of a limb.
            let mut strokes = Vec::new();
            let mut start = 0;
            for k in 1..last {
                if rng.random_bool(0.35) {
                    strokes.push((start, k));
                    start = k;
                    if degree(k) == 1 && rng.random_bool(0.6) {
                        start = k + 2;
                    }
                }
            }
            strokes.retain(|(a, b)| a < b);
            let mut at = 0;
            strokes.retain_mut(|(a, b)| {
                *a = (*a).max(at);
                at = *b;
                a < b
            });
            let start = start.max(strokes.last().map_or(0, |s| s.1));
            strokes.push((start, last));
            strokes
        }
    }
}

/// The strokes of a drawing of `joints_px`.
pub(crate) fn draw(
    figure: &Figure,
    rng: &mut impl Rng,
    joints_px: &[Vec2],
    cuts: &[(usize, usize)],
    hand: Hand,
) -> Vec<Stroke> {
    let path = &figure.path;
    let mut time_s = 0.0;
    let mut own = ChaCha8Rng::from_rng(rng);
    cuts.iter()
        .map(|&(from, to)| {
            let corners: Vec<Vec2> = (from..=to)
                .map(|k| joints_px[path[k]] + wobble(&mut own, hand.aim_px))
                .collect();
            time_s += 0.3;
            line(&mut own, &corners, hand, &mut time_s)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::rng;

    #[test]
    fn strokes_are_cut_where_a_person_lifts_the_pen() {
        let cut = |figure, style| cuts(figure, &mut rng(1), style);
        let human = Figure::human();
        assert_eq!(
            cut(human, Style::StrokePerLimb),
            [(0, 1), (1, 3), (5, 7), (9, 10), (10, 12), (14, 16)]
        );
        assert_eq!(
            cut(human, Style::StrokePerBone),
            [0, 1, 2, 5, 6, 9, 10, 11, 14, 15].map(|k| (k, k + 1))
        );
        assert_eq!(
            cut(Figure::horse(), Style::StrokePerLimb),
            [
                (0, 1),
                (1, 3),
                (5, 7),
                (9, 10),
                (10, 12),
                (14, 16),
                (18, 19)
            ]
        );
    }
}
