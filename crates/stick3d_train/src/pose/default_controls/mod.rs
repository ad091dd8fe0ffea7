//! Degrees of freedom for a rig that comes without a file of controls, from its skeleton, its clips and its figure.
//!
//! Every bone that the figure's joints hang on, and every other one that the clips move, turns about three axes of its
//! own: `NAME.bend`, `NAME.side` and `NAME.twist`, all 0 at rest. Trunk, neck and tail also curve as a whole:
//! `trunk_curve.bend` and so on. Roots have `yaw`, `pitch` and `roll`. A knee or elbow is a hinge that folds the way it is
//! bent at rest, or the way the clips bend it. Limits are wide enough for all clips, so that any of their poses can be
//! made exactly ([`Controls::unfold`]). Where the skeleton is symmetric, so are the controls.

mod anatomy;
mod axes;
mod limits;
mod names;
mod parts;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use glam::Vec3;
use stick3d_figure::figure::Figure;

use anatomy::{Anatomy, Role};
use axes::{Axes, Joint, Turning};
use limits::Range;

use super::controls::Controls;
use super::error::PoseError;
use super::spec::{ControlSpec, ControlsSpec, DriveSpec, usual_overlap_m};
use super::unfold::angles_about;
use crate::rig::Rig;
use crate::size::relative_size;

/// The default controls of a rig: what a file of controls for it would hold.
///
/// # Errors
/// [`PoseError::Rig`] where a joint of the figure is on a bone that the rig does not have, or on no bone.
pub fn default_controls(rig: &Rig, figure: &Figure) -> Result<ControlsSpec, PoseError> {
    let anatomy = Anatomy::read(rig, figure)?;
    let stems = names::stems(rig, &anatomy);
    let writer = Writer {
        axes: axes_of_all(rig, &anatomy),
        rig,
        figure,
        anatomy,
        stems,
    };
    let (low, high) = rig.mesh.bounds();
    let size = relative_size((high - low).max_element());
    let mut spec = ControlsSpec {
        rig: rig.name.clone(),
        lateral: writer.anatomy.lateral,
        neutral: Vec::new(),
        controls: writer.controls(),
        swings: Vec::new(),
        limbs: writer.limbs(),
        whole_share: 0.0,
        parts: parts::parts(rig, &writer.anatomy, &writer.stems),
        may_overlap: Vec::new(),
        overlap_m: usual_overlap_m() * size,
    };
    let bound = Controls::bind(&spec, rig)?;
    spec.may_overlap = parts::meeting(&bound, rig.skeleton.bones.len());
    Ok(spec)
}

/// The axes of every bone that moves; of a pair the right one's mirror the left one's.
fn axes_of_all(rig: &Rig, anatomy: &Anatomy) -> BTreeMap<usize, Axes> {
    let mut all: BTreeMap<usize, Axes> = BTreeMap::new();
    for bone in anatomy.steered() {
        let image = anatomy.mirror[bone].filter(|&other| other != bone);
        let axes = match image.and_then(|other| all.get(&other)) {
            Some(other) => Axes {
                turns: other
                    .turns
                    .map(|(turning, axis)| (turning, -anatomy.lateral.mirror(axis))),
                ..*other
            },
            None => axes::axes(rig, anatomy, bone),
        };
        all.insert(bone, axes);
    }
    all
}

struct Writer<'a> {
    rig: &'a Rig,
    figure: &'a Figure,
    anatomy: Anatomy,
    stems: BTreeMap<usize, String>,
    axes: BTreeMap<usize, Axes>,
}

