//! Why keys are no path.

use thiserror::Error;

use crate::infer::InferError;

/// Why keys are no path, or why a path cannot be sampled. Keys are counted from 1.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PathError {
    /// Fewer than two keys.
    #[error("a motion needs at least two keys, there are {found}; add another pose")]
    TooFewKeys {
        /// How many there are.
        found: usize,
    },
    /// A key's time is NaN or infinite.
    #[error("the time of key {key} is {time_s}; give it in seconds")]
    KeyTime {
        /// Which key.
        key: usize,
        /// Its time, seconds.
        time_s: f32,
    },
    /// Two keys at one time.
    #[error("keys {} and {key} are both at {time_s} s; move one of them", key - 1)]
    EqualTimes {
        /// The second of them.
        key: usize,
        /// Their time, seconds.
        time_s: f32,
    },
    /// A key before the one that precedes it in the list.
    #[error("key {key} is at {time_s} s, before key {} at {before_s} s; sort the keys by time", key - 1)]
    OutOfOrder {
        /// Which key.
        key: usize,
        /// Its time, seconds.
        time_s: f32,
        /// The time of the key before it, seconds.
        before_s: f32,
    },
    /// A key's latent has another length than the model's, or than the first key's.
    #[error(
        "the latent of key {key} has {found} numbers, expected {expected}; it is of another model"
    )]
    LatentLength {
        /// Which key.
        key: usize,
        /// The length needed.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// A key's latent has NaN, infinity or something huge in it.
    #[error("the latent of key {key} has a number that is not finite, or huge, at index {index}")]
    NotFinite {
        /// Which key.
        key: usize,
        /// Where.
        index: usize,
    },
    /// A loop that takes no time, or NaN, to come back to its first key.
    #[error("a loop cannot come back to its first key in {closing_s} s; give a time above 0")]
    ClosingTime {
        /// As given.
        closing_s: f32,
    },
    /// The least trust is no share.
    #[error("the least trust of an extrapolation is {found}; give a number between 0 and 1")]
    LeastTrust {
        /// As given.
        found: f32,
    },
    /// The buffer has another length than the path's latents.
    #[error("the buffer has room for {found} numbers, the path's latents have {expected}")]
    Buffer {
        /// The length needed.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// A path asked for a time that is none.
    #[error("the path was asked for the time {time_s} s")]
    Time {
        /// As given.
        time_s: f32,
    },
    /// The model could not decode a latent of the path.
    #[error(transparent)]
    Infer(#[from] InferError),
}
