//! True motions, and what is drawn of them.

use glam::{Quat, Vec3};
use stick3d_figure::sketch::Sketch;
use stick3d_model::latent::{Easing, LatentKey};
use stick3d_model::{Inference, Model};

use crate::dataset::{centre, drawn};
use crate::evaluate::EvalError;
use crate::rig::{Clip, Pose, Rig};

/// Seconds between two keys of a motion between poses.
const INTERVAL_S: f32 = 0.5;
/// How many moments of a rig's clip are drawn: first and last, and between.
const CLIP_KEYS: usize = 5;
/// How many moments of a clip that goes round are drawn.
const GAIT_KEYS: usize = 8;
/// Two poses are the same whose bones are turned, on average, and whose roots are moved by less than this.
const SAME_RAD: f32 = 0.02;
const SAME_M: f32 = 0.02;

/// A motion of a rig: poses at times; between them every bone turns evenly (spherical linear interpolation).
#[derive(Debug, Clone, PartialEq)]
pub struct TrueMotion {
    /// What it is called in a report.
    pub name: String,
    /// Rising times, seconds, and the poses there; at least two.
    pub poses: Vec<(f32, Pose)>,
    /// Which of these poses are drawn: the keys, rising; at least two.
    pub keys: Vec<usize>,
    /// Whether it goes on from the last pose to the first; as long as between the first two.
    pub is_loop: bool,
}

impl TrueMotion {
    /// A motion through poses, evenly in time, all of them drawn.
    #[must_use]
    pub fn between(name: String, poses: Vec<Pose>, interval_s: f32, is_loop: bool) -> Self {
        let timed = |(index, pose)| (index as f32 * interval_s, pose);
        Self {
            name,
            keys: (0..poses.len()).collect(),
            poses: poses.into_iter().enumerate().map(timed).collect(),
            is_loop,
        }
    }

    /// The pose at a time between the first pose and the last.
    fn at(&self, time_s: f32) -> Option<Pose> {
        let after = self.poses.partition_point(|(t, _)| *t <= time_s);
        let (from_s, from) = self.poses.get(after.checked_sub(1)?)?;
        let Some((to_s, to)) = self.poses.get(after) else {
            return Some(from.clone());
        };
        let share = (time_s - from_s) / (to_s - from_s);
        let turns = from.rotations.iter().zip(&to.rotations);
        Some(Pose {
            rotations: turns.map(|(a, b)| a.slerp(*b, share)).collect(),
            root_translation: from.root_translation.lerp(to.root_translation, share),
        })
    }
}

/// Motions between poses that are much alike: each pose with the two nearest others, as a pair and as a triple.
#[must_use]
pub fn held_out_motions(poses: &[(String, Pose)]) -> Vec<TrueMotion> {
    let mut motions = vec![];
    for (index, (name, pose)) in poses.iter().enumerate() {
        let mut others: Vec<usize> = (0..poses.len()).filter(|other| *other != index).collect();
        others.sort_by(|a, b| {
            let distance = |other: &usize| turned_by(pose, &poses[*other].1);
            distance(a).total_cmp(&distance(b))
        });
        let through = |indices: &[usize]| {
            let names: Vec<&str> = indices.iter().map(|i| poses[*i].0.as_str()).collect();
            let poses = indices.iter().map(|i| poses[*i].1.clone()).collect();
            TrueMotion::between(names.join(" - "), poses, INTERVAL_S, false)
        };
        let [first, second, ..] = others.as_slice() else {
            continue;
        };
        motions.push(through(&[index, *first]));
        motions.push(TrueMotion {
            name: format!("{name} in the middle"),
            ..through(&[*first, index, *second])
        });
    }
    motions
}

/// The motions that come with a rig, each with a few moments drawn.
#[must_use]
pub fn clip_motions(rig: &Rig) -> Vec<TrueMotion> {
    let drawn = |clip: &Clip| {
        let last = clip.poses.len() - 1;
        let mut keys: Vec<usize> = (0..CLIP_KEYS).map(|i| i * last / (CLIP_KEYS - 1)).collect();
        keys.dedup();
        let times_s = clip.times_s.iter().copied();
        TrueMotion {
            name: clip.name.clone(),
            poses: times_s.zip(clip.poses.iter().cloned()).collect(),
            keys,
            is_loop: false,
        }
    };
    let moving = rig.clips.iter().filter(|clip| clip.poses.len() > 1);
    moving.map(drawn).collect()
}

