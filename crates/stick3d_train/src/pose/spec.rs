//! The file of controls: how it is written, and how one side stands for both.

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

/// Ending of a name that stands for both sides: `elbow_@` is `elbow_l` and `elbow_r`.
const BOTH: char = '@';

/// A file of controls (`assets/rigs/*.controls.ron`).
///
/// Everything paired is written once, for the left side, with `@` in place of `l` and `r` (and `#` for
/// the other side). The right side is its mirror image in the plane that [`Lateral`] names: a
/// direction's part across that plane changes sign, a rotation axis' other two do.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlsSpec {
    /// The rig these controls are for.
    pub rig: String,
    /// The axis from side to side.
    #[serde(default)]
    pub lateral: Lateral,
    /// How bones stand in the neutral stance, where every control is 0.
    pub neutral: Vec<NeutralSpec>,
    /// Hinges and other turns about fixed axes.
    pub controls: Vec<ControlSpec>,
    /// Ball joints steered by direction: the shoulders.
    #[serde(default)]
    pub swings: Vec<SwingSpec>,
    /// Names before the dot of the controls that a natural pose may take from another pose of the
    /// library than the rest; what is in none stays together.
    #[serde(default)]
    pub limbs: Vec<Vec<String>>,
    /// How often, from 0 to 1, a limb (or the trunk) of a natural pose is that of one pose of the library instead of a blend of
    /// several: the more often, the more extreme the poses.
    #[serde(default)]
    pub whole_share: f32,
    /// Pieces of the body that touch the ground or each other.
    pub parts: Vec<PartSpec>,
    /// Pairs of parts that may overlap, because flesh gives way there or they are joined.
    pub may_overlap: Vec<(String, String)>,
    /// How deep the other pairs may run into each other, metres: flesh gives way.
    #[serde(default = "usual_overlap_m")]
    pub overlap_m: f32,
}

/// Which axis of model space goes from side to side; the body is symmetric about the plane across it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Lateral {
    /// The body faces +Z; its left is +X.
    #[default]
    X,
    /// The body faces +X; its left is -Z.
    Z,
}

impl Lateral {
    /// The mirror image of a direction.
    pub(crate) fn mirror(self, v: Vec3) -> Vec3 {
        match self {
            Self::X => Vec3::new(-v.x, v.y, v.z),
            Self::Z => Vec3::new(v.x, v.y, -v.z),
        }
    }

    /// The mirror image of a rotation.
    pub(crate) fn mirror_turn(self, q: Quat) -> Quat {
        match self {
            Self::X => Quat::from_xyzw(q.x, -q.y, -q.z, q.w),
            Self::Z => Quat::from_xyzw(-q.x, -q.y, q.z, q.w),
        }
    }

    /// A direction of a body that faces +Z as one of this body.
    pub(crate) fn facing(self, v: Vec3) -> Vec3 {
        match self {
            Self::X => v,
            Self::Z => Vec3::new(v.z, v.y, -v.x),
        }
    }
}

/// How one bone stands in the neutral stance.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NeutralSpec {
    /// The bone.
    pub bone: String,
    /// Where it points.
    pub stance: Stance,
}

/// Where a bone points in the neutral stance.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Stance {
    /// As at rest, whatever its parent does.
    Rest,
    /// The bone's head-to-`toward` line points along `points`, and `side` (a direction known at
    /// rest) turns as near as possible to `becomes`.
    Aim {
        /// The bone whose head the line goes to.
        toward: String,
        /// Direction of the line, model space.
        points: Vec3,
        /// A second direction at rest.
        side: SideOf,
        /// What the second direction becomes, model space.
        becomes: Vec3,
    },
}

/// A direction read off the rig at rest.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum SideOf {
    /// From one bone's head to another's.
    Between(String, String),
    /// The axis about which a chain of three bones bends: from the first line to the second.
    Bend(String, String, String),
    /// A direction of model space.
    Axis(Vec3),
}

/// One named degree of freedom.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlSpec {
    /// Its name, for instance `elbow_@.flexion`.
    pub name: String,
    /// Smallest and largest value, degrees.
    pub limits: (f32, f32),
    /// The value at ease, degrees: what a pose has that does not mention the control.
    #[serde(default)]
    pub ease: f32,
    /// Whether a mirrored body has the opposite value. Only for controls in the middle.
    #[serde(default)]
    pub odd: bool,
    /// How far the sampler strays from the ease, degrees. `None`: a fifth of the range.
    #[serde(default)]
    pub spread: Option<f32>,
    /// What it turns.
    pub drives: Vec<DriveSpec>,
}

