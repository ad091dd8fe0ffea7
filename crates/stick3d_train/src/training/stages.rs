//! Going through the stages of a run, epoch by epoch: with a log, with checkpoints, and so that it can be stopped.

use std::path::Path;

use super::adam::Adam;
use super::checkpoint::{Checkpoint, NamedArrays};
use super::log::{LossLog, LossRecord};
use super::{Progress, StageName, TrainError, plot};

/// One epoch of one stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Epoch {
    /// Index of the stage.
    pub(crate) stage: usize,
    pub(crate) name: StageName,
    /// Which epoch of the stage, from 0.
    pub(crate) index: usize,
    /// How many epochs the stage has.
    pub(crate) count: usize,
}

impl Epoch {
    /// For people: which of how many.
    pub(crate) fn label(&self) -> String {
        format!("{} {}/{}", self.name.label(), self.index + 1, self.count)
    }

    /// Its record, before the first batch.
    pub(crate) fn record(&self) -> LossRecord {
        LossRecord {
            stage: self.name,
            epoch: self.index,
            epochs: self.count,
            loss: 0.0,
            terms: vec![],
        }
    }
}

/// A run that goes through stages.
pub(crate) trait Staged {
    /// What is trained.
    type Networks;
    /// The same on plain arrays.
    type Weights: NamedArrays;
    /// What stays as it is during a stage.
    type Fixed;

    /// Tells checkpoints of this run from others.
    fn identity(&self) -> &str;

    /// Epochs between two checkpoints.
    fn checkpoint_every(&self) -> usize;

    /// How many epochs each stage has.
    fn epochs(&self) -> [usize; 3];

    /// Weights as networks in training.
    fn networks(&self, weights: &Self::Weights) -> Self::Networks;

    /// Networks as weights.
    fn weights(&self, networks: &Self::Networks) -> Result<Self::Weights, TrainError>;

    /// What is found out once before epochs of a stage.
    fn fixed(&self, stage: StageName, networks: &Self::Networks)
    -> Result<Self::Fixed, TrainError>;

    /// Trains for an epoch.
    fn epoch(
        &self,
        networks: Self::Networks,
        at: Epoch,
        fixed: &Self::Fixed,
        adam: &mut Adam,
        progress: &dyn Progress,
    ) -> Result<(Self::Networks, LossRecord), TrainError>;

    /// A stage is over.
    fn stage_is_over(&self, stage: StageName, log: &LossLog, progress: &dyn Progress) {
        let _ = (stage, log, progress);
    }

    /// All stages, from `first` or with `resume` from the checkpoint in the folder, if there is one. Leaves there, as it goes,
    /// `checkpoint.safetensors`, `losses.csv` and `losses.png`.
    fn run_stages(
        &self,
        first: Self::Weights,
        folder: Option<&Path>,
        resume: bool,
        progress: &dyn Progress,
    ) -> Result<(Self::Networks, LossLog), TrainError> {
        let fresh = Checkpoint::start(first);
        let path = folder.map(checkpoint_in).filter(|path| path.exists());
        let mut state = match path.filter(|_| resume) {
            Some(path) => Checkpoint::load(&path, self.identity(), fresh)?,
            None => fresh,
        };
        let mut networks = self.networks(&state.weights);
        let epochs = self.epochs();
        while let Some(name) = StageName::ALL.get(state.stage).copied() {
            let count = epochs[state.stage];
            if state.epoch == 0 {
                state.adam = Adam::default();
            }
            if state.epoch < count {
                let fixed = self.fixed(name, &networks)?;
                while state.epoch < count {
                    let at = Epoch {
                        stage: state.stage,
                        name,
                        index: state.epoch,
                        count,
                    };
                    let (trained, record) =
                        self.epoch(networks, at, &fixed, &mut state.adam, progress)?;
                    networks = trained;
                    progress.epoch(&record);
                    record.check()?;
                    state.log.records.push(record);
                    state.epoch += 1;
                    self.leave(&networks, &mut state, count, folder, progress)?;
                }
            }
            self.stage_is_over(name, &state.log, progress);
            state.stage += 1;
            state.epoch = 0;
        }
        Ok((networks, state.log))
    }

    /// Writes checkpoint, log and plot where they are due, and stops where that is asked for.
    fn leave(
        &self,
        networks: &Self::Networks,
        state: &mut Checkpoint<Self::Weights>,
        epochs: usize,
        folder: Option<&Path>,
        progress: &dyn Progress,
    ) -> Result<(), TrainError> {
        let stop = progress.should_stop();
        let every = self.checkpoint_every().max(1);
        let due = state.epoch.is_multiple_of(every) || state.epoch == epochs;
        if let Some(folder) = folder.filter(|_| stop || due) {
            state.weights = self.weights(networks)?;
            state.save(&checkpoint_in(folder), self.identity())?;
            plot::leave(&state.log, folder)?;
        }
        if stop {
            return Err(TrainError::Stopped {
                epochs: state.log.records.len(),
            });
        }
        Ok(())
    }
}

fn checkpoint_in(folder: &Path) -> std::path::PathBuf {
    folder.join("checkpoint.safetensors")
}
