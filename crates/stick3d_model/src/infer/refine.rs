//! Pulls the bodies that Encoder2D proposes onto the drawing.
//!
//! Each proposal is a normal distribution of latents: around Encoder2D's answer, as wide as its answers were off in training.
//! The drawing is a measurement of the body's projected joints, with the errors of [`noise`](super::noise). Gauss and Newton's
//! steps on what is both likely and drawn are then those of an iterated Kalman filter ([Bell and Cathey
//! 1993](https://doi.org/10.1109/9.250476)): a step costs one pass through the head forward, one backward per joint and axis,
//! and a linear system of as many numbers as a drawing has. How badly the drawing is drawn is what makes it likeliest under
//! all proposals; so exact drawings are followed closely, and crooked ones only in what a body can do.

use glam::{Vec2, Vec3};
use stick3d_figure::figure::Figure;

use super::gaussian::Gaussian;
use super::hypotheses::Hypotheses;
use super::joint_map::JointRows;
use super::marks::JointMark;
use super::noise::{self, LEVELS, Noise, Skeleton};
use super::perceptron::Perceptron;
use super::slope::Slopes;
use crate::final_layer::{FinalLayer, FinalScratch};
use crate::kernels;
use crate::weights::MlpWeights;

/// How often bodies are pulled and looked at again.
const STEPS: usize = 3;

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
    flat: Vec<Vec2>,
    /// The drawing, moved and scaled onto it.
    aligned: Vec<Vec2>,
    /// `[joint][2][rank]`.
    slopes: Vec<f32>,
    /// `slopes` times its transpose, `[joint, axis]` by `[joint, axis]`.
    spread: Vec<f64>,
    /// `spread`, and that the drawing is anywhere and of any size.
    placed: Vec<f64>,
    /// See [`Skeleton::write_bones`].
    bones: Vec<f64>,
    /// See [`Skeleton::write_bones`].
    strains: Vec<f64>,
    /// The logarithm of its probability, up to a constant of the drawing.
    pub(super) log_weight: f64,
}

/// Memory for the bodies that one drawing may mean.
#[derive(Debug, Clone)]
pub(super) struct Refiner {
    /// `[rank][latent_len]`: the ways in which Encoder2D's answers are off, each as long as it is usual.
    pub(super) ways: Vec<f32>,
    pub(super) slopes: Slopes,
    pub(super) skeleton: Skeleton,
    gaussian: Gaussian,
    difference: Vec<f64>,
    proposals: Vec<Proposal>,
    count: usize,
}

