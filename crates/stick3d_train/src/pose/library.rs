//! Files of named poses.

use std::collections::BTreeMap;

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::controls::{Controls, PoseValues};
use super::error::PoseError;
use super::goals::{Goal, solve};

/// A clip's pose whose lowest part is less high than this, metres, is on the ground.
const ON_GROUND_M: f32 = 0.03;

/// A file of poses, as written.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LibrarySpec {
    /// The rig that the poses are for.
    rig: String,
    poses: Vec<PoseSpec>,
}

/// One pose, as written. What is not mentioned is as in the pose it is like, or at ease.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseSpec {
    name: String,
    /// An earlier pose to start from.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    like: String,
    /// Whether that pose is mirrored first.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    mirrored: bool,
    /// A moment of one of the rig's own clips to start from: its name and seconds from its beginning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    clip: Option<(String, f32)>,
    /// Control -> degrees. A name without a side (`elbow.flexion`) sets both.
    #[serde(default)]
    values: BTreeMap<String, f32>,
    /// Height of the lowest point above the ground, or above where the clip has it, metres.
    #[serde(default)]
    lift_m: f32,
    /// What the pose achieves, beyond its angles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    goals: Vec<Goal>,
    /// The controls that give way for the goals.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    free: Vec<String>,
}

/// A pose with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedPose {
    /// Unique in its library, `snake_case`.
    pub name: String,
    /// What it looks like.
    pub values: PoseValues,
    /// The pose that this one is a plain mirror image of, else its own name.
    pub family: String,
    /// How far the bones are turned from the moment of a clip that it was fitted to: root of the mean
    /// square, radians.
    pub clip_miss_rad: f32,
    /// How well its goals are met: the largest miss (decimetres, or unit direction).
    pub miss: f32,
}

/// Named, authored poses.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PoseLibrary {
    /// The poses, in the order of the file.
    pub poses: Vec<NamedPose>,
}

impl PoseLibrary {
    /// Reads a library and solves the goals of its poses.
    ///
    /// # Errors
    /// [`PoseError::Syntax`] for a malformed file, [`PoseError::UnknownControl`] with the nearest valid
    /// name, [`PoseError::OtherRig`], [`PoseError::OutsideLimits`], or [`PoseError::Inconsistent`] for names of poses and parts.
    pub fn from_ron(text: &str, controls: &Controls) -> Result<Self, PoseError> {
        let spec: LibrarySpec =
            ron::from_str(text).map_err(|error| PoseError::syntax("the pose library", &error))?;
        if spec.rig != controls.rig() {
            return Err(PoseError::OtherRig {
                library: spec.rig,
                controls: controls.rig().to_owned(),
            });
        }
        let mut library = Self::default();
        for pose in &spec.poses {
            let pose = library.read_pose(pose, controls)?;
            library.poses.push(pose);
        }
        Ok(library)
    }

    fn read_pose(&self, spec: &PoseSpec, controls: &Controls) -> Result<NamedPose, PoseError> {
        let place = format!("pose `{}`", spec.name);
        if self.get(&spec.name).is_some() {
            return Err(PoseError::inconsistent(
                place,
                "another pose has the same name",
            ));
        }
        let mut values = controls.ease();
        let mut family = &spec.name;
        if !spec.like.is_empty() {
            let base = self.get(&spec.like).ok_or_else(|| {
                let why = format!("it is like `{}`, which does not stand before it", spec.like);
                PoseError::inconsistent(place.clone(), why)
            })?;
            values = base.values.clone();
            if spec.mirrored {
                values = controls.mirror(&values);
                if spec.values.is_empty() && spec.goals.is_empty() {
                    family = &base.family;
                }
            }
        }
        let mut clip_miss_rad = 0.0;
        if let Some((clip, time_s)) = &spec.clip {
            let moment = controls.clip_pose(clip, *time_s, &place)?;
            (values, clip_miss_rad) = controls.fit_from(&moment, &values);
            if values.lift_m < ON_GROUND_M {
                values.lift_m = 0.0;
            }
        } else {
            values.lift_m = 0.0;
        }
        if !spec.lift_m.is_finite() {
            let why = format!("lift_m is {}; metres are expected", spec.lift_m);
            return Err(PoseError::inconsistent(place, why));
        }
        values.lift_m += spec.lift_m;
        // Both sides first, so that a single side can differ from them.
        let (pairs, singles): (Vec<_>, Vec<_>) = spec
            .values
            .iter()
            .partition(|(name, _)| controls.index(name, &place).is_err());
        for (name, &degrees) in pairs.into_iter().chain(singles) {
            for index in controls.indices(name, &place)? {
                values.degrees[index] = degrees;
            }
        }
        controls.check(&values, &place)?;
        let mut free = Vec::new();
        for name in &spec.free {
            free.extend(controls.indices(name, &place)?);
        }
        let miss = if spec.goals.is_empty() {
            0.0
        } else {
            solve(controls, &mut values, &spec.goals, &free)?
        };
        Ok(NamedPose {
            name: spec.name.clone(),
            values,
            family: family.clone(),
            clip_miss_rad,
            miss,
        })
    }

    /// Writes the poses with plain angles, goals solved.
    ///
    /// # Errors
    /// [`PoseError::Inconsistent`] where RON refuses to write a value.
    pub fn to_ron(&self, rig: &str, controls: &Controls) -> Result<String, PoseError> {
        let ease = controls.ease();
        let poses = self.poses.iter().map(|pose| PoseSpec {
            name: pose.name.clone(),
            like: String::new(),
            mirrored: false,
            values: controls
                .list()
                .iter()
                .enumerate()
                .filter(|(i, _)| pose.values.degrees[*i] != ease.degrees[*i])
                .map(|(i, control)| (control.name.clone(), pose.values.degrees[i]))
                .collect(),
            lift_m: pose.values.lift_m,
            clip: None,
            goals: Vec::new(),
            free: Vec::new(),
        });
        let spec = LibrarySpec {
            rig: rig.to_owned(),
            poses: poses.collect(),
        };
        ron::ser::to_string_pretty(&spec, ron::ser::PrettyConfig::default())
            .map_err(|error| PoseError::inconsistent("writing poses", error.to_string()))
    }

    /// The pose called `name`.
    pub fn get(&self, name: &str) -> Option<&NamedPose> {
        self.poses.iter().find(|pose| pose.name == name)
    }

    /// Splits into (training, held out): about `fraction` of the poses are held out, mirror images
    /// always together with their originals. The same seed gives the same split.
    #[must_use]
    pub fn split(&self, seed: u64, fraction: f32) -> (Self, Self) {
        let mut families: Vec<&str> = self.poses.iter().map(|p| p.family.as_str()).collect();
        families.sort_unstable();
        families.dedup();
        families.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
        let wanted = (self.poses.len() as f32 * fraction.clamp(0.0, 1.0)).round() as usize;
        let mut held_out = Vec::new();
        let mut count = 0;
        for family in families {
            let size = self
                .poses
                .iter()
                .filter(|pose| pose.family == family)
                .count();
            if count + size <= wanted {
                held_out.push(family);
                count += size;
            }
        }
        let part = |held: bool| Self {
            poses: self
                .poses
                .iter()
                .filter(|pose| held_out.contains(&pose.family.as_str()) == held)
                .cloned()
                .collect(),
        };
        (part(false), part(true))
    }
}
