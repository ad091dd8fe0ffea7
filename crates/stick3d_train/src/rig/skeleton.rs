//! Bones, and poses as rotations against the rest.

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use super::RigError;

/// One bone at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bone {
    /// The bone's name, unique in its skeleton.
    pub name: String,
    /// The bone that carries it: an index smaller than its own; `None` for a root.
    pub parent: Option<usize>,
    /// The joint that the bone turns about, at rest, model space, metres.
    pub head: Vec3,
    /// The bone's own axes at rest, model space. Poses do not depend on it; files keep it.
    pub rest_rotation: Quat,
}

/// The bones of a rig, parents before children.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Skeleton {
    /// The bones; a bone's parent has a smaller index.
    pub bones: Vec<Bone>,
}

/// A bodily attitude: every bone's rotation against the rest.
///
/// `rotations[b]` turns bone `b` by a rotation whose axes are those of *model space as they stand at
/// rest*, whatever the bone's own roll. The parent's whole rotation is applied after it:
///
/// `D_b = D_parent * q_b`, `head'_b = head'_parent + D_parent * (head_b - head_parent)`,
///
/// and a point `x` fixed to bone `b` goes to `head'_b + D_b * (x - head_b)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// One unit quaternion per bone of the skeleton.
    pub rotations: Vec<Quat>,
    /// How far the roots' heads move, model space, metres.
    pub root_translation: Vec3,
}

impl Pose {
    /// The rest pose of a skeleton with `bone_count` bones.
    pub fn rest(bone_count: usize) -> Self {
        Self {
            rotations: vec![Quat::IDENTITY; bone_count],
            root_translation: Vec3::ZERO,
        }
    }
}

impl Skeleton {
    /// The index of the bone called `name`.
    ///
    /// # Errors
    /// [`RigError::UnknownBone`] with the most similar name.
    pub fn bone_index(&self, name: &str) -> Result<usize, RigError> {
        self.bones
            .iter()
            .position(|bone| bone.name == name)
            .ok_or_else(|| RigError::UnknownBone {
                name: name.to_owned(),
                nearest: self
                    .bones
                    .iter()
                    .min_by_key(|bone| edit_distance(&bone.name, name))
                    .map(|bone| bone.name.clone()),
            })
    }

    /// Checks that parents come before children and that every head and rotation is finite.
    ///
    /// # Errors
    /// [`RigError::Inconsistent`] names the first bone that does not fit.
    pub fn validate(&self) -> Result<(), RigError> {
        for (index, bone) in self.bones.iter().enumerate() {
            let what = if bone.parent.is_some_and(|parent| parent >= index) {
                "comes before its parent"
            } else if !bone.head.is_finite() || !bone.rest_rotation.is_finite() {
                "is not at a finite place"
            } else {
                continue;
            };
            return Err(RigError::Inconsistent {
                what: format!("bone `{}` {what}", bone.name),
            });
        }
        if self.bones.len() > usize::from(u16::MAX) {
            return Err(RigError::Inconsistent {
                what: format!("{} bones are more than 65,535", self.bones.len()),
            });
        }
        Ok(())
    }

    /// Where a pose brings every bone: (whole rotation against the rest `D_b`, posed head `head'_b`).
    ///
    /// Rotations that the pose lacks count as the identity.
    pub fn bone_transforms(&self, pose: &Pose) -> Vec<(Quat, Vec3)> {
        let mut transforms: Vec<(Quat, Vec3)> = Vec::with_capacity(self.bones.len());
        for (index, bone) in self.bones.iter().enumerate() {
            let own = pose.rotations.get(index).copied().unwrap_or(Quat::IDENTITY);
            let posed = match bone.parent {
                Some(parent) => {
                    let (parent_rotation, parent_head) = transforms[parent];
                    let offset = bone.head - self.bones[parent].head;
                    (
                        (parent_rotation * own).normalize(),
                        parent_head + parent_rotation * offset,
                    )
                }
                None => (own.normalize(), bone.head + pose.root_translation),
            };
            transforms.push(posed);
        }
        transforms
    }

    /// The bone that `bone` hangs on in the end, itself if it is a root.
    pub fn root_of(&self, bone: usize) -> usize {
        let mut at = bone;
        while let Some(parent) = self.bones[at].parent {
            at = parent;
        }
        at
    }

    /// Whether `bone` is `ancestor` or hangs below it.
    pub fn is_below(&self, bone: usize, ancestor: usize) -> bool {
        let mut at = Some(bone);
        while let Some(index) = at {
            if index == ancestor {
                return true;
            }
            at = self.bones[index].parent;
        }
        false
    }
}

/// The number of single-letter changes between two words (Levenshtein).
fn edit_distance(left: &str, right: &str) -> usize {
    let right: Vec<char> = right.chars().collect();
    let mut row: Vec<usize> = (0..=right.len()).collect();
    for (i, l) in left.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, r) in right.iter().enumerate() {
            let changed = diagonal + usize::from(l != *r);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[right.len()]
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;

    fn arm() -> Skeleton {
        let bone = |name: &str, parent, x| Bone {
            name: name.into(),
            parent,
            head: Vec3::new(x, 1.0, 0.0),
            rest_rotation: Quat::IDENTITY,
        };
        Skeleton {
            bones: vec![
                bone("upper", None, 0.0),
                bone("lower", Some(0), 1.0),
                bone("hand", Some(1), 2.0),
            ],
        }
    }

    #[test]
    fn turns_are_about_model_axes_at_rest_and_carried_by_the_parent() {
        let skeleton = arm();
        let mut pose = Pose::rest(3);
        pose.rotations[0] = Quat::from_rotation_z(FRAC_PI_2);
        pose.rotations[1] = Quat::from_rotation_z(FRAC_PI_2);
        pose.root_translation = Vec3::new(0.0, 0.0, 3.0);
        let posed = skeleton.bone_transforms(&pose);
        assert!(
            posed[1].1.abs_diff_eq(Vec3::new(0.0, 2.0, 3.0), 1e-6),
            "{posed:?}"
        );
        assert!(
            posed[2].1.abs_diff_eq(Vec3::new(-1.0, 2.0, 3.0), 1e-6),
            "{posed:?}"
        );
        assert!((posed[2].0 * Vec3::X).abs_diff_eq(Vec3::NEG_X, 1e-6));
    }

    #[test]
    fn a_wrong_bone_name_gets_the_nearest_one() {
        let error = arm().bone_index("lowr").unwrap_err();
        assert!(
            error.to_string().contains("did you mean `lower`"),
            "{error}"
        );
    }

    #[test]
    fn a_child_before_its_parent_is_refused() {
        let mut skeleton = arm();
        skeleton.bones[1].parent = Some(2);
        assert!(skeleton.validate().is_err());
    }
}
