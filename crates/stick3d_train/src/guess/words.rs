//! The words that bones are named with, as data.
//!
//! Words are compared after [`BoneName`](super::name::BoneName) has joined them in lower case, without side and numbers.

use stick3d_figure::Side;

use super::name::End::{self, Back, Front};

/// A bone that a joint may sit on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Head,
    Neck,
    Pelvis,
    UpperArm,
    Forearm,
    Hand,
    MiddleFinger,
    Thigh,
    Calf,
    Foot,
    Toe,
    Tail,
}

/// What bones of a role are called. Names of an earlier list are sure; those of a later one count if there is none.
type Names = &'static [&'static [&'static str]];

const HEAD: Names = &[&["head", "skull"]];
const NECK: Names = &[&["neck", "necklower", "lowerneck"], &["cervical"]];
const PELVIS: Names = &[&["hips", "pelvis"], &["hip", "lowerbody", "cog"]];
const UPPER_ARM: Names = &[
    &[
        "upperarm", "uparm", "armupper", "armup", "shldr", "humerus", "bicep", "arm",
    ],
    &["shoulder"],
];
const FOREARM: Names = &[
    &[
        "forearm", "lowerarm", "lowarm", "loarm", "armlower", "armlow", "ulna", "radius",
    ],
    &["elbow"],
];
const HAND: Names = &[&["hand"], &["wrist", "fist", "palm"]];
const MIDDLE_FINGER: Names = &[&[
    "middle",
    "middlefinger",
    "fingermiddle",
    "handmiddle",
    "middleproximal",
    "handmid",
    "mid",
    // Autodesk counts fingers from the thumb as 0, MakeHuman as 1.
    "finger2",
    "finger3.1",
]];
const THIGH: Names = &[
    &["thigh", "upperleg", "upleg", "legupper", "legup", "femur"],
    &["hip", "leg"],
];
const CALF: Names = &[
    &[
        "calf", "shin", "lowerleg", "lowleg", "loleg", "leglower", "leglow", "tibia", "crus",
    ],
    &["knee"],
    &["leg"],
];
const FOOT: Names = &[&["foot"], &["ankle", "feet"]];
const TOE: Names = &[&["toe", "toes", "ball"]];
const TAIL: Names = &[&["tail"]];

impl Role {
    /// How sure a name is for the role, 0 the surest; `None` if it is a name of something else.
    pub(super) fn tier(self, stem: &str, numbered: &str) -> Option<usize> {
        self.names()
            .iter()
            .position(|names| names.contains(&stem) || names.contains(&numbered))
    }

    /// Whether there is one on either side of the body.
    pub(super) fn is_paired(self) -> bool {
        !matches!(self, Self::Head | Self::Neck | Self::Pelvis | Self::Tail)
    }

    /// The bone that carries joints of this role is usually called so.
    pub(super) fn usual_name(self) -> &'static str {
        self.names()[0][0]
    }

    fn names(self) -> Names {
        match self {
            Self::Head => HEAD,
            Self::Neck => NECK,
            Self::Pelvis => PELVIS,
            Self::UpperArm => UPPER_ARM,
            Self::Forearm => FOREARM,
            Self::Hand => HAND,
            Self::MiddleFinger => MIDDLE_FINGER,
            Self::Thigh => THIGH,
            Self::Calf => CALF,
            Self::Foot => FOOT,
            Self::Toe => TOE,
            Self::Tail => TAIL,
        }
    }
}

pub(super) const LEFT_WORDS: &[&str] = &["l", "left", "lt", "lft"];
pub(super) const RIGHT_WORDS: &[&str] = &["r", "right", "rt", "rgt"];
pub(super) const FRONT_WORDS: &[&str] = &["front", "fore", "frnt"];
pub(super) const BACK_WORDS: &[&str] = &["back", "hind", "rear"];

/// Both at once, as in `leg_FL`: front and back, or front and rear, or fore and hind; either letter first.
pub(super) const CORNERS: &[(&str, End, Side)] = &[
    ("fl", Front, Side::Left),
    ("lf", Front, Side::Left),
    ("fr", Front, Side::Right),
    ("rf", Front, Side::Right),
    ("bl", Back, Side::Left),
    ("lb", Back, Side::Left),
    ("hl", Back, Side::Left),
    ("lh", Back, Side::Left),
    ("rl", Back, Side::Left),
    ("br", Back, Side::Right),
    ("rb", Back, Side::Right),
    ("hr", Back, Side::Right),
    ("rh", Back, Side::Right),
    ("rr", Back, Side::Right),
];

/// Marks of bones that the skin follows (Rigify), and of copies that it does not.
pub(super) const DEFORM_WORDS: &[&str] = &["def", "deform"];
pub(super) const COPY_WORDS: &[&str] = &["org"];

/// What programs and people put into every name; single letters are left out as well.
pub(super) const HABITS: &[&str] = &[
    "mixamorig",
    "mixamo",
    "armature",
    "skeleton",
    "rig",
    "bip",
    "biped",
    "valve",
    "cc",
    "base",
    "character",
    "bone",
    "bn",
    "jnt",
    "joint",
    "jt",
    "sk",
    "bend",
    "stretch",
    "center",
    "centre",
];

/// Bones that help others and are no joints of a body.
pub(super) const HELPERS: &[&str] = &[
    "twist",
    "twst",
    "roll",
    "ik",
    "fk",
    "pole",
    "target",
    "ctrl",
    "control",
    "con",
    "end",
    "nub",
    "site",
    "mch",
    "vis",
    "tweak",
    "helper",
    "dummy",
    "null",
    "socket",
    "attach",
    "prop",
    "weapon",
    "look",
    "aim",
    "corrective",
    "bulge",
    "muscle",
    "master",
    "goal",
    "effector",
];

/// Things that come in pairs or hang down, and are no limbs.
pub(super) const TRIMMINGS: &[&str] = &[
    "ear", "eye", "eyes", "eyelid", "lid", "brow", "eyebrow", "lip", "lips", "mouth", "cheek",
    "nose", "nostril", "jaw", "chin", "teeth", "tongue", "hair", "beard", "mustache", "whisker",
    "antler", "horn", "mane", "wing", "fin", "skirt", "dress", "coat", "robe", "cape", "cloak",
    "cloth", "breast", "bust", "boob", "belt", "strap", "scarf", "ribbon", "hat", "sec", "adj",
];

/// Legs whose bones are called so are at the front; what is called like a man's leg is at the back.
pub(super) const FRONT_LEG_STEMS: &[&str] = &[
    "scapula",
    "clavicle",
    "shoulder",
    "upperarm",
    "arm",
    "forearm",
    "lowerarm",
    "humerus",
    "radius",
    "ulna",
    "elbow",
    "carpus",
    "metacarpus",
    "wrist",
    "hand",
];
pub(super) const BACK_LEG_STEMS: &[&str] = &[
    "thigh",
    "upleg",
    "femur",
    "hip",
    "stifle",
    "gaskin",
    "shin",
    "calf",
    "tibia",
    "hock",
    "tarsus",
    "metatarsus",
    "knee",
    "ankle",
];
