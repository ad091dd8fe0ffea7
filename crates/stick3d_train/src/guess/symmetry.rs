//! The plane that a body mirrors in: which bones are pairs, which are on which side.

use glam::Vec3;
use stick3d_figure::Side;

use super::body::{Body, BodyBone};

/// Mirrored bones miss each other's image by at most this share of the body's extent.
const MIRRORED: f32 = 0.03;

/// Bones nearer to the plane than this share of the extent are on it, if their names say no side.
const ON_PLANE: f32 = 0.008;

/// A direction nearer to an axis than this is meant as one: the sine of 15 degrees.
const SQUARE: f32 = 0.26;

/// The plane, and what it says of every bone.
#[derive(Debug, Clone)]
pub(super) struct Symmetry {
    /// Unit normal of the plane, horizontal; toward the side of [`Side::Left`] in `sides`.
    pub(super) across: Vec3,
    /// Where the plane is along the normal, metres.
    pub(super) offset_m: f32,
    /// Whether names say which side is left. Otherwise it is one of two at will.
    pub(super) named: bool,
    /// Per bone the side of the plane that it is on.
    pub(super) sides: Vec<Side>,
    /// Per bone its mirror image.
    pub(super) partners: Vec<Option<usize>>,
}

impl Symmetry {
    /// Finds the plane by names that differ in their side only, else by where the bones are; `None` where there are
    /// no two pairs.
    pub(super) fn find(body: &Body) -> Option<Self> {
        let by_name = partners_by_name(body);
        let pairs: Vec<(Vec3, Vec3)> = (0..body.bones.len())
            .filter(|&bone| body.bones[bone].says.side == Some(Side::Left))
            .filter_map(|bone| Some((bone, by_name[bone]?)))
            .filter(|&(left, right)| body.bones[left].lives || body.bones[right].lives)
            .map(|(left, right)| (body.bones[left].head, body.bones[right].head))
            .collect();
        if pairs.len() < 2 {
            return Self::find_by_place(body);
        }
        let across = named_direction(&pairs)?;
        let middles = pairs.iter().map(|(l, r)| across.dot(*l + *r) / 2.0);
        let mut symmetry = Self::with(body, across, median(middles.collect()), true);
        // A name is more certain than a place: a rest pose need not be symmetric.
        for (partner, named) in symmetry.partners.iter_mut().zip(&by_name) {
            *partner = named.or(*partner);
        }
        Some(symmetry)
    }

    fn find_by_place(body: &Body) -> Option<Self> {
        let mut planes = Vec::new();
        for across in [Vec3::Z, Vec3::X] {
            let along = || body.living().map(|bone| across.dot(body.bones[bone].head));
            // As many bones are on one side as on the other, and most bodies stand in the middle of their file.
            let offsets = [0.0, median(along().collect())];
            planes.extend(offsets.map(|offset_m| Self::with(body, across, offset_m, false)));
        }
        // A pair says more than a bone on the plane: a man with his arms out is flat.
        let explained = |symmetry: &Self| -> usize {
            let says = |bone: usize| match symmetry.sides[bone] {
                Side::Center => 1,
                _ => 2 * usize::from(symmetry.partners[bone].is_some()),
            };
            body.living().map(says).sum()
        };
        let best = planes.into_iter().max_by_key(explained)?;
        let paired = best.partners.iter().flatten().count() / 2;
        (paired >= 2).then(|| best.with_named_left(body))
    }

    /// The same with its left where names say so, if any do.
    fn with_named_left(self, body: &Body) -> Self {
        let toward_left = |bone: &BodyBone| match bone.says.side {
            Some(Side::Left) => self.away_m(bone.head),
            Some(Side::Right) => -self.away_m(bone.head),
            Some(Side::Center) | None => 0.0,
        };
        let sum: f32 = body.bones.iter().map(toward_left).sum();
        if sum == 0.0 {
            self
        } else {
            let sign = sum.signum();
            Self::with(body, sign * self.across, sign * self.offset_m, true)
        }
    }

    /// The same with left and right exchanged.
    pub(super) fn flipped(mut self) -> Self {
        self.across = -self.across;
        self.offset_m = -self.offset_m;
        for side in &mut self.sides {
            *side = match *side {
                Side::Center => Side::Center,
                Side::Left => Side::Right,
                Side::Right => Side::Left,
            };
        }
        self
    }

    /// How far a point is from the plane, toward the left, metres.
    pub(super) fn away_m(&self, point: Vec3) -> f32 {
        self.across.dot(point) - self.offset_m
    }

