//! What keeps joints from being guessed.

use stick3d_figure::FigureError;
use thiserror::Error;

use crate::rig::RigError;

/// Why no figure could be guessed for a rig.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GuessError {
    /// The skeleton has no left and right.
    #[error(
        "no two pairs of mirrored bones are found, neither by names (`Arm.L`, `Arm.R`) nor by places; write the figure by hand; the bones are: {}",
        .bones.join(", ")
    )]
    NoPairs {
        /// The first names of bones.
        bones: Vec<String>,
    },
    /// Nothing that it stands on.
    #[error(
        "no pair of limbs reaches the ground, and no names say what is an arm or a leg; write the figure by hand; the limbs begin at: {}",
        or_none(.limbs)
    )]
    NoLegs {
        /// The first bones of all pairs of limbs.
        limbs: Vec<String>,
    },
    /// More legs than two pairs.
    #[error(
        "{} pairs of legs reach the ground, two are known how to draw; write the figure by hand; the legs begin at: {}",
        .legs.len(),
        .legs.join(", ")
    )]
    ManyLegs {
        /// The first bones of all pairs of legs, left and right.
        legs: Vec<String>,
    },
    /// The figure that came out is not sound.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The rig is not sound.
    #[error(transparent)]
    Rig(#[from] RigError),
}

/// Why one joint of a figure was not guessed.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum JointFault {
    /// Two bones fit equally well.
    #[error(
        "joint \"{joint}\": both bone `{first}` and bone `{second}` could be it; write the right one into the figure file"
    )]
    TwoCandidates {
        /// The joint of the figure.
        joint: String,
        /// One bone.
        first: String,
        /// Another one.
        second: String,
    },
    /// No bone fits.
    #[error("joint \"{joint}\": {why}; {}", candidates(.nearest))]
    NotFound {
        /// The joint of the figure.
        joint: String,
        /// What was looked for in vain.
        why: String,
        /// Bones that come nearest.
        nearest: Vec<String>,
    },
}

impl JointFault {
    /// The joint that was not guessed.
    #[must_use]
    pub fn joint(&self) -> &str {
        match self {
            Self::TwoCandidates { joint, .. } | Self::NotFound { joint, .. } => joint,
        }
    }
}

fn or_none(names: &[String]) -> String {
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    }
}

fn candidates(nearest: &[String]) -> String {
    if nearest.is_empty() {
        "no bone comes near".to_owned()
    } else {
        format!("perhaps `{}`", nearest.join("` or `"))
    }
}
