//! What the default controls are called: after their bones, with `_l` and `_r` for the two sides.

use std::collections::BTreeMap;

use super::anatomy::Anatomy;
use super::axes::left_and_forward;
use crate::rig::Rig;

/// Endings and words that say the left side in a bone's name, longest first.
const LEFT: [&str; 6] = ["Left", "left", "_l", "_L", ".l", ".L"];

/// Per bone the name before the dot of its controls.
pub(super) fn stems(rig: &Rig, anatomy: &Anatomy) -> BTreeMap<usize, String> {
    let (left, _) = left_and_forward(anatomy.lateral);
    let mut stems: BTreeMap<usize, String> = BTreeMap::new();
    for bone in anatomy.steered() {
        let heads = |bone: usize| rig.skeleton.bones[bone].head.dot(left);
        match anatomy.mirror[bone] {
            Some(other) if other != bone && anatomy.roles[other].is_some() => {
                let is_left = heads(bone) > heads(other);
                let (left, side) = if is_left { (bone, "_l") } else { (other, "_r") };
                let base = unsided(&rig.skeleton.bones[left].name);
                stems.insert(bone, free_name(&stems, &base, side));
            }
            _ => {
                let mut base = plain(&rig.skeleton.bones[bone].name);
                // No control of the other side belongs to it.
                if base.ends_with("_l") || base.ends_with("_r") {
                    base.push('_');
                }
                stems.insert(bone, free_name(&stems, &base, ""));
            }
        }
    }
    stems
}

fn free_name(taken: &BTreeMap<usize, String>, base: &str, side: &str) -> String {
    let is_free = |name: &String| taken.values().all(|other| other != name);
    let numbered = (2_usize..).map(|number| format!("{base}_{number}{side}"));
    std::iter::once(format!("{base}{side}"))
        .chain(numbered)
        .find(is_free)
        .unwrap_or_default()
}

/// A bone's name without what says its side.
fn unsided(name: &str) -> String {
    let found = LEFT.iter().find_map(|mark| {
        let at = name.find(mark)?;
        let word = mark.len() > 2 || at + mark.len() == name.len();
        word.then(|| format!("{}{}", &name[..at], &name[at + mark.len()..]))
    });
    plain(&found.unwrap_or_else(|| name.to_owned()))
}

/// A name of letters, digits and underscores.
pub(super) fn plain(name: &str) -> String {
    let kept = |c: char| if c.is_alphanumeric() { c } else { '_' };
    let plain: String = name.chars().map(kept).collect();
    let plain = plain.trim_matches('_');
    if plain.is_empty() {
        "bone".to_owned()
    } else {
        plain.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_taken_out_of_names_as_tools_write_them() {
        for (name, base) in [
            ("BackLeg.L", "BackLeg"),
            ("mixamorig:LeftUpLeg", "mixamorig_UpLeg"),
            ("upperarm_l", "upperarm"),
            ("J_Bip_L_UpperArm", "J_Bip_L_UpperArm"),
            ("..", "bone"),
        ] {
            assert_eq!(unsided(name), base);
        }
    }
}
