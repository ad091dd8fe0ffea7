//! Sample bodies: trees of bones with names of one's own, at the places of a man's or a horse's joints.

use glam::{Quat, Vec3};

use super::{Flesh, flesh};
use crate::rig::{Bone, Skeleton};

/// A skeleton, what follows its bones, and which place each bone is at.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    pub(super) skeleton: Skeleton,
    pub(super) flesh: Vec<Flesh>,
    pub(super) keys: Vec<String>,
}

/// Places of the left half and the middle of a man with his arms out, who faces +Z; metres.
const MAN: &[(&str, [f32; 3])] = &[
    ("root", [0.0, 0.0, 0.0]),
    ("pelvis", [0.0, 0.98, 0.0]),
    ("pelvis_l", [0.05, 0.97, 0.0]),
    ("spine1", [0.0, 1.06, -0.02]),
    ("spine2", [0.0, 1.15, -0.02]),
    ("spine3", [0.0, 1.27, -0.03]),
    ("neck", [0.0, 1.52, 0.0]),
    ("neck2", [0.0, 1.57, 0.01]),
    ("head", [0.0, 1.63, 0.03]),
    ("crown", [0.0, 1.8, 0.03]),
    ("jaw", [0.0, 1.62, 0.06]),
    ("eye_l", [0.03, 1.7, 0.1]),
    ("clavicle_l", [0.03, 1.46, 0.02]),
    ("shoulder_l", [0.1, 1.45, 0.0]),
    ("upperarm_l", [0.2, 1.43, 0.0]),
    ("upperarm2_l", [0.33, 1.43, -0.01]),
    ("forearm_l", [0.47, 1.43, -0.02]),
    ("forearm2_l", [0.6, 1.43, -0.01]),
    ("hand_l", [0.72, 1.43, 0.0]),
    ("thumb1_l", [0.74, 1.42, 0.04]),
    ("thumb2_l", [0.77, 1.42, 0.06]),
    ("index1_l", [0.81, 1.43, 0.03]),
    ("index2_l", [0.84, 1.43, 0.03]),
    ("middle0_l", [0.75, 1.43, 0.0]),
    ("middle1_l", [0.815, 1.43, 0.0]),
    ("middle2_l", [0.86, 1.43, 0.0]),
    ("pinky1_l", [0.8, 1.43, -0.03]),
    ("pinky2_l", [0.82, 1.43, -0.03]),
    ("thigh_l", [0.1, 0.95, 0.0]),
    ("thigh2_l", [0.105, 0.75, 0.01]),
    ("calf_l", [0.11, 0.52, 0.02]),
    ("calf2_l", [0.115, 0.3, 0.0]),
    ("foot_l", [0.12, 0.08, -0.02]),
    ("toe_l", [0.12, 0.02, 0.12]),
    ("toe2_l", [0.14, 0.02, 0.11]),
    ("toe_end_l", [0.12, 0.02, 0.2]),
    ("ik_l", [0.12, 0.08, -0.02]),
];

/// Places of the left half and the middle of a horse that walks toward +Z; metres.
const HORSE: &[(&str, [f32; 3])] = &[
    ("root", [0.0, 0.0, 0.0]),
    ("hips", [0.0, 1.35, -0.6]),
    ("spine1", [0.0, 1.23, -0.3]),
    ("spine2", [0.0, 1.18, 0.04]),
    ("chest", [0.0, 1.18, 0.44]),
    ("neck1", [0.0, 1.24, 0.64]),
    ("neck2", [0.0, 1.4, 0.75]),
    ("head", [0.0, 1.8, 1.08]),
    ("jaw", [0.0, 1.7, 1.15]),
    ("ear_l", [0.08, 1.85, 1.08]),
    ("ear2_l", [0.1, 1.95, 1.1]),
    ("scapula_l", [0.1, 1.39, 0.41]),
    ("humerus_l", [0.17, 1.1, 0.66]),
    ("forearm_l", [0.18, 1.0, 0.56]),
    ("carpus_l", [0.18, 0.51, 0.6]),
    ("fpastern_l", [0.18, 0.17, 0.56]),
    ("fhoof_l", [0.18, 0.06, 0.6]),
    ("thigh_l", [0.18, 1.28, -0.53]),
    ("stifle_l", [0.18, 0.95, -0.41]),
    ("hock_l", [0.18, 0.57, -0.79]),
    ("bpastern_l", [0.18, 0.17, -0.78]),
    ("bhoof_l", [0.18, 0.06, -0.74]),
    ("tail1", [0.0, 1.35, -0.65]),
    ("tail2", [0.0, 1.3, -0.83]),
    ("tail3", [0.0, 0.9, -0.89]),
    ("tail4", [0.0, 0.55, -0.92]),
    ("pole_l", [0.18, 0.57, -3.0]),
];

/// Bones at these places carry nothing.
const BARE: [&str; 5] = ["root", "crown", "toe_end_l", "ik_l", "pole_l"];

