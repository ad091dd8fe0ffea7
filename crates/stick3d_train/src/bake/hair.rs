//! The horse's mane and tail: from the source's slab and tube to hair that falls, and one colour per
//! vertex for the whole body.
//!
//! Axes: the horse walks along +X, its right side faces +Z; metres. Numbers were read off the body.

use glam::DVec3;

use super::paint::smoothstep;
use super::surface::Surface;

/// What a piece of the source's surface is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece {
    Coat,
    /// Insides of the ears and the like.
    Dark,
    Light,
    Hoof,
    Hair,
    Muzzle,
    EyeWhite,
    EyeBlack,
}

impl Piece {
    pub(super) const ALL: [Self; 8] = [
        Self::Coat,
        Self::Dark,
        Self::Light,
        Self::Hoof,
        Self::Hair,
        Self::Muzzle,
        Self::EyeWhite,
        Self::EyeBlack,
    ];

    /// Its colour in the source: linear bytes.
    pub(super) fn color(self) -> [u8; 4] {
        match self {
            Self::Coat => [50, 23, 8, 255],
            Self::Dark => [28, 13, 5, 255],
            Self::Light => [83, 37, 13, 255],
            Self::Hoof => [38, 34, 28, 255],
            Self::Hair => [10, 10, 10, 255],
            Self::Muzzle => [12, 9, 5, 255],
            Self::EyeWhite => [124, 124, 124, 255],
            Self::EyeBlack => [2, 2, 2, 255],
        }
    }

    /// Which of two pieces a vertex between them belongs to: the larger.
    pub(super) fn rank(self) -> usize {
        match self {
            Self::Coat => 0,
            Self::Light => 1,
            Self::Dark => 2,
            Self::Hair => 3,
            Self::Muzzle => 4,
            Self::Hoof => 5,
            Self::EyeWhite => 6,
            Self::EyeBlack => 7,
        }
    }
}

/// How far the tail is let down, metres.
const TAIL_DOWN_M: f64 = 0.24;
/// Heights between which it lengthens: below the dock, to its end in the source.
const TAIL_M: [f64; 2] = [1.28, 0.62];
/// The middle of the hanging tail.
const TAIL_X: f64 = -0.868;

/// Where a point of the source's tail goes: the tail grows longer and fuller toward its lower half.
pub(super) fn full_tail(point: DVec3) -> DVec3 {
    let down = (TAIL_M[0] - point.y) / (TAIL_M[0] - TAIL_M[1]);
    if down <= 0.0 || point.x > -0.6 {
        return point;
    }
    let fuller = 1.0 + 0.40 * smoothstep(2.0 * down) + 0.5 * smoothstep((down - 0.6) / 0.4);
    DVec3::new(
        TAIL_X + (point.x - TAIL_X) * (0.4 + 0.6 * fuller) - 0.03 * down,
        point.y - TAIL_DOWN_M * down * down,
        point.z * fuller,
    )
}

/// Narrows the slab on the neck to a crest.
pub(super) fn narrow_mane(point: DVec3) -> DVec3 {
    DVec3::new(point.x, point.y + 0.004, point.z * 0.5)
}

/// The crest of the neck from the withers to the poll, side view.
const CREST: [(f64, f64); 5] = [
    (0.46, 1.575),
    (0.60, 1.665),
    (0.77, 1.79),
    (0.94, 1.905),
    (1.04, 1.955),
];

/// How deep below the crest a point is, and how far along it (0 at the withers), metres.
fn below_crest(point: DVec3) -> (f64, f64) {
    let mut best = (f64::INFINITY, 0.0, 0.0);
    let mut before = 0.0;
    for pair in CREST.windows(2) {
        let (from, to) = (
            DVec3::new(pair[0].0, pair[0].1, 0.0),
            DVec3::new(pair[1].0, pair[1].1, 0.0),
        );
        let line = to - from;
        let offset = DVec3::new(point.x, point.y, 0.0) - from;
        let along = (offset.dot(line) / line.length_squared()).clamp(0.0, 1.0);
        let miss = offset - line * along;
        let depth = (line.x * -miss.y + line.y * miss.x).signum() * miss.length();
        if miss.length() < best.0 {
            best = (miss.length(), depth, before + along * line.length());
        }
        before += line.length();
    }
    (best.1, best.2)
}

