//! The joints of a horse: muzzle, tail, four hooves and what lies between.

use glam::{Mat3, Vec3};

use super::limbs::Limbs;
use super::surface::{Ring, Surface};
use super::{Found, LandmarkError, facing_below, longest};

/// Shares of the way from a hoof to the trunk, half of the way from hoof to hoof of a pair.
const FOOT: f32 = 0.105;
const CARPUS: f32 = 0.52;
const HOCK: f32 = 0.5;
const UPPER_LEG: f32 = 0.9;
/// Shares of the way from the muzzle to where the front legs leave the trunk.
const POLL: f32 = 0.45;
const SHOULDER: f32 = 1.04;
/// Shares of the way from the tip of the tail to where the hind legs leave the trunk.
const TAIL: f32 = 0.14;
const HIP: f32 = 1.11;
/// Share of the way from muzzle to tail at which a head is thick and a tail is thin.
const GIRTH: f32 = 0.08;
/// How far the forehead is turned from the muzzle toward the ears, seen from the poll, radians.
const FOREHEAD_RAD: f32 = 0.96;

pub(super) fn joints(surface: &Surface<'_>) -> Result<Found, LandmarkError> {
    let limbs = Limbs::find(surface, 6)?;
    let on = |tip: usize, level: f32, joint: &'static str| {
        longest(surface, &limbs.tips[tip].distances, level, joint)
    };
    let (mut head, mut tail) = (limbs.middle[0], limbs.middle[1]);
    let whole = limbs.between(head, tail);
    if on(head, GIRTH * whole, "forehead")?.length < on(tail, GIRTH * whole, "tail")?.length {
        std::mem::swap(&mut head, &mut tail);
    }
    let [mut front, mut back] = limbs.pairs;
    if limbs.to_pair(head, back) < limbs.to_pair(head, front) {
        std::mem::swap(&mut front, &mut back);
    }
    let half = |pair: [usize; 2]| limbs.between(pair[0], pair[1]) / 2.0;
    let (fore, hind) = (half(front), half(back));
    let neck = limbs.to_pair(head, front) - fore;
    let dock = limbs.to_pair(tail, back) - hind;
    let shoulder = on(head, SHOULDER * neck, "shoulder")?;
    let hip = on(tail, HIP * dock, "hip")?;

    // The tips' order says which are on one side; which side that is, the upper legs.
    let mut feet = Vec3::ZERO;
    let mut across = Vec3::ZERO;
    for (pair, length) in [(front, fore), (back, hind)] {
        let [a, b] = [
            on(pair[0], UPPER_LEG * length, "knee_fr")?,
            on(pair[1], UPPER_LEG * length, "knee_fl")?,
        ];
        across += a.centre - b.centre;
        for tip in pair {
            feet += surface.mesh.positions[limbs.tips[tip].vertex as usize] / 4.0;
        }
    }
    let forward = (shoulder.centre - hip.centre).normalize_or(Vec3::X);
    let trunk_middle = (shoulder.centre + hip.centre) / 2.0;
    let up = (trunk_middle - feet)
        .reject_from(forward)
        .normalize_or(Vec3::Y);
    let left = up.cross(forward);
    let (l, r) = if across.dot(left) > 0.0 {
        (0, 1)
    } else {
        (1, 0)
    };

    let muzzle = &limbs.tips[head];
    let poll = on(head, POLL * neck, "forehead")?.centre;
    let nose = (surface.mesh.positions[muzzle.vertex as usize] - poll).normalize_or(forward);
    let (sin, cos) = FOREHEAD_RAD.sin_cos();
    let toward = cos * nose + sin * nose.cross(left).normalize_or(up);
    let forehead = facing_below(surface, &muzzle.distances, POLL * neck, poll, toward);
    let ring = |ring: Ring| ring.vertices;
    let joints = vec![
        ("forehead", forehead),
        ("shoulder", ring(shoulder)),
        ("hip", ring(hip)),
        ("tail", ring(on(tail, TAIL * dock, "tail")?)),
        ("knee_fr", ring(on(front[r], CARPUS * fore, "knee_fr")?)),
        ("foot_fr", ring(on(front[r], FOOT * fore, "foot_fr")?)),
        ("knee_fl", ring(on(front[l], CARPUS * fore, "knee_fl")?)),
        ("foot_fl", ring(on(front[l], FOOT * fore, "foot_fl")?)),
        ("knee_br", ring(on(back[r], HOCK * hind, "knee_br")?)),
        ("foot_br", ring(on(back[r], FOOT * hind, "foot_br")?)),
        ("knee_bl", ring(on(back[l], HOCK * hind, "knee_bl")?)),
        ("foot_bl", ring(on(back[l], FOOT * hind, "foot_bl")?)),
    ];
    Ok(Found {
        joints,
        // It walks to the right and shows its right side.
        axes: Mat3::from_cols(forward, up, -left),
    })
}
