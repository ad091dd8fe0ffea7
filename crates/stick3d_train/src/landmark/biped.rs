//! The joints of a person: head, two hands, two feet and what lies between.

use glam::{Mat3, Vec3};

use super::limbs::Limbs;
use super::surface::{Ring, Surface};
use super::{Found, LandmarkError, facing_below, longest, lower};

/// Shares of the way from a toe to the crotch, which is half of the way from toe to toe.
const FOOT: f32 = 0.16;
const ANKLE: f32 = 0.27;
const KNEE: f32 = 0.63;
const HIP: f32 = 0.93;
const ABDOMEN: f32 = 1.08;
/// Shares of the way from a finger tip to the middle of the back, half of the way from hand to hand.
const HAND: f32 = 0.13;
const ELBOW: f32 = 0.54;
/// Shares of the way from the crown to the neck's narrowest ring.
const HEAD: f32 = 0.5;
const NECK: f32 = 1.06;
/// The forehead is this much above the horizontal from the middle of the head, radians.
const FOREHEAD_RAD: f32 = 0.3;

pub(super) fn joints(surface: &Surface<'_>) -> Result<Found, LandmarkError> {
    let limbs = Limbs::find(surface, 5)?;
    let head = limbs.middle[0];
    // Hands are nearer to the head than feet are.
    let [mut hands, mut feet] = limbs.pairs;
    if limbs.to_pair(head, feet) < limbs.to_pair(head, hands) {
        std::mem::swap(&mut hands, &mut feet);
    }
    let leg = limbs.between(feet[0], feet[1]) / 2.0;
    let arm = limbs.between(hands[0], hands[1]) / 2.0;
    let on = |tip: usize, level: f32, joint: &'static str| {
        longest(surface, &limbs.tips[tip].distances, level, joint)
    };
    let crown = &limbs.tips[head].distances;
    let narrowest = narrowest(surface, crown, limbs.to_pair(head, hands))?;
    let neck = longest(surface, crown, NECK * narrowest, "neck")?;
    let of_feet = lower(
        &limbs.tips[feet[0]].distances,
        &limbs.tips[feet[1]].distances,
    );
    let abdomen = longest(surface, &of_feet, ABDOMEN * leg, "abdomen")?;

    let hips = [
        on(feet[0], HIP * leg, "knee_r")?,
        on(feet[1], HIP * leg, "knee_l")?,
    ];
    let up = (neck.centre - (hips[0].centre + hips[1].centre) / 2.0).normalize_or(Vec3::Y);
    let mut toes = Vec3::ZERO;
    for foot in feet {
        toes += on(foot, FOOT * leg, "foot_r")?.centre - on(foot, ANKLE * leg, "foot_r")?.centre;
    }
    // From one hip to the other is left or right: left is where up × forward points.
    let across = (hips[0].centre - hips[1].centre)
        .reject_from(up)
        .normalize_or(Vec3::X);
    let first_is_left = across.cross(up).dot(toes) > 0.0;
    let left = if first_is_left { across } else { -across };
    let forward = left.cross(up);
    let (l, r) = if first_is_left { (0, 1) } else { (1, 0) };

    let ring = |ring: Ring| ring.vertices;
    let middle = longest(surface, crown, HEAD * narrowest, "forehead")?.centre;
    let (sin, cos) = FOREHEAD_RAD.sin_cos();
    let forehead = facing_below(surface, crown, narrowest, middle, cos * forward + sin * up);
    let joints = vec![
        ("forehead", forehead),
        ("neck", ring(neck)),
        ("abdomen", ring(abdomen)),
        ("elbow_r", ring(on(hands[r], ELBOW * arm, "elbow_r")?)),
        ("hand_r", ring(on(hands[r], HAND * arm, "hand_r")?)),
        ("knee_r", ring(on(feet[r], KNEE * leg, "knee_r")?)),
        ("foot_r", ring(on(feet[r], FOOT * leg, "foot_r")?)),
        ("elbow_l", ring(on(hands[l], ELBOW * arm, "elbow_l")?)),
        ("hand_l", ring(on(hands[l], HAND * arm, "hand_l")?)),
        ("knee_l", ring(on(feet[l], KNEE * leg, "knee_l")?)),
        ("foot_l", ring(on(feet[l], FOOT * leg, "foot_l")?)),
    ];
    Ok(Found {
        joints,
        axes: Mat3::from_cols(left, up, forward),
    })
}

/// How far from the crown the neck is narrowest; `to_hands` is how far the hands are.
fn narrowest(surface: &Surface<'_>, crown: &[f32], to_hands: f32) -> Result<f32, LandmarkError> {
    const LEVELS: usize = 40;
    let mut best: Option<(f32, f32)> = None;
    for step in 0..LEVELS {
        // The head is wider than the neck from here on, and the shoulders begin before there.
        let level = to_hands * (0.15 + 0.25 * step as f32 / LEVELS as f32);
        let length = longest(surface, crown, level, "neck")?.length;
        if best.is_none_or(|(_, shortest)| length < shortest) {
            best = Some((level, length));
        }
    }
    best.map(|(level, _)| level)
        .ok_or(LandmarkError::NoRing { joint: "neck" })
}
