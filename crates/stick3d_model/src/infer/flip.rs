//! The same body with one limb's depth the other way round.

use glam::{Vec2, Vec3};
use stick3d_figure::figure::Limb;

use super::gaussian::Gaussian;
use super::marks::JointMark;
use super::noise;
use super::proposal::{Body, Drawn};
use super::refine::Refiner;
use crate::kernels;

/// How often the body is pulled and looked at again.
const STEPS: usize = 10;
/// How near joints are to come to where they should be: standard deviation, share of the figure's size.
const NEARNESS: f64 = 0.012;
/// A limb turns farther than answers are usually off.
const REACH: f32 = 5.0;

impl Refiner {
    /// Pulls the body of `start` to where the joints should come to be, writes its latent, and gives the mean square of how
    /// far its joints are from there, square metres.
    pub(super) fn pull_to(
        &mut self,
        start: &[f32],
        goals: &[Vec3],
        body: &mut Body<'_>,
        pulled: &mut [f32],
    ) -> f32 {
        let (rank, size) = (self.slopes.rank(), 3 * goals.len());
        let mut joints = vec![Vec3::ZERO; goals.len()];
        let mut slopes = vec![0.0; size * rank];
        let mut offset = vec![0.0; rank];
        let mut gaussian = Gaussian::new(size);
        let mut goal_offset = vec![0.0; rank];
        pulled.copy_from_slice(start);
        write_joints(body, pulled, &mut joints);
        let mut least = mean_square(&joints, goals);
        for _ in 0..STEPS {
            write_joints(body, pulled, &mut joints);
            let features = body.layer.features(body.head.output(), body.scratch);
            self.slopes
                .write(body.head, body.layer, features, body.rows, 3, &mut slopes);
            let row = |i: usize| &slopes[i * rank..][..rank];
            let difference: Vec<f64> = (0..size)
                .map(|i| {
                    let off = goals[i / 3][i % 3] - joints[i / 3][i % 3];
                    f64::from(off + kernels::dot(row(i), &offset))
                })
                .collect();
            let nearness = (NEARNESS * self.measurement.skeleton.size_m()).powi(2);
            for (at, entry) in gaussian.covariance().iter_mut().enumerate() {
                let (i, j) = (at / size, at % size);
                *entry = f64::from(REACH * REACH * kernels::dot(row(i), row(j)));
                if i == j {
                    *entry += nearness;
                }
            }
            gaussian.factorise();
            goal_offset.fill(0.0);
            for (i, pull) in gaussian.solve(&difference).iter().enumerate() {
                for (offset, slope) in goal_offset.iter_mut().zip(row(i)) {
                    *offset += REACH * REACH * *pull as f32 * slope;
                }
            }
            // A whole step may lead too far on so long a way.
            let from = offset.clone();
            let nearer = [1.0, 0.5, 0.25, 0.1].into_iter().find(|share| {
                for ((offset, from), to) in offset.iter_mut().zip(&from).zip(&goal_offset) {
                    *offset = from + share * (to - from);
                }
                pulled.copy_from_slice(start);
                kernels::accumulate(&offset, &self.measurement.ways, pulled);
                write_joints(body, pulled, &mut joints);
                let off = mean_square(&joints, goals);
                let is_nearer = off < least;
                least = least.min(off);
                is_nearer
            });
            if nearer.is_none() {
                pulled.copy_from_slice(start);
                kernels::accumulate(&from, &self.measurement.ways, pulled);
                break;
            }
        }
        least
    }
}

/// Mean square of the distance between joints, square metres.
fn mean_square(joints: &[Vec3], goals: &[Vec3]) -> f32 {
    let squares = joints
        .iter()
        .zip(goals)
        .map(|(a, b)| a.distance_squared(*b));
    squares.sum::<f32>() / goals.len().max(1) as f32
}

/// The joints of a latent, metres.
pub(super) fn write_joints(body: &mut Body<'_>, latent: &[f32], joints: &mut [Vec3]) {
    let code = body.head.run(latent);
    let features = body.layer.features(code, body.scratch);
    body.rows.write(features, joints);
}

/// Where the joints of a body should come to be: the limb as far before its base as it was behind it, all on the sketch plane
/// where they are drawn.
pub(super) fn goals_of(joints: &[Vec3], limb: &Limb, drawn: Drawn<'_>) -> Vec<Vec3> {
    let flat: Vec<Vec2> = joints.iter().map(|joint| joint.truncate()).collect();
    let mut aligned = flat.clone();
    noise::align(drawn.points, drawn.marks, &flat, &mut aligned);
    let base = joints[limb.base].z;
    let depth = |joint: usize| match limb.joints.contains(&joint) {
        true => 2.0 * base - joints[joint].z,
        false => joints[joint].z,
    };
    let place = |joint: usize| match drawn.marks[joint] {
        JointMark::Guessed => flat[joint],
        JointMark::Drawn | JointMark::Pinned => aligned[joint],
    };
    (0..joints.len())
        .map(|joint| place(joint).extend(depth(joint)))
        .collect()
}