/// Those of a rig's motions that go round: all that end as they began.
#[must_use]
pub fn clip_gaits(rig: &Rig) -> Vec<TrueMotion> {
    let round = |clip: &&Clip| match clip.poses.as_slice() {
        [first, _, .., last] => {
            turned_by(first, last) / (first.rotations.len() as f32) < SAME_RAD
                && first.root_translation.distance(last.root_translation) < SAME_M
        }
        _ => false,
    };
    let looped = |clip: &Clip| {
        let interval_s = clip.duration_s() / GAIT_KEYS as f32;
        TrueMotion::between(clip.name.clone(), clip.spread(GAIT_KEYS), interval_s, true)
    };
    rig.clips.iter().filter(round).map(looped).collect()
}

/// By how much the bones of two poses are turned against each other, the sum over all bones, radians.
fn turned_by(a: &Pose, b: &Pose) -> f32 {
    let pairs = a.rotations.iter().zip(&b.rotations);
    pairs.map(|(a, b)| a.angle_between(*b)).sum()
}

/// A true motion, turned, and its keys as sketches.
#[derive(Debug, Clone)]
pub(super) struct DrawnMotion {
    pub(super) is_loop: bool,
    /// Times and sketches of the keys.
    pub(super) keys: Vec<(f32, Sketch)>,
    /// From the first key to the last.
    pub(super) frames: Vec<TrueFrame>,
}

/// A moment of a true motion: centred on the root joint, metres.
#[derive(Debug, Clone)]
pub(super) struct TrueFrame {
    pub(super) time_s: f32,
    pub(super) mesh: Vec<Vec3>,
    pub(super) joints: Vec<Vec3>,
    /// How high its lowest vertex is above the ground, metres.
    pub(super) lift_m: f32,
    /// Whether it is a key.
    pub(super) is_key: bool,
}

impl DrawnMotion {
    pub(super) fn new(
        model: &Model,
        rig: &Rig,
        motion: &TrueMotion,
        turn: Quat,
        frames_per_s: f32,
    ) -> Result<Self, EvalError> {
        let figure = model.figure();
        let frame = |time_s: f32, pose: &Pose, is_key: bool| {
            let mut mesh = vec![];
            rig.skin(pose, &mut mesh);
            let lowest_m = mesh.iter().map(|v| v.y).fold(f32::INFINITY, f32::min);
            let mut joints = centre(model.regressor(), figure.root, &mut mesh);
            let points = mesh.iter_mut().chain(&mut joints);
            points.for_each(|point| *point = turn * *point);
            TrueFrame {
                time_s,
                mesh,
                joints,
                // Between poses on the ground, turned bones may lead below it.
                lift_m: lowest_m.max(0.0),
                is_key,
            }
        };
        let timed: Vec<&(f32, Pose)> = motion
            .keys
            .iter()
            .filter_map(|key| motion.poses.get(*key))
            .collect();
        let keys = timed
            .iter()
            .map(|(time_s, pose)| {
                let joints = frame(*time_s, pose, true).joints;
                Ok((
                    *time_s,
                    Sketch::new(figure, drawn(Quat::IDENTITY, &joints))?,
                ))
            })
            .collect::<Result<Vec<_>, EvalError>>()?;
        let ([(start_s, _), ..], [.., (end_s, _)]) = (timed.as_slice(), timed.as_slice()) else {
            return Err(EvalError::NoMotions);
        };
        let count = ((end_s - start_s) * frames_per_s).round() as usize;
        let frames = (0..=count)
            .filter_map(|index| {
                let time_s = start_s + index as f32 / frames_per_s;
                let is_key = timed.iter().any(|(key_s, _)| (key_s - time_s).abs() < 1e-3);
                Some(frame(time_s, &motion.at(time_s)?, is_key))
            })
            .collect();
        Ok(Self {
            is_loop: motion.is_loop,
            keys,
            frames,
        })
    }

    /// The keys as latents of their sketches.
    pub(super) fn latent_keys(
        &self,
        inference: &mut Inference,
    ) -> Result<Vec<LatentKey>, EvalError> {
        let mut keys = vec![];
        for (time_s, sketch) in &self.keys {
            let mut latent = vec![0.0; inference.latent_len()];
            inference.encode(sketch, &mut latent)?;
            keys.push(LatentKey {
                latent,
                time_s: *time_s,
                easing: Easing::Linear,
            });
        }
        Ok(keys)
    }
}
