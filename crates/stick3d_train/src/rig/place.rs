//! Bringing a rig to the size and heading of a figure's template.

use glam::Quat;
use stick3d_figure::figure::Figure;

use super::{Pose, Rig, RigError, regressor};
use crate::placement::Placement;

impl Rig {
    /// Brings the rig, its clips included, to metres and to the heading of the figure's template: see [`Placement::of`].
    /// Most files face +Z; a figure whose template is a side view walks to +X.
    ///
    /// # Errors
    /// [`RigError::UnknownBone`] or [`RigError::Joint`] for a joint that this rig has no place for, and
    /// [`RigError::Inconsistent`] for joints that are all at one place.
    pub fn place(&mut self, figure: &Figure) -> Result<Placement, RigError> {
        let joints = regressor(figure, self)?.joints(&self.mesh.positions);
        let placement =
            Placement::of(&joints, figure, None).ok_or_else(|| RigError::Inconsistent {
                what: format!(
                    "all joints of the figure `{}` are at one place",
                    figure.name
                ),
            })?;
        if !placement.is_none() {
            self.transform(placement.turn(), placement.scale);
        }
        Ok(placement)
    }

    /// Turns the rig at rest about the origin, after scaling it; poses of the turned rig look like those of this one,
    /// turned.
    pub fn transform(&mut self, turn: Quat, scale: f32) {
        let points = self.mesh.positions.iter_mut().chain(&mut self.centers);
        points.for_each(|point| *point = turn * (scale * *point));
        for bone in &mut self.skeleton.bones {
            bone.head = turn * (scale * bone.head);
            bone.rest_rotation = (turn * bone.rest_rotation).normalize();
        }
        let poses = self.clips.iter_mut().flat_map(|clip| &mut clip.poses);
        poses.for_each(|pose| *pose = transformed(pose, turn, scale));
    }
}

/// A pose's rotations have the axes of model space: they turn along with it.
fn transformed(pose: &Pose, turn: Quat, scale: f32) -> Pose {
    let rotations = pose.rotations.iter();
    Pose {
        rotations: rotations
            .map(|rotation| (turn * *rotation * turn.inverse()).normalize())
            .collect(),
        root_translation: turn * (scale * pose.root_translation),
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use glam::Vec3;

    use super::*;
    use crate::size::relative_size;

    fn shipped(name: &str) -> Rig {
        let path = format!(
            "{}/../../assets/rigs/{name}.glb",
            env!("CARGO_MANIFEST_DIR")
        );
        Rig::from_glb(&std::fs::read(path).unwrap()).unwrap()
    }

    #[test]
    fn shipped_rigs_stand_as_their_figures_do() {
        for figure in Figure::shipped() {
            let mut rig = shipped(&figure.name);
            let before = rig.clone();
            let placement = rig.place(figure).unwrap();
            assert!(placement.is_none(), "{}: {placement:?}", figure.name);
            assert_eq!(rig, before);
            let (low, high) = rig.mesh.bounds();
            assert_eq!(relative_size((high - low).max_element()), 1.0);
        }
    }

    #[test]
    fn a_horse_that_faces_the_viewer_in_centimetres_is_turned_to_its_side_with_its_clips() {
        let rig = shipped("horse");
        let mut foreign = rig.clone();
        foreign.transform(Quat::from_rotation_y(-FRAC_PI_2), 100.0);
        let placement = foreign.place(Figure::horse()).unwrap();
        assert_eq!((placement.scale, placement.yaw_deg), (0.01, 90.0));
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for (clip, placed) in rig.clips.iter().zip(&foreign.clips) {
            let time_s = clip.duration_s() / 3.0;
            rig.skin(&clip.sample(time_s).unwrap(), &mut ours);
            foreign.skin(&placed.sample(time_s).unwrap(), &mut theirs);
            let apart = |(a, b): (&Vec3, &Vec3)| a.distance(*b);
            let worst = ours.iter().zip(&theirs).map(apart).fold(0.0, f32::max);
            assert!(worst < 1e-3, "{}: {worst}", clip.name);
        }
    }
}
