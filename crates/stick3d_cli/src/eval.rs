//! `stick3d eval`: how far a model's bodies are from the truth.

use std::fmt::Write as _;

use serde::Serialize;
use stick3d_model::Model;
use stick3d_train::evaluate::{self, Drawn, EvalConfig, EvalInput, Report};
use stick3d_train::training::Progress;

use crate::args::EvalArguments;
use crate::corpus::Corpus;
use crate::failure::{Failure, Outcome};
use crate::progress::Bar;
use crate::{eval_motion, inputs, mesh_set};

/// Poses of the nearest-neighbour baseline: as many as the paper's data set has (section 4.1).
const BASELINE_POSES: usize = 72;

/// Seed of the sampled test poses; training derives its own from other numbers.
const TEST_STREAM: u64 = 0x7e57;

/// Runs `stick3d eval`.
pub(crate) fn run(arguments: &EvalArguments) -> Outcome {
    let model = inputs::model(arguments.model.as_deref())?;
    let bar = Bar::new();
    let report = match &arguments.set.meshes {
        Some(folder) => mesh_set::measure_folder(&model, folder, &arguments.set, &bar)?,
        None => {
            let corpus = Corpus::read(&arguments.body, Some(model.figure()))?;
            // Standard output is the report's.
            corpus.said.iter().for_each(|line| eprintln!("{line}"));
            if arguments.motion {
                let report = eval_motion::measure(&model, &corpus, &bar)?;
                bar.clear();
                return print(&report, arguments.json, eval_motion::table);
            }
            measure(&model, &corpus, &EvalConfig::default(), &bar)?
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

/// Measures a model on sampled poses and on those of the library that it was not trained on.
pub(crate) fn measure(
    model: &Model,
    corpus: &Corpus,
    config: &EvalConfig,
    progress: &dyn Progress,
) -> Outcome<Report> {
    let (trained_on, held_out) = corpus.split_of(model)?;
    let baseline = spread(corpus.poses(&trained_on), BASELINE_POSES);
    let input = EvalInput {
        rig: &corpus.rig,
        library: &baseline,
        held_out: &corpus.poses(&held_out),
        stream: corpus.stream(&trained_on, TEST_STREAM),
    };
    evaluate::evaluate(model, input, config, progress).map_err(Failure::model)
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
    let test = &report.test;
    let mut text = format!(
        "{} sampled and {} library poses that were not trained on; nearest neighbour among {} meshes\n\n\
         {:26} {:>10} {:>8} {:>9} {:>12} {:>9} {:>9}\n",
        test.sampled_cases,
        test.library_cases,
        test.baseline_meshes,
        "",
        "vertex cm",
        "p95 cm",
        "MPJPE mm",
        "PA-MPJPE mm",
        "2D cm",
        "bones %",
    );
    for (label, rows) in [
        ("model", &report.model),
        ("nearest neighbour", &report.baseline),
    ] {
        // Writing into a String cannot fail.
        let _ = writeln!(text, "{label}");
        rows.iter().for_each(|row| write_row(&mut text, row));
    }
    text
}

fn write_row(text: &mut String, row: &Drawn) {
    let all = &row.all;
    let _ = writeln!(
        text,
        "  {:24} {:>10.2} {:>8.2} {:>9.1} {:>12.1} {:>9.2} {:>9.2}",
        row.name,
        all.vertex_mean_cm,
        all.vertex_p95_cm,
        all.mpjpe_mm,
        all.pa_mpjpe_mm,
        all.reprojection_cm,
        all.bone_length_percent,
    );
}
