//! From a pose to the values that make it exactly, where every bone that moves has three axes of its own.

use glam::{EulerRot, Mat3, Quat, Vec3};

use super::controls::{Controls, PoseValues, Turn};
use crate::rig::Pose;

/// How far (one minus cosine, or cosine) axes may be from right angles.
const SQUARE: f32 = 1e-3;

/// The angles by which turns about three axes at right angles, the first outermost, make a rotation; degrees. The second
/// is between -90 and 90.
pub(super) fn angles_about(axes: [Vec3; 3], rotation: Quat) -> [f32; 3] {
    let [first, second, third] = axes;
    // A left-handed triple is a right-handed one whose last axis is turned about, and its angle with it.
    let hand = first.cross(second).dot(third).signum();
    let frame = Mat3::from_cols(first, second, hand * third);
    let seen = frame.transpose() * Mat3::from_quat(rotation) * frame;
    let (a, b, c) = seen.to_euler(EulerRot::XYZ);
    [a, b, hand * c].map(f32::to_degrees)
}

impl Controls {
    /// The values that make a pose exactly, but for bones that no control turns; `None` unless every bone that is turned
    /// has three controls of its own about axes at right angles, as those of
    /// [`default_controls`](super::default_controls) are. Controls that several bones share stay at 0. Limits are not
    /// looked at.
    ///
    /// `lift_m` is as in [`Controls::fit`].
    #[must_use]
    pub fn unfold(&self, pose: &Pose) -> Option<PoseValues> {
        if !self.swings.is_empty() {
            return None;
        }
        let mut values = PoseValues {
            degrees: vec![0.0; self.list().len()],
            lift_m: self.lift_m(&self.skeleton.bone_transforms(pose)),
        };
        for (bone, turns) in self.turns.iter().enumerate() {
            if turns.is_empty() {
                continue;
            }
            let own = self.own_turns(bone)?;
            let above = self.skeleton.bones[bone].parent;
            let above = above.map_or(Quat::IDENTITY, |parent| self.neutral[parent]);
            let local = above * *pose.rotations.get(bone)? * self.neutral[bone].inverse();
            let angles = angles_about(own.map(|turn| turn.axis), local);
            for (turn, degrees) in own.iter().zip(angles) {
                values.degrees[turn.control] = degrees / turn.share;
            }
        }
        Some(values)
    }

    /// The last three turns of a bone, if they are about axes at right angles and no other bone shares them.
    fn own_turns(&self, bone: usize) -> Option<[Turn; 3]> {
        let own: [Turn; 3] = *self.turns[bone].last_chunk()?;
        let square = |a: usize, b: usize| own[a].axis.dot(own[b].axis).abs() < SQUARE;
        let alone = |turn: &Turn| {
            let drives = self.turns.iter().flatten();
            turn.share != 0.0 && drives.filter(|t| t.control == turn.control).count() == 1
        };
        let fits = square(0, 1) && square(0, 2) && square(1, 2) && own.iter().all(alone);
        fits.then_some(own)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_angles_make_the_rotation(
            turn in proptest::array::uniform4(-1.0_f32..1.0),
            frame in proptest::array::uniform4(-1.0_f32..1.0),
            left_handed in any::<bool>(),
        ) {
            let quat = |q: [f32; 4]| Quat::from_array(q).normalize();
            prop_assume!(Quat::from_array(turn).length() > 0.1 && Quat::from_array(frame).length() > 0.1);
            let (rotation, frame) = (quat(turn), Mat3::from_quat(quat(frame)));
            let last = if left_handed { -frame.z_axis } else { frame.z_axis };
            let axes = [frame.x_axis, frame.y_axis, last];
            let angles = angles_about(axes, rotation);
            let made = axes.iter().zip(angles).fold(Quat::IDENTITY, |q, (axis, degrees)| {
                q * Quat::from_axis_angle(*axis, degrees.to_radians())
            });
            prop_assert!(made.dot(rotation).abs() > 1.0 - 1e-5, "{made} {rotation}");
        }
    }
}
