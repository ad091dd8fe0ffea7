//! The paper's tables and figures, reproduced.
//!
//! [`reproduce`] trains what is missing of the paper's autoencoders (variational ones with 256, 128 and 512 numbers in the
//! latent, a plain one with 256), measures them on what they did not learn from, and writes a folder: `report.md`,
//! `results.csv`, pictures, and the models themselves. It can be stopped at any time: models that are there are not
//! trained again, and one that is half trained goes on from its checkpoint. The report is written anew after every model.

mod clock;
mod color_map;
mod distances;
mod generation;
mod icp;
mod motion;
mod pictures;
mod report;
mod results;
mod runs;

use std::path::{Path, PathBuf};

use image::{ImageError, RgbaImage};
use stick3d_model::{Inference, Model, ModelError};
use thiserror::Error;

use crate::device::ComputeDevice;
use crate::evaluate::EvalError;
use crate::paper::{PaperSet, Samples, Split};
use crate::training::{Progress, TrainError};
pub use runs::Run;

use clock::Clock;
use results::Results;

/// A body whose models are trained and measured.
#[derive(Debug, Clone)]
pub struct Subject {
    /// What it is called in the report and in file names.
    pub name: String,
    /// Its key meshes.
    pub set: PaperSet,
    /// Names of those that no model learns from.
    pub held_out: Vec<String>,
    /// The model that ships for this body, where there is one; its vertices are those that the set has or was made of.
    pub shipped: Option<Model>,
    /// Whether the published tables 1 and 2 are about such a body.
    pub published: bool,
}

/// How the tables are reproduced.
#[derive(Debug, Clone, PartialEq)]
pub struct ReproduceConfig {
    /// What all random numbers depend on.
    pub seed: u64,
    /// Share of the paper's epochs.
    pub epochs_share: f64,
    /// Width of the hidden layers.
    pub hidden: usize,
    /// What to compute on.
    pub device: ComputeDevice,
    /// The command, for the report.
    pub command: String,
}

/// Why there is no report, or no whole one.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// A model was not trained.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// A model was not measured.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// A model cannot be used.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A picture was not made.
    #[error("a picture of the report cannot be made: {0}")]
    Picture(#[from] ImageError),
    /// The file system said no.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the file system said.
        source: std::io::Error,
    },
}

/// A subject with its samples parted, and its shipped model made ready.
struct Prepared<'a> {
    subject: &'a Subject,
    samples: Samples,
    shipped: Option<Inference>,
}

impl<'a> Prepared<'a> {
    fn new(subject: &'a Subject, seed: u64) -> Result<Self, ReproduceError> {
        Ok(Self {
            samples: subject.set.samples(Split::Both, &subject.held_out, seed)?,
            shipped: subject.shipped.as_ref().map(Inference::new).transpose()?,
            subject,
        })
    }
}

/// Trains what is missing and writes the report into the folder `out`; see the [module](self).
///
/// # Errors
/// [`ReproduceError`]; what is written by then stays and is used by the next call.
pub fn reproduce(
    subjects: &[Subject],
    config: &ReproduceConfig,
    out: &Path,
    progress: &dyn Progress,
) -> Result<(), ReproduceError> {
    let models = out.join("models");
    std::fs::create_dir_all(&models).map_err(|source| ReproduceError::Io {
        path: models.clone(),
        source,
    })?;
    let prepared: Vec<Prepared<'_>> = subjects
        .iter()
        .map(|subject| Prepared::new(subject, config.seed))
        .collect::<Result<_, _>>()?;
    let mut results = Results::of_baselines(&prepared)?;
    let runs = runs::all(&prepared, config);
    let clock = Clock::new(progress, &runs, &prepared);
    let mut pending: Vec<&Run> = runs.iter().collect();
    for run in &runs {
        let prepared = &prepared[run.subject];
        let trained = runs::trained(run, prepared, &models, &clock)?;
        clock.finish(run);
        results.add(run, &trained, prepared)?;
        pending.retain(|other| *other != run);
        if run.is_promoted() {
            draw(prepared, run, &trained.model, &models, out)?;
        }
        report::write(&results, &pending, subjects, config, out)?;
    }
    Ok(())
}

/// Draws the figures of a subject.
fn draw(
    prepared: &Prepared<'_>,
    run: &Run,
    model: &Model,
    models: &Path,
    out: &Path,
) -> Result<(), ReproduceError> {
    // The plain autoencoder is trained before the promoted model.
    let plain = Model::load(&models.join(format!("{}.stick3d", run.plain_id()))).ok();
    let vae = Inference::new(model)?;
    let plain = plain.as_ref().map(Inference::new).transpose()?;
    let name = &prepared.subject.name;
    let save = |what: &str, picture: &RgbaImage| {
        pictures::save(&out.join(format!("{name}_{what}.png")), picture)
    };
    let generation = generation::picture(prepared, &vae, plain.as_ref())?;
    save("generation", &generation)?;
    save("distances", &distances::picture(prepared, &vae)?)?;
    save("motion", &motion::picture(prepared, &vae)?)
}

#[cfg(test)]
mod tests;
