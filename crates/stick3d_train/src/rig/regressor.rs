//! Finding a figure's joints on the surface of its rig.
//!
//! A joint must be readable from a mesh alone, so it is a weighted mean of vertices. The weights are
//! fitted: over a few bent poses of the joint's own bones and those that hang on them the mean shall stay at the bone's head,
//! at rest it shall hit it exactly, and the weights shall stay near a plain average, so that noise in
//! the vertices is averaged out and not amplified.

use std::collections::BTreeMap;

use glam::{DVec3, Quat, Vec3};
use nalgebra::{DMatrix, DVector};
use stick3d_figure::{Anchor, Figure, JointRegressor};

use super::{Bone, Pose, Rig, RigError};
use crate::size::relative_size;

/// Degrees that the fit bends a joint by, about each model axis.
const BENDS_DEG: [f32; 4] = [-90.0, -45.0, 45.0, 90.0];

/// Weight of "near a plain average" against "near the bone's head", in square metres, on a body of usual size.
const RIDGE_M2: f64 = 0.005;

/// A vertex belongs to a joint's ring when the bones below and above the joint both hold this share of it.
const RING_SHARE: f32 = 0.15;

/// The fewest vertices that a joint is the mean of, where it is on a bone.
const LEAST_RING: usize = 4;

/// How many of the nearest vertices stand in where there is neither ring nor slab.
const NEAREST: usize = 12;

/// Half height of the slab that stands in for a ring where a bone has no moving parent, in bone lengths.
const SLAB: f32 = 0.5;

/// The joint regressor of `figure` on `rig`: each joint a weighted mean of a ring of vertices round it.
///
/// At rest every joint lies exactly on its anchor; the weights of a joint sum to 1 (a few may be
/// slightly negative).
///
/// # Errors
/// [`RigError::UnknownBone`] or [`RigError::Joint`] when an anchor does not exist on this rig.
pub fn regressor(figure: &Figure, rig: &Rig) -> Result<JointRegressor, RigError> {
    let rows = figure
        .joints
        .iter()
        .map(|joint| {
            let row = match &joint.anchor {
                Anchor::Vertices(vertices) => mean_of(vertices, rig.mesh.positions.len()),
                Anchor::Bones(names) => {
                    let bones = names
                        .iter()
                        .map(|name| rig.skeleton.bone_index(name))
                        .collect::<Result<Vec<_>, _>>()?;
                    fit(&bones, rig)
                }
            };
            row.map_err(|why| RigError::Joint {
                joint: joint.name.clone(),
                why,
            })
        })
        .collect::<Result<Vec<_>, _>>()?;
    Ok(JointRegressor { rows })
}

/// The plain mean of some of `count` vertices.
pub(crate) fn mean_of(vertices: &[u32], count: usize) -> Result<Vec<(u32, f32)>, String> {
    match vertices.iter().find(|&&vertex| vertex as usize >= count) {
        Some(vertex) => Err(format!("vertex {vertex} is past the last one, {count}")),
        None if vertices.is_empty() => Err("its list of vertices is empty".into()),
        None => Ok(vertices
            .iter()
            .map(|&v| (v, 1.0 / vertices.len() as f32))
            .collect()),
    }
}

/// Some vertices round a bone's head, with the share that each has in a plain average.
type Ring = Vec<(u32, f64)>;

/// Where to look for a ring, the best place first: low-poly meshes may have no vertex where weights change, or only a
/// flat ring that the head is not in.
const RINGS: [fn(usize, &Rig) -> Ring; 3] = [seam, slab, nearest];

/// Weights whose mean follows the mean head of `bones`.
fn fit(bones: &[usize], rig: &Rig) -> Result<Vec<(u32, f32)>, String> {
    let mut any = false;
    for first in 0..RINGS.len() {
        let Some(start) = plain_average(bones, rig, &RINGS[first..]) else {
            continue;
        };
        any = true;
        let (ring, plain): (Vec<u32>, Vec<f64>) = start.into_iter().unzip();
        if let Some(weights) = solve(&ring, &plain, bones, rig) {
            let weights = weights.into_iter().map(|weight| weight as f32);
            return Ok(ring.into_iter().zip(weights).collect());
        }
    }
    if any {
        return Err("the vertices round it lie in one plane with it".to_owned());
    }
    let names: Vec<&str> = bones
        .iter()
        .map(|&bone| rig.skeleton.bones[bone].name.as_str())
        .collect();
    Err(format!(
        "fewer than {LEAST_RING} vertices surround the head of bone `{}`",
        names.join("` or `")
    ))
}

/// The plain average over one ring for each bone, the first kind that is large enough.
fn plain_average(
    bones: &[usize],
    rig: &Rig,
    rings: &[fn(usize, &Rig) -> Ring],
) -> Option<BTreeMap<u32, f64>> {
    let mut shares = BTreeMap::new();
    for &bone in bones {
        let mut found = rings.iter().map(|ring| ring(bone, rig));
        let ring = found.find(|ring| ring.len() >= LEAST_RING)?;
        let total: f64 = ring.iter().map(|&(_, share)| share).sum();
        for (vertex, share) in ring {
            *shares.entry(vertex).or_insert(0.0) += share / total / bones.len() as f64;
        }
    }
    Some(shares)
}

