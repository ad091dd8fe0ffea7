//! How a drawing may differ from a body's projection: joints off at random, bones drawn too long or too short, and any
//! place and size.

use glam::Vec2;
use stick3d_figure::figure::Figure;

use super::marks::JointMark;

/// How badly a drawing is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    /// Standard deviation of a joint's coordinate, share of the figure's size.
    pub(super) joint: f64,
    /// Standard deviation of the factor of a bone's length.
    pub(super) bone: f64,
    /// What the logarithm of the fit counts for beside the network's. Proposals are not normally distributed, so taken at its
    /// word the fit is too sure; the less so the more exact the drawing is.
    pub(super) trust: f64,
}

const fn noise(joint: f64, bone: f64, trust: f64) -> Noise {
    Noise { joint, bone, trust }
}

/// An exact drawing.
pub(super) const EXACT: Noise = noise(0.005, 0.01, 0.7);

/// The crooked drawings that are told apart.
pub(super) const CROOKED: [Noise; 5] = [
    noise(0.008, 0.10, 0.1),
    noise(0.014, 0.03, 0.1),
    noise(0.014, 0.12, 0.1),
    noise(0.025, 0.05, 0.1),
    noise(0.025, 0.16, 0.1),
];

/// How likely a drawing is exact, from the logarithm of how much likelier it is exactly than crookedly drawn.
pub(super) fn exactness(exact_over_crooked: f64) -> f64 {
    /// As proposals are not normally distributed, the difference is too sure.
    const SURE: f64 = 0.5;
    1.0 / (1.0 + (-SURE * exact_over_crooked).exp())
}

/// A place anywhere: standard deviation, shares of the figure's size.
const PLACE: f64 = 1.0;
/// Any size: standard deviation of the factor.
const SIZE: f64 = 0.5;
/// A joint that was not drawn: standard deviation, share of the figure's size, so large that nothing is learnt from it.
const ANYWHERE: f64 = 1e3;

/// A figure's bones as seen from its root.
#[derive(Debug, Clone)]
pub(super) struct Skeleton {
    /// Bones as (nearer the root, farther from it).
    bones: Vec<[usize; 2]>,
    /// `[bone][joint]`: whether the joint moves when the bone gets longer.
    beyond: Vec<Vec<bool>>,
    /// Metres.
    size_m: f64,
}

impl Skeleton {
    pub(super) fn new(figure: &Figure, size_m: f32) -> Self {
        let count = figure.joint_count();
        let bones = figure.bones_outward();
        let mut before = vec![None; count];
        for &[near, far] in &bones {
            before[far] = Some(near);
        }
        let is_beyond = |joint: usize, far: usize| {
            let chain = std::iter::successors(Some(joint), |joint| before[*joint]);
            chain.into_iter().any(|joint| joint == far)
        };
        let beyond = bones
            .iter()
            .map(|&[_, far]| (0..count).map(|joint| is_beyond(joint, far)).collect())
            .collect();
        Self {
            bones,
            beyond,
            size_m: f64::from(size_m),
        }
    }

    /// Writes the covariance of a drawing's joints for bones that are off by their whole length, `[joint, axis]` by
    /// `[joint, axis]`, square metres.
    ///
    /// `points` is the body's projection, metres; `strains` are per bone how much more than usual its length is to be
    /// doubted (1: no more). Pinned joints stay where they are however long bones are drawn.
    pub(super) fn write_bones(
        &self,
        points: &[Vec2],
        strains: &[f64],
        marks: &[JointMark],
        covariance: &mut [f64],
    ) {
        let size = 2 * points.len();
        covariance.fill(0.0);
        for ((&[near, far], beyond), strain) in self.bones.iter().zip(&self.beyond).zip(strains) {
            let along = points[far] - points[near];
            add_square(covariance, size, *strain, |joint, axis| {
                if beyond[joint] && marks[joint] != JointMark::Pinned {
                    f64::from(along[axis])
                } else {
                    0.0
                }
            });
        }
    }

    /// Adds the covariance of a drawing that is anywhere and of any size.
    pub(super) fn add_place(&self, points: &[Vec2], covariance: &mut [f64]) {
        let size = 2 * points.len();
        let place = (PLACE * self.size_m).powi(2);
        for axis in 0..2 {
            add_square(covariance, size, place, |_, other| {
                f64::from(u8::from(axis == other))
            });
        }
        let middle = points.iter().sum::<Vec2>() / points.len().max(1) as f32;
        add_square(covariance, size, SIZE * SIZE, |joint, axis| {
            f64::from((points[joint] - middle)[axis])
        });
    }

    /// The variance of a joint's coordinate, square metres.
    pub(super) fn joint_variance(&self, noise: Noise, mark: JointMark) -> f64 {
        let share = match mark {
            JointMark::Drawn => noise.joint,
            JointMark::Guessed => ANYWHERE,
            JointMark::Pinned => EXACT.joint,
        };
        (share * self.size_m).powi(2)
    }

