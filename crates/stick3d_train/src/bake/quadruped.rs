//! The horse's skeleton, made from the source's: names by anatomy, feet that hang on the legs, and
//! shoulder blades that glide under the withers.
//!
//! The source steers its feet by inverse kinematics from outside the legs, moves no shoulder, and has
//! four bones in an ear. What is not listed here has no vertex of its own.

use std::collections::BTreeMap;

use glam::{DVec3, Quat};

use super::makehuman::Influences;
use super::paint::smoothstep;
use crate::rig::{Bone, Clip, Pose, Rig, Skeleton};

/// A bone: its name, the bone that carries it, and the source's bones whose vertices follow it. `@` is
/// either side; the head is that of the first source bone.
struct Entry(&'static str, &'static str, &'static [&'static str]);

const BONES: [Entry; 26] = [
    Entry("pelvis", "", &["Back"]),
    Entry("spine_01", "pelvis", &["Torso"]),
    Entry("spine_02", "spine_01", &["Torso2"]),
    Entry("spine_03", "spine_02", &["Torso3"]),
    Entry("neck_01", "spine_03", &["Neck1"]),
    Entry("neck_02", "neck_01", &["Neck2"]),
    Entry("neck_03", "neck_02", &["Neck3"]),
    Entry("head", "neck_03", &["Head"]),
    Entry("ear_@", "head", &["Ear1.@", "Ear2.@", "Ear3.@", "Ear4.@"]),
    Entry("tail_01", "pelvis", &["Tail1"]),
    Entry("tail_02", "tail_01", &["Tail2"]),
    Entry("tail_03", "tail_02", &["Tail3"]),
    Entry("tail_04", "tail_03", &["Tail4"]),
    Entry("tail_05", "tail_04", &["Tail5"]),
    Entry("tail_06", "tail_05", &["Tail6"]),
    Entry("tail_07", "tail_06", &["Tail7"]),
    Entry("scapula_@", "spine_02", &["FrontShoulder.@"]),
    Entry("forearm_@", "scapula_@", &["FrontUpperLeg.@"]),
    Entry("metacarpus_@", "forearm_@", &["FrontLowerLeg.@"]),
    Entry("fore_pastern_@", "metacarpus_@", &["IKFrontLeg.@"]),
    Entry("fore_hoof_@", "fore_pastern_@", &["FF.@"]),
    // The source turns the hip by a second bone at the same place.
    Entry("thigh_@", "pelvis", &["BackLeg.@", "BackShoulder.@"]),
    Entry("gaskin_@", "thigh_@", &["BackUpperLeg.@"]),
    Entry("metatarsus_@", "gaskin_@", &["BackLowerLeg.@"]),
    Entry("hind_pastern_@", "metatarsus_@", &["IKBackLeg.@"]),
    Entry("hind_hoof_@", "hind_pastern_@", &["FFB.@"]),
];

/// The upper end of the left shoulder blade, and its lower end where the forearm hangs on it.
const BLADE: [DVec3; 2] = [DVec3::new(0.41, 1.39, -0.10), DVec3::new(0.60, 1.03, -0.20)];
/// How far from its middle line the blade moves the skin, metres, and how much of it.
const BLADE_REACH_M: f64 = 0.26;
const BLADE_SHARE: f64 = 0.8;

/// The new skeleton and how it hangs together with the source's.
pub(super) struct Rebuilt {
    pub(super) skeleton: Skeleton,
    /// For each bone of the source that has any, the new one that its vertices follow.
    pub(super) followed: BTreeMap<usize, u16>,
    /// For each new bone the one of the source that it turns with.
    leaders: Vec<usize>,
}