/// The vertices round a bone's head that follow what is above it as well as what is below.
fn seam(bone: usize, rig: &Rig) -> Ring {
    let below = rig.influences.iter().map(|list| -> f32 {
        let hangs = |b: u16| rig.skeleton.is_below(usize::from(b), bone);
        list.iter()
            .filter(|(b, _)| hangs(*b))
            .map(|&(_, w)| w)
            .sum()
    });
    (0u32..)
        .zip(below)
        .map(|(vertex, share)| (vertex, share.min(1.0 - share)))
        .filter(|&(_, share)| share > RING_SHARE)
        .map(|(vertex, share)| (vertex, f64::from(share)))
        .collect()
}

/// The vertices nearest to a bone's head, of those that follow it or the bone above.
fn nearest(bone: usize, rig: &Rig) -> Ring {
    let Bone { head, parent, .. } = rig.skeleton.bones[bone];
    let follows = |list: &[(u16, f32)]| {
        let near = |b: u16| usize::from(b) == bone || Some(usize::from(b)) == parent;
        list.iter().any(|&(b, weight)| near(b) && weight > 0.3)
    };
    let mut near: Vec<(f32, u32)> = (0u32..)
        .zip(&rig.influences)
        .filter(|(_, list)| follows(list))
        .map(|(vertex, _)| (rig.mesh.positions[vertex as usize].distance(head), vertex))
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.truncate(NEAREST);
    near.into_iter().map(|(_, vertex)| (vertex, 1.0)).collect()
}

/// A slice of the vertices that mostly follow `bone`, across its head.
fn slab(bone: usize, rig: &Rig) -> Ring {
    let bones = &rig.skeleton.bones;
    let head = bones[bone].head;
    let child = bones
        .iter()
        .filter(|b| b.parent == Some(bone))
        .map(|b| b.head - head);
    let along = child.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    let along = along.unwrap_or(Vec3::Y * 0.1);
    let (axis, half) = (along.normalize_or(Vec3::Y), SLAB * along.length());
    (0u32..)
        .zip(&rig.influences)
        .filter(|(vertex, list)| {
            let offset = rig.mesh.positions[*vertex as usize] - head;
            list.iter().any(|&(b, w)| usize::from(b) == bone && w > 0.3)
                && axis.dot(offset).abs() < half
        })
        .map(|(vertex, _)| (vertex, 1.0))
        .collect()
}

/// Solves for the weights: least squares over bent poses, with a ridge toward `plain`, subject to
/// sum 1 and the exact place at rest (Lagrange multipliers).
fn solve(ring: &[u32], plain: &[f64], bones: &[usize], rig: &Rig) -> Option<Vec<f64>> {
    let size = ring.len();
    let (low, high) = rig.mesh.bounds();
    let relative = f64::from(relative_size((high - low).max_element()));
    let ridge_m2 = RIDGE_M2 * relative * relative;
    let mut matrix = DMatrix::<f64>::zeros(size + 4, size + 4);
    let mut right = DVector::<f64>::zeros(size + 4);
    for (row, share) in plain.iter().enumerate() {
        matrix[(row, row)] = ridge_m2;
        right[row] = ridge_m2 * share;
    }
    let bent = bent_offsets(ring, bones, rig);
    let per_pose = 1.0 / bent.len().max(1) as f64;
    for offsets in &bent {
        for row in 0..size {
            for column in 0..size {
                matrix[(row, column)] += per_pose * offsets[row].dot(offsets[column]);
            }
        }
    }
    let rest = offsets_to_target(&rig.mesh.positions, ring, mean_head(bones, rig, None));
    for (row, offset) in rest.iter().enumerate() {
        let constraints = [1.0, offset.x, offset.y, offset.z];
        for (extra, value) in constraints.into_iter().enumerate() {
            matrix[(row, size + extra)] = value;
            matrix[(size + extra, row)] = value;
        }
    }
    right[size] = 1.0;
    let solution = matrix.lu().solve(&right)?;
    let weights: Vec<f64> = solution.iter().take(size).copied().collect();
    weights
        .iter()
        .all(|weight| weight.is_finite())
        .then_some(weights)
}

/// For every bent pose, the offsets from the target to the ring's vertices, metres.
fn bent_offsets(ring: &[u32], bones: &[usize], rig: &Rig) -> Vec<Vec<DVec3>> {
    let skeleton = &rig.skeleton;
    let mut bent = Vec::new();
    let mut posed = Vec::new();
    let hangs_on_them = |bone: usize| {
        bones.contains(&bone)
            || skeleton.bones[bone]
                .parent
                .is_some_and(|parent| bones.contains(&parent))
    };
    for bone in (0..skeleton.bones.len()).filter(|&bone| hangs_on_them(bone)) {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for degrees in BENDS_DEG {
                let mut pose = Pose::rest(skeleton.bones.len());
                pose.rotations[bone] = Quat::from_axis_angle(axis, degrees.to_radians());
                rig.skin(&pose, &mut posed);
                bent.push(offsets_to_target(
                    &posed,
                    ring,
                    mean_head(bones, rig, Some(&pose)),
                ));
            }
        }
    }
    bent
}

fn mean_head(bones: &[usize], rig: &Rig, pose: Option<&Pose>) -> DVec3 {
    let posed = pose.map(|pose| rig.bone_transforms(pose));
    let head = |bone: usize| match &posed {
        Some(transforms) => transforms[bone].1,
        None => rig.skeleton.bones[bone].head,
    };
    bones
        .iter()
        .map(|&bone| head(bone).as_dvec3())
        .sum::<DVec3>()
        / bones.len() as f64
}

fn offsets_to_target(points: &[Vec3], ring: &[u32], target: DVec3) -> Vec<DVec3> {
    ring.iter()
        .map(|&vertex| points[vertex as usize].as_dvec3() - target)
        .collect()
}
