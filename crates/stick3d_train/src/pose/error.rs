//! What can be wrong with controls, pose libraries and posing.

use thiserror::Error;

use crate::rig::RigError;

/// Why controls or poses could not be read or used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PoseError {
    /// A file of controls or poses is not well-formed RON of the expected shape.
    #[error("{what} cannot be read, line {line} column {column}: {why}")]
    Syntax {
        /// Which file, in words.
        what: &'static str,
        /// Line, counted from 1.
        line: usize,
        /// Column, counted from 1.
        column: usize,
        /// What the reader met, and what it expected.
        why: String,
    },
    /// A pose names a control that does not exist.
    #[error("{place}: there is no control `{name}`; {hint}")]
    UnknownControl {
        /// Where the name stands, for instance the pose.
        place: String,
        /// The name as written.
        name: String,
        /// The nearest valid name, or the list of them.
        hint: String,
    },
    /// A control stands outside its limits.
    #[error("{place}: `{name}` is {degrees}, but must lie between {min} and {max} degrees")]
    OutsideLimits {
        /// Where the value stands, for instance the pose.
        place: String,
        /// The control.
        name: String,
        /// The value given, degrees.
        degrees: f32,
        /// Smallest allowed value, degrees.
        min: f32,
        /// Largest allowed value, degrees.
        max: f32,
    },
    /// A pose library was written for another rig.
    #[error(
        "the pose library is for the rig `{library}`, but the controls are for `{controls}`; give the library of \
         `{controls}`, or the controls and the rig of `{library}`"
    )]
    OtherRig {
        /// The rig that the library names.
        library: String,
        /// The rig that the controls name.
        controls: String,
    },
    /// A pose refers to a pose, part or bone that does not exist, or exists twice.
    #[error("{place}: {why}")]
    Inconsistent {
        /// Where, for instance the pose.
        place: String,
        /// What is wrong, and what would be right.
        why: String,
    },
    /// The controls name a bone that the rig lacks, or the rig itself is unusable.
    #[error("the controls do not fit the rig: {0}")]
    Rig(#[from] RigError),
}

impl PoseError {
    /// Turns RON's report into ours.
    pub(crate) fn syntax(what: &'static str, error: &ron::error::SpannedError) -> Self {
        let at = error.span.start;
        Self::Syntax {
            what,
            line: at.line,
            column: at.col,
            why: error.code.to_string(),
        }
    }

    /// A contradiction inside a file.
    pub(crate) fn inconsistent(place: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Inconsistent {
            place: place.into(),
            why: why.into(),
        }
    }
}

/// What an error says about an unknown name: the most similar known one, or what is known.
pub(crate) fn hint<'a>(given: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    let nearest = known
        .clone()
        .map(|name| (strsim::jaro_winkler(given, name), name))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match nearest {
        Some((likeness, name)) if likeness > 0.7 => format!("did you mean `{name}`?"),
        _ => format!("known are: {}", known.collect::<Vec<_>>().join(", ")),
    }
}
