//! The timeline: keys that were drawn, and the motion through them.
//!
//! What it is and how it is edited knows no user interface: [`state`] is the scene of keys, [`history`] its undo, [`player`]
//! its clock, [`clip`] its file, [`motion`] what is made of it, [`perform`] what puts that on the bodies. What it looks like
//! is in [`scale`], [`track`], [`easings`], [`thumbnail`] and [`controls`].

pub(super) mod clip;
pub(super) mod controls;
mod easings;
pub(super) mod history;
pub(super) mod motion;
pub(super) mod perform;
pub(super) mod player;
pub(super) mod scale;
pub(super) mod state;
pub(super) mod thumbnail;
pub(super) mod track;
