//! The same body with one limb's depth the other way round.

use glam::{Vec2, Vec3};
use stick3d_figure::figure::Limb;

use super::gaussian::Gaussian;
use super::noise;
use super::refine::{Body, Refiner};
use crate::kernels;

/// How often the body is pulled and looked at again.
const STEPS: usize = 5;
/// How near joints are to come to where they should be: standard deviation, share of the figure's size.
const NEARNESS: f64 = 0.008;
/// A limb turns farther than answers are usually off.
const REACH: f32 = 5.0;

impl Refiner {
    /// Writes the latent of the body that is as that of `latent`, but for a limb, whose joints are as far before its base as
    /// they were behind it; on the sketch plane its joints are where they are drawn.
    pub(super) fn flip(
        &mut self,
        latent: &[f32],
        limb: &Limb,
        drawn: &[Vec2],
        body: &mut Body<'_>,
        flipped: &mut [f32],
    ) {
        let count = drawn.len();
        let (rank, size) = (self.slopes.rank(), 3 * count);
        let mut joints = vec![Vec3::ZERO; count];
        let mut slopes = vec![0.0; size * rank];
        let mut offset = vec![0.0; rank];
        let mut gaussian = Gaussian::new(size);
        flipped.copy_from_slice(latent);
        let mut goals = None;
        for _ in 0..STEPS {
            body.head.run(flipped);
            let features = body.layer.features(body.head.output(), body.scratch);
            body.rows.write(features, &mut joints);
            let goals = goals.get_or_insert_with(|| goals_of(&joints, limb, drawn));
            self.slopes
                .write(body.head, body.layer, features, body.rows, 3, &mut slopes);
            let difference: Vec<f64> = (0..size)
                .map(|i| {
                    let off = goals[i / 3][i % 3] - joints[i / 3][i % 3];
                    let back = kernels::dot(&slopes[i * rank..][..rank], &offset);
                    f64::from(off + back)
                })
                .collect();
            let nearness = (NEARNESS * self.skeleton.size_m()).powi(2);
            for (at, entry) in gaussian.covariance().iter_mut().enumerate() {
                let (i, j) = (at / size, at % size);
                let row = |i: usize| &slopes[i * rank..][..rank];
                *entry = f64::from(REACH * REACH * kernels::dot(row(i), row(j)));
                if i == j {
                    *entry += nearness;
                }
            }
            gaussian.factorise();
            offset.fill(0.0);
            let solved = gaussian.solve(&difference);
            for (slope, pull) in slopes.chunks_exact(rank).zip(solved) {
                for (offset, slope) in offset.iter_mut().zip(slope) {
                    *offset += REACH * REACH * *pull as f32 * slope;
                }
            }
            flipped.copy_from_slice(latent);
            kernels::accumulate(&offset, &self.ways, flipped);
        }
    }
}

/// Where the joints should come to be.
fn goals_of(joints: &[Vec3], limb: &Limb, drawn: &[Vec2]) -> Vec<Vec3> {
    let flat: Vec<Vec2> = joints.iter().map(|joint| joint.truncate()).collect();
    let mut aligned = flat.clone();
    noise::align(drawn, &flat, &mut aligned);
    let base = joints[limb.base].z;
    let depth = |joint: usize| match limb.joints.contains(&joint) {
        true => 2.0 * base - joints[joint].z,
        false => joints[joint].z,
    };
    (0..joints.len())
        .map(|joint| aligned[joint].extend(depth(joint)))
        .collect()
}