/// Signed distance into the mane, positive inside: it falls on the right side of the neck, in locks.
pub(super) fn mane(point: DVec3) -> f64 {
    let (depth, along) = below_crest(point);
    let length = CREST
        .windows(2)
        .map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1))
        .sum::<f64>();
    let ends = (along - 0.01).min(length - along + 0.005);
    let locks = 0.024 * (along * 41.0).sin() + 0.010 * (along * 67.0 + 1.0).sin();
    let fall =
        0.165 * smoothstep(along / 0.18) * (0.75 + 0.25 * smoothstep((length - along) / 0.2));
    let on_right = fall + locks * smoothstep(along / 0.1) - depth;
    let on_left = 0.03 - depth;
    let side = if point.z > 0.0 { on_right } else { on_left };
    side.min(ends).min(off_the_ear(point))
}

/// How far a point is from the nearer ear, which stands in the mane's way.
fn off_the_ear(point: DVec3) -> f64 {
    const EAR: [DVec3; 2] = [DVec3::new(1.08, 1.86, 0.085), DVec3::new(1.12, 2.06, 0.10)];
    const GIRTH_M: f64 = 0.045;
    let mirrored = DVec3::new(point.x, point.y, point.z.abs());
    let line = EAR[1] - EAR[0];
    let along = (mirrored - EAR[0]).dot(line) / line.length_squared();
    mirrored.distance(EAR[0] + line * along.clamp(0.0, 1.0)) - GIRTH_M
}

/// How much longer an edge counts when the longest are split: locks end in fine points.
pub(super) fn detail(point: DVec3) -> f64 {
    if point.z > 0.0 && mane(point).abs() < 0.05 {
        2.2
    } else {
        1.0
    }
}

/// How far hair stands off the skin at its thickest, metres.
const MANE_THICK_M: f64 = 0.016;

/// Lays the falling side of the mane on the neck, in strands.
pub(super) fn lay_mane(surface: &mut Surface) {
    let normals = surface.normals();
    for (point, normal) in surface.positions.iter_mut().zip(normals) {
        let inside = mane(*point);
        if inside > 0.0 && point.z > 0.0 {
            let (_, along) = below_crest(*point);
            let strand = 0.75 + 0.25 * (along * 41.0).sin();
            *point += normal * MANE_THICK_M * strand * smoothstep(inside / 0.03);
        }
    }
}

/// The colour of a vertex: its piece's, with what makes a bay horse: dark legs, light and dark hair.
pub(super) fn shade(piece: Piece, point: DVec3) -> [u8; 4] {
    let color = piece.color();
    match piece {
        Piece::Coat => {
            let leg = smoothstep((0.62 - point.y) / 0.16) * f64::from(point.x > -0.95);
            let belly = smoothstep((0.98 - point.y) / 0.14)
                * smoothstep((point.y - 0.80) / 0.06)
                * smoothstep((0.17 - point.z.abs()) / 0.06);
            let toward_light = blend(color, Piece::Light.color(), 0.35 * belly);
            blend(toward_light, Piece::Hair.color(), 0.86 * leg)
        }
        Piece::Hair => {
            let strand = (point.x * 53.0 - point.y * 19.0).sin() * (point.z * 61.0).cos();
            blend(color, [24, 17, 13, 255], 0.5 + 0.5 * strand)
        }
        _ => color,
    }
}

fn blend(from: [u8; 4], to: [u8; 4], t: f64) -> [u8; 4] {
    std::array::from_fn(|i| {
        let (a, b) = (f64::from(from[i]), f64::from(to[i]));
        (a + (b - a) * t).round() as u8
    })
}
