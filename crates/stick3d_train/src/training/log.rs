//! The losses of a run, epoch by epoch, as CSV.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::losses::{Terms, values};
use super::{StageName, TrainError};
use crate::dataset::rounded;

/// The losses of one epoch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LossRecord {
    /// Which stage.
    pub stage: StageName,
    /// Which epoch of the stage, from 0.
    pub epoch: usize,
    /// How many epochs the stage has.
    pub epochs: usize,
    /// What was minimised, mean over the epoch.
    pub loss: f64,
    /// Its terms, unweighted, mean over the epoch.
    pub terms: Vec<(String, f64)>,
}

impl LossRecord {
    /// Fails when the loss is no number any more.
    pub(crate) fn check(&self) -> Result<(), TrainError> {
        if self.loss.is_finite() {
            return Ok(());
        }
        Err(TrainError::Diverged {
            stage: self.stage.label(),
            epoch: self.epoch,
            loss: self.loss,
        })
    }

    /// Adds a batch's terms, `share` of the epoch.
    pub(crate) fn add(&mut self, terms: Terms, share: f64) -> Result<(), TrainError> {
        for (name, value) in values(terms)? {
            let value = value * share;
            match self.terms.iter_mut().find(|(known, _)| known == name) {
                _ if name == "loss" => self.loss += value,
                Some((_, sum)) => *sum += value,
                None => self.terms.push((name.to_owned(), value)),
            }
        }
        Ok(())
    }

    /// To the digits that are told.
    pub(crate) fn round(&mut self) {
        self.loss = rounded(self.loss);
        self.terms
            .iter_mut()
            .for_each(|(_, value)| *value = rounded(*value));
    }

    /// A term by its name.
    pub(crate) fn term(&self, name: &str) -> Option<f64> {
        let found = self.terms.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| *value)
    }
}

/// All epochs so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LossLog {
    /// In the order they were run.
    pub records: Vec<LossRecord>,
}

impl LossLog {
    /// Names of all terms in the order they first appear.
    #[must_use]
    pub fn term_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = vec![];
        for (name, _) in self.records.iter().flat_map(|record| &record.terms) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        names
    }

    /// One line per epoch: stage, epoch, loss, then every term; a term that a stage lacks stays empty.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let names = self.term_names();
        let mut csv = format!(
            "stage,epoch,loss{}\n",
            names.iter().map(|n| format!(",{n}")).collect::<String>()
        );
        for record in &self.records {
            // Writing into a String cannot fail.
            let _ = write!(
                csv,
                "{},{},{:.6}",
                record.stage.label(),
                record.epoch,
                record.loss
            );
            for name in &names {
                csv.push(',');
                if let Some((_, value)) = record.terms.iter().find(|(term, _)| term == name) {
                    let _ = write!(csv, "{value:.6}");
                }
            }
            csv.push('\n');
        }
        csv
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_has_a_column_for_every_term() {
        let record = |stage, terms: &[(&str, f64)]| LossRecord {
            stage,
            epoch: 0,
            epochs: 1,
            loss: 1.5,
            terms: terms
                .iter()
                .map(|(name, value)| ((*name).to_owned(), *value))
                .collect(),
        };
        let log = LossLog {
            records: vec![
                record(StageName::Autoencoder, &[("mse", 0.5), ("kl", 2.0)]),
                record(StageName::Joint, &[("latent", 0.25), ("kl", 1.0)]),
            ],
        };
        let expected = "stage,epoch,loss,mse,kl,latent\n\
                        autoencoder,0,1.500000,0.500000,2.000000,\n\
                        joint,0,1.500000,,1.000000,0.250000\n";
        assert_eq!(log.to_csv(), expected);
    }
}
