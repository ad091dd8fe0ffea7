//! The models that the tables need, and training those that are missing.

use std::path::Path;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use stick3d_model::Model;
use stick3d_model::architecture::LATENT_LEN;
use stick3d_model::files::write_atomically;

use super::clock::Clock;
use super::{Prepared, ReproduceConfig, ReproduceError};
use crate::paper::{PaperConfig, PaperKind, train_paper};
use crate::training::{Progress, TrainError};

/// The other latent lengths of table 2.
const OTHER_LENGTHS: [usize; 2] = [128, 512];

/// One model of one subject.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Its name, also of its files.
    pub id: String,
    /// Whose: index among the subjects.
    pub subject: usize,
    /// How it is trained.
    pub config: PaperConfig,
}

/// A model, and how long it took.
pub(super) struct TrainedRun {
    pub(super) model: Model,
    pub(super) cost: Cost,
}

/// What training took.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Cost {
    /// Wall-clock seconds of the part that was not interrupted.
    pub(super) seconds: f64,
    /// Whether there was a part before.
    pub(super) resumed: bool,
}

impl Run {
    fn new(subject: usize, name: &str, config: PaperConfig) -> Self {
        Self {
            id: format!("{name}_{}_{}", kind_label(config.kind), config.latent_len),
            subject,
            config,
        }
    }

    /// "VAE" or "AE".
    pub(super) fn label(&self) -> String {
        kind_label(self.config.kind).to_uppercase()
    }

    /// Whether it is the one that the paper promotes.
    pub(super) fn is_promoted(&self) -> bool {
        self.config.kind == PaperKind::Variational && self.config.latent_len == LATENT_LEN
    }

    /// The name of the plain autoencoder beside it.
    pub(super) fn plain_id(&self) -> String {
        let of_kind = |kind| format!("_{}_", kind_label(kind));
        self.id
            .replace(&of_kind(PaperKind::Variational), &of_kind(PaperKind::Plain))
    }
}

fn kind_label(kind: PaperKind) -> &'static str {
    match kind {
        PaperKind::Variational => "vae",
        PaperKind::Plain => "ae",
    }
}

/// All models: first those of table 1, of all subjects, then the other lengths of table 2.
pub(super) fn all(prepared: &[Prepared<'_>], config: &ReproduceConfig) -> Vec<Run> {
    let with = |subject: usize, latent_len: usize| PaperConfig {
        seed: config.seed,
        hidden: config.hidden,
        latent_len,
        device: config.device.clone(),
        ..PaperConfig::published(prepared[subject].subject.set.meshes.len())
    };
    let table_1 = |subject| [with(subject, LATENT_LEN).plain(), with(subject, LATENT_LEN)];
    let table_2 = |subject| OTHER_LENGTHS.map(|length| with(subject, length));
    let run = |subject: usize, recipe: PaperConfig| {
        let name = &prepared[subject].subject.name;
        Run::new(subject, name, recipe.scaled(config.epochs_share))
    };
    let subjects = 0..prepared.len();
    let first = subjects
        .clone()
        .flat_map(|s| table_1(s).map(|recipe| run(s, recipe)));
    let rest = subjects.flat_map(|s| table_2(s).map(|recipe| run(s, recipe)));
    first.chain(rest).collect()
}

/// The model of a run: as it is in the folder, else trained.
pub(super) fn trained(
    run: &Run,
    prepared: &Prepared<'_>,
    models: &Path,
    clock: &Clock<'_>,
) -> Result<TrainedRun, ReproduceError> {
    let path = models.join(format!("{}.stick3d", run.id));
    let cost_path = models.join(format!("{}.json", run.id));
    if let Some(model) = known(&path, run, prepared) {
        let cost = std::fs::read(&cost_path).ok();
        let cost = cost.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let cost = cost.unwrap_or_default();
        return Ok(TrainedRun { model, cost });
    }
    clock.note(&format!("training {}", run.id));
    let folder = models.join(&run.id);
    let io = |path: &Path| {
        let path = path.to_owned();
        |source| ReproduceError::Io { path, source }
    };
    std::fs::create_dir_all(&folder).map_err(io(&folder))?;
    let checkpoint = folder.join("checkpoint.safetensors");
    let (start, resumed) = (Instant::now(), checkpoint.exists());
    let (set, samples) = (&prepared.subject.set, &prepared.samples);
    let train = |resume| train_paper(set, samples, &run.config, Some(&folder), resume, clock);
    let model = match train(true) {
        // Left by a run with other options.
        Err(TrainError::Checkpoint { .. }) => train(false)?.model,
        other => other?.model,
    };
    let cost = Cost {
        seconds: start.elapsed().as_secs_f64(),
        resumed,
    };
    model.save(&path)?;
    let text = serde_json::to_vec(&cost).map_err(|e| io(&cost_path)(e.into()))?;
    write_atomically(&cost_path, &text).map_err(io(&cost_path))?;
    // Three times as large as the model, and of no more use.
    std::fs::remove_file(&checkpoint).map_err(io(&checkpoint))?;
    Ok(TrainedRun { model, cost })
}

/// The model of a file, if it was trained as the run says and on the same meshes.
fn known(path: &Path, run: &Run, prepared: &Prepared<'_>) -> Option<Model> {
    let model = Model::load(path).ok()?;
    let recipe: PaperConfig = serde_json::from_value(model.metadata().recipe.clone()).ok()?;
    let data_hash = prepared.subject.set.hash(&prepared.samples);
    (recipe == run.config && model.metadata().data_hash == data_hash).then_some(model)
}
