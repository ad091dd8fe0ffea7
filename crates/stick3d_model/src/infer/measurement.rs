//! What a drawing says of a proposal: how likely it makes it, and where it pulls it.

use stick3d_figure::figure::Figure;

use super::gaussian::Gaussian;
use super::hypotheses::Hypotheses;
use super::marks::JointMark;
use super::noise::{Noise, Skeleton};
use super::proposal::Proposal;

/// A drawing as a measurement of a body's projected joints, with the memory for it.
#[derive(Debug, Clone)]
pub(super) struct Measurement {
    /// `[rank][latent_len]`: the ways in which Encoder2D's answers are off, each as long as it is usual.
    pub(super) ways: Vec<f32>,
    pub(super) skeleton: Skeleton,
    gaussian: Gaussian,
    difference: Vec<f64>,
}

impl Measurement {
    /// `ways`: `[rank][latent_len]`.
    pub(super) fn new(figure: &Figure, ways: &[f32]) -> Self {
        let size = 2 * figure.joint_count();
        Self {
            ways: ways.to_vec(),
            skeleton: Skeleton::new(figure, figure.template_extent_m()),
            gaussian: Gaussian::new(size),
            difference: vec![0.0; size],
        }
    }

    /// The logarithm of how likely a drawing so badly drawn is under all proposals, which are gathered, up to a constant.
    pub(super) fn evidence(
        &mut self,
        proposals: &[Proposal],
        hypotheses: &Hypotheses<'_>,
        noise: Noise,
        marks: &[JointMark],
    ) -> f64 {
        let (mut highest, mut sum) = (f64::NEG_INFINITY, 0.0);
        for (index, proposal) in proposals.iter().enumerate() {
            self.expect(proposal, noise, marks);
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
        highest + f64::ln(sum)
    }

    /// Moves a proposal to where it is likeliest, as seen from where it is, and gives the logarithm of the density of the
    /// drawing, up to a constant. It has to be looked at after that.
    pub(super) fn pull(
        &mut self,
        proposal: &mut Proposal,
        noise: Noise,
        marks: &[JointMark],
    ) -> f64 {
        proposal.gather(&self.skeleton, marks);
        self.expect(proposal, noise, marks);
        let solved = self.gaussian.solve(&self.difference);
        self.skeleton
            .update_strains(noise, &proposal.flat, solved, &mut proposal.strains);
        proposal.gather(&self.skeleton, marks);
        self.expect(proposal, noise, marks);
        let density = self.gaussian.log_density(&self.difference);
        proposal.move_by(self.gaussian.solve(&self.difference), &self.ways);
        density
    }

    /// What the drawing of a gathered proposal is expected to be off, and what it is off.
    fn expect(&mut self, proposal: &Proposal, noise: Noise, marks: &[JointMark]) {
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
        proposal.write_difference(&mut self.difference);
    }
}
