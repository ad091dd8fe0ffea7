//! Poses: controls, libraries and the sampler.
//!
//! [`Controls`] are named degrees of freedom (`elbow_r.flexion`, `spine.twist`, `shoulder_l.raise`)
//! that count from a neutral stance (the human's: upright, arms hanging, palms to the thighs).
//! [`PoseValues`] is an angle for each; [`Controls::pose`] turns it into a [`crate::rig::Pose`]. A [`PoseLibrary`] is a file
//! of named ones, and [`PoseSampler`] draws new ones from it and from the joints' limits.

mod align;
mod body;
mod clip_poses;
mod controls;
mod default_controls;
mod error;
mod fit;
mod goals;
mod library;
mod posing;
mod sampler;
mod sheet;
mod shipped;
mod spec;
mod unfold;

pub use body::{Body, Overlap, Part};
pub use controls::{Control, Controls, PoseValues};
pub use default_controls::default_controls;
pub use error::PoseError;
pub use goals::Goal;
pub use library::{NamedPose, PoseLibrary};
pub use posing::BoneTransforms;
pub use sampler::{PoseSampler, SampleKind};
pub use sheet::pose_sheet;
pub use shipped::{SHIPPED, ShippedBody};
pub use spec::{
    ControlSpec, ControlsSpec, DriveSpec, Lateral, NeutralSpec, PartSpec, SideOf, Stance, SwingSpec,
};
