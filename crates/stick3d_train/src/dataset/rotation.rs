//! How whole bodies are turned before they are drawn.

use glam::{Mat3, Quat};
use rand::Rng;
use serde::{Deserialize, Serialize};
use stick3d_figure::figure::Views;

use super::normal_pair;

/// Which turns of a body are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Rotations {
    /// The 21 of the paper (section 4.1): about y from -90° to 90° in steps of 30°, about z by -45°, 0° and 45°.
    Paper,
    /// As [`Rotations::Continuous`]; half of the bodies are turned about, so that they face the other way.
    BothWays {
        /// About y, from the figure's usual view or its back.
        yaw_deg: f32,
        /// About z, in the plane of the sketch.
        roll_deg: f32,
        /// About x: toward the viewer.
        pitch_deg: f32,
        /// As in [`Rotations::Continuous`].
        upright_share: f32,
    },
    /// Any within limits, uniformly, degrees either way.
    Continuous {
        /// About y, the body's own long axis: which way it faces.
        yaw_deg: f32,
        /// About z, in the plane of the sketch.
        roll_deg: f32,
        /// About x: nodding toward the viewer.
        pitch_deg: f32,
        /// Share of the turns whose roll is instead drawn from a normal distribution of 10° about upright:
        /// most figures stand.
        upright_share: f32,
    },
}

impl Rotations {
    /// The turns that a figure is usually drawn in: those that it is trained with.
    #[must_use]
    pub fn of(views: &Views) -> Self {
        let Views {
            yaw_deg,
            both_ways,
            roll_deg,
            pitch_deg,
            upright_share,
        } = *views;
        if both_ways {
            Self::BothWays {
                yaw_deg,
                roll_deg,
                pitch_deg,
                upright_share,
            }
        } else {
            Self::Continuous {
                yaw_deg,
                roll_deg,
                pitch_deg,
                upright_share,
            }
        }
    }

    /// The turns that models of a figure are measured with: uniform within the limits of [`Rotations::of`].
    #[must_use]
    pub fn test_of(views: &Views) -> Self {
        Self::of(&Views {
            upright_share: 0.0,
            ..*views
        })
    }

    /// The paper's 21 turns.
    #[must_use]
    pub fn paper_list() -> Vec<Quat> {
        let rolls = [-45.0, 0.0, 45.0];
        let yaws = (-3..=3).map(|step| 30.0 * step as f32);
        yaws.flat_map(|yaw| rolls.map(|roll| rotation(yaw, 0.0, roll)))
            .collect()
    }

    /// The paper's 21 turns, and for a figure that is drawn facing both ways as many of its other side.
    #[must_use]
    pub fn paper_list_of(views: &Views) -> Vec<Quat> {
        let list = Self::paper_list();
        if !views.both_ways {
            return list;
        }
        let about = |turn: &Quat| *turn * Quat::from_rotation_y(std::f32::consts::PI);
        let others: Vec<Quat> = list.iter().map(about).collect();
        [list, others].concat()
    }

    /// Draws one.
    pub fn sample(&self, rng: &mut impl Rng) -> Quat {
        match *self {
            Self::Paper => {
                let yaw = 30.0 * (rng.random_range(0..7_i32) - 3) as f32;
                rotation(yaw, 0.0, 45.0 * (rng.random_range(0..3_i32) - 1) as f32)
            }
            Self::Continuous {
                yaw_deg,
                roll_deg,
                pitch_deg,
                upright_share,
            } => {
                let uniform = |rng: &mut dyn rand::RngCore| 2.0 * rng.random::<f32>() - 1.0;
                let yaw = yaw_deg * uniform(rng);
                let pitch = pitch_deg * uniform(rng);
                let mut roll = roll_deg * uniform(rng);
                if rng.random::<f32>() < upright_share {
                    roll = (10.0 * normal_pair(rng)[0]).clamp(-roll_deg, roll_deg);
                }
                rotation(yaw, pitch, roll)
            }
            Self::BothWays {
                yaw_deg,
                roll_deg,
                pitch_deg,
                upright_share,
            } => {
                let one_way = Self::Continuous {
                    yaw_deg,
                    roll_deg,
                    pitch_deg,
                    upright_share,
                };
                let about = if rng.random::<bool>() {
                    std::f32::consts::PI
                } else {
                    0.0
                };
                one_way.sample(rng) * Quat::from_rotation_y(about)
            }
        }
    }
}

