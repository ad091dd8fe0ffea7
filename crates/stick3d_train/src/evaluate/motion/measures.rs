//! The measures of motions: distances, lengths, stretches, jerks.

use glam::Vec3;
use rayon::prelude::*;
use stick3d_figure::figure::Figure;
use stick3d_figure::regressor::JointRegressor;
use stick3d_model::Model;

use super::cases::DrawnMotion;
use super::report::BetweenReport;
use crate::dataset::rounded;
use crate::rig::{Pose, Rig};

/// How long the edges of a mesh may be.
#[derive(Debug, Clone)]
pub(super) struct EdgeLengths {
    edges: Vec<[u32; 2]>,
    longest_m: Vec<f32>,
}

impl EdgeLengths {
    /// The longest that each edge is in some poses of the rig.
    pub(super) fn longest(rig: &Rig, edges: Vec<[u32; 2]>, poses: &[Pose]) -> Self {
        let none = || vec![0.0_f32; edges.len()];
        let longest_m = poses
            .par_chunks(64)
            .map(|poses| {
                let (mut mesh, mut longest) = (vec![], none());
                for pose in poses {
                    rig.skin(pose, &mut mesh);
                    for (longest, length) in longest.iter_mut().zip(lengths(&edges, &mesh)) {
                        *longest = longest.max(length);
                    }
                }
                longest
            })
            .reduce(none, |a, b| {
                a.iter().zip(&b).map(|(a, b)| a.max(*b)).collect()
            });
        Self { edges, longest_m }
    }

    /// Lets edges also be as long as on the training bodies as the model's final layer holds them, where it says: it is a
    /// little off the rig's own skin.
    pub(super) fn or_as_trained(mut self, model: &Model) -> Self {
        if let Some(statistics) = model.statistics() {
            for (longest, trained) in self.longest_m.iter_mut().zip(&statistics.longest_edges_m) {
                *longest = longest.max(*trained);
            }
        }
        self
    }

    /// Lets edges also be as long as on some meshes.
    pub(super) fn or_as_on(mut self, meshes: &[Vec<Vec3>]) -> Self {
        for mesh in meshes {
            for (longest, length) in self.longest_m.iter_mut().zip(lengths(&self.edges, mesh)) {
                *longest = longest.max(length);
            }
        }
        self
    }

    /// By which share edges are longer than they may be: 99 of 100 are stretched less.
    pub(super) fn stretch(&self, mesh: &[Vec3]) -> f32 {
        let longest = self.longest_m.iter().map(|l| l.max(f32::MIN_POSITIVE));
        let mut stretches: Vec<f32> = lengths(&self.edges, mesh)
            .zip(longest)
            .map(|(length, longest)| (length / longest - 1.0).max(0.0))
            .collect();
        percentile(&mut stretches, 99)
    }
}

fn lengths<'a>(edges: &'a [[u32; 2]], mesh: &'a [Vec3]) -> impl Iterator<Item = f32> + 'a {
    edges
        .iter()
        .map(|[a, b]| mesh[*a as usize].distance(mesh[*b as usize]))
}

/// So many of 100 numbers are at most this; 0 for none.
pub(super) fn percentile(numbers: &mut [f32], percent: usize) -> f32 {
    if numbers.is_empty() {
        return 0.0;
    }
    let index = (numbers.len() - 1) * percent / 100;
    *numbers.select_nth_unstable_by(index, f32::total_cmp).1
}

/// Gathers what one method puts between keys.
#[derive(Debug, Clone, Default)]
pub(super) struct Between {
    motions: usize,
    /// Per frame between keys, the mean distance of its vertices from the truth.
    distance_m: Vec<f32>,
    /// Per bone and frame between keys, the error of its length as a share of the true one.
    bones: Vec<f32>,
    /// Per bone and frame, how far its length is from the even way between its lengths in the keys.
    bones_beside_keys: Vec<f32>,
    /// Per frame between keys.
    stretches: Vec<f32>,
    /// Per joint and four frames.
    jerks: Vec<f32>,
}