    fn with(body: &Body, across: Vec3, offset_m: f32, named: bool) -> Self {
        let mut symmetry = Self {
            across,
            offset_m,
            named,
            sides: vec![Side::Center; body.bones.len()],
            partners: vec![None; body.bones.len()],
        };
        let side = |bone: &BodyBone| {
            let away_m = symmetry.away_m(bone.head);
            match bone.says.side {
                Some(named) => named,
                None if away_m.abs() <= ON_PLANE * body.extent_m => Side::Center,
                None if away_m > 0.0 => Side::Left,
                None => Side::Right,
            }
        };
        symmetry.sides = body.bones.iter().map(side).collect();
        symmetry.pair_by_place(body);
        symmetry
    }

    fn pair_by_place(&mut self, body: &Body) {
        let nearest = |bone: usize| {
            let head = body.bones[bone].head;
            let image = head - 2.0 * self.away_m(head) * self.across;
            let away = |other: usize| body.bones[other].head.distance(image);
            let depth = |bone: usize| body.upward(bone).count();
            body.living()
                .filter(|&other| self.sides[other] != Side::Center)
                .filter(|&other| self.sides[other] != self.sides[bone])
                .filter(|&other| away(other) <= MIRRORED * body.extent_m)
                // Bones of one chain may lie at one place: those at one depth are a pair.
                .min_by(|&a, &b| {
                    let apart = |other: usize| depth(other).abs_diff(depth(bone));
                    apart(a).cmp(&apart(b)).then(away(a).total_cmp(&away(b)))
                })
        };
        let mut partners = vec![None; body.bones.len()];
        for bone in body.living().filter(|&b| self.sides[b] == Side::Left) {
            if let Some(other) = nearest(bone).filter(|&other| nearest(other) == Some(bone)) {
                (partners[bone], partners[other]) = (Some(other), Some(bone));
            }
        }
        self.partners = partners;
    }
}

/// Per bone the one whose name differs in its side only.
fn partners_by_name(body: &Body) -> Vec<Option<usize>> {
    let key = |bone: usize| {
        let says = &body.bones[bone].says;
        (says.numbered.as_str(), says.end, says.helper, says.rank)
    };
    let only = |bone: usize, side: Side| {
        let mut alike = (0..body.bones.len())
            .filter(|&other| body.bones[other].says.side == Some(side) && key(other) == key(bone));
        let first = alike.next()?;
        alike.next().is_none().then_some(first)
    };
    (0..body.bones.len())
        .map(|bone| match body.bones[bone].says.side? {
            Side::Left => only(bone, Side::Right).filter(|_| only(bone, Side::Left).is_some()),
            Side::Right => only(bone, Side::Left).filter(|_| only(bone, Side::Right).is_some()),
            Side::Center => None,
        })
        .collect()
}

/// From right to left: horizontal, along an axis if it is near one. Limbs may be bent to either side, so that only
/// pairs count that agree with the one that most others agree with.
fn named_direction(pairs: &[(Vec3, Vec3)]) -> Option<Vec3> {
    let flat = |(left, right): &(Vec3, Vec3)| (*left - *right).reject_from(Vec3::Y);
    let apart: Vec<Vec3> = pairs.iter().map(flat).collect();
    let agreement = |one: Vec3| -> f32 {
        let one = one.normalize_or_zero();
        apart
            .iter()
            .map(|other| other.normalize_or_zero().dot(one))
            .sum()
    };
    let most = apart
        .iter()
        .copied()
        .max_by(|&a, &b| agreement(a).total_cmp(&agreement(b)))?
        .try_normalize()?;
    let agrees = |other: &&Vec3| most.dot(**other) > 0.0 && near(most, **other);
    let across = apart.iter().filter(agrees).sum::<Vec3>().try_normalize()?;
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z];
    let axis = axes
        .into_iter()
        .find(|axis| axis.dot(across) > 0.0 && near(*axis, across));
    Some(axis.unwrap_or(across))
}

/// Whether the line of a vector is nearer than [`SQUARE`] to a unit vector's.
fn near(axis: Vec3, other: Vec3) -> bool {
    axis.cross(other).length() < SQUARE * other.length()
}

/// The middle of some numbers: as many are below as above.
fn median(mut numbers: Vec<f32>) -> f32 {
    numbers.sort_by(f32::total_cmp);
    match numbers.len() {
        0 => 0.0,
        count if count % 2 == 1 => numbers[count / 2],
        count => (numbers[count / 2 - 1] + numbers[count / 2]) / 2.0,
    }
}
