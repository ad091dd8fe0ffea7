//! Poses: controls, libraries and the sampler.
//!
//! [`Controls`] are named degrees of freedom (`elbow_r.flexion`, `spine.twist`, `shoulder_l.raise`)
//! that count from a neutral stance: upright, arms hanging, palms to the thighs. [`PoseValues`] is an
//! angle for each; [`Controls::pose`] turns it into a [`crate::rig::Pose`]. A [`PoseLibrary`] is a file
//! of named ones, and [`PoseSampler`] draws new ones from it and from the joints' limits.

mod align;
mod body;
mod controls;
mod error;
mod fit;
mod goals;
mod library;
mod posing;
mod sampler;
mod sheet;
mod spec;

pub use body::{Body, Overlap, Part};
pub use controls::{Control, Controls, PoseValues};
pub use error::PoseError;
pub use goals::Goal;
pub use library::{NamedPose, PoseLibrary};
pub use posing::BoneTransforms;
pub use sampler::{PoseSampler, SampleKind};
pub use sheet::pose_sheet;
pub use spec::{
    ControlSpec, ControlsSpec, DriveSpec, Lateral, NeutralSpec, PartSpec, SideOf, Stance, SwingSpec,
};

/// The human's controls, `assets/rigs/human.controls.ron`.
pub const HUMAN_CONTROLS: &str = include_str!("../../../../assets/rigs/human.controls.ron");

/// The human's authored poses, `assets/poses/human.ron`.
pub const HUMAN_POSES: &str = include_str!("../../../../assets/poses/human.ron");
