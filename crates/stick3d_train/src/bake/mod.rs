//! Baking the shipped bodies from their free sources.
