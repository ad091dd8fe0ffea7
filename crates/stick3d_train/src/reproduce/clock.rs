//! How far the whole reproduction is, and how long the rest takes.

use std::sync::Mutex;
use std::time::Instant;

use super::{Prepared, Run};
use crate::training::{LossRecord, Progress, StageName};

/// The epochs of Encoder2D alone are cheap beside those that pass whole meshes: by about this factor.
const SMALL: f64 = 0.02;

/// Passes progress on, with the time left. Says one line for a tenth of a stage instead of one for every epoch.
pub(super) struct Clock<'a> {
    progress: &'a dyn Progress,
    /// What an epoch of each run costs, in numbers that pass.
    costs: Vec<(Run, f64)>,
    state: Mutex<State>,
}

struct State {
    /// The run that is trained.
    at: usize,
    /// Cost of the epochs that were run since the start, and the seconds they took.
    run: f64,
    seconds: f64,
    /// Cost of the epochs of the current run that lie behind.
    behind: f64,
    begun: Instant,
}

impl<'a> Clock<'a> {
    pub(super) fn new(progress: &'a dyn Progress, runs: &[Run], prepared: &[Prepared<'_>]) -> Self {
        let cost = |run: &Run| {
            let prepared = &prepared[run.subject];
            let samples = prepared.samples.train.len() as f64;
            samples * prepared.subject.set.vertex_count() as f64
        };
        Self {
            progress,
            costs: runs.iter().map(|run| (run.clone(), cost(run))).collect(),
            state: Mutex::new(State {
                at: 0,
                run: 0.0,
                seconds: 0.0,
                behind: 0.0,
                begun: Instant::now(),
            }),
        }
    }

    /// A run is done, or was there already.
    pub(super) fn finish(&self, run: &Run) {
        let index = self.costs.iter().position(|(other, _)| other == run);
        if let (Ok(mut state), Some(index)) = (self.state.lock(), index) {
            (state.at, state.behind) = (index + 1, 0.0);
        }
    }

    /// Minutes left in words, once an epoch has shown how long they take.
    fn left(&self) -> String {
        let Ok(state) = self.state.lock() else {
            return String::new();
        };
        let all: f64 = self.costs[state.at..].iter().map(whole).sum();
        if state.run <= 0.0 {
            return String::new();
        }
        let seconds = (all - state.behind).max(0.0) * state.seconds / state.run;
        format!(", about {:.0} min left in all", (seconds / 60.0).ceil())
    }

    fn id(&self) -> String {
        let at = self.state.lock().map_or(0, |state| state.at);
        self.costs
            .get(at)
            .map_or(String::new(), |(run, _)| run.id.clone())
    }
}

/// The cost of all epochs of a run.
fn whole((run, cost): &(Run, f64)) -> f64 {
    let [autoencoder, encoder2d, joint] = run.config.epochs.map(|epochs| epochs as f64);
    cost * (autoencoder + joint + SMALL * encoder2d)
}

impl Progress for Clock<'_> {
    fn begin(&self, what: &str, steps: usize) {
        if let Ok(mut state) = self.state.lock() {
            state.begun = Instant::now();
        }
        let text = format!("{} {what}{}", self.id(), self.left());
        self.progress.begin(&text, steps);
    }

    fn advance(&self, steps: usize) {
        self.progress.advance(steps);
    }

    fn epoch(&self, record: &LossRecord) {
        if let Ok(mut state) = self.state.lock() {
            let mut cost = self.costs.get(state.at).map_or(0.0, |(_, cost)| *cost);
            if record.stage == StageName::Encoder2d {
                cost *= SMALL;
            }
            state.run += cost;
            state.behind += cost;
            state.seconds += state.begun.elapsed().as_secs_f64();
        }
        let tenth = record.epochs.div_ceil(10);
        if (record.epoch + 1).is_multiple_of(tenth) || record.epoch + 1 == record.epochs {
            let terms = record
                .terms
                .iter()
                .map(|(name, value)| format!("{name} {value:.3}"));
            self.note(&format!(
                "{} {} {}/{}: loss {:.3} {}{}",
                self.id(),
                record.stage.label(),
                record.epoch + 1,
                record.epochs,
                record.loss,
                terms.collect::<Vec<_>>().join(" "),
                self.left()
            ));
        }
    }

    fn note(&self, text: &str) {
        self.progress.note(text);
    }

    fn should_stop(&self) -> bool {
        self.progress.should_stop()
    }
}