impl Writer<'_> {
    fn controls(&self) -> Vec<ControlSpec> {
        let mut controls = Vec::new();
        // The curves first: what is written first turns outermost.
        for (role, bones) in self.curves() {
            for turning in [Turning::Bend, Turning::Side, Turning::Twist] {
                controls.push(self.curve(role, &bones, turning));
            }
        }
        let mut clip_angles = self.clip_angles();
        for (&bone, axes) in &self.axes {
            for (place, &(turning, axis)) in axes.turns.iter().enumerate() {
                let angles = clip_angles.remove(&(bone, place)).unwrap_or_default();
                controls.push(self.turn(bone, axes.joint, turning, axis, &angles));
            }
        }
        controls
    }

    /// Trunk, necks and tails of more than one bone.
    fn curves(&self) -> BTreeMap<Role, Vec<usize>> {
        let mut curves: BTreeMap<Role, Vec<usize>> = BTreeMap::new();
        for bone in self.anatomy.steered() {
            if let Some(role @ (Role::Trunk | Role::Free(_))) = self.anatomy.roles[bone] {
                curves.entry(role).or_default().push(bone);
            }
        }
        curves.retain(|_, bones| bones.len() > 1);
        curves
    }

    fn curve_name(&self, role: Role) -> String {
        let of = match role {
            Role::Free(joint) => names::plain(&self.figure.joints[joint].name),
            _ => "trunk".to_owned(),
        };
        format!("{of}_curve")
    }

    fn curve(&self, role: Role, bones: &[usize], turning: Turning) -> ControlSpec {
        let Range { min, max, spread } = limits::of_curve(matches!(role, Role::Free(_)), turning);
        let drives = bones.iter().filter_map(|bone| {
            let (_, axis) = self.axes[bone]
                .turns
                .iter()
                .find(|(own, _)| *own == turning)?;
            Some(DriveSpec {
                bone: self.bone_name(*bone),
                axis: *axis,
                share: 1.0 / bones.len() as f32,
            })
        });
        ControlSpec {
            name: format!("{}.{}", self.curve_name(role), turning.name(Joint::Curve)),
            limits: (min, max),
            ease: 0.0,
            odd: turning != Turning::Bend,
            spread: Some(spread),
            drives: drives.collect(),
        }
    }

    fn turn(
        &self,
        bone: usize,
        joint: Joint,
        turning: Turning,
        axis: Vec3,
        clip_angles: &[f32],
    ) -> ControlSpec {
        let in_the_middle = self.anatomy.mirror[bone] == Some(bone);
        let odd = in_the_middle && turning != Turning::Bend;
        let range = self.default_range(bone, joint, turning);
        let Range { min, max, spread } = range.widened(clip_angles.iter().copied(), odd);
        ControlSpec {
            name: format!("{}.{}", self.stems[&bone], turning.name(joint)),
            limits: (min, max),
            ease: 0.0,
            odd,
            spread: Some(spread),
            drives: vec![DriveSpec {
                bone: self.bone_name(bone),
                axis,
                share: 1.0,
            }],
        }
    }

    /// A neck of one bone turns as far as a neck of many.
    fn default_range(&self, bone: usize, joint: Joint, turning: Turning) -> Range {
        let own = limits::of_bone(joint, turning);
        match self.anatomy.roles[bone] {
            Some(role @ (Role::Trunk | Role::Free(_))) if !self.curves().contains_key(&role) => {
                limits::of_curve(matches!(role, Role::Free(_)), turning)
            }
            _ => own,
        }
    }

    /// The angles that the clips' poses turn a bone by, per bone and place among its turns; those of a pair together.
    fn clip_angles(&self) -> BTreeMap<(usize, usize), Vec<f32>> {
        let mut angles: BTreeMap<(usize, usize), Vec<f32>> = BTreeMap::new();
        let poses = || self.rig.clips.iter().flat_map(|clip| &clip.poses);
        for (&bone, axes) in &self.axes {
            let axes = axes.turns.map(|(_, axis)| axis);
            for rotation in poses().filter_map(|pose| pose.rotations.get(bone)) {
                for (place, degrees) in angles_about(axes, *rotation).into_iter().enumerate() {
                    let image = self.anatomy.mirror[bone].filter(|other| *other != bone);
                    for bone in std::iter::once(bone).chain(image) {
                        angles.entry((bone, place)).or_default().push(degrees);
                    }
                }
            }
        }
        angles
    }

    /// What may be taken from another pose: each limb, neck and tail with what hangs on it.
    fn limbs(&self) -> Vec<Vec<String>> {
        let mut limbs: BTreeMap<Role, Vec<String>> = BTreeMap::new();
        for (role, _) in self.curves() {
            limbs.entry(role).or_default().push(self.curve_name(role));
        }
        for bone in self.anatomy.steered() {
            limbs
                .entry(self.carrying_role(bone))
                .or_default()
                .push(self.stems[&bone].clone());
        }
        limbs.retain(|role, _| matches!(role, Role::Limb(_) | Role::Free(_)));
        limbs.into_values().collect()
    }

    /// The role of the first bone that has one of its own, from `bone` upward.
    fn carrying_role(&self, bone: usize) -> Role {
        let above = std::iter::successors(Some(bone), |&at| self.rig.skeleton.bones[at].parent);
        above
            .filter_map(|at| self.anatomy.roles[at])
            .find(|role| *role != Role::Other)
            .unwrap_or(Role::Other)
    }

    fn bone_name(&self, bone: usize) -> String {
        self.rig.skeleton.bones[bone].name.clone()
    }
}
