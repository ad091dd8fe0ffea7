//! The joints of a file's skin: which nodes they are, where they stand at rest, what carries them.

use std::collections::BTreeMap;

use glam::{Mat4, Quat, Vec3};
use gltf::{Document, Skin};

use super::animation::Animation;
use super::clips::{Frame, Motion};
use super::nodes::NodeTree;
use super::open::{Source, named};
use super::report::RigReport;
use super::{Bone, RigError, Skeleton};

/// How far (degrees) the nodes may turn the skeleton as a whole against the bind pose.
const AGREEING_TURN_DEG: f32 = 30.0;

/// The joints, in the order of the skin.
#[derive(Debug)]
pub(super) struct Joints {
    /// The node of each.
    pub(super) nodes: Vec<usize>,
    names: Vec<String>,
    /// The joint that carries each.
    pub(super) parents: Vec<Option<usize>>,
    /// Rest to model space.
    pub(super) rest: Vec<Mat4>,
}

impl Joints {
    /// The joints of the largest skin of the file; other skins must be made of the same ones.
    pub(super) fn read(
        source: &Source,
        tree: &NodeTree,
        report: &mut RigReport,
    ) -> Result<Self, RigError> {
        let document = &source.document;
        let skin = only_skin(document)?;
        let nodes: Vec<usize> = skin.joints().map(|node| node.index()).collect();
        if nodes.is_empty() {
            return Err(RigError::Missing {
                what: format!("bones in skin {}", named(skin.name(), skin.index())),
            });
        }
        if nodes.len() > usize::from(u16::MAX) {
            return Err(RigError::Unsupported {
                what: "more than 65,535 bones".into(),
            });
        }
        let joint_of_node: BTreeMap<usize, usize> = nodes
            .iter()
            .enumerate()
            .map(|(j, &node)| (node, j))
            .collect();
        let parent = |&node: &usize| {
            let above = tree.above(node, |at| joint_of_node.contains_key(&at))?;
            joint_of_node.get(&above).copied()
        };
        let parents: Vec<Option<usize>> = nodes.iter().map(parent).collect();
        let mut joints = Self {
            names: unique_names(&skin, report),
            parents,
            rest: Vec::new(),
            nodes,
        };
        joints.rest = joints.rest_matrices(source, &skin, tree, report)?;
        Ok(joints)
    }

    /// Where the joints stand at rest: as the file shows them, or, where that is another pose than the one
    /// the skin was bound in, in the latter, placed as the file places the armature.
    fn rest_matrices(
        &self,
        source: &Source,
        skin: &Skin<'_>,
        tree: &NodeTree,
        report: &mut RigReport,
    ) -> Result<Vec<Mat4>, RigError> {
        let globals = tree.globals();
        let shown: Vec<Mat4> = self.nodes.iter().map(|&node| globals[node]).collect();
        let inverse = inverse_bind(source, skin)?;
        let singular = |m: &Mat4| !(m.determinant().abs() > f32::MIN_POSITIVE && m.is_finite());
        if skin.inverse_bind_matrices().is_none() || inverse.iter().any(singular) {
            return Ok(shown);
        }
        let bound: Vec<Mat4> = inverse.iter().map(Mat4::inverse).collect();
        // Per joint what takes the bind pose to where the file shows it: one and the same if the file
        // shows the bind pose.
        let placings: Vec<Mat4> = shown.iter().zip(&inverse).map(|(g, i)| *g * *i).collect();
        let root = (0..self.nodes.len())
            .find(|&joint| self.parents[joint].is_none())
            .unwrap_or(0);
        let heads: Vec<Vec3> = shown.iter().map(|m| m.w_axis.truncate()).collect();
        let extent = extent(&heads).max(f32::MIN_POSITIVE);
        let off = |joint: usize| {
            let there = (placings[root] * bound[joint]).w_axis.truncate();
            (there - heads[joint]).length() > 1e-3 * extent
                || turn_between_deg(&placings[root], &placings[joint]) > 0.5
        };
        let moved = (0..self.nodes.len()).filter(|&joint| off(joint)).count();
        if moved == 0 {
            return Ok(shown);
        }
        let armature =
            std::iter::successors(tree.parents[self.nodes[root]], |&at| tree.parents[at])
                .find(|node| !self.nodes.contains(node))
                .map_or(Mat4::IDENTITY, |node| globals[node]);
        let agrees = |placing: &Mat4| {
            let scale = placing.determinant().abs().cbrt() / armature.determinant().abs().cbrt();
            turn_between_deg(placing, &armature) < AGREEING_TURN_DEG && (scale - 1.0).abs() < 0.02
        };
        let whole = if placings.iter().any(agrees) {
            armature
        } else {
            placings[root]
        };
        report.notes.push(format!(
            "the file shows another pose than the one the skin was bound in ({moved} of {} bones \
             differ); the latter is the rest",
            self.nodes.len()
        ));
        Ok(bound.iter().map(|bind| whole * *bind).collect())
    }

    /// The matrices of a skin whose joints are among these: its own joint number -> (joint, to rest).
    pub(super) fn bind(
        &self,
        source: &Source,
        skin: &Skin<'_>,
    ) -> Result<Vec<(u16, Mat4)>, RigError> {
        let inverse = inverse_bind(source, skin)?;
        let joint = |node: usize| self.nodes.iter().position(|&other| other == node);
        skin.joints()
            .zip(inverse)
            .map(|(node, inverse)| {
                let joint = joint(node.index()).ok_or_else(|| RigError::Missing {
                    what: format!("bone {}", named(node.name(), node.index())),
                })?;
                Ok((joint as u16, self.rest[joint] * inverse))
            })
            .collect()
    }

