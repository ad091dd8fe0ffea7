//! `stick3d eval`: how far a model's bodies are from the truth.

use std::fmt::Write as _;

use serde::Serialize;
use stick3d_model::Model;
use stick3d_train::evaluate::{self, EvalConfig, EvalInput, PartReport, Recognition, Report, Row};
use stick3d_train::pose::PoseLibrary;
use stick3d_train::rig::Pose;
use stick3d_train::training::Progress;

use crate::args::EvalArguments;
use crate::corpus::Corpus;
use crate::failure::{Failure, Outcome};
use crate::progress::Bar;
use crate::{eval_motion, eval_sheet, inputs, mesh_set};

/// Poses of the nearest-neighbour baseline: as many as the paper's data set has (section 4.1).
const BASELINE_POSES: usize = 72;

/// Seeds of the natural and of the broad test poses; training derives its own from other numbers.
const TEST_STREAMS: [u64; 2] = [0x7e57, 0xb40a_d7e5];

/// Runs `stick3d eval`.
pub(crate) fn run(arguments: &EvalArguments) -> Outcome {
    let model = inputs::model(arguments.model.as_deref())?;
    if let Some(out) = &arguments.sheet {
        return eval_sheet::run(&model, arguments, out);
    }
    let bar = Bar::new();
    let config = EvalConfig {
        latency: true,
        ..EvalConfig::default()
    };
    let report = match &arguments.set.meshes {
        Some(folder) => mesh_set::measure_folder(&model, folder, &arguments.set, &config, &bar)?,
        None => {
            let corpus = Corpus::read(&arguments.body, Some(model.figure()))?;
            // Standard output is the report's.
            corpus.said.iter().for_each(|line| eprintln!("{line}"));
            if arguments.motion {
                let report = eval_motion::measure(&model, &corpus, &bar)?;
                bar.clear();
                return print(&report, arguments.json, eval_motion::table);
            }
            measure(&model, &corpus, &config, &bar)?
        }
    };
    bar.clear();
    print(&report, arguments.json, table)
}

/// Prints a report as JSON or as a table.
fn print<R: Serialize>(report: &R, as_json: bool, table: fn(&R) -> String) -> Outcome {
    if as_json {
        let json = serde_json::to_string_pretty(report).map_err(anyhow::Error::from)?;
        println!("{json}");
    } else {
        println!("{}", table(report));
    }
    Ok(())
}

/// Measures a model on poses of the library that it was not trained on, and on any inside the joints' limits.
pub(crate) fn measure(
    model: &Model,
    corpus: &Corpus,
    config: &EvalConfig,
    progress: &dyn Progress,
) -> Outcome<Report> {
    let (trained_on, held_out) = corpus.split_of(model)?;
    let baseline = spread(corpus.poses(&trained_on), BASELINE_POSES);
    let input = test_poses(corpus, &baseline, &held_out);
    evaluate::evaluate(model, input, config, progress).map_err(Failure::model)
}

/// What models of a body are measured on.
pub(crate) fn test_poses<'a>(
    corpus: &'a Corpus,
    baseline: &'a [Pose],
    held_out: &'a PoseLibrary,
) -> EvalInput<'a> {
    EvalInput {
        rig: &corpus.rig,
        library: baseline,
        natural: corpus.natural(held_out, TEST_STREAMS[0]),
        broad: corpus.broad(TEST_STREAMS[1]),
    }
}

/// At most `count` of the poses, evenly spread over the library, which is ordered by subject.
pub(crate) fn spread<T>(poses: Vec<T>, count: usize) -> Vec<T> {
    let len = poses.len();
    let picked = |i: &usize| len <= count || (i * count) % len < count;
    poses
        .into_iter()
        .enumerate()
        .filter(|(i, _)| picked(i))
        .map(|(_, pose)| pose)
        .collect()
}

/// The report for people.
pub(crate) fn table(report: &Report) -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    let _ = write_table(&mut text, report);
    text
}

fn write_table(text: &mut String, report: &Report) -> std::fmt::Result {
    writeln!(
        text,
        "{}; nearest neighbour among {} meshes",
        report.test.figure, report.test.baseline_meshes
    )?;
    for part in &report.parts {
        write_part(text, part)?;
    }
    let flat = &report.flat_any_order;
    writeln!(text, "\nflat poses: {}", recognised(flat))?;
    if let Some(latency) = &report.latency {
        writeln!(
            text,
            "all answers to a sketch: median {:.2} ms, 99 % within {:.2} ms, one core, {} sketches",
            latency.p50_ms, latency.p99_ms, latency.sketches
        )?;
    }
    Ok(())
}

fn write_part(text: &mut String, part: &PartReport) -> std::fmt::Result {
    writeln!(
        text,
        "\n{:28} {:>9} {:>6} {:>6} {:>8} {:>8} {:>7} {:>8} {:>7} {:>7} {:>7}",
        format!("{}, {} cases", part.name, part.cases),
        "vertex cm",
        "std",
        "p95",
        "MPJPE mm",
        "PA mm",
        "turn \u{b0}",
        "bones %",
        "p95 %",
        "2D cm",
        "of",
    )?;
    let mut answer = "";
    for row in &part.rows {
        if row.answer != answer {
            writeln!(text, "  {}", row.answer)?;
            answer = &row.answer;
        }
        write_row(text, row)?;
    }
    writeln!(
        text,
        "  strokes in any order: {}",
        recognised(&part.any_order)
    )
}

fn write_row(text: &mut String, row: &Row) -> std::fmt::Result {
    let of = &row.metrics;
    writeln!(
        text,
        "    {:24} {:>9.2} {:>6.2} {:>6.2} {:>8.1} {:>8.1} {:>7.1} {:>8.2} {:>7.2} {:>7.2} {:>7.1}",
        drawn(row),
        of.vertex_mean_cm,
        of.vertex_std_cm,
        of.vertex_p95_cm,
        of.mpjpe_mm,
        of.pa_mpjpe_mm,
        of.bone_direction_deg,
        of.bone_length_percent,
        of.bone_length_p95_percent,
        of.reprojection_cm,
        row.choice,
    )
}

/// How sketches of a row were drawn, with numbers.
fn drawn(row: &Row) -> String {
    let (jitter_cm, scale) = (100.0 * row.noise.jitter_m, 100.0 * row.noise.bone_scale);
    match (jitter_cm > 0.0, scale > 0.0) {
        (true, false) => format!("{} by {jitter_cm:.1} cm", row.drawn),
        (false, true) => format!("{} by {scale:.0} %", row.drawn),
        _ => row.drawn.clone(),
    }
}

fn recognised(count: &Recognition) -> String {
    format!(
        "{:.1} % of {} drawings recognised; {} of {} poses can be read",
        count.percent, count.drawings, count.readable, count.poses
    )
}
