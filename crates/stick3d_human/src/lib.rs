//! The trained model of the human, embedded.
