//! `stick3d eval --motion`: how good motions between sketched keys are.

use std::fmt::Write as _;

use stick3d_model::Model;
use stick3d_train::evaluate::{
    BetweenReport, MotionEvalConfig, MotionEvalInput, MotionReport, TrueMotion, clip_gaits,
    clip_motions, evaluate_motion, held_out_motions,
};
use stick3d_train::pose::PoseLibrary;
use stick3d_train::rig::Pose;

use crate::corpus::Corpus;
use crate::failure::{Failure, Outcome};
use crate::progress::Bar;

/// Seconds between two poses of a gait of the library.
const GAIT_INTERVAL_S: f32 = 0.13;
/// Seed of the sampled poses that say how long edges may be.
const EDGE_STREAM: u64 = 0xed9e;

/// Measures the motions of a model.
pub(crate) fn measure(model: &Model, corpus: &Corpus, bar: &Bar) -> Outcome<MotionReport> {
    let (trained_on, held_out) = corpus.split_of(model)?;
    let named: Vec<(String, Pose)> = held_out
        .poses
        .iter()
        .map(|pose| (pose.name.clone(), corpus.controls.pose(&pose.values)))
        .collect();
    let mut motions = held_out_motions(&named);
    motions.extend(clip_motions(&corpus.rig));
    let mut gaits = gaits(corpus);
    gaits.extend(clip_gaits(&corpus.rig));
    let input = MotionEvalInput {
        rig: &corpus.rig,
        motions: &motions,
        gaits: &gaits,
        library: &corpus.poses_both_ways(&corpus.library),
        stream: corpus.stream(&trained_on, EDGE_STREAM),
    };
    evaluate_motion(model, input, &MotionEvalConfig::default(), bar).map_err(Failure::model)
}

/// The gaits of the library: four or more poses that are numbered one after the other, `walk_1_heel_strike_r`, `walk_2_...`.
fn gaits(corpus: &Corpus) -> Vec<TrueMotion> {
    let PoseLibrary { poses } = &corpus.library;
    let numbered = |name: &str| -> Option<(String, usize)> {
        let mut words = name.split('_');
        let gait = words.next()?.to_owned();
        Some((gait, words.next()?.parse().ok()?))
    };
    let mut gaits: Vec<(String, Vec<Pose>)> = vec![];
    for pose in poses {
        let Some((gait, number)) = numbered(&pose.name) else {
            continue;
        };
        let values = corpus.controls.pose(&pose.values);
        match gaits.iter_mut().find(|(name, _)| *name == gait) {
            Some((_, poses)) if number == poses.len() + 1 => poses.push(values),
            None if number == 1 => gaits.push((gait, vec![values])),
            _ => {}
        }
    }
    gaits
        .into_iter()
        .filter(|(_, poses)| poses.len() >= 4)
        .map(|(name, poses)| TrueMotion::between(name, poses, GAIT_INTERVAL_S, true))
        .collect()
}

/// The report for people.
pub(crate) fn table(report: &MotionReport) -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    let _ = write_table(&mut text, report);
    text
}

fn write_table(text: &mut String, report: &MotionReport) -> std::fmt::Result {
    let MotionReport {
        test,
        between,
        beyond,
        gaits,
    } = report;
    writeln!(
        text,
        "{} motions between poses that were not trained on, and of the rig, each from {} sides; between their keys:",
        test.motions.len(),
        test.yaws_deg.len()
    )?;
    writeln!(
        text,
        "  {:18} {:>9} {:>8} {:>14} {:>10} {:>8} {:>10}",
        "", "vertex cm", "bones %", "beside keys %", "stretch %", "worst %", "jerk m/s3"
    )?;
    for row in between {
        write_row(text, row)?;
    }
    writeln!(
        text,
        "\nbeyond the last key, in distances between the last two keys:\n  \
         edges stretch by 5 % after {:.2} (a tenth before {:.2}), vertex-linear after {:.2}; worst {:.1} %\n  \
         bounded, it goes as far as {:.2} (a tenth stops before {:.2}); worst {:.1} %",
        beyond.unbounded_horizon,
        beyond.unbounded_horizon_p10,
        beyond.vertex_linear_horizon,
        beyond.unbounded_worst_percent,
        beyond.bounded_reach,
        beyond.bounded_reach_p10,
        beyond.bounded_worst_percent,
    )?;
    writeln!(
        text,
        "\n{} at {:.2} m/s; steps of feet on the ground that skate, %:\n  \
         {:24} {:>14} {:>14}",
        test.gaits.join(", "),
        gaits.speed_m_per_s,
        "",
        "within 2.5 cm",
        "within 5 cm"
    )?;
    let rows = [
        (
            "grounded",
            gaits.grounded_percent,
            gaits.grounded_below_5_cm_percent,
        ),
        (
            "held still",
            gaits.still_percent,
            gaits.still_below_5_cm_percent,
        ),
        (
            "the true motion, pinned",
            gaits.true_percent,
            gaits.true_below_5_cm_percent,
        ),
    ];
    for (name, near, below) in rows {
        writeln!(text, "  {name:24} {near:>14.1} {below:>14.1}")?;
    }
    Ok(())
}

fn write_row(text: &mut String, row: &BetweenReport) -> std::fmt::Result {
    writeln!(
        text,
        "  {:18} {:>9.2} {:>8.2} {:>14.2} {:>10.2} {:>8.1} {:>10.0}",
        row.name,
        row.vertex_cm,
        row.bone_length_percent,
        row.bone_length_beside_keys_percent,
        row.edge_stretch_percent,
        row.edge_stretch_worst_percent,
        row.jerk_m_s3,
    )
}