/// The turn by yaw about y first, then pitch about x, then roll about z, degrees.
#[must_use]
pub fn rotation(yaw_deg: f32, pitch_deg: f32, roll_deg: f32) -> Quat {
    Quat::from_rotation_z(roll_deg.to_radians())
        * Quat::from_rotation_x(pitch_deg.to_radians())
        * Quat::from_rotation_y(yaw_deg.to_radians())
}

/// Turns coefficients laid out `[3][rank]`: the mesh they stand for turns with them.
pub(crate) fn turn_coefficients(turn: Quat, coefficients: &[f32], output: &mut [f32]) {
    let rank = coefficients.len() / 3;
    let rows = Mat3::from_quat(turn).transpose();
    let (x, rest) = coefficients.split_at(rank);
    let (y, z) = rest.split_at(rank);
    for (axis, out) in output.chunks_exact_mut(rank).enumerate() {
        let row = rows.col(axis);
        for (((out, x), y), z) in out.iter_mut().zip(x).zip(y).zip(z) {
            *out = row.x * x + row.y * y + row.z * z;
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use stick3d_figure::figure::Figure;

    use super::*;
    use crate::dataset::random;

    #[test]
    fn the_paper_has_21() {
        let list = Rotations::paper_list();
        assert_eq!(list.len(), 21);
        let mut rng = random(1, "test", 0);
        for _ in 0..100 {
            let turn = Rotations::Paper.sample(&mut rng);
            assert!(list.iter().any(|known| known.dot(turn).abs() > 1.0 - 1e-6));
        }
    }

    #[test]
    fn yaw_turns_the_chest_and_roll_tilts_the_drawing() {
        // At yaw 90° he faces +x, the right of the sketch.
        assert!((rotation(90.0, 0.0, 0.0) * Vec3::Z).distance(Vec3::X) < 1e-6);
        // A positive roll tilts the head to the left of the sketch.
        assert!((rotation(0.0, 0.0, 45.0) * Vec3::Y).x < -0.7);
    }

    #[test]
    fn shipped_turns_stay_in_their_limits() {
        let mut rng = random(2, "test", 0);
        for _ in 0..1000 {
            let turn = Rotations::of(&Figure::human().views).sample(&mut rng);
            let (facing, up) = (turn * Vec3::Z, turn * Vec3::Y);
            assert!(facing.z > -0.2, "he never shows his back: {facing}");
            assert!(up.y > 0.69, "{up}");
        }
    }

    #[test]
    fn a_horse_shows_either_side_and_never_its_back() {
        let mut rng = random(3, "test", 0);
        let mut rightward = 0;
        for _ in 0..1000 {
            let turn = Rotations::of(&Figure::horse().views).sample(&mut rng);
            let (forward, up) = (turn * Vec3::X, turn * Vec3::Y);
            assert!(up.y > 0.8, "{up}");
            assert!(forward.x.abs() > 0.25, "{forward}");
            rightward += usize::from(forward.x > 0.0);
        }
        assert!((450..550).contains(&rightward), "{rightward}");
        assert_eq!(Rotations::paper_list_of(&Figure::horse().views).len(), 42);
        assert_eq!(
            Rotations::paper_list_of(&Figure::human().views),
            Rotations::paper_list()
        );
    }

    #[test]
    fn turned_coefficients_are_coefficients_of_the_turned_points() {
        let turn = rotation(30.0, 5.0, -20.0);
        let points = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 0.5, 0.25)];
        let flat: Vec<f32> = (0..3).flat_map(|axis| points.map(|p| p[axis])).collect();
        let mut output = vec![0.0; 6];
        turn_coefficients(turn, &flat, &mut output);
        for (i, point) in points.iter().enumerate() {
            let expected = turn * *point;
            let found = Vec3::new(output[i], output[2 + i], output[4 + i]);
            assert!(expected.distance(found) < 1e-5);
        }
    }
}
