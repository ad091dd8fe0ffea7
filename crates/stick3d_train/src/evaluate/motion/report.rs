//! What a measurement of motions says.

use serde::{Deserialize, Serialize};

use super::Beyond;
use super::gait::Skating;
use super::measures::percentile;
use crate::dataset::rounded;

/// How good motions are, beside other ways to make them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MotionReport {
    /// What was measured on.
    pub test: MotionTestSet,
    /// Between keys: one entry per method, and the true motion itself.
    pub between: Vec<BetweenReport>,
    /// Beyond the last key.
    pub beyond: BeyondReport,
    /// Feet on the ground.
    pub gaits: GaitReport,
}

/// What was measured on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MotionTestSet {
    /// The motions, each drawn at every yaw.
    pub motions: Vec<String>,
    /// The loops whose feet were looked at, likewise.
    pub gaits: Vec<String>,
    /// Degrees about y.
    pub yaws_deg: Vec<f32>,
    /// Frames a second.
    pub frames_per_s: f32,
}

/// What a method puts between keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BetweenReport {
    /// The method.
    pub name: String,
    /// How many motions were measured.
    pub motions: usize,
    /// Mean distance between a vertex and where it should be, centimetres.
    pub vertex_cm: f64,
    /// Mean error of a bone's length, per cent of the true one.
    pub bone_length_percent: f64,
    /// Mean difference of a bone's length from the even way between its lengths in the keys, per cent: what the method
    /// itself adds to what was wrong with the keys.
    pub bone_length_beside_keys_percent: f64,
    /// By how much edges are longer than on any body of the rig: 99 of 100 are stretched less; mean over frames.
    pub edge_stretch_percent: f64,
    /// The same in the worst frame.
    pub edge_stretch_worst_percent: f64,
    /// Jerk of the joints (third derivative of their way), root mean square, metres per cubic second.
    pub jerk_m_s3: f64,
}

/// What is beyond the last key. Edges may be as long as on any body of the rig or in the keys: what is wrong with a key is no
/// fault of its extrapolation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BeyondReport {
    /// How many motions were followed, up to 8 key distances.
    pub motions: usize,
    /// Median way until edge stretch passes 5 per cent, key distances: the endless straight line of the paper.
    pub unbounded_horizon: f64,
    /// A tenth of them break earlier than this.
    pub unbounded_horizon_p10: f64,
    /// The median for the vertices' straight line.
    pub vertex_linear_horizon: f64,
    /// How far the bounded extrapolation goes: median.
    pub bounded_reach: f64,
    /// A tenth of them stop earlier than this.
    pub bounded_reach_p10: f64,
    /// The largest edge stretch at any time, bounded, per cent.
    pub bounded_worst_percent: f64,
    /// The same, unbounded.
    pub unbounded_worst_percent: f64,
}

/// How feet skate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GaitReport {
    /// How many loops were looked at.
    pub gaits: usize,
    /// Share of the steps of feet on the ground that skate (faster than 0.5 m/s while both ends of the step are less than
    /// 2.5 cm above where the foot is at rest), grounded, per cent; mean over loops.
    pub grounded_percent: f64,
    /// The same with the root joint held still.
    pub still_percent: f64,
    /// [`GaitReport::grounded_percent`] with 5 cm instead of 2.5: swinging feet count too.
    pub grounded_below_5_cm_percent: f64,
    /// The same with the root joint held still.
    pub still_below_5_cm_percent: f64,
    /// [`GaitReport::grounded_percent`] of the true motions, the lowest foot held where it is in every step.
    pub true_percent: f64,
    /// The same with 5 cm instead of 2.5.
    pub true_below_5_cm_percent: f64,
    /// How fast the loops go over the ground: mean, metres a second.
    pub speed_m_per_s: f64,
}

pub(super) fn beyond(all: &[Beyond]) -> BeyondReport {
    let of = |pick: fn(&Beyond) -> f32, percent: usize| {
        let mut numbers: Vec<f32> = all.iter().map(pick).collect();
        f64::from(percentile(&mut numbers, percent))
    };
    BeyondReport {
        motions: all.len(),
        unbounded_horizon: rounded(of(|b| b.unbounded, 50)),
        unbounded_horizon_p10: rounded(of(|b| b.unbounded, 10)),
        vertex_linear_horizon: rounded(of(|b| b.vertex_linear, 50)),
        bounded_reach: rounded(of(|b| b.bounded, 50)),
        bounded_reach_p10: rounded(of(|b| b.bounded, 10)),
        bounded_worst_percent: rounded(100.0 * of(|b| b.stretch[0], 100)),
        unbounded_worst_percent: rounded(100.0 * of(|b| b.stretch[1], 100)),
    }
}

pub(super) fn gaits(all: &[Skating]) -> GaitReport {
    let mean = |pick: fn(&Skating) -> f32| {
        let sum: f64 = all.iter().map(pick).map(f64::from).sum();
        sum / all.len().max(1) as f64
    };
    GaitReport {
        gaits: all.len(),
        grounded_percent: rounded(100.0 * mean(|s| s.ratio[0][0])),
        still_percent: rounded(100.0 * mean(|s| s.ratio[0][1])),
        grounded_below_5_cm_percent: rounded(100.0 * mean(|s| s.ratio[1][0])),
        still_below_5_cm_percent: rounded(100.0 * mean(|s| s.ratio[1][1])),
        true_percent: rounded(100.0 * mean(|s| s.truth[0])),
        true_below_5_cm_percent: rounded(100.0 * mean(|s| s.truth[1])),
        speed_m_per_s: rounded(mean(|s| s.speed_m_per_s)),
    }
}