impl Between {
    /// Adds the meshes of a motion's frames.
    pub(super) fn add(
        &mut self,
        figure: &Figure,
        regressor: &JointRegressor,
        drawn: &DrawnMotion,
        meshes: &[Vec<Vec3>],
        edges: &EdgeLengths,
    ) {
        self.motions += 1;
        let joints: Vec<Vec<Vec3>> = meshes.iter().map(|mesh| regressor.joints(mesh)).collect();
        let even = even_lengths(figure, drawn, &joints);
        for (index, (frame, mesh)) in drawn.frames.iter().zip(meshes).enumerate() {
            if frame.is_key {
                continue;
            }
            let distances = frame.mesh.iter().zip(mesh).map(|(a, b)| a.distance(*b));
            self.distance_m
                .push(distances.sum::<f32>() / mesh.len() as f32);
            self.stretches.push(edges.stretch(mesh));
            for (bone, even) in figure.bones.iter().zip(&even[index]) {
                let found = length(&joints[index], *bone);
                let truth = length(&frame.joints, *bone).max(f32::EPSILON);
                self.bones.push((found - truth).abs() / truth);
                self.bones_beside_keys
                    .push((found - even).abs() / even.max(f32::EPSILON));
            }
        }
        for four in joints.windows(4).zip(drawn.frames.windows(2)) {
            let ([a, b, c, d], times) = (four.0, four.1) else {
                continue;
            };
            let step_s = times[1].time_s - times[0].time_s;
            for joint in 0..a.len() {
                let third = d[joint] - 3.0 * c[joint] + 3.0 * b[joint] - a[joint];
                self.jerks.push(third.length() / step_s.powi(3));
            }
        }
    }

    /// The measures; all 0 when there is no motion.
    pub(super) fn report(&self, name: &str) -> BetweenReport {
        let percent = |x: f64| rounded(100.0 * x);
        BetweenReport {
            name: name.to_owned(),
            motions: self.motions,
            vertex_cm: percent(mean(&self.distance_m)),
            bone_length_percent: percent(mean(&self.bones)),
            bone_length_beside_keys_percent: percent(mean(&self.bones_beside_keys)),
            edge_stretch_percent: percent(mean(&self.stretches)),
            edge_stretch_worst_percent: percent(f64::from(percentile(
                &mut self.stretches.clone(),
                100,
            ))),
            jerk_m_s3: rounded(root_mean_square(&self.jerks)),
        }
    }
}

/// Per frame and bone, its length if it went evenly from its length in one key to that in the next.
fn even_lengths(figure: &Figure, drawn: &DrawnMotion, joints: &[Vec<Vec3>]) -> Vec<Vec<f32>> {
    let keys: Vec<usize> = (0..drawn.frames.len())
        .filter(|i| drawn.frames[*i].is_key)
        .collect();
    let of_frame = |index: usize| -> Vec<f32> {
        let after = keys
            .partition_point(|key| *key <= index)
            .clamp(1, keys.len().max(2) - 1);
        let (Some(&from), Some(&to)) = (keys.get(after - 1), keys.get(after)) else {
            return vec![f32::NAN; figure.bones.len()];
        };
        let share = (index - from) as f32 / (to - from) as f32;
        let even = |bone: &[usize; 2]| {
            let [a, b] = [from, to].map(|key| length(&joints[key], *bone));
            a + share * (b - a)
        };
        figure.bones.iter().map(even).collect()
    };
    (0..drawn.frames.len()).map(of_frame).collect()
}

fn length(joints: &[Vec3], [a, b]: [usize; 2]) -> f32 {
    joints[a].distance(joints[b])
}

fn mean(numbers: &[f32]) -> f64 {
    numbers.iter().copied().map(f64::from).sum::<f64>() / numbers.len().max(1) as f64
}

fn root_mean_square(numbers: &[f32]) -> f64 {
    let squares = numbers.iter().map(|x| f64::from(*x) * f64::from(*x));
    (squares.sum::<f64>() / numbers.len().max(1) as f64).sqrt()
}
