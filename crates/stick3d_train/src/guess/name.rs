//! What the name of a bone says: its words, its side, whether it is a helper.

use stick3d_figure::Side;

use super::words::{
    BACK_WORDS, COPY_WORDS, CORNERS, DEFORM_WORDS, FRONT_WORDS, HABITS, HELPERS, LEFT_WORDS,
    RIGHT_WORDS, TRIMMINGS,
};

/// A word that at least this share of all names begin with is the name of the rig, not of a bone.
const SHARED: f32 = 0.8;

/// Which end of a body that walks on four legs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Front,
    Back,
}

/// A bone's name, read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct BoneName {
    /// The words that are left, joined, without numbers: `forearm` of `mixamorig:LeftForeArm`.
    pub(super) stem: String,
    /// The same with numbers, joined by points: `finger3.1` of `finger3-1.L`.
    pub(super) numbered: String,
    /// Left or right if the name says so.
    pub(super) side: Option<Side>,
    /// Front or back leg if the name says so.
    pub(super) end: Option<End>,
    /// Twists, targets, ends of chains: no joint of a body.
    pub(super) helper: bool,
    /// Ears, hair, cloth: moves with a body, and is no limb of it.
    pub(super) trimming: bool,
    /// Programs that keep a skeleton several times mark which one the skin follows: smaller is better.
    pub(super) rank: u8,
}

impl BoneName {
    /// Reads all names of a skeleton: words that all of them begin with say nothing.
    pub(super) fn read_all<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<Self> {
        let mut parts: Vec<Vec<String>> = names.into_iter().map(split).collect();
        while let Some(word) = shared_start(&parts) {
            for words in &mut parts {
                if words.len() > 1 && words[0] == word {
                    words.remove(0);
                }
            }
        }
        parts.iter().map(|words| Self::from_words(words)).collect()
    }

    fn from_words(parts: &[String]) -> Self {
        let mut name = Self {
            stem: String::new(),
            numbered: String::new(),
            side: None,
            end: None,
            helper: false,
            trimming: false,
            rank: 1,
        };
        let mut numbers_count = true;
        for (at, part) in parts.iter().enumerate() {
            if part.starts_with(|c: char| c.is_ascii_digit()) {
                if numbers_count {
                    name.add_number(part);
                }
                continue;
            }
            // The number of a rig (`Bip01`) is none of the bone.
            numbers_count = name.take_word(part, parts, at);
        }
        name
    }

    fn add_number(&mut self, digits: &str) {
        if self.numbered.ends_with(|c: char| c.is_ascii_digit()) {
            self.numbered.push('.');
        }
        let short = digits.trim_start_matches('0');
        self.numbered
            .push_str(if short.is_empty() { "0" } else { short });
    }

    /// Reads one word; whether a number after it belongs to the bone.
    fn take_word(&mut self, word: &str, parts: &[String], at: usize) -> bool {
        let is = |list: &[&str]| list.contains(&word);
        if let Some((_, end, side)) = CORNERS.iter().find(|(corner, _, _)| *corner == word) {
            (self.side, self.end) = (Some(*side), Some(*end));
            return true;
        }
        if is(LEFT_WORDS) || is(RIGHT_WORDS) {
            self.side = Some(if is(LEFT_WORDS) {
                Side::Left
            } else {
                Side::Right
            });
            return true;
        }
        if is(DEFORM_WORDS) || is(COPY_WORDS) {
            self.rank = if is(DEFORM_WORDS) { 0 } else { 2 };
            return false;
        }
        if is(HABITS) || word.chars().count() == 1 {
            return false;
        }
        if is(HELPERS) {
            self.helper = true;
            return true;
        }
        self.trimming |= is(TRIMMINGS);
        // `back` alone is the spine, `forearm` is no arm at the front.
        let others = parts.len() > 1 && parts.iter().any(|p| p != word && is_bone_word(p));
        let before_arm = parts.get(at + 1).is_some_and(|next| next == "arm");
        if others && !before_arm && (is(FRONT_WORDS) || is(BACK_WORDS)) {
            self.end = Some(if is(FRONT_WORDS) {
                End::Front
            } else {
                End::Back
            });
            return true;
        }
        self.stem.push_str(word);
        self.numbered.push_str(word);
        true
    }
}

/// Whether a part of a name may name a bone: it is neither a number, a side nor a habit.
fn is_bone_word(part: &str) -> bool {
    let says_else = [
        LEFT_WORDS,
        RIGHT_WORDS,
        DEFORM_WORDS,
        COPY_WORDS,
        HABITS,
        FRONT_WORDS,
        BACK_WORDS,
    ];
    part.chars().count() > 1
        && !part.starts_with(|c: char| c.is_ascii_digit())
        && !says_else.iter().any(|list| list.contains(&part))
}

/// The word that nearly all names begin with, if there are enough of them to tell.
fn shared_start(parts: &[Vec<String>]) -> Option<String> {
    const ENOUGH: usize = 6;
    let longer = || parts.iter().filter(|words| words.len() > 1);
    let first = longer().next()?.first()?;
    // The first name may be the odd one out.
    let second = longer().nth(1)?.first()?;
    [first, second].into_iter().find_map(|word| {
        let count = longer().filter(|words| &words[0] == word).count();
        let nearly_all = count as f32 >= SHARED * parts.len() as f32 && count >= ENOUGH;
        nearly_all.then(|| word.clone())
    })
}

