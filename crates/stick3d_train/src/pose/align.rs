//! From the stance a rig rests in to the neutral stance that controls count from.
//!
//! Rigs rest in all kinds of A and T stances with half-bent elbows. Angles that a person can author
//! count from one known stance instead: upright, arms hanging, palms to the thighs, everything
//! straight. The rotation between the two, per bone, is found once from the bones' heads.

use glam::{Mat3, Quat, Vec3};

use super::error::PoseError;
use super::spec::{ControlsSpec, Half, Lateral, SideOf, Stance};
use crate::rig::Skeleton;

/// Every bone's whole rotation from rest to the neutral stance.
pub(super) fn neutral_rotations(
    skeleton: &Skeleton,
    controls: &ControlsSpec,
) -> Result<Vec<Quat>, PoseError> {
    let mut own: Vec<Option<Quat>> = vec![None; skeleton.bones.len()];
    for spec in &controls.neutral {
        for &half in Half::of(&spec.bone) {
            let bone = skeleton.bone_index(&half.name(&spec.bone))?;
            own[bone] = Some(match &spec.stance {
                Stance::Rest => Quat::IDENTITY,
                Stance::Aim { .. } => aim(skeleton, bone, &spec.stance, half, controls.lateral)?,
            });
        }
    }
    // A bone that is not mentioned goes along with its parent, so that parents come first.
    let mut whole: Vec<Quat> = Vec::with_capacity(own.len());
    for (bone, rotation) in own.into_iter().enumerate() {
        let parent = skeleton.bones[bone]
            .parent
            .map_or(Quat::IDENTITY, |parent| whole[parent]);
        whole.push(rotation.unwrap_or(parent));
    }
    Ok(whole)
}

fn aim(
    skeleton: &Skeleton,
    bone: usize,
    stance: &Stance,
    half: Half,
    lateral: Lateral,
) -> Result<Quat, PoseError> {
    let Stance::Aim {
        toward,
        points,
        side,
        becomes,
    } = stance
    else {
        return Ok(Quat::IDENTITY);
    };
    let head = |name: &String| -> Result<Vec3, PoseError> {
        Ok(skeleton.bones[skeleton.bone_index(&half.name(name))?].head)
    };
    let line = head(toward)? - skeleton.bones[bone].head;
    // Only an axis of rotation changes its hand under reflection; a plain direction does not.
    let (side, becomes) = match side {
        SideOf::Between(from, to) => (head(to)? - head(from)?, half.direction(*becomes, lateral)),
        SideOf::Bend(a, b, c) => (
            (head(b)? - head(a)?).cross(head(c)? - head(b)?),
            half.axis(*becomes, lateral),
        ),
        SideOf::Axis(axis) => (half.axis(*axis, lateral), half.axis(*becomes, lateral)),
    };
    let frame = |what, line, side| {
        frame(line, side).ok_or_else(|| {
            let name = &skeleton.bones[bone].name;
            PoseError::inconsistent(
                format!("neutral stance of bone `{name}`"),
                format!("its line and its side are parallel or empty {what}; choose another side"),
            )
        })
    };
    let rest = frame("at rest", line, side)?;
    let stands = frame("in the stance", half.direction(*points, lateral), becomes)?;
    Ok(Quat::from_mat3(&(stands * rest.transpose())).normalize())
}

/// The right-handed frame whose first axis is `line` and whose second is as near `side` as possible.
fn frame(line: Vec3, side: Vec3) -> Option<Mat3> {
    let x = line.try_normalize()?;
    let y = side.try_normalize()?.reject_from_normalized(x);
    let y = if y.length() > 1e-3 {
        y.normalize()
    } else {
        return None;
    };
    Some(Mat3::from_cols(x, y, x.cross(y)))
}
