//! How far feet skate when a loop of keys walks.

use glam::Vec3;
use stick3d_figure::sketch::Sketch;
use stick3d_model::Inference;
use stick3d_model::latent::{Interpolation, Motion, MotionSettings, Repeat, feet};

use super::cases::DrawnMotion;
use crate::evaluate::EvalError;

/// A foot is near the ground whose joint is less than this above where it is at rest, metres.
const NEAR_M: f32 = 0.05;
/// A foot near the ground that is faster than this skates, metres a second.
const SKATING_M_PER_S: f32 = 0.5;
/// Rounds of a loop that are looked at.
const ROUNDS: f32 = 2.0;

/// What one gait yields, on the ground and on the spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Skating {
    /// Share of the steps of feet near the ground that are too fast: grounded, and with the root joint held still.
    pub(super) ratio: [f32; 2],
    /// How fast it walks over the ground, metres a second.
    pub(super) speed_m_per_s: f32,
}

/// Plays a gait and looks at its feet.
pub(super) fn measure(
    drawn: &DrawnMotion,
    inference: &mut Inference,
    frames_per_s: f32,
) -> Result<Skating, EvalError> {
    let keys = drawn.latent_keys(inference)?;
    let settings = MotionSettings {
        interpolation: Interpolation::Cubic,
        repeat: match drawn.is_loop {
            true => Repeat::Loop { closing_s: None },
            false => Repeat::Once,
        },
        ..MotionSettings::default()
    };
    let motion = Motion::new(&keys, settings, inference)?;
    let rest_m = rest_heights(inference)?;
    let duration_s = ROUNDS * motion.path().duration_s();
    let mut counts = [(0_usize, 0_usize); 2];
    let start_s = motion.path().key_times_s()[0];
    let mut before: Option<[Vec<Vec3>; 2]> = None;
    for frame in 0..=(duration_s * frames_per_s) as usize {
        let time_s = start_s + frame as f32 / frames_per_s;
        let now = feet_at(&motion, time_s, inference)?;
        if let Some(before) = &before {
            for ((before, now), (near, skating)) in before.iter().zip(&now).zip(&mut counts) {
                for ((from, to), rest_m) in before.iter().zip(now).zip(&rest_m) {
                    if from.y.max(to.y) - rest_m < NEAR_M {
                        *near += 1;
                        let step = (*to - *from) * Vec3::new(1.0, 0.0, 1.0);
                        *skating += usize::from(step.length() * frames_per_s > SKATING_M_PER_S);
                    }
                }
            }
        }
        before = Some(now);
    }
    let way = |time_s| motion.root_translation(time_s).unwrap_or_default();
    let way = (way(start_s + duration_s) - way(start_s)) * Vec3::new(1.0, 0.0, 1.0);
    Ok(Skating {
        ratio: counts.map(|(near, skating)| skating as f32 / near.max(1) as f32),
        speed_m_per_s: way.length() / duration_s,
    })
}

/// Where the feet are, with the root joint where the motion says, and with it only as high.
fn feet_at(
    motion: &Motion,
    time_s: f32,
    inference: &mut Inference,
) -> Result<[Vec<Vec3>; 2], EvalError> {
    let mut latent = vec![0.0; inference.latent_len()];
    motion.sample_into(time_s, &mut latent)?;
    let mut joints = vec![Vec3::ZERO; inference.figure().joint_count()];
    inference.joints(&latent, &mut joints)?;
    let root = motion.root_translation(time_s).unwrap_or_default();
    let feet = feet(inference.figure());
    Ok([root, Vec3::new(0.0, root.y, 0.0)]
        .map(|root| feet.iter().map(|foot| joints[*foot] + root).collect()))
}

/// How high the feet's joints are above the ground when the figure stands as in its template, metres.
fn rest_heights(inference: &mut Inference) -> Result<Vec<f32>, EvalError> {
    let figure = inference.figure().clone();
    let mut latent = vec![0.0; inference.latent_len()];
    inference.encode(&Sketch::template(&figure), &mut latent)?;
    let mesh = super::methods::mesh(&latent, inference)?;
    let lowest = mesh.iter().map(|v| v.y).fold(f32::INFINITY, f32::min);
    let mut joints = vec![Vec3::ZERO; figure.joint_count()];
    inference.joints(&latent, &mut joints)?;
    let heights = feet(&figure)
        .into_iter()
        .map(|foot| joints[foot].y - lowest);
    Ok(heights.collect())
}
