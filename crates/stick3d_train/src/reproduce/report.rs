//! The report in words and tables.

use std::fmt::Write as _;
use std::path::Path;

use stick3d_model::files::write_atomically;

use super::results::{NEAREST, Part, Results, Row, SHIPPED};
use super::{ReproduceConfig, ReproduceError, Run, Subject};

/// Tables 1 and 2 as published: model, latent length, mean and standard deviation in thousandths.
const PUBLISHED: [(&str, usize, f64, f64); 4] = [
    ("AE", 256, 2.996, 1.568),
    ("VAE", 256, 2.118, 2.598),
    ("VAE", 128, 3.887, 3.802),
    ("VAE", 512, 10.830, 6.888),
];

/// Writes `report.md` and `results.csv`.
pub(super) fn write(
    results: &Results,
    pending: &[&Run],
    subjects: &[Subject],
    config: &ReproduceConfig,
    out: &Path,
) -> Result<(), ReproduceError> {
    let save = |name: &str, text: &str| {
        let path = out.join(name);
        write_atomically(&path, text.as_bytes())
            .map_err(|source| ReproduceError::Io { path, source })
    };
    save("results.csv", &results.to_csv())?;
    save("report.md", &markdown(results, pending, subjects, config))
}

fn markdown(
    results: &Results,
    pending: &[&Run],
    subjects: &[Subject],
    config: &ReproduceConfig,
) -> String {
    let mut text = format!(
        "# The paper's tables and figures, reproduced\n\n`{}`\n\n\
         {:.0} % of the paper's epochs, hidden width {}, seed {}. Errors are on what no model of a table learnt from: \
         `random`, a tenth of the turned meshes whose meshes were learnt from in other turns; `pose`, a tenth of the \
         poses in all their turns. The second is the honest one.\n\n",
        config.command,
        100.0 * config.epochs_share,
        config.hidden,
        config.seed
    );
    if !pending.is_empty() {
        let ids: Vec<&str> = pending.iter().map(|run| run.id.as_str()).collect();
        let _ = writeln!(text, "**Not trained yet: {}.**\n", ids.join(", "));
    }
    for subject in subjects {
        let rows: Vec<&Row> = results
            .rows
            .iter()
            .filter(|row| row.subject == subject.name)
            .collect();
        let _ = writeln!(
            text,
            "## {}\n\n{} key meshes of {} vertices in {} turns; kept out as a whole: {}.\n",
            subject.name,
            subject.set.meshes.len(),
            subject.set.vertex_count(),
            subject.set.turns.len(),
            subject.held_out.join(", ")
        );
        reconstruction(&mut text, &rows, subject.published);
        generation(&mut text, &rows);
        figures(&mut text, &subject.name);
    }
    trainings(&mut text, results);
    text
}

/// Tables 1 and 2: meshes through Encoder3D and back.
fn reconstruction(text: &mut String, rows: &[&Row], published: bool) {
    text.push_str(
        "### Tables 1 and 2: a mesh from itself\n\n\
         Squared error of a coordinate in thousandths of a normalised unit squared (1 is half of the body's largest \
         extent), which is the only reading that gives the published numbers' size; and the distance of a vertex.\n\n\
         | model | latent | published mean (std) | split | squared error, mean (std) | distance, normalised, mean (std) | distance, cm, mean (std) |\n\
         | --- | ---: | ---: | --- | ---: | ---: | ---: |\n",
    );
    for row in rows.iter().filter(|row| row.from_mesh) {
        let known = PUBLISHED
            .iter()
            .find(|(label, length, ..)| *label == row.label && *length == row.latent_len);
        let known = match known.filter(|_| published) {
            Some((_, _, mean, std)) => format!("{mean:.3} ({std:.3})"),
            None => "-".to_owned(),
        };
        let (errors, metrics) = (&row.errors, &row.errors.metrics);
        let _ = writeln!(
            text,
            "| {} | {} | {known} | {} | {:.3} ({:.3}) | {:.4} ({:.4}) | {:.2} ({:.2}) |",
            row.label,
            row.latent_len,
            row.part.label(),
            1e3 * errors.squared_mean,
            1e3 * errors.squared_std,
            metrics.vertex_mean_normalised,
            errors.vertex_std_normalised,
            metrics.vertex_mean_cm,
            metrics.vertex_std_cm,
        );
    }
    text.push('\n');
}

/// What the system is for: meshes from sketches.
fn generation(text: &mut String, rows: &[&Row]) {
    text.push_str(
        "### A mesh from its sketch\n\n\
         | model | latent | split | squared error, mean (std) | distance, cm, mean (std) | 95 of 100 closer, cm | MPJPE, mm | PA-MPJPE, mm | on the sketch, cm | bones, % |\n\
         | --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for row in rows.iter().filter(|row| !row.from_mesh) {
        let (errors, metrics) = (&row.errors, &row.errors.metrics);
        let latent = match row.latent_len {
            0 => "-".to_owned(),
            length => length.to_string(),
        };
        let _ = writeln!(
            text,
            "| {} | {latent} | {} | {:.3} ({:.3}) | {:.2} ({:.2}) | {:.2} | {:.1} | {:.1} | {:.2} | {:.1} |",
            row.label,
            row.part.label(),
            1e3 * errors.squared_mean,
            1e3 * errors.squared_std,
            metrics.vertex_mean_cm,
            metrics.vertex_std_cm,
            metrics.vertex_p95_cm,
            metrics.mpjpe_mm,
            metrics.pa_mpjpe_mm,
            metrics.reprojection_cm,
            metrics.bone_length_percent,
        );
    }
    text.push('\n');
    for part in Part::ALL {
        let distance = |label: &str| {
            let found = rows.iter().find(|row| {
                row.label == label
                    && !row.from_mesh
                    && row.part == part
                    && [0, 256].contains(&row.latent_len)
            });
            found.map(|row| row.errors.metrics.vertex_mean_cm)
        };
        if let (Some(ours), Some(paper)) = (distance(SHIPPED), distance("VAE")) {
            let nearest = distance(NEAREST).unwrap_or(f64::NAN);
            let _ = writeln!(
                text,
                "On `{}`, the vertices of what ships are {:.2} times as far off as those of the paper's network, which \
                 has {:.2} times the distance of the nearest neighbour.",
                part.label(),
                ours / paper,
                paper / nearest
            );
        }
    }
    text.push('\n');
}

fn figures(text: &mut String, name: &str) {
    for (what, caption) in [
        (
            "generation",
            "Bodies from sketches, front and side (the paper's figures 5, 8 and 9)",
        ),
        (
            "distances",
            "Distance to the truth (figure 7); a turn that was not trained is compared after rigid alignment by iterative closest points",
        ),
        (
            "motion",
            "From one sketch to another: through latent space, every vertex straight, bone by bone in the sketch; and past the second, red (figures 10 and 11)",
        ),
    ] {
        let _ = writeln!(text, "{caption}:\n\n![{caption}]({name}_{what}.png)\n");
    }
}

fn trainings(text: &mut String, results: &Results) {
    text.push_str("## Training\n\n| model | epochs | minutes |\n| --- | --- | ---: |\n");
    for training in &results.trainings {
        let [a, b, c] = training.epochs;
        let resumed = if training.cost.resumed {
            " (after the last interruption)"
        } else {
            ""
        };
        let _ = writeln!(
            text,
            "| {} | {a} + {b} + {c} | {:.1}{resumed} |",
            training.id,
            training.cost.seconds / 60.0
        );
    }
}
