//! Telling the caller how far training is.

use super::LossRecord;

/// A stage of training.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
pub enum StageName {
    /// Encoder3D and Decoder.
    Autoencoder,
    /// Encoder2D, the others frozen.
    Encoder2d,
    /// All three.
    Joint,
}

impl StageName {
    /// In their order.
    pub(crate) const ALL: [Self; 3] = [Self::Autoencoder, Self::Encoder2d, Self::Joint];

    /// A short name for logs and progress bars.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Autoencoder => "autoencoder",
            Self::Encoder2d => "encoder2d",
            Self::Joint => "joint",
        }
    }
}

/// Hears how far training is. All methods do nothing unless written.
pub trait Progress: Sync {
    /// Something that takes a while begins: `what`, in `steps` steps.
    fn begin(&self, what: &str, steps: usize) {
        let _ = (what, steps);
    }

    /// `steps` more steps of it are done. Called from several threads.
    fn advance(&self, steps: usize) {
        let _ = steps;
    }

    /// An epoch is over.
    fn epoch(&self, record: &LossRecord) {
        let _ = record;
    }

    /// Something worth a line.
    fn note(&self, text: &str) {
        let _ = text;
    }

    /// Whether to stop at the end of this epoch, with a checkpoint.
    fn should_stop(&self) -> bool {
        false
    }
}

/// Says nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Quiet;

impl Progress for Quiet {}