    /// The skeleton, parents before children, and per joint its bone.
    pub(super) fn skeleton(&self) -> (Skeleton, Vec<u16>) {
        let depth = |joint: usize| std::iter::successors(Some(joint), |&j| self.parents[j]).count();
        let mut order: Vec<usize> = (0..self.nodes.len()).collect();
        order.sort_by_cached_key(|&joint| depth(joint));
        let mut bone_of_joint = vec![0_u16; self.nodes.len()];
        for (bone, &joint) in order.iter().enumerate() {
            bone_of_joint[joint] = bone as u16;
        }
        let bones = order
            .iter()
            .map(|&joint| {
                let (_, rest_rotation, head) = self.rest[joint].to_scale_rotation_translation();
                Bone {
                    name: self.names[joint].clone(),
                    parent: self.parents[joint].map(|parent| usize::from(bone_of_joint[parent])),
                    head,
                    rest_rotation,
                }
            })
            .collect();
        (Skeleton { bones }, bone_of_joint)
    }

    /// The name of a joint.
    pub(super) fn name(&self, joint: usize) -> &str {
        &self.names[joint]
    }

    /// Where every joint is at rest.
    pub(super) fn heads(&self) -> Vec<Vec3> {
        self.rest.iter().map(|m| m.w_axis.truncate()).collect()
    }

    /// What an animation does to the joints.
    pub(super) fn motion(
        &self,
        animation: &Animation,
        tree: &NodeTree,
    ) -> Result<Motion, RigError> {
        let rest: Vec<Quat> = self.rest.iter().map(rotation_of).collect();
        let times = animation.times_s()?;
        let first = times.first().copied().unwrap_or(0.0);
        let frame = |&time_s: &f32| {
            let globals = tree.globals_of(&animation.posture(tree, time_s));
            let joint = |(joint, &node): (usize, &usize)| {
                let turn = (rotation_of(&globals[node]) * rest[joint].inverse()).normalize();
                let head = globals[node].w_axis.truncate();
                if turn.is_finite() && head.is_finite() {
                    (turn, head)
                } else {
                    // A bone scaled to nothing has no direction: it stays as it was.
                    (Quat::IDENTITY, self.rest[joint].w_axis.truncate())
                }
            };
            Frame {
                time_s: time_s - first,
                joints: self.nodes.iter().enumerate().map(joint).collect(),
            }
        };
        Ok(Motion {
            name: animation.name.clone(),
            frames: times.iter().map(frame).collect(),
        })
    }
}

/// The largest extent of a cloud of points.
pub(super) fn extent(points: &[Vec3]) -> f32 {
    let low = points.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    (high - low).max_element()
}

fn rotation_of(matrix: &Mat4) -> Quat {
    matrix.to_scale_rotation_translation().1
}

fn turn_between_deg(first: &Mat4, second: &Mat4) -> f32 {
    let between = rotation_of(first).inverse() * rotation_of(second);
    let half = between.w.abs().min(1.0).acos();
    (2.0 * half).to_degrees()
}

/// The skin with the most joints, which must include those of all the others that are used.
fn only_skin(document: &Document) -> Result<Skin<'_>, RigError> {
    let skinned = || document.nodes().filter(|node| node.mesh().is_some());
    let used: Vec<(gltf::Node<'_>, Skin<'_>)> = skinned()
        .filter_map(|node| node.skin().map(|skin| (node, skin)))
        .collect();
    let most = used
        .iter()
        .max_by_key(|(node, skin)| (skin.joints().count(), std::cmp::Reverse(node.index())));
    let Some((main_node, main)) = most else {
        let meshes: Vec<String> = skinned()
            .map(|node| named(node.name(), node.index()))
            .collect();
        return Err(RigError::NoSkin { meshes });
    };
    let joints: Vec<usize> = main.joints().map(|node| node.index()).collect();
    for (node, skin) in &used {
        if let Some(foreign) = skin.joints().find(|joint| !joints.contains(&joint.index())) {
            return Err(RigError::TwoSkins {
                first: named(main_node.name(), main_node.index()),
                second: named(node.name(), node.index()),
                bone: named(foreign.name(), foreign.index()),
            });
        }
    }
    Ok(main.clone())
}

fn inverse_bind(source: &Source, skin: &Skin<'_>) -> Result<Vec<Mat4>, RigError> {
    let joints = skin.joints().count();
    let reader = skin.reader(|buffer| source.bytes(&buffer));
    let inverse: Vec<Mat4> = match reader.read_inverse_bind_matrices() {
        Some(matrices) => matrices.map(|m| Mat4::from_cols_array_2d(&m)).collect(),
        None => vec![Mat4::IDENTITY; joints],
    };
    if inverse.len() < joints {
        return Err(RigError::Inconsistent {
            what: format!(
                "skin {} has {joints} bones but {} inverse bind matrices",
                named(skin.name(), skin.index()),
                inverse.len()
            ),
        });
    }
    Ok(inverse)
}

/// The joints' names; a name that several have gets a number.
fn unique_names(skin: &Skin<'_>, report: &mut RigReport) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (joint, node) in skin.joints().enumerate() {
        let name = node
            .name()
            .map_or_else(|| format!("bone_{joint}"), str::to_owned);
        let mut unique = name.clone();
        let mut number = 2;
        while names.contains(&unique) {
            unique = format!("{name}_{number}");
            number += 1;
        }
        if unique != name {
            report.notes.push(format!(
                "several bones are called `{name}`; one of them is `{unique}` here"
            ));
        }
        names.push(unique);
    }
    names
}
