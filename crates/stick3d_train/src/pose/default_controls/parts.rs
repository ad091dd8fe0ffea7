//! The rigid pieces of a rig for contacts: one for each moving bone that enough vertices follow.

use std::collections::BTreeMap;

use super::anatomy::Anatomy;
use crate::pose::body::{LEAST_VERTICES, followers};
use crate::pose::controls::Controls;
use crate::pose::spec::PartSpec;
use crate::rig::{Pose, Rig};

/// A pair of parts that meets in more than this share of the clips' poses may meet.
const MEETS_SHARE: f32 = 0.02;

/// The parts. A bone that too few vertices follow, or that does not move by itself, belongs to the part of the bone
/// that carries it.
pub(super) fn parts(
    rig: &Rig,
    anatomy: &Anatomy,
    stems: &BTreeMap<usize, String>,
) -> Vec<PartSpec> {
    let bones = &rig.skeleton.bones;
    let mut members: Vec<Vec<usize>> = (0..bones.len()).map(|bone| vec![bone]).collect();
    let mut parts = Vec::new();
    for bone in (0..bones.len()).rev().filter(|&b| anatomy.carried[b] > 0.0) {
        let own = std::mem::take(&mut members[bone]);
        match stems.get(&bone) {
            Some(stem) if followers(rig, &own).len() >= LEAST_VERTICES => parts.push(PartSpec {
                name: stem.clone(),
                bone: bones[bone].name.clone(),
                with: own[1..].iter().map(|&b| bones[b].name.clone()).collect(),
                slim: 1.0,
            }),
            _ => {
                if let Some(parent) = bones[bone].parent {
                    members[parent].extend(own);
                }
            }
        }
    }
    parts.reverse();
    parts
}

/// The pairs of parts, by name, that run into each other at rest or as the clips move the body: flesh on flesh.
pub(super) fn meeting(controls: &Controls, bone_count: usize) -> Vec<(String, String)> {
    let body = controls.body();
    let allowed_m = body.allowed_overlap_m();
    let poses = || controls.clips().iter().flat_map(|clip| &clip.poses);
    let often = (MEETS_SHARE * poses().count() as f32).ceil() as usize;
    let mut met: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for overlap in body.overlaps(&controls.transforms(&Pose::rest(bone_count)), allowed_m) {
        met.insert((overlap.first, overlap.second), often.max(1));
    }
    for pose in poses() {
        for overlap in body.overlaps(&controls.transforms(pose), allowed_m) {
            *met.entry((overlap.first, overlap.second)).or_default() += 1;
        }
    }
    let name = |part: usize| body.parts()[part].name.clone();
    met.into_iter()
        .filter(|&(_, count)| count >= often.max(1))
        .map(|((first, second), _)| (name(first), name(second)))
        .collect()
}
