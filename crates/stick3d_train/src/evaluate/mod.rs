//! Measuring a model on poses it never saw.
