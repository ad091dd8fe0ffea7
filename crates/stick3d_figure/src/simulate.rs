//! A person who draws the shipped figures, for tests: plausible poses, styles of drawing, an unsteady hand.

pub(crate) mod any_order;

use glam::{Quat, Vec2, Vec3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

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

/// How steadily and quickly it is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hand {
    pub(crate) height_px: f32,
    pub(crate) spacing_px: f32,
    pub(crate) jitter_px: f32,
    /// How far strokes start beside the joint they mean.
    pub(crate) aim_px: f32,
    pub(crate) speed_px_per_s: f32,
    /// How far bones bulge, at most, in parts of their length.
    pub(crate) bow: f32,
}

impl Default for Hand {
    fn default() -> Self {
        Self {
            height_px: 450.0,
            spacing_px: 4.0,
            jitter_px: 2.0,
            aim_px: 6.0,
            speed_px_per_s: 700.0,
            bow: 0.04,
        }
    }
}

pub(crate) fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

fn in_cone(rng: &mut impl Rng, axis: Vec3, max_deg: f32) -> Vec3 {
    let angle = rng.random_range(0.0..max_deg.to_radians());
    let side = Quat::from_axis_angle(axis, rng.random_range(0.0..std::f32::consts::TAU))
        * axis.any_orthonormal_vector();
    axis * angle.cos() + side * angle.sin()
}

/// Who is drawn.
#[derive(Clone, Copy)]
pub(crate) struct Subject {
    pub(crate) figure: fn() -> &'static Figure,
    /// Joints in a random pose, metres: bones turn in three dimensions and are projected.
    pub(crate) pose: fn(&mut ChaCha8Rng) -> Vec<Vec2>,
    /// As `pose`, but one of those that can be read in one way only.
    pub(crate) clear_pose: fn(&mut ChaCha8Rng) -> Vec<Vec2>,
}

impl std::fmt::Debug for Subject {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&(self.figure)().name)
    }
}

pub(crate) const HUMAN: Subject = Subject {
    figure: Figure::human,
    pose,
    clear_pose,
};

pub(crate) const HORSE: Subject = Subject {
    figure: Figure::horse,
    pose: |rng| swung(Figure::horse(), rng, 32.0, |_| true),
    clear_pose: |rng| swung(Figure::horse(), rng, 26.0, clear_legs),
};

/// The template with every bone swung out of its direction by up to `max_deg`, what hangs on it along
/// with it, turned to the right or the left.
fn swung(
    figure: &Figure,
    rng: &mut impl Rng,
    max_deg: f32,
    wanted: fn(&[Vec2]) -> bool,
) -> Vec<Vec2> {
    loop {
        let yaw =
            rng.random_range(-0.6..0.6) + std::f32::consts::PI * f32::from(rng.random::<bool>());
        let mut placed: Vec<Option<(Vec3, Quat)>> = vec![None; figure.joint_count()];
        placed[figure.root] = Some((Vec3::ZERO, Quat::from_rotation_y(yaw)));
        for _ in 0..figure.bones.len() {
            for &[a, b] in &figure.bones {
                let (from, to) = match (placed[a], placed[b]) {
                    (Some(_), None) => (a, b),
                    (None, Some(_)) => (b, a),
                    _ => continue,
                };
                let Some((at, turned)) = placed[from] else {
                    continue;
                };
                let line = (figure.template[to] - figure.template[from]).extend(0.0);
                let swing = Quat::from_rotation_arc(
                    line.normalize(),
                    in_cone(rng, line.normalize(), max_deg),
                );
                placed[to] = Some((at + turned * swing * line, turned * swing));
            }
        }
        let flat: Vec<Vec2> = placed
            .iter()
            .flatten()
            .map(|(at, _)| at.truncate())
            .collect();
        let drawable = figure
            .bones
            .iter()
            .all(|&[a, b]| flat[a].distance(flat[b]) > 0.1);
        if drawable && wanted(&flat) {
            return flat;
        }
    }
}