impl Rebuilt {
    /// The source's clips on the new skeleton: every bone turns as its leader does, and hangs on its own
    /// parent. `turn` brings the source's axes to the new ones.
    pub(super) fn clips(&self, source: &Rig, turn: Quat) -> Vec<Clip> {
        let moment = |pose: &Pose| {
            let transforms = source.skeleton.bone_transforms(pose);
            let whole = |bone: usize| turn * transforms[self.leaders[bone]].0 * turn.inverse();
            let own = |bone: usize| match self.skeleton.bones[bone].parent {
                Some(parent) => (whole(parent).inverse() * whole(bone)).normalize(),
                None => whole(bone),
            };
            let root = self.leaders[0];
            Pose {
                rotations: (0..self.leaders.len()).map(own).collect(),
                root_translation: turn * (transforms[root].1 - source.skeleton.bones[root].head),
            }
        };
        let clips = source.clips.iter();
        clips
            .map(|clip| Clip {
                name: clip.name.clone(),
                times_s: clip.times_s.clone(),
                poses: clip.poses.iter().map(moment).collect(),
            })
            .collect()
    }
}

/// The new skeleton after the source's; `place` brings a point of it to the new axes.
pub(super) fn skeleton(
    source: &Skeleton,
    place: impl Fn(DVec3) -> DVec3,
) -> Result<Rebuilt, String> {
    let mut skeleton = Skeleton::default();
    let mut followed = BTreeMap::new();
    let mut leaders = Vec::new();
    for Entry(name, parent, sources) in &BONES {
        let sides: &[(&str, &str)] = if name.contains('@') {
            &[("l", "L"), ("r", "R")]
        } else {
            &[("", "")]
        };
        for &(side, side_there) in sides {
            let own = |name: &str| name.replace('@', side);
            let index = skeleton.bones.len();
            let mut head = None;
            let mut leader = None;
            for source_name in *sources {
                let wanted = source_name.replace('@', side_there);
                let found = source
                    .bone_index(&wanted)
                    .map_err(|error| error.to_string())?;
                followed.insert(found, index as u16);
                leader.get_or_insert(found);
                head.get_or_insert(place(source.bones[found].head.as_dvec3()));
            }
            if name.starts_with("scapula") {
                head = Some(mirrored(BLADE[0], side));
            }
            leaders.push(leader.unwrap_or_default());
            let parent = match *parent {
                "" => None,
                parent => Some(
                    skeleton
                        .bone_index(&own(parent))
                        .map_err(|error| error.to_string())?,
                ),
            };
            skeleton.bones.push(Bone {
                name: own(name),
                parent,
                head: head.unwrap_or_default().as_vec3(),
                rest_rotation: Quat::IDENTITY,
            });
        }
    }
    Ok(Rebuilt {
        skeleton,
        followed,
        leaders,
    })
}

fn mirrored(point: DVec3, side: &str) -> DVec3 {
    if side == "r" {
        DVec3::new(point.x, point.y, -point.z)
    } else {
        point
    }
}

/// Lets the skin over the shoulder blades go along with them: a share of what followed the trunk.
pub(super) fn hang_blades(skeleton: &Skeleton, positions: &[DVec3], influences: &mut Influences) {
    let bone = |name: &str| {
        let found = skeleton.bones.iter().position(|bone| bone.name == name);
        found.unwrap_or_default() as u16
    };
    let trunk = ["spine_01", "spine_02", "spine_03", "neck_01"].map(bone);
    for (point, list) in positions.iter().zip(influences) {
        let side = if point.z > 0.0 { "r" } else { "l" };
        let [top, bottom] = BLADE.map(|end| mirrored(end, side));
        // Seen from the side; the withers between the blades stay with the trunk.
        let flat = DVec3::new(1.0, 1.0, 0.0);
        let (offset, line) = ((*point - top) * flat, (bottom - top) * flat);
        let along = (offset.dot(line) / line.length_squared()).clamp(0.0, 1.0);
        let near = 1.0 - (offset - line * along).length() / BLADE_REACH_M;
        let outside = smoothstep((point.z.abs() - 0.03) / 0.12);
        let share = BLADE_SHARE * smoothstep(1.6 * near) * outside;
        let mut moved = 0.0;
        for (_, weight) in list.iter_mut().filter(|(bone, _)| trunk.contains(bone)) {
            moved += share * *weight;
            *weight *= 1.0 - share;
        }
        let blade = bone(&format!("scapula_{side}"));
        match list.iter_mut().find(|(bone, _)| *bone == blade) {
            Some((_, weight)) => *weight += moved,
            None if moved > 0.0 => list.push((blade, moved)),
            None => {}
        }
        list.sort_by_key(|&(bone, _)| bone);
    }
}
