//! The trained model of the human, embedded: nothing but its bytes.