impl Sample {
    /// A man from lines `name | place`, indented under their parents. Lines whose place ends in `_l` come a second time,
    /// for the right, with every `from` of the name as `to`. Bones marked `bare` carry no surface.
    pub(super) fn man(lines: &str, right: (&str, &str)) -> Self {
        Self::new(lines, right, MAN)
    }

    /// A horse, likewise.
    pub(super) fn horse(lines: &str, right: (&str, &str)) -> Self {
        Self::new(lines, right, HORSE)
    }

    fn new(lines: &str, (from, to): (&str, &str), places: &[(&str, [f32; 3])]) -> Self {
        let lines: Vec<(usize, &str, &str, bool)> = lines
            .lines()
            .filter(|line| !line.trim().is_empty())
            .map(|line| {
                let (name, key) = line.split_once('|').unwrap();
                let depth = name.len() - name.trim_start().len();
                let bare = key.ends_with(" bare");
                (
                    depth,
                    name.trim(),
                    key.trim_end_matches(" bare").trim(),
                    bare,
                )
            })
            .collect();
        let mut bones: Vec<Bone> = Vec::new();
        let mut flesh_of = Vec::new();
        let mut keys: Vec<String> = Vec::new();
        for mirrored in [false, true] {
            // The bones that those to come may hang on, with their depths.
            let mut above: Vec<(usize, usize)> = Vec::new();
            for (line, &(depth, name, key, bare)) in lines.iter().enumerate() {
                above.retain(|&(other, _)| other < depth);
                let sided = key.ends_with("_l");
                // The first time round every line is a bone.
                let at = if mirrored && !sided {
                    line
                } else {
                    let place = places.iter().find(|(other, _)| *other == key);
                    let (_, [x, y, z]) = place.unwrap_or_else(|| panic!("no place {key}"));
                    let head = Vec3::new(if mirrored { -x } else { *x }, *y, *z);
                    let weight = match key {
                        _ if bare || BARE.contains(&key) => 0.0,
                        "head" => 9.0,
                        _ => 1.0,
                    };
                    bones.push(Bone {
                        name: if mirrored {
                            name.replace(from, to)
                        } else {
                            name.to_owned()
                        },
                        parent: above.last().map(|&(_, bone)| bone),
                        head,
                        rest_rotation: Quat::IDENTITY,
                    });
                    flesh_of.push(flesh(weight, head, head.y));
                    keys.push(if mirrored {
                        format!("{}_r", &key[..key.len() - 2])
                    } else {
                        key.to_owned()
                    });
                    bones.len() - 1
                };
                above.push((depth, at));
            }
        }
        Self {
            skeleton: Skeleton { bones },
            flesh: flesh_of,
            keys,
        }
    }

    /// The same with its bones in another order, parents still before children; smaller numbers come first.
    pub(super) fn reordered(&self, numbers: &[u32]) -> Self {
        let bones = &self.skeleton.bones;
        let mut order: Vec<usize> = Vec::new();
        while order.len() < bones.len() {
            let ready = (0..bones.len()).filter(|bone| {
                !order.contains(bone) && bones[*bone].parent.is_none_or(|p| order.contains(&p))
            });
            order.extend(ready.min_by_key(|bone| (numbers[*bone % numbers.len()], *bone)));
        }
        let place = |bone: usize| order.iter().position(|&other| other == bone).unwrap();
        Self {
            skeleton: Skeleton {
                bones: order
                    .iter()
                    .map(|&bone| Bone {
                        parent: bones[bone].parent.map(place),
                        ..bones[bone].clone()
                    })
                    .collect(),
            },
            flesh: order.iter().map(|&bone| self.flesh[bone]).collect(),
            keys: order.iter().map(|&bone| self.keys[bone].clone()).collect(),
        }
    }

    /// The same with numbers instead of names.
    pub(super) fn nameless(mut self) -> Self {
        for (number, bone) in self.skeleton.bones.iter_mut().enumerate() {
            bone.name = format!("bone_{number:03}");
        }
        self
    }

    /// The same turned about the vertical axis.
    pub(super) fn turned(mut self, degrees: f32) -> Self {
        let turn = Quat::from_rotation_y(degrees.to_radians());
        for (bone, flesh) in self.skeleton.bones.iter_mut().zip(&mut self.flesh) {
            bone.head = turn * bone.head;
            flesh.middle = turn * flesh.middle;
        }
        self
    }

    /// Hangs one more bone somewhere.
    pub(super) fn add(&mut self, name: &str, parent: Option<&str>, head: Vec3, weight: f32) {
        let parent = parent.map(|key| self.at(key));
        self.skeleton.bones.push(Bone {
            name: name.to_owned(),
            parent,
            head,
            rest_rotation: Quat::IDENTITY,
        });
        self.flesh.push(flesh(weight, head, head.y));
        self.keys.push(name.to_owned());
    }

    /// The bone at a place.
    pub(super) fn at(&self, key: &str) -> usize {
        let found = self.keys.iter().position(|other| other == key);
        found.unwrap_or_else(|| panic!("no bone at {key}"))
    }

    /// Where it is.
    pub(super) fn head(&self, key: &str) -> Vec3 {
        self.skeleton.bones[self.at(key)].head
    }
}
