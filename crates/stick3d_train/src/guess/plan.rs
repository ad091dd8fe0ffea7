//! What the plans of bodies share: how joints are looked for, and what is found.

use glam::Vec3;
use stick3d_figure::{Side, names};

use super::body::Body;
use super::error::JointFault;
use super::limbs::{LimbPair, Limbs};
use super::symmetry::Symmetry;
use super::words::Role;

/// A segment shorter than this share of its limb is no part of a limb but of the joint that begins it.
const SHORT: f32 = 0.15;

/// Where a joint is to be.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Place {
    /// At the mean of the heads of bones.
    Heads(Vec<usize>),
    /// In the middle of the surface that mostly follows bones.
    Middle(Vec<usize>),
    /// At the far end of the surface that mostly follows a bone.
    End(usize),
    /// On the forehead of the head that hangs on a bone.
    Forehead(usize, Face),
}

/// How a face is built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Face {
    /// Flat: the forehead is this far above straight ahead, seen from the middle of the head, radians.
    Flat(f32),
    /// With a muzzle: the forehead is turned this far up from the nose, seen from where the head begins, radians.
    Muzzle(f32),
}

/// A joint of the figure, and where it is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Finding {
    pub(super) joint: String,
    pub(super) place: Result<Place, JointFault>,
    /// Whether names told, and not places.
    pub(super) named: bool,
}

/// What bones a search by names gave.
#[derive(Debug, Clone, Copy)]
pub(super) enum Named {
    None,
    One(usize),
    /// Several that fit equally well, the first two by name.
    Several(usize, usize),
}

/// A body as the plans look at it.
#[derive(Debug, Clone)]
pub(super) struct View<'a> {
    pub(super) body: &'a Body,
    pub(super) symmetry: Symmetry,
    pub(super) limbs: Limbs,
}

impl<'a> View<'a> {
    pub(super) fn new(body: &'a Body, symmetry: Symmetry) -> Self {
        let limbs = Limbs::find(body, &symmetry);
        Self {
            body,
            symmetry,
            limbs,
        }
    }

    /// The same with left and right exchanged.
    pub(super) fn flipped(self) -> Self {
        Self::new(self.body, self.symmetry.flipped())
    }

    pub(super) fn head(&self, bone: usize) -> Vec3 {
        self.body.bones[bone].head
    }

    pub(super) fn weight(&self, bone: usize) -> f32 {
        self.body.bones[bone].flesh.weight
    }

    /// The way ahead that goes with the left side, a unit vector.
    pub(super) fn forward(&self) -> Vec3 {
        self.symmetry.across.cross(Vec3::Y)
    }

    /// The bone of a role by its name.
    pub(super) fn named(&self, role: Role, side: Side) -> Named {
        let mut bones = self.body.named(role, side, &self.symmetry.sides);
        bones.sort_by_cached_key(|&bone| self.body.name(bone));
        match bones[..] {
            [] => Named::None,
            [one] => Named::One(one),
            [first, second, ..] => Named::Several(first, second),
        }
    }

    /// The bone of a role if names leave no doubt.
    pub(super) fn sure(&self, role: Role, side: Side) -> Option<usize> {
        match self.named(role, side) {
            Named::One(bone) => Some(bone),
            Named::None | Named::Several(..) => None,
        }
    }

    /// Bones of the middle that carry surface.
    pub(super) fn middle(&self) -> impl Iterator<Item = usize> + '_ {
        self.body
            .living()
            .filter(|&bone| self.symmetry.sides[bone] == Side::Center && self.weight(bone) > 0.0)
    }

    /// The heaviest of some bones: of a neck and a head it is the head.
    pub(super) fn heaviest(&self, bones: impl Iterator<Item = usize>) -> Option<usize> {
        bones.max_by(|&a, &b| self.weight(a).total_cmp(&self.weight(b)))
    }

    /// A finding where nothing was found; `near` are the bones where it should be.
    pub(super) fn missing(&self, joint: &str, role: Role, why: &str, near: &[usize]) -> Finding {
        let mut nearest: Vec<String> = near.iter().map(|&bone| self.body.name(bone)).collect();
        if nearest.is_empty() {
            let all = self.body.living().map(|b| self.body.bones[b].name.as_str());
            nearest.extend(names::nearest(role.usual_name(), all).map(str::to_owned));
        }
        Finding {
            joint: joint.to_owned(),
            named: false,
            place: Err(JointFault::NotFound {
                joint: joint.to_owned(),
                why: why.to_owned(),
                nearest,
            }),
        }
    }

    /// A finding where two bones fit.
    pub(super) fn doubtful(&self, joint: &str, first: usize, second: usize) -> Finding {
        Finding {
            joint: joint.to_owned(),
            named: true,
            place: Err(JointFault::TwoCandidates {
                joint: joint.to_owned(),
                first: self.body.name(first),
                second: self.body.name(second),
            }),
        }
    }
}

impl Finding {
    /// A joint that was found.
    pub(super) fn at(joint: &str, place: Place, named: bool) -> Self {
        Self {
            joint: joint.to_owned(),
            place: Ok(place),
            named,
        }
    }
}

/// The end of a joint's name that says its side.
pub(super) fn of_side(joint: &str, side: Side) -> String {
    let end = if side == Side::Right { "r" } else { "l" };
    format!("{joint}{end}")
}

impl View<'_> {
    /// Where along a limb its bones begin, from its first bone on, metres.
    pub(super) fn along(&self, chain: &[usize]) -> Vec<f32> {
        let mut along_m = 0.0;
        let mut last = chain.first().map(|&bone| self.head(bone));
        chain
            .iter()
            .map(|&bone| {
                along_m += last.map_or(0.0, |last| self.head(bone).distance(last));
                last = Some(self.head(bone));
                along_m
            })
            .collect()
    }

    /// The bone that begins the first long segment of a limb.
    pub(super) fn limb_begin(&self, chain: &[usize]) -> usize {
        let along = self.along(chain);
        let whole_m = along.last().copied().unwrap_or(0.0);
        let long = |at: &usize| {
            along
                .get(at + 1)
                .is_none_or(|next| next - along[*at] > SHORT * whole_m)
        };
        let first = (0..chain.len()).find(long).unwrap_or(0);
        // Past the middle there is no beginning.
        let begins = along.get(first).is_some_and(|&at| at < whole_m / 2.0);
        chain[if begins { first } else { 0 }]
    }

    /// The beginnings of both limbs of a pair.
    pub(super) fn limb_begins(&self, pair: &LimbPair) -> Vec<usize> {
        pair.chains
            .iter()
            .map(|chain| self.limb_begin(chain))
            .collect()
    }

    /// The bone that divides the way from `top` to `end` most evenly, seen from the side: where a leg bends.
    pub(super) fn bend(&self, top: Vec3, chain: &[usize], end: Vec3) -> Option<usize> {
        let across = self.symmetry.across;
        let away = |a: Vec3, b: Vec3| (a - b).reject_from(across).length();
        let shorter = |bone: usize| {
            let head = self.head(bone);
            away(head, top).min(away(head, end))
        };
        chain
            .iter()
            .copied()
            .max_by(|&a, &b| shorter(a).total_cmp(&shorter(b)))
            .filter(|&bone| shorter(bone) > 0.0)
    }
}
