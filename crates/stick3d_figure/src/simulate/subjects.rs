//! Who is drawn: plausible poses of the shipped figures.

use glam::{Quat, Vec2, Vec3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

use crate::figure::Figure;

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
        let mut placed = vec![(Vec3::ZERO, Quat::from_rotation_y(yaw)); figure.joint_count()];
        for [from, to] in figure.bones_outward() {
            let (at, turned) = placed[from];
            let line = (figure.template[to] - figure.template[from]).extend(0.0);
            let swing =
                Quat::from_rotation_arc(line.normalize(), in_cone(rng, line.normalize(), max_deg));
            placed[to] = (at + turned * swing * line, turned * swing);
        }
        let flat: Vec<Vec2> = placed.iter().map(|(at, _)| at.truncate()).collect();
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
