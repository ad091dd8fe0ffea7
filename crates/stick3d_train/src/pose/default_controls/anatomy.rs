//! Which bones of a rig a figure needs, and what each of them is to it: root, trunk, limb, neck or tail.

use std::collections::BTreeSet;

use glam::Vec3;
use stick3d_figure::figure::{Anchor, Figure, Side};

use crate::pose::error::PoseError;
use crate::pose::spec::Lateral;
use crate::rig::{Rig, RigError};

/// A bone is moved by the clips if it turns more than this somewhere, degrees.
const MOVES_DEG: f32 = 0.5;

/// Two bones are each other's mirror image within this share of the skeleton's extent.
const MIRRORED: f32 = 0.02;

/// What a bone is to the figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    /// Carries the whole body, and nothing that turns carries it.
    Root,
    /// Carries several limbs.
    Trunk,
    /// Part of a limb, by its number.
    Limb(usize),
    /// Part of a neck, a tail or the like, by the figure's joint at its end.
    Free(usize),
    /// None of these: an ear, a toe, a finger.
    Other,
}

/// The bones of a rig as a figure sees them.
#[derive(Debug)]
pub(super) struct Anatomy {
    pub(super) lateral: Lateral,
    /// Per bone what it is; `None` for bones that stay at rest.
    pub(super) roles: Vec<Option<Role>>,
    /// Per bone its mirror image; itself in the middle, `None` where the skeleton is not symmetric.
    pub(super) mirror: Vec<Option<usize>>,
    /// Per bone how many vertices' worth of surface follow it and what hangs on it.
    pub(super) carried: Vec<f32>,
    /// Per limb whether it reaches the ground.
    pub(super) is_leg: Vec<bool>,
}

impl Anatomy {
    pub(super) fn read(rig: &Rig, figure: &Figure) -> Result<Self, PoseError> {
        let anchors = anchors(rig, figure)?;
        let lateral = lateral(rig, figure, &anchors);
        let carried = carried(rig);
        let limb_of_joint = limbs(figure);
        let limb_count = limb_of_joint
            .iter()
            .flatten()
            .max()
            .map_or(0, |last| last + 1);
        let below = |bone: usize, joint: usize| {
            let anchors = &anchors[joint];
            anchors.iter().any(|&at| rig.skeleton.is_below(at, bone))
        };
        let role = |bone: usize| -> Role {
            let joints = (0..figure.joint_count()).filter(|&joint| below(bone, joint));
            let joints: Vec<usize> = joints.collect();
            let limbs: BTreeSet<usize> = joints.iter().filter_map(|&j| limb_of_joint[j]).collect();
            let tip = joints.iter().find(|&&joint| is_tip(figure, joint));
            match (limbs.len(), limbs.first(), tip) {
                (1, Some(&limb), _) => Role::Limb(limb),
                (0, _, Some(&joint)) => Role::Free(joint),
                (0, ..) => Role::Other,
                _ => Role::Trunk,
            }
        };
        let moved = moved(rig);
        let count = rig.skeleton.bones.len();
        let mut roles: Vec<Option<Role>> = vec![None; count];
        for bone in (0..count).filter(|&bone| carried[bone] > 0.0) {
            let role = role(bone);
            let needed = role != Role::Other || moved[bone];
            let carrier = rig.skeleton.bones[bone].parent;
            let free = carrier.is_none_or(|parent| !rooted(rig, &roles, parent));
            roles[bone] = needed.then_some(match role {
                Role::Trunk if free => Role::Root,
                role => role,
            });
        }
        let (low, high) = rig.mesh.bounds();
        let ground = low.y + 0.2 * (high.y - low.y);
        let is_leg = |limb: usize| {
            let ends =
                (0..figure.joint_count()).filter(|&joint| limb_of_joint[joint] == Some(limb));
            let heads = ends.flat_map(|joint| &anchors[joint]);
            heads
                .map(|&bone| rig.skeleton.bones[bone].head.y)
                .fold(f32::INFINITY, f32::min)
                < ground
        };
        Ok(Self {
            mirror: mirror(rig, lateral),
            is_leg: (0..limb_count).map(is_leg).collect(),
            lateral,
            roles,
            carried,
        })
    }

    /// The bones that move.
    pub(super) fn steered(&self) -> impl Iterator<Item = usize> {
        (0..self.roles.len()).filter(|&bone| self.roles[bone].is_some())
    }

    /// The child that a bone goes on in: of those with its own role the one that carries most.
    pub(super) fn heir(&self, rig: &Rig, bone: usize) -> Option<usize> {
        let children = (0..self.roles.len()).filter(|&child| {
            rig.skeleton.bones[child].parent == Some(bone) && self.carried[child] > 0.0
        });
        let kin = |role: Option<Role>| match (self.roles[bone], role) {
            (Some(Role::Root), Some(Role::Trunk)) => true,
            (own, other) => own == other,
        };
        children.max_by(|&a, &b| {
            let rank = |child: usize| (kin(self.roles[child]), self.carried[child]);
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })
    }
}

/// Whether a bone or one above it is a root of the body.
fn rooted(rig: &Rig, roles: &[Option<Role>], bone: usize) -> bool {
    let above = std::iter::successors(Some(bone), |&at| rig.skeleton.bones[at].parent);
    above.into_iter().any(|at| roles[at] == Some(Role::Root))
}