/// A bone turned by a control.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveSpec {
    /// The bone.
    pub bone: String,
    /// Axis of positive rotation (right hand), model space in the neutral stance.
    pub axis: Vec3,
    /// Degrees of the bone per degree of the control.
    #[serde(default = "one")]
    pub share: f32,
}

/// How deep parts of bodies as large as people may run into each other, metres.
pub(crate) fn usual_overlap_m() -> f32 {
    0.02
}

fn one() -> f32 {
    1.0
}

/// A ball joint whose limb hangs down in the neutral stance.
///
/// Three controls steer it: `plane` (0 = to the side, 90 = forward, negative = backward), `raise`
/// (0 = hanging, 90 = horizontal, 180 = overhead) and `twist` (positive = inward). As in the ISB's
/// recommendation for the shoulder, but with the twist counted from the shortest swing.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SwingSpec {
    /// Name before the dot: `shoulder_@`.
    pub name: String,
    /// The bone that swings.
    pub bone: String,
    /// The bone before it that gives way: the clavicle.
    pub girdle: String,
    /// Limits of `plane`, `raise` and `twist`, degrees.
    pub limits: [(f32, f32); 3],
    /// `plane`, `raise` and `twist` at ease, degrees.
    pub ease: [f32; 3],
    /// The sampler's spread of the three, degrees.
    pub spread: [f32; 3],
    /// Highest raise for some planes, ascending, degrees: linear in between.
    pub raise_max: Vec<(f32, f32)>,
    /// The raise above which the girdle helps, degrees.
    pub girdle_from: f32,
    /// The girdle's share of what is above, upward.
    pub girdle_up: f32,
    /// How far the girdle comes forward with the limb level in front, degrees.
    pub girdle_forward: f32,
}

/// A piece of the body that counts as rigid for contacts: a capsule fitted to the vertices that mostly
/// follow its bones.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartSpec {
    /// Its name.
    pub name: String,
    /// The bone that carries it.
    pub bone: String,
    /// Further bones whose vertices belong to it.
    #[serde(default)]
    pub with: Vec<String>,
    /// Factor on the fitted radius.
    #[serde(default = "one")]
    pub slim: f32,
}

/// Which side an entry is written out for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Half {
    /// In the middle, or already a definite side.
    Whole,
    /// Left: as written.
    Left,
    /// Right: mirrored.
    Right,
}

impl Half {
    /// The sides that an entry called `name` stands for.
    pub(crate) fn of(name: &str) -> &'static [Half] {
        if name.contains(BOTH) {
            &[Half::Left, Half::Right]
        } else {
            &[Half::Whole]
        }
    }

    /// A name with `@` and `#` replaced by this side's letter and the other's.
    pub(crate) fn name(self, name: &str) -> String {
        match self {
            Half::Whole => name.to_owned(),
            Half::Left => name.replace(BOTH, "l").replace('#', "r"),
            Half::Right => name.replace(BOTH, "r").replace('#', "l"),
        }
    }

    /// A direction on this side.
    pub(crate) fn direction(self, v: Vec3, lateral: Lateral) -> Vec3 {
        if self == Half::Right {
            lateral.mirror(v)
        } else {
            v
        }
    }

    /// A rotation axis on this side.
    pub(crate) fn axis(self, v: Vec3, lateral: Lateral) -> Vec3 {
        if self == Half::Right {
            -lateral.mirror(v)
        } else {
            v
        }
    }
}

/// The name on the other side: `elbow_r.flexion` for `elbow_l.flexion`, unchanged in the middle.
pub(crate) fn mirrored_name(name: &str) -> String {
    let (stem, rest) = name.split_once('.').map_or((name, ""), |(a, b)| (a, b));
    let turned = if let Some(base) = stem.strip_suffix("_l") {
        format!("{base}_r")
    } else if let Some(base) = stem.strip_suffix("_r") {
        format!("{base}_l")
    } else {
        stem.to_owned()
    };
    if rest.is_empty() {
        turned
    } else {
        format!("{turned}.{rest}")
    }
}

/// A piecewise linear function through ascending points, constant outside them.
pub(crate) fn piecewise(points: &[(f32, f32)], x: f32) -> f32 {
    let Some(after) = points.iter().position(|p| p.0 > x) else {
        return points.last().map_or(f32::INFINITY, |p| p.1);
    };
    let Some(before) = after.checked_sub(1) else {
        return points[0].1;
    };
    let (x0, y0) = points[before];
    let (x1, y1) = points[after];
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}
