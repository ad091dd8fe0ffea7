//! How far feet skate when a loop of keys walks.

use glam::Vec3;
use stick3d_figure::sketch::Sketch;
use stick3d_model::Inference;
use stick3d_model::latent::{Interpolation, Motion, MotionSettings, Repeat, feet};

use super::cases::DrawnMotion;
use crate::evaluate::EvalError;

/// A foot is on the ground whose joint is less than this above where it is at rest, metres: a swinging foot is hardly lower
/// (Zhang, Starke, Komura, Saito, "Mode-adaptive neural networks for quadruped motion control", ACM TOG 37, 2018). And one is
/// near it that is less than the second number above; feet of real walkers swing there.
const NEAR_M: [f32; 2] = [0.025, 0.05];
/// A foot near the ground that is faster than this skates, metres a second.
const SKATING_M_PER_S: f32 = 0.5;
/// Rounds of a loop that are looked at.
const ROUNDS: f32 = 2.0;

/// What one gait yields, on the ground and on the spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Skating {
    /// Per height of [`NEAR_M`], the share of the steps of feet below it that are too fast: grounded, and with the root joint
    /// held still.
    pub(super) ratio: [[f32; 2]; 2],
    /// The same of the true motion, in every step of which the lowest foot stays where it is: what no motion can be better
    /// than that looks like it.
    pub(super) truth: [f32; 2],
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
    let mut counts = [[Count::default(); 2]; NEAR_M.len()];
    let start_s = motion.path().key_times_s()[0];
    let mut before: Option<[Vec<Vec3>; 2]> = None;
    for frame in 0..=(duration_s * frames_per_s) as usize {
        let time_s = start_s + frame as f32 / frames_per_s;
        let now = feet_at(&motion, time_s, inference)?;
        if let Some(before) = &before {
            for (counts, near_m) in counts.iter_mut().zip(NEAR_M) {
                for ((before, now), count) in before.iter().zip(&now).zip(counts) {
                    for ((from, to), rest_m) in before.iter().zip(now).zip(&rest_m) {
                        count.add(*from, *to, rest_m + near_m, frames_per_s);
                    }
                }
            }
        }
        before = Some(now);
    }
    let way = |time_s| motion.root_translation(time_s).unwrap_or_default();
    let way = (way(start_s + duration_s) - way(start_s)) * Vec3::new(1.0, 0.0, 1.0);
    Ok(Skating {
        ratio: counts.map(|counts| counts.map(Count::ratio)),
        truth: of_truth(drawn, &feet(inference.figure()), &rest_m, frames_per_s),
        speed_m_per_s: way.length() / duration_s,
    })
}

/// The skating of a true motion.
fn of_truth(
    drawn: &DrawnMotion,
    feet: &[usize],
    rest_m: &[f32],
    frames_per_s: f32,
) -> [f32; NEAR_M.len()] {
    let standing: Vec<Vec<Vec3>> = drawn
        .frames
        .iter()
        .map(|frame| {
            let lowest_m = frame.mesh.iter().map(|v| v.y).fold(f32::INFINITY, f32::min);
            let ground_m = lowest_m - frame.lift_m;
            let raised = |foot: &usize| frame.joints[*foot] - Vec3::Y * ground_m;
            feet.iter().map(raised).collect()
        })
        .collect();
    let mut counts = [Count::default(); NEAR_M.len()];
    for pair in standing.windows(2) {
        let (before, now) = (&pair[0], &pair[1]);
        let height = |foot: &usize| before[*foot].y.max(now[*foot].y) - rest_m[*foot];
        let lowest = (0..feet.len()).min_by(|a, b| height(a).total_cmp(&height(b)));
        let Some(pinned) = lowest else {
            continue;
        };
        let way = before[pinned] - now[pinned];
        for (foot, rest_m) in rest_m.iter().enumerate() {
            for (count, near_m) in counts.iter_mut().zip(NEAR_M) {
                let to = now[foot] + way * Vec3::new(1.0, 0.0, 1.0);
                count.add(before[foot], to, rest_m + near_m, frames_per_s);
            }
        }
    }
    counts.map(Count::ratio)
}

/// Steps of feet that are low, and those of them that skate.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    low: usize,
    skating: usize,
}

impl Count {
    fn add(&mut self, from: Vec3, to: Vec3, below_m: f32, frames_per_s: f32) {
        if from.y.max(to.y) < below_m {
            let step = (to - from) * Vec3::new(1.0, 0.0, 1.0);
            self.low += 1;
            self.skating += usize::from(step.length() * frames_per_s > SKATING_M_PER_S);
        }
    }

    fn ratio(self) -> f32 {
        self.skating as f32 / self.low.max(1) as f32
    }
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
