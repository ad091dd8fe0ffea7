//! Rigs, poses, data sets, training, evaluation and baking for stick3d.
//!
//! Knows [`stick3d_figure`], [`stick3d_model`] and Burn's training side. Knows no Bevy: a game that plays never
//! compiles this crate.

pub mod bake;
pub mod dataset;
pub mod device;
pub mod evaluate;
pub mod format;
pub mod guess;
pub mod landmark;
pub mod meshes;
pub mod paper;
pub mod placement;
pub mod pose;
pub mod render;
pub mod reproduce;
pub mod rig;
pub mod size;
pub mod training;
