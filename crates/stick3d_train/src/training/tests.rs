//! A tiny real run.
