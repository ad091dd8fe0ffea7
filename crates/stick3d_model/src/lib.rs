//! The networks, the model file and the frame-rate decoder of stick3d.
//!
//! Knows [`stick3d_figure`] and Burn. Knows no Bevy, and nothing of how a model is trained.

pub mod files;