/// Feet and knees of the horse's legs stand apart, and every knee is bent.
fn clear_legs(points: &[Vec2]) -> bool {
    let figure = Figure::horse();
    let at = |name: &str| points[figure.joint_index(name).unwrap()];
    let bent = [
        ("shoulder", "knee_fr", "foot_fr"),
        ("shoulder", "knee_fl", "foot_fl"),
        ("hip", "knee_br", "foot_br"),
        ("hip", "knee_bl", "foot_bl"),
    ]
    .iter()
    .all(|&(root, knee, foot)| {
        let (upper, lower) = (at(knee) - at(root), at(foot) - at(knee));
        (18.0..125.0).contains(&upper.angle_to(lower).abs().to_degrees())
            && upper.length() > 0.25
            && lower.length() > 0.2
    });
    let apart = [("fr", "fl"), ("br", "bl")].iter().all(|(one, other)| {
        at(&format!("knee_{one}")).distance(at(&format!("knee_{other}"))) > 0.2
            && at(&format!("foot_{one}")).distance(at(&format!("foot_{other}"))) > 0.2
    });
    bent && apart
}

/// The joints of the human in a random pose, metres: bones turn in three dimensions and are projected.
fn pose(rng: &mut ChaCha8Rng) -> Vec<Vec2> {
    loop {
        let up = in_cone(rng, Vec3::Y, 25.0);
        let abdomen = Vec3::ZERO;
        let neck = up * 0.54;
        let forehead = neck + in_cone(rng, up, 25.0) * 0.2;
        let yaw = Quat::from_rotation_y(rng.random_range(-0.8..0.8));
        let mut points = vec![forehead, neck, abdomen];
        for side in [-1.0, 1.0] {
            let shoulder = neck + yaw * Vec3::new(side * 0.17, -0.07, 0.0);
            let upper = in_cone(rng, Vec3::new(side * 0.5, -0.8, 0.2).normalize(), 110.0);
            let elbow = shoulder + upper * 0.28;
            let hand = elbow + in_cone(rng, upper, 110.0) * 0.33;
            let thigh = in_cone(rng, Vec3::new(side * 0.2, -1.0, 0.2).normalize(), 60.0);
            let knee = abdomen + yaw * Vec3::new(side * 0.09, -0.03, 0.0) + thigh * 0.41;
            let foot = knee + in_cone(rng, thigh, 75.0) * 0.45;
            points.extend([elbow, hand, knee, foot]);
        }
        let flat: Vec<Vec2> = points.iter().map(|p| p.truncate()).collect();
        let drawable = Figure::human()
            .bones
            .iter()
            .all(|&[a, b]| flat[a].distance(flat[b]) > 0.08);
        if drawable {
            return flat;
        }
    }
}

/// As [`pose`], but one of those that can be read in one way only: limbs are visibly bent, hands are away from
/// the neck and feet from the abdomen, nothing is much foreshortened.
fn clear_pose(rng: &mut ChaCha8Rng) -> Vec<Vec2> {
    let limbs = [(1, 3, 4), (2, 5, 6), (1, 7, 8), (2, 9, 10)];
    loop {
        let points = pose(rng);
        let clear = limbs.iter().all(|&(root, middle, end)| {
            let (upper, lower) = (points[middle] - points[root], points[end] - points[middle]);
            let bend_deg = upper.angle_to(lower).abs().to_degrees();
            (25.0..125.0).contains(&bend_deg)
                && upper.length() > 0.22
                && lower.length() > 0.2
                && points[root].distance(points[end]) > 0.25
        });
        if clear {
            return points;
        }
    }
}

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

/// A stroke from corner to corner by an unsteady hand.
pub(crate) fn line(rng: &mut ChaCha8Rng, corners: &[Vec2], hand: Hand, time_s: &mut f64) -> Stroke {
    let mut stroke = Stroke::default();
    for pair in corners.windows(2) {
        let length = pair[0].distance(pair[1]);
        let steps = (length / hand.spacing_px).ceil().max(1.0);
        // A slight bow, since nobody draws a straight line.
        let bow = (pair[1] - pair[0]).perp() * rng.random_range(-hand.bow..=hand.bow);
        for i in 0..=steps as usize {
            let t = i as f32 / steps;
            let p = pair[0].lerp(pair[1], t) + bow * (4.0 * t * (1.0 - t));
            stroke
                .push(p + wobble(rng, hand.jitter_px), *time_s)
                .unwrap();
            *time_s += f64::from(length / steps / hand.speed_px_per_s);
        }
    }
    stroke
}

/// Anywhere in a square round zero.
pub(crate) fn wobble(rng: &mut ChaCha8Rng, size: f32) -> Vec2 {
    Vec2::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0)) * size
}

/// A pose in canvas pixels.
pub(crate) fn on_canvas(pose: &[Vec2], height_px: f32) -> Vec<Vec2> {
    let scale = height_px / 1.8;
    pose.iter()
        .map(|p| *p * scale + Vec2::new(400.0, 380.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