/// Per joint of the figure the bones that it is on; of a joint on vertices the bone that they follow most.
fn anchors(rig: &Rig, figure: &Figure) -> Result<Vec<Vec<usize>>, PoseError> {
    let find = |joint: &stick3d_figure::figure::Joint| match &joint.anchor {
        Anchor::Bones(names) => names
            .iter()
            .map(|name| Ok(rig.skeleton.bone_index(name)?))
            .collect(),
        Anchor::Vertices(vertices) => {
            let mut followed = vec![0.0_f32; rig.skeleton.bones.len()];
            for &vertex in vertices {
                let list = rig.influences.get(vertex as usize);
                let list = list.ok_or_else(|| RigError::Joint {
                    joint: joint.name.clone(),
                    why: format!(
                        "vertex {vertex} is past the last one, {}",
                        rig.influences.len()
                    ),
                })?;
                for &(bone, weight) in list {
                    followed[usize::from(bone)] += weight;
                }
            }
            let most = (0..followed.len()).max_by(|&a, &b| followed[a].total_cmp(&followed[b]));
            Ok(most.into_iter().collect())
        }
    };
    figure.joints.iter().map(find).collect()
}

/// The axis from side to side: the one along which the two sides of the figure are apart.
fn lateral(rig: &Rig, figure: &Figure, anchors: &[Vec<usize>]) -> Lateral {
    let mean = |joint: usize| -> Vec3 {
        let heads = anchors[joint]
            .iter()
            .map(|&bone| rig.skeleton.bones[bone].head);
        heads.sum::<Vec3>() / anchors[joint].len().max(1) as f32
    };
    let lefts = (0..figure.joint_count()).filter(|&j| figure.joints[j].side == Side::Left);
    let apart: Vec3 = lefts
        .map(|joint| (mean(joint) - mean(figure.mirror_of(joint))).abs())
        .sum();
    if apart.z > apart.x {
        Lateral::Z
    } else {
        Lateral::X
    }
}

/// Per joint of one side the limb that it belongs to: joints of a side that the figure's bones join.
fn limbs(figure: &Figure) -> Vec<Option<usize>> {
    let sided = |joint: usize| figure.joints[joint].side != Side::Center;
    let mut limb: Vec<Option<usize>> = vec![None; figure.joint_count()];
    let mut count = 0;
    for start in (0..figure.joint_count()).filter(|&joint| sided(joint)) {
        if limb[start].is_some() {
            continue;
        }
        let mut open = vec![start];
        while let Some(joint) = open.pop() {
            limb[joint] = Some(count);
            for &[a, b] in &figure.bones {
                for (from, to) in [(a, b), (b, a)] {
                    if from == joint && sided(to) && limb[to].is_none() {
                        open.push(to);
                    }
                }
            }
        }
        count += 1;
    }
    limb
}

/// Whether a joint of the middle is the end of a line.
fn is_tip(figure: &Figure, joint: usize) -> bool {
    let lines = figure.bones.iter().filter(|line| line.contains(&joint));
    figure.joints[joint].side == Side::Center && lines.count() == 1
}

fn carried(rig: &Rig) -> Vec<f32> {
    let mut carried = vec![0.0_f32; rig.skeleton.bones.len()];
    for &(bone, weight) in rig.influences.iter().flatten() {
        carried[usize::from(bone)] += weight;
    }
    for bone in (0..carried.len()).rev() {
        if let Some(parent) = rig.skeleton.bones[bone].parent {
            carried[parent] += carried[bone];
        }
    }
    carried
}

fn moved(rig: &Rig) -> Vec<bool> {
    let mut moved = vec![false; rig.skeleton.bones.len()];
    for pose in rig.clips.iter().flat_map(|clip| &clip.poses) {
        for (moved, rotation) in moved.iter_mut().zip(&pose.rotations) {
            let half_turn = rotation.w.abs().min(1.0).acos();
            *moved |= (2.0 * half_turn).to_degrees() > MOVES_DEG;
        }
    }
    moved
}

/// Per bone the bone at its mirrored place that hangs on the mirror image of its parent.
fn mirror(rig: &Rig, lateral: Lateral) -> Vec<Option<usize>> {
    let bones = &rig.skeleton.bones;
    let heads: Vec<Vec3> = bones.iter().map(|bone| bone.head).collect();
    let spread = |axis: fn(Vec3) -> f32| {
        let places = heads.iter().map(|&head| axis(head));
        places.clone().fold(f32::NEG_INFINITY, f32::max) - places.fold(f32::INFINITY, f32::min)
    };
    let extent = spread(|v| v.x).max(spread(|v| v.y)).max(spread(|v| v.z));
    let mut mirror: Vec<Option<usize>> = vec![None; bones.len()];
    for bone in 0..bones.len() {
        let image = lateral.mirror(heads[bone]);
        // The parent's image is known: parents come first.
        let hangs_there = |other: usize| match (bones[bone].parent, bones[other].parent) {
            (None, None) => true,
            (Some(parent), Some(there)) => mirror[parent] == Some(there),
            _ => false,
        };
        mirror[bone] = (0..bones.len())
            .filter(|&other| hangs_there(other))
            .map(|other| (image.distance(heads[other]), other))
            .filter(|&(apart, _)| apart <= MIRRORED * extent)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, other)| other);
    }
    // Only what is each other's image counts.
    (0..bones.len())
        .map(|bone| mirror[bone].filter(|&other| mirror[other] == Some(bone)))
        .collect()
}
