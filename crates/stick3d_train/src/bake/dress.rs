//! The man's clothes, hair and face: shape where cloth or hair lies, and one colour per vertex.
//!
//! Lines between colours are the zeros of *fields*: signed distances in metres over model space at
//! rest, positive on the side that the line names. The numbers were read off the body.

use std::collections::BTreeSet;

use glam::DVec3;

use super::eyes::Eye;
use super::paint::{smoothstep, srgb_hex};
use super::surface::Surface;

/// Vertices of the face that the dresser must know.
pub(super) struct Face {
    pub(super) mouth: u32,
    pub(super) lips: Vec<u32>,
    pub(super) eyes: [Eye; 2],
}

/// How far from a line between two colours their vertices are pulled, metres.
const SEAM_M: f64 = 0.0012;

/// Thickness of the hair, metres.
const HAIR_M: f64 = 0.009;

/// Rings of vertices round the mouth that are lips.
const LIP_RINGS: usize = 5;

const SLATE: [u8; 4] = srgb_hex(0x263240);
const TEAL: [u8; 4] = srgb_hex(0x2a7f86);
const SKIN: [u8; 4] = srgb_hex(0xd9a688);
const LIPS: [u8; 4] = srgb_hex(0xbd7d6b);
const MOUTH: [u8; 4] = srgb_hex(0x6e3a33);
const HAIR: [u8; 4] = srgb_hex(0x33251e);
const BROW: [u8; 4] = srgb_hex(0x5a4133);
const EYE_WHITE: [u8; 4] = srgb_hex(0xe6ded8);
const IRIS: [u8; 4] = srgb_hex(0x3f2a1c);
const PUPIL: [u8; 4] = srgb_hex(0x140d0a);
const LASH: [u8; 4] = srgb_hex(0x5c3f32);

/// Dresses the body: smooths it under the suit, gives it hair, and returns one linear colour per vertex.
pub(super) fn dress(surface: &mut Surface, face: &Face) -> Vec<[u8; 4]> {
    lay_cloth(surface);
    grow_hair(surface);
    // The second pass brings those to the line that were more than a step away.
    for field in [hairline, collar, cuff, hem, yoke, brow].repeat(2) {
        surface.pinch(field, SEAM_M);
    }
    let mut colors: Vec<[u8; 4]> = surface
        .positions
        .iter()
        .map(|&point| color_at(point))
        .collect();
    paint_face(surface, face, &mut colors);
    colors
}

/// How much longer an edge counts here when the longest are split: the scalp is coarse and round.
pub(super) fn detail(point: DVec3) -> f64 {
    if hairline(point) > 0.0 { 1.7 } else { 1.0 }
}

/// What is worn at a place.
fn color_at(point: DVec3) -> [u8; 4] {
    if hairline(point) > 0.0 {
        HAIR
    } else if brow(point) > 0.0 {
        BROW
    } else if collar(point) > 0.0 || cuff(point) > 0.0 || hem(point) > 0.0 {
        SKIN
    } else if yoke(point) > 0.0 {
        TEAL
    } else {
        SLATE
    }
}

/// Above the collar.
fn collar(point: DVec3) -> f64 {
    let edge = 1.500 - 0.36 * (point.z - 0.03) + 0.45 * point.x.abs();
    (point.y - edge) / 1.15
}

/// Past the cuff of either sleeve: beyond a plane across the wrist.
fn cuff(point: DVec3) -> f64 {
    let mirrored = DVec3::new(point.x.abs(), point.y, point.z);
    let along = DVec3::new(0.503, -0.482, 0.718);
    let past = (mirrored - DVec3::new(0.522, 1.1145, 0.211)).dot(along);
    past.min(mirrored.x - 0.40)
}

/// Below the hem of either leg.
fn hem(point: DVec3) -> f64 {
    0.095 - point.y
}

/// The lighter upper part with the sleeves: a V across chest and back, running out under the arms.
fn yoke(point: DVec3) -> f64 {
    let out = point.x.abs();
    let chevron = (point.y - 1.265 - 0.40 * out) / 1.08;
    let sleeve = (point.y - 1.33 + 0.9 * (out - 0.165)) / 1.35;
    chevron.max(sleeve)
}

/// Above the hairline: (degrees from the front about the head's middle, height).
fn hairline(point: DVec3) -> f64 {
    const LINE: [(f64, f64); 9] = [
        (0.0, 1.756),
        (35.0, 1.757),
        (55.0, 1.742),
        (70.0, 1.708),
        (85.0, 1.706),
        (105.0, 1.700),
        (122.0, 1.655),
        (150.0, 1.622),
        (180.0, 1.615),
    ];
    let degrees = point.x.abs().atan2(point.z - 0.05).to_degrees();
    let mut height = LINE[LINE.len() - 1].1;
    for pair in LINE.windows(2) {
        let ((from, low), (to, high)) = (pair[0], pair[1]);
        if (from..=to).contains(&degrees) {
            height = low + (high - low) * (degrees - from) / (to - from);
        }
    }
    point.y - height
}

/// On an eyebrow.
fn brow(point: DVec3) -> f64 {
    let out = (point.x.abs() - 0.034) / 0.022;
    let middle = 1.7085 + 0.0022 * out - 0.0025 * out * out;
    let half = 0.0042 - 0.0012 * out;
    (half - (point.y - middle).abs())
        .min(0.02 * (1.0 - out.abs()))
        .min(point.z - 0.1)
}

/// Smooths the body where cloth spans it: between the legs and buttocks, over the navel.
fn lay_cloth(surface: &mut Surface) {
    let spots = [
        (
            DVec3::new(0.0, 0.95, -0.11),
            DVec3::new(0.05, 0.13, 0.10),
            40,
        ),
        (
            DVec3::new(0.0, 0.885, 0.04),
            DVec3::new(0.035, 0.04, 0.06),
            5,
        ),
        (DVec3::new(0.0, 1.06, 0.12), DVec3::splat(0.05), 20),
    ];
    for (center, reach, steps) in spots {
        let mask: Vec<f64> = surface
            .positions
            .iter()
            .map(|&point| smoothstep(2.0 * (1.0 - ((point - center) / reach).length())))
            .collect();
        surface.smooth(&mask, steps);
    }
}

/// Lifts the scalp by the thickness of short hair.
fn grow_hair(surface: &mut Surface) {
    let normals = surface.normals();
    for (point, normal) in surface.positions.iter_mut().zip(normals) {
        *point += normal * HAIR_M * smoothstep(hairline(*point) / 0.03);
    }
}

fn paint_face(surface: &Surface, face: &Face, colors: &mut [[u8; 4]]) {
    let neighbors = surface.neighbors();
    let mut lips: BTreeSet<u32> = face.lips.iter().copied().chain([face.mouth]).collect();
    for _ in 1..LIP_RINGS {
        let ring: Vec<u32> = lips
            .iter()
            .flat_map(|&v| neighbors[v as usize].iter().copied())
            .collect();
        lips.extend(ring);
    }
    let mut paint = |vertices: &mut dyn Iterator<Item = &u32>, color| {
        vertices.for_each(|&vertex| colors[vertex as usize] = color);
    };
    paint(&mut lips.iter(), LIPS);
    paint(&mut face.lips.iter().chain([&face.mouth]), MOUTH);
    for eye in &face.eyes {
        paint(&mut eye.lid.iter(), LASH);
        paint(&mut eye.white.iter(), EYE_WHITE);
        paint(&mut eye.iris.iter(), IRIS);
        paint(&mut [eye.pupil].iter(), PUPIL);
    }
}
