//! Crooked and disproportionate drawings: what hands do to a sketch.

use glam::Vec2;
use rand::Rng;
use serde::{Deserialize, Serialize};
use stick3d_figure::complete_from_template;
use stick3d_figure::figure::Figure;

use super::normal_pair;

/// How the sketches of training differ from true projections.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Augmentation {
    /// Share of the sketches that stay true.
    pub clean_share: f32,
    /// The most that joints of the others are jittered: the standard deviation is drawn between 0 and this, metres.
    pub jitter_m: f32,
    /// The most that their bones are scaled: the range is drawn between 0 and this.
    pub bone_scale: f32,
    /// Share of the sketches, clean or not, of which a limb is not drawn, but filled in from the template.
    #[serde(default)]
    pub missing_share: f32,
}

/// One kind of disturbance of a sketch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SketchNoise {
    /// Standard deviation by which every coordinate of every joint is moved, metres (normal distribution).
    pub jitter_m: f32,
    /// Every bone's length is multiplied by its own factor, uniform in 1 ± this.
    pub bone_scale: f32,
}

impl SketchNoise {
    /// No disturbance.
    pub const CLEAN: Self = Self {
        jitter_m: 0.0,
        bone_scale: 0.0,
    };

    /// Disturbs the joints of a sketch (metres, one point per joint): bones first, then jitter.
    pub fn apply(&self, figure: &Figure, joints: &mut [Vec2], rng: &mut impl Rng) {
        if self.bone_scale > 0.0 {
            scale_bones(figure, joints, || {
                1.0 + self.bone_scale * (2.0 * rng.random::<f32>() - 1.0)
            });
        }
        if self.jitter_m > 0.0 {
            for joint in joints {
                *joint += self.jitter_m * Vec2::from_array(normal_pair(rng));
            }
        }
    }
}

impl Augmentation {
    /// Disturbs the joints of a sketch (metres, one point per joint).
    pub fn apply(&self, figure: &Figure, joints: &mut Vec<Vec2>, rng: &mut impl Rng) {
        self.sample(rng).apply(figure, joints, rng);
        if self.missing_share > 0.0 && rng.random::<f32>() < self.missing_share {
            leave_out_a_limb(figure, joints, rng);
        }
    }

    /// Draws the disturbance of one sketch.
    pub fn sample(&self, rng: &mut impl Rng) -> SketchNoise {
        if rng.random::<f32>() < self.clean_share {
            return SketchNoise::CLEAN;
        }
        SketchNoise {
            jitter_m: self.jitter_m * rng.random::<f32>(),
            bone_scale: self.bone_scale * rng.random::<f32>(),
        }
    }
}

/// Puts the joints of a random limb where they are while a person draws the others.
fn leave_out_a_limb(figure: &Figure, joints: &mut Vec<Vec2>, rng: &mut impl Rng) {
    let limbs = figure.limbs();
    if limbs.is_empty() {
        return;
    }
    let limb = &limbs[rng.random_range(0..limbs.len())];
    let mut placed: Vec<Option<Vec2>> = joints.iter().copied().map(Some).collect();
    limb.joints.iter().for_each(|joint| placed[*joint] = None);
    if let Some(sketch) = complete_from_template(figure, &placed) {
        *joints = sketch.points().to_vec();
    }
}

/// Scales every bone by its own factor, from the root outward, so that what hangs on a bone moves with it.
fn scale_bones(figure: &Figure, joints: &mut [Vec2], mut factor: impl FnMut() -> f32) {
    let before = joints.to_vec();
    for [from, to] in figure.bones_outward() {
        joints[to] = joints[from] + factor() * (before[to] - before[from]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::random;

    fn lengths(figure: &Figure, joints: &[Vec2]) -> Vec<f32> {
        figure
            .bones
            .iter()
            .map(|&[a, b]| joints[a].distance(joints[b]))
            .collect()
    }

    #[test]
    fn clean_sketches_stay() {
        let figure = Figure::human();
        let mut joints = figure.template.clone();
        SketchNoise::CLEAN.apply(figure, &mut joints, &mut random(1, "test", 0));
        assert_eq!(joints, figure.template);
    }

    #[test]
    fn scaled_bones_keep_their_directions() {
        let figure = Figure::human();
        let noise = SketchNoise {
            jitter_m: 0.0,
            bone_scale: 0.15,
        };
        let mut rng = random(2, "test", 0);
        let before = lengths(figure, &figure.template);
        let mut seen: (f32, f32) = (1.0, 1.0);
        for _ in 0..200 {
            let mut joints = figure.template.clone();
            noise.apply(figure, &mut joints, &mut rng);
            assert_eq!(joints[figure.root], figure.template[figure.root]);
            for (bone, (&[a, b], before)) in figure.bones.iter().zip(&before).enumerate() {
                let factor = joints[a].distance(joints[b]) / before;
                assert!((0.849..=1.151).contains(&factor), "bone {bone}: {factor}");
                seen = (seen.0.min(factor), seen.1.max(factor));
                let turned =
                    (joints[b] - joints[a]).angle_to(figure.template[b] - figure.template[a]);
                assert!(turned.abs() < 2e-3);
            }
        }
        assert!(seen.0 < 0.87 && seen.1 > 1.13, "{seen:?}");
    }

    #[test]
    fn a_limb_is_missing_as_often_as_is_said() {
        let figure = Figure::human();
        let augmentation = Augmentation {
            clean_share: 1.0,
            jitter_m: 0.0,
            bone_scale: 0.0,
            missing_share: 0.3,
        };
        let raised: Vec<Vec2> = figure
            .template
            .iter()
            .map(|p| *p * Vec2::new(2.0, 1.0))
            .collect();
        let mut rng = random(4, "test", 0);
        let (mut missing, rounds) = (0, 1000);
        for _ in 0..rounds {
            let mut joints = raised.clone();
            augmentation.apply(figure, &mut joints, &mut rng);
            let moved: Vec<usize> = (0..joints.len())
                .filter(|i| joints[*i] != raised[*i])
                .collect();
            let is_of_a_limb = figure
                .limbs()
                .iter()
                .any(|limb| moved.iter().all(|joint| limb.joints.contains(joint)));
            assert!(is_of_a_limb, "{moved:?}");
            missing += usize::from(!moved.is_empty());
        }
        assert!((250..350).contains(&missing), "{missing}");
    }

    #[test]
    fn jitter_has_the_given_spread() {
        let figure = Figure::human();
        let noise = SketchNoise {
            jitter_m: 0.025,
            bone_scale: 0.0,
        };
        let mut rng = random(3, "test", 0);
        let mut squares = 0.0;
        let rounds = 2000;
        for _ in 0..rounds {
            let mut joints = figure.template.clone();
            noise.apply(figure, &mut joints, &mut rng);
            squares += joints
                .iter()
                .zip(&figure.template)
                .map(|(a, b)| a.distance_squared(*b))
                .sum::<f32>();
        }
        let spread = (squares / (2 * rounds * figure.joint_count()) as f32).sqrt();
        assert!((spread - 0.025).abs() < 0.001, "{spread}");
    }
}
