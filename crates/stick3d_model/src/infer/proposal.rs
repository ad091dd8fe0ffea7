//! A body on its way to the drawing.

use glam::{Vec2, Vec3};

use super::joint_map::JointRows;
use super::marks::JointMark;
use super::noise::{self, Skeleton};
use super::perceptron::Perceptron;
use super::slope::Slopes;
use crate::final_layer::{FinalLayer, FinalScratch};
use crate::kernels;

/// The parts of a model that a body's joints come from.
pub(super) struct Body<'a> {
    pub(super) head: &'a mut Perceptron,
    pub(super) layer: &'a FinalLayer,
    pub(super) scratch: &'a mut FinalScratch,
    pub(super) rows: &'a JointRows,
}

/// What was drawn: one of each per joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drawn<'a> {
    pub(super) points: &'a [Vec2],
    pub(super) marks: &'a [JointMark],
}

/// A body on its way to the drawing.
#[derive(Debug, Clone)]
pub(super) struct Proposal {
    /// Encoder2D's answer.
    start: Vec<f32>,
    /// How far it is from there along each way.
    offset: Vec<f32>,
    /// Where it is.
    pub(super) latent: Vec<f32>,
    /// Its joints, metres.
    pub(super) joints: Vec<Vec3>,
    /// Its joints on the sketch plane.
    pub(super) flat: Vec<Vec2>,
    /// The drawing, moved and scaled onto it.
    aligned: Vec<Vec2>,
    /// `[joint][2][rank]`.
    slopes: Vec<f32>,
    /// `slopes` times its transpose, `[joint, axis]` by `[joint, axis]`.
    spread: Vec<f64>,
    /// `spread`, and that the drawing is anywhere and of any size.
    pub(super) placed: Vec<f64>,
    /// See [`Skeleton::write_bones`].
    pub(super) bones: Vec<f64>,
    /// See [`Skeleton::write_bones`].
    pub(super) strains: Vec<f64>,
    /// The logarithm of its probability, up to a constant of the drawing.
    pub(super) log_weight: f64,
}

impl Proposal {
    pub(super) fn new(latent_len: usize, joints: usize, bones: usize, rank: usize) -> Self {
        let size = 2 * joints;
        Self {
            start: vec![0.0; latent_len],
            offset: vec![0.0; rank],
            latent: vec![0.0; latent_len],
            joints: vec![Vec3::ZERO; joints],
            flat: vec![Vec2::ZERO; joints],
            aligned: vec![Vec2::ZERO; joints],
            slopes: vec![0.0; size * rank],
            spread: vec![0.0; size * size],
            placed: vec![0.0; size * size],
            bones: vec![0.0; size * size],
            strains: vec![1.0; bones],
            log_weight: 0.0,
        }
    }

    /// Puts it at a latent of Encoder2D's, `[latent_len]`.
    pub(super) fn begin(&mut self, write_start: impl FnOnce(&mut [f32])) {
        write_start(&mut self.start);
        self.latent.copy_from_slice(&self.start);
        self.offset.fill(0.0);
        self.strains.fill(1.0);
    }

    /// Makes it as another one is, in the memory that it has.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let Self {
            start,
            offset,
            latent,
            joints,
            flat,
            aligned,
            slopes,
            spread,
            placed,
            bones,
            strains,
            log_weight,
        } = self;
        start.clone_from(&other.start);
        offset.clone_from(&other.offset);
        latent.clone_from(&other.latent);
        joints.clone_from(&other.joints);
        flat.clone_from(&other.flat);
        aligned.clone_from(&other.aligned);
        slopes.clone_from(&other.slopes);
        spread.clone_from(&other.spread);
        placed.clone_from(&other.placed);
        bones.clone_from(&other.bones);
        strains.clone_from(&other.strains);
        *log_weight = other.log_weight;
    }

    /// Its joints, and the drawing aligned with them.
    pub(super) fn look(&mut self, body: &mut Body<'_>, drawn: Drawn<'_>) {
        let code = body.head.run(&self.latent);
        let features = body.layer.features(code, body.scratch);
        body.rows.write(features, &mut self.joints);
        for (flat, joint) in self.flat.iter_mut().zip(&self.joints) {
            *flat = joint.truncate();
        }
        noise::align(drawn.points, drawn.marks, &self.flat, &mut self.aligned);
    }

    /// How its joints move with the latent. Right after [`Proposal::look`].
    pub(super) fn differentiate(&mut self, body: &mut Body<'_>, slopes: &mut Slopes) {
        let features = body.layer.features(body.head.output(), body.scratch);
        slopes.write(
            body.head,
            body.layer,
            features,
            body.rows,
            2,
            &mut self.slopes,
        );
        let (rank, size) = (slopes.rank(), 2 * self.joints.len());
        for i in 0..size {
            for j in 0..=i {
                let row = |i: usize| &self.slopes[i * rank..][..rank];
                let dot = kernels::dot(row(i), row(j));
                self.spread[i * size + j] = f64::from(dot);
                self.spread[j * size + i] = f64::from(dot);
            }
        }
    }

    /// What the drawing's covariance is made of, as seen from here.
    pub(super) fn gather(&mut self, skeleton: &Skeleton, marks: &[JointMark]) {
        self.placed.copy_from_slice(&self.spread);
        skeleton.add_place(&self.flat, &mut self.placed);
        skeleton.write_bones(&self.flat, &self.strains, marks, &mut self.bones);
    }

    /// The drawing minus what is expected of it at [`Proposal::start`], as seen from here.
    pub(super) fn write_difference(&self, difference: &mut [f64]) {
        let rank = self.offset.len();
        let differences = difference.iter_mut().zip(self.slopes.chunks_exact(rank));
        for (i, (out, slope)) in differences.enumerate() {
            let (joint, axis) = (i / 2, i % 2);
            let back = kernels::dot(slope, &self.offset);
            *out = f64::from(self.aligned[joint][axis] - self.flat[joint][axis] + back);
        }
    }

    /// Puts it where pulls on the drawn coordinates bring it. `pulls`: `[joint, axis]`; `ways`: `[rank][latent_len]`.
    pub(super) fn move_by(&mut self, pulls: &[f64], ways: &[f32]) {
        let rank = self.offset.len();
        self.offset.fill(0.0);
        for (slope, pull) in self.slopes.chunks_exact(rank).zip(pulls) {
            for (offset, slope) in self.offset.iter_mut().zip(slope) {
                *offset += *pull as f32 * slope;
            }
        }
        self.latent.copy_from_slice(&self.start);
        kernels::accumulate(&self.offset, ways, &mut self.latent);
    }

    /// Goes a share of the way to what it is in an exact drawing. That tells answers apart far better, so its word counts only
    /// where exactness is nearly sure.
    pub(super) fn come_nearer(&mut self, exact: &Self, exactness: f32) {
        for (x, exact) in self.latent.iter_mut().zip(&exact.latent) {
            *x += exactness * (exact - *x);
        }
        self.log_weight += f64::from(exactness).powi(3) * (exact.log_weight - self.log_weight);
    }
}
