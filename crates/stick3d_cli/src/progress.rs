//! Progress bars on the terminal's error stream, so that standard output stays clean.

use indicatif::{ProgressBar, ProgressStyle};
use stick3d_train::training::{LossRecord, Progress};

/// Draws one bar for whatever is going on.
#[derive(Debug)]
pub(crate) struct Bar {
    bar: ProgressBar,
}

impl Bar {
    /// A bar that shows nothing yet.
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::no_length();
        let template = "{msg:24} {wide_bar} {pos}/{len} {elapsed_precise} left {eta_precise}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self { bar }
    }

    /// Takes the bar off the screen.
    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn begin(&self, what: &str, steps: usize) {
        self.bar.reset();
        self.bar.set_length(steps as u64);
        self.bar.set_message(what.to_owned());
    }

    fn advance(&self, steps: usize) {
        self.bar.inc(steps as u64);
    }

    fn epoch(&self, record: &LossRecord) {
        let terms: Vec<String> = record
            .terms
            .iter()
            .map(|(name, value)| format!("{name} {value:.4}"))
            .collect();
        self.note(&format!(
            "{:12} {:3}/{}  loss {:.4}  {}",
            record.stage.label(),
            record.epoch + 1,
            record.epochs,
            record.loss,
            terms.join("  ")
        ));
    }

    fn note(&self, text: &str) {
        self.bar.suspend(|| eprintln!("{text}"));
    }
}
