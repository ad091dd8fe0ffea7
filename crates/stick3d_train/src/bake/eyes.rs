//! Eyes and lips, where the base mesh has holes: an eyeball's front between the lids, closed lips.

use glam::DVec3;

use super::surface::Surface;

/// Vertices of one eye, from the middle out.
pub(super) struct Eye {
    pub(super) pupil: u32,
    pub(super) iris: Vec<u32>,
    pub(super) white: Vec<u32>,
    pub(super) lid: Vec<u32>,
}

/// An eyeball of the base mesh's helpers, metres.
pub(super) struct Eyeball {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

/// Radius of the iris, metres, and how much of a short spoke (toward the lids) it may fill.
const IRIS_M: f64 = 0.0056;
const IRIS_SHARE: f64 = 0.72;

/// Where between iris and lid the white ends and the shadow of the lid begins.
const WHITE_SHARE: f64 = 0.8;

/// Closes an eye's hole by a fan, splits its spokes into rings, and rounds it to the eyeball.
pub(super) fn close_eye(surface: &mut Surface, rim: &[u32], ball: &Eyeball) -> Eye {
    let round =
        |point: DVec3| ball.center + (point - ball.center).normalize_or(DVec3::Z) * ball.radius;
    let apex = round(mean(surface, rim));
    let pupil = surface.fan_shut(rim, apex);
    let spoke = |surface: &Surface, lid: u32| surface.positions[lid as usize].distance(apex);
    let share = |length: f64| (IRIS_M / length).min(IRIS_SHARE);
    // The outer ring first: a spoke's inner part stays a spoke of the fan.
    let white: Vec<u32> = rim
        .iter()
        .map(|&lid| {
            let iris = share(spoke(surface, lid));
            surface.split_at(pupil, lid, iris + (1.0 - iris) * WHITE_SHARE)
        })
        .collect();
    let iris: Vec<u32> = rim
        .iter()
        .zip(&white)
        .map(|(&lid, &white)| {
            let length = spoke(surface, lid);
            let inner = share(length) * length / spoke(surface, white);
            surface.split_at(pupil, white, inner)
        })
        .collect();
    for &vertex in iris.iter().chain(&white) {
        surface.positions[vertex as usize] = round(surface.positions[vertex as usize]);
    }
    Eye {
        pupil,
        iris,
        white,
        lid: rim.to_vec(),
    }
}

/// Closes the mouth's hole by a fan; returns the vertex in the middle.
pub(super) fn close_mouth(surface: &mut Surface, rim: &[u32]) -> u32 {
    let apex = mean(surface, rim);
    surface.fan_shut(rim, apex)
}

fn mean(surface: &Surface, vertices: &[u32]) -> DVec3 {
    let sum: DVec3 = vertices
        .iter()
        .map(|&vertex| surface.positions[vertex as usize])
        .sum();
    sum / vertices.len().max(1) as f64
}