impl Proposal {
    fn new(latent_len: usize, joints: usize, bones: usize, rank: usize) -> Self {
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

    /// Its joints, and the drawing aligned with them.
    fn look(&mut self, body: &mut Body<'_>, drawn: Drawn<'_>) {
        let code = body.head.run(&self.latent);
        let features = body.layer.features(code, body.scratch);
        body.rows.write(features, &mut self.joints);
        for (flat, joint) in self.flat.iter_mut().zip(&self.joints) {
            *flat = joint.truncate();
        }
        noise::align(drawn.points, drawn.marks, &self.flat, &mut self.aligned);
    }

    /// How its joints move with the latent. Right after [`Proposal::look`].
    fn differentiate(&mut self, body: &mut Body<'_>, slopes: &mut Slopes) {
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
    fn gather(&mut self, skeleton: &Skeleton, marks: &[JointMark]) {
        self.placed.copy_from_slice(&self.spread);
        skeleton.add_place(&self.flat, &mut self.placed);
        skeleton.write_bones(&self.flat, &self.strains, marks, &mut self.bones);
    }

    /// The drawing minus what is expected of it at [`Proposal::start`], as seen from here.
    fn write_difference(&self, rank: usize, difference: &mut [f64]) {
        let differences = difference.iter_mut().zip(self.slopes.chunks_exact(rank));
        for (i, (out, slope)) in differences.enumerate() {
            let (joint, axis) = (i / 2, i % 2);
            let back = kernels::dot(slope, &self.offset);
            *out = f64::from(self.aligned[joint][axis] - self.flat[joint][axis] + back);
        }
    }
}

impl Refiner {
    /// `ways`: `[rank][latent_len]`; `hypotheses`: the most there are of one drawing.
    pub(super) fn new(
        figure: &Figure,
        head: &MlpWeights,
        layer: &FinalLayer,
        ways: &[f32],
        hypotheses: usize,
    ) -> Self {
        let slopes = Slopes::new(head, layer, ways);
        let skeleton = Skeleton::new(figure, figure.template_extent_m());
        let latent_len = head.layers.first().map_or(0, |layer| layer.input_len);
        let joints = figure.joint_count();
        let proposal = Proposal::new(latent_len, joints, skeleton.bone_count(), slopes.rank());
        Self {
            ways: ways.to_vec(),
            slopes,
            skeleton,
            gaussian: Gaussian::new(2 * joints),
            difference: vec![0.0; 2 * joints],
            proposals: vec![proposal; hypotheses + 1],
            count: 0,
        }
    }

    /// The bodies, pulled onto the drawing, in the order of the hypotheses.
    pub(super) fn refine(
        &mut self,
        hypotheses: &Hypotheses<'_>,
        drawn: Drawn<'_>,
        body: &mut Body<'_>,
    ) -> &mut [Proposal] {
        let several = hypotheses.len().min(self.proposals.len() - 1);
        self.count = several + usize::from(several > 1);
        for (index, proposal) in self.proposals[..self.count].iter_mut().enumerate() {
            if index < several {
                proposal.start.copy_from_slice(hypotheses.latent(index));
            } else {
                hypotheses.write_mean(&mut proposal.start);
            }
            proposal.latent.copy_from_slice(&proposal.start);
            proposal.offset.fill(0.0);
            proposal.strains.fill(1.0);
            proposal.look(body, drawn);
            proposal.differentiate(body, &mut self.slopes);
            proposal.gather(&self.skeleton, drawn.marks);
        }
        let noise = self.noise(hypotheses, drawn.marks);
        for index in 0..self.count {
            // The slopes hardly change on so short a way, and cost most.
            for _ in 0..STEPS {
                self.pull(index, noise, drawn.marks);
                self.proposals[index].look(body, drawn);
            }
            let proposal = &mut self.proposals[index];
            proposal.log_weight =
                noise.trust * proposal.log_weight + f64::from(hypotheses.log_probability(index));
        }
        &mut self.proposals[..self.count]
    }

    /// How badly the drawing is drawn: what makes it likeliest.
    fn noise(&mut self, hypotheses: &Hypotheses<'_>, marks: &[JointMark]) -> Noise {
        let mut best = (f64::NEG_INFINITY, LEVELS[0]);
        for level in LEVELS {
            let mut highest = f64::NEG_INFINITY;
            let mut sum = 0.0;
            for index in 0..self.count {
                self.expect(index, level, marks);
                let density = self.gaussian.log_density(&self.difference);
                let weight = density + f64::from(hypotheses.log_probability(index));
                // The logarithm of a sum of exponentials, without overflow.
                if weight > highest {
                    sum = sum * (highest - weight).exp() + 1.0;
                    highest = weight;
                } else {
                    sum += (weight - highest).exp();
                }
            }
            let evidence = highest + sum.ln();
            if evidence > best.0 {
                best = (evidence, level);
            }
        }
        best.1
    }

    /// What the drawing of a proposal is expected to be off, and what it is off.
    fn expect(&mut self, index: usize, noise: Noise, marks: &[JointMark]) {
        let proposal = &self.proposals[index];
        let variance = noise.bone * noise.bone;
        let entries = proposal.placed.iter().zip(&proposal.bones);
        let covariance = self.gaussian.covariance();
        for (out, (placed, bones)) in covariance.iter_mut().zip(entries) {
            *out = placed + variance * bones;
        }
        let size = self.difference.len();
        let diagonal = covariance.iter_mut().step_by(size + 1);
        for (axis, entry) in diagonal.enumerate() {
            *entry += self.skeleton.joint_variance(noise, marks[axis / 2]);
        }
        self.gaussian.factorise();
        proposal.write_difference(self.slopes.rank(), &mut self.difference);
    }

    /// Moves a proposal to where it is likeliest, as seen from where it is.
    fn pull(&mut self, index: usize, noise: Noise, marks: &[JointMark]) {
        self.proposals[index].gather(&self.skeleton, marks);
        self.expect(index, noise, marks);
        let solved = self.gaussian.solve(&self.difference);
        let proposal = &mut self.proposals[index];
        self.skeleton
            .update_strains(noise, &proposal.flat, solved, &mut proposal.strains);
        proposal.gather(&self.skeleton, marks);
        self.expect(index, noise, marks);
        let proposal = &mut self.proposals[index];
        proposal.log_weight = self.gaussian.log_density(&self.difference);
        let solved = self.gaussian.solve(&self.difference);
        proposal.offset.fill(0.0);
        for (slope, pull) in proposal.slopes.chunks_exact(self.slopes.rank()).zip(solved) {
            for (offset, slope) in proposal.offset.iter_mut().zip(slope) {
                *offset += *pull as f32 * slope;
            }
        }
        proposal.latent.copy_from_slice(&proposal.start);
        kernels::accumulate(&proposal.offset, &self.ways, &mut proposal.latent);
    }
}