/// Words and numbers in lower case: at signs, at changes of case, between letters and digits.
fn split(name: &str) -> Vec<String> {
    let own = name.rsplit([':', '|']).next().unwrap_or(name);
    let letters: Vec<char> = own.chars().collect();
    let mut parts: Vec<String> = Vec::new();
    let mut word = String::new();
    for (at, &letter) in letters.iter().enumerate() {
        let before = at.checked_sub(1).map(|at| letters[at]);
        let after = letters.get(at + 1);
        let starts = before.is_some_and(|before| {
            let up = letter.is_uppercase() && before.is_lowercase();
            // The last capital of several begins the next word: `IKFront`.
            let ends_capitals = letter.is_uppercase()
                && before.is_uppercase()
                && after.is_some_and(|after| after.is_lowercase());
            up || ends_capitals || letter.is_ascii_digit() != before.is_ascii_digit()
        });
        if starts || !letter.is_alphanumeric() {
            parts.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
        }
        if letter.is_alphanumeric() {
            word.extend(letter.to_lowercase());
        }
    }
    parts.extend((!word.is_empty()).then_some(word));
    parts.into_iter().flat_map(side_apart).collect()
}

/// A side that is written together with a bone in small letters, apart: `leftforearm`.
fn side_apart(word: String) -> Vec<String> {
    for side in ["left", "right"] {
        let rest = word.strip_prefix(side).or_else(|| word.strip_suffix(side));
        if let Some(rest) = rest.filter(|rest| !rest.is_empty()) {
            return vec![side.to_owned(), rest.to_owned()];
        }
    }
    vec![word]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str) -> BoneName {
        BoneName::read_all([name]).remove(0)
    }

    #[test]
    fn the_habits_of_programs_are_known() {
        let (left, right) = (Some(Side::Left), Some(Side::Right));
        for (name, stem, side) in [
            ("mixamorig:LeftForeArm", "forearm", left),
            ("mixamorig_RightUpLeg", "upleg", right),
            ("DEF-forearm.L", "forearm", left),
            ("DEF-upper_arm.R.001", "upperarm", right),
            ("ORG-f_middle.01.L", "middle", left),
            ("upperarm01.L", "upperarm", left),
            ("lowerarm_l", "lowerarm", left),
            ("J_Bip_L_LowerArm", "lowerarm", left),
            ("J_Bip_C_UpperChest", "upperchest", None),
            ("leftUpperArm", "upperarm", left),
            ("Bip01 L Forearm", "forearm", left),
            ("CC_Base_R_Calf", "calf", right),
            ("ValveBiped.Bip01_R_Hand", "hand", right),
            ("lForearmBend", "forearm", left),
            ("rightforearm", "forearm", right),
            ("Armature|Hips", "hips", None),
            ("Shoulder.R", "shoulder", right),
            ("RArm", "arm", right),
            ("thigh_stretch.l", "thigh", left),
            ("Head", "head", None),
        ] {
            let read = read(name);
            assert_eq!((read.stem.as_str(), read.side), (stem, side), "{name}");
        }
    }

    #[test]
    fn numbers_stay_apart_from_words() {
        assert_eq!(read("finger3-1.L").numbered, "finger3.1");
        assert_eq!(read("Bip01 L Finger2").numbered, "finger2");
        assert_eq!(read("spine.006").numbered, "spine6");
        assert_eq!(read("LeftHandMiddle1").numbered, "handmiddle1");
    }

    #[test]
    fn legs_of_the_front_and_of_the_back_are_told_apart() {
        for (name, stem, end) in [
            ("FrontUpperLeg.L", "upperleg", Some(End::Front)),
            ("BackShoulder.R", "shoulder", Some(End::Back)),
            ("leg_FL_1", "leg", Some(End::Front)),
            ("hind_hoof_l", "hoof", Some(End::Back)),
            ("fore_hoof_l", "hoof", Some(End::Front)),
            ("DEF-front_thigh.L", "thigh", Some(End::Front)),
            ("Back", "back", None),
            ("Back1", "back", None),
            ("ForeArm.L", "forearm", None),
        ] {
            let read = read(name);
            assert_eq!((read.stem.as_str(), read.end), (stem, end), "{name}");
        }
    }

    #[test]
    fn helpers_are_marked() {
        for name in [
            "ik_foot_l",
            "PoleTarget.L",
            "upperarm_twist_01_l",
            "HeadTop_End",
            "LeftForeArmRoll",
            "MCH-foot.L",
        ] {
            assert!(read(name).helper, "{name}");
        }
        for name in ["LeftToeBase", "lThighBend", "neck_01", "IKEAShelf"] {
            assert!(!read(name).helper, "{name}");
        }
        assert!(read("Ear1.L").trimming && !read("Forearm.L").trimming);
    }

    #[test]
    fn what_all_names_begin_with_is_the_name_of_the_rig() {
        let names = [
            "Knight",
            "Knight_Hips",
            "Knight_Arm_L",
            "Knight_Arm_R",
            "Knight_Leg_L",
            "Knight_Leg_R",
            "Knight_Head",
        ];
        let read = BoneName::read_all(names);
        let stems: Vec<&str> = read.iter().map(|name| name.stem.as_str()).collect();
        assert_eq!(
            stems,
            ["knight", "hips", "arm", "arm", "leg", "leg", "head"]
        );
    }
}