    /// How far beyond its usual error each bone's length is: what is expected of its square, over the variance, given the
    /// inverse covariance times the difference.
    pub(super) fn update_strains(
        &self,
        noise: Noise,
        points: &[Vec2],
        solved: &[f64],
        strains: &mut [f64],
    ) {
        /// Degrees of freedom of the t-distribution that bones' errors are taken to have.
        const FREEDOM: f64 = 4.0;
        for ((&[near, far], beyond), strain) in self.bones.iter().zip(&self.beyond).zip(strains) {
            let along = points[far] - points[near];
            let pull: f64 = beyond
                .iter()
                .enumerate()
                .filter(|(_, beyond)| **beyond)
                .map(|(joint, _)| {
                    f64::from(along.x) * solved[2 * joint]
                        + f64::from(along.y) * solved[2 * joint + 1]
                })
                .sum();
            let error = noise.bone * *strain * pull;
            *strain = (FREEDOM + error * error) / (FREEDOM + 1.0);
        }
    }

    /// The figure's size, metres.
    pub(super) fn size_m(&self) -> f64 {
        self.size_m
    }

    pub(super) fn bone_count(&self) -> usize {
        self.bones.len()
    }
}

/// Adds `variance` times the outer square of a vector over joints and axes.
fn add_square(
    covariance: &mut [f64],
    size: usize,
    variance: f64,
    entry: impl Fn(usize, usize) -> f64,
) {
    for i in 0..size {
        let along = variance * entry(i / 2, i % 2);
        if along == 0.0 {
            continue;
        }
        for j in 0..size {
            covariance[i * size + j] += along * entry(j / 2, j % 2);
        }
    }
}

/// Moves and scales drawn points so that those that say something come nearest to others (least squares, closed form).
pub(super) fn align(drawn: &[Vec2], marks: &[JointMark], to: &[Vec2], aligned: &mut [Vec2]) {
    let weight = |mark: &JointMark| f32::from(u8::from(*mark != JointMark::Guessed));
    let count = marks.iter().map(weight).sum::<f32>().max(1.0);
    let middle = |points: &[Vec2]| {
        let weighed = points.iter().zip(marks);
        weighed
            .map(|(point, mark)| weight(mark) * *point)
            .sum::<Vec2>()
            / count
    };
    let (from_middle, to_middle) = (middle(drawn), middle(to));
    let (mut along, mut square, mut to_square) = (0.0, 0.0, 0.0);
    for ((a, b), mark) in drawn.iter().zip(to).zip(marks) {
        let (a, b) = (*a - from_middle, *b - to_middle);
        along += weight(mark) * a.dot(b);
        square += weight(mark) * a.length_squared();
        to_square += weight(mark) * b.length_squared();
    }
    let square = square.max(f32::MIN_POSITIVE);
    // A drawing that has nothing in common with the body is at least as large.
    let scale = (along / square).max(0.25 * (to_square / square).sqrt());
    for (out, a) in aligned.iter_mut().zip(drawn) {
        *out = to_middle + scale * (*a - from_middle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aligning_undoes_place_and_size() {
        let to = Figure::human().template.clone();
        let drawn: Vec<Vec2> = to
            .iter()
            .map(|p| 130.0 * *p + Vec2::new(40.0, -900.0))
            .collect();
        let mut aligned = vec![Vec2::ZERO; to.len()];
        let marks = vec![JointMark::Drawn; to.len()];
        align(&drawn, &marks, &to, &mut aligned);
        for (a, b) in aligned.iter().zip(&to) {
            assert!(a.distance(*b) < 1e-4);
        }
    }

    #[test]
    fn what_was_not_drawn_does_not_move_the_rest() {
        let human = Figure::human();
        let to = &human.template;
        let hand = human.joint_index("hand_l").unwrap();
        let mut drawn: Vec<Vec2> = to.iter().map(|p| 30.0 * *p).collect();
        drawn[hand] += Vec2::new(40.0, 90.0);
        let mut marks = vec![JointMark::Drawn; to.len()];
        marks[hand] = JointMark::Guessed;
        let mut aligned = vec![Vec2::ZERO; to.len()];
        align(&drawn, &marks, to, &mut aligned);
        for (joint, (a, b)) in aligned.iter().zip(to).enumerate() {
            assert_eq!(a.distance(*b) < 1e-4, joint != hand);
        }
    }

    #[test]
    fn a_longer_bone_moves_what_hangs_on_it() {
        let human = Figure::human();
        let skeleton = Skeleton::new(human, 1.7);
        assert_eq!(skeleton.bone_count(), human.bones.len());
        let elbow = human.joint_index("elbow_r").unwrap();
        let bone = skeleton
            .bones
            .iter()
            .position(|bone| bone[1] == elbow)
            .unwrap();
        let moved: Vec<&str> = (0..human.joint_count())
            .filter(|joint| skeleton.beyond[bone][*joint])
            .map(|joint| human.joints[joint].name.as_str())
            .collect();
        assert_eq!(moved, ["elbow_r", "hand_r"]);
    }
}
