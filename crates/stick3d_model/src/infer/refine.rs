//! Pulls the bodies that Encoder2D proposes onto the drawing.
//!
//! Each proposal is a normal distribution of latents: around Encoder2D's answer, as wide as its answers were off in training.
//! The drawing is a measurement of the body's projected joints, with the errors of [`noise`](super::noise). Gauss and Newton's
//! steps on what is both likely and drawn are then those of an iterated Kalman filter ([Bell and Cathey
//! 1993](https://doi.org/10.1109/9.250476)): a step costs one pass through the head forward, one backward per joint and axis,
//! and a linear system of as many numbers as a drawing has. How badly the drawing is drawn is what makes it likeliest under
//! all proposals; so exact drawings are followed closely, and crooked ones only in what a body can do. Where it may be either,
//! the answers are in between, as likely as each is.

use stick3d_figure::figure::Figure;

use super::hypotheses::Hypotheses;
use super::marks::JointMark;
use super::measurement::Measurement;
use super::noise::{CROOKED, EXACT, Noise, exactness};
use super::proposal::{Body, Drawn, Proposal};
use super::slope::Slopes;
use crate::final_layer::FinalLayer;
use crate::weights::MlpWeights;

/// How often bodies are pulled and looked at again.
const STEPS: usize = 3;
/// What is less likely is not looked at.
const UNLIKELY: f64 = 0.02;

/// Memory for the bodies that one drawing may mean.
#[derive(Debug, Clone)]
pub(super) struct Refiner {
    pub(super) slopes: Slopes,
    pub(super) measurement: Measurement,
    /// What they are if the drawing is crooked; where it may be either, in between.
    crooked: Vec<Proposal>,
    /// What they are if it is exact.
    exact: Vec<Proposal>,
    /// See [`exact_from`](crate::latent::TrainingStatistics::exact_from).
    exact_from: f64,
}

/// How badly a drawing is drawn, as its proposals see it.
pub(super) struct Judged {
    /// How, if it is crooked.
    crooked: Noise,
    /// The logarithm of how much likelier it is as an exact drawing than as that crooked one.
    pub(super) exact_over_crooked: f64,
}

impl Refiner {
    /// `ways`: `[rank][latent_len]`, the ways in which Encoder2D's answers are off, each as long as it is usual; `hypotheses`:
    /// the most there are of one drawing.
    pub(super) fn new(
        figure: &Figure,
        head: &MlpWeights,
        layer: &FinalLayer,
        ways: &[f32],
        exact_from: f32,
        hypotheses: usize,
    ) -> Self {
        let slopes = Slopes::new(head, layer, ways);
        let measurement = Measurement::new(figure, ways);
        let latent_len = head.layers.first().map_or(0, |layer| layer.input_len);
        let bones = measurement.skeleton.bone_count();
        let proposal = Proposal::new(latent_len, figure.joint_count(), bones, slopes.rank());
        Self {
            slopes,
            measurement,
            crooked: vec![proposal.clone(); hypotheses + 1],
            exact: vec![proposal; hypotheses + 1],
            exact_from: f64::from(exact_from),
        }
    }

    /// How many of the hypotheses are looked at.
    fn looked_at(&self, hypotheses: &Hypotheses<'_>) -> usize {
        hypotheses.len().min(self.crooked.len() - 1)
    }

    /// How many proposals there are: one per hypothesis, and where those are several, their mean.
    fn count(&self, hypotheses: &Hypotheses<'_>) -> usize {
        let several = self.looked_at(hypotheses);
        several + usize::from(several > 1)
    }

    /// Puts proposals at Encoder2D's answers, the last of several at their mean.
    fn begin(&mut self, hypotheses: &Hypotheses<'_>, drawn: Drawn<'_>, body: &mut Body<'_>) {
        let (several, count) = (self.looked_at(hypotheses), self.count(hypotheses));
        for (index, proposal) in self.crooked[..count].iter_mut().enumerate() {
            proposal.begin(|start| match index < several {
                true => start.copy_from_slice(hypotheses.latent(index)),
                false => hypotheses.write_mean(start),
            });
            proposal.look(body, drawn);
            proposal.differentiate(body, &mut self.slopes);
            proposal.gather(&self.measurement.skeleton, drawn.marks);
        }
    }

    /// How badly a drawing is drawn: whatever makes it likeliest under all proposals.
    pub(super) fn judge(
        &mut self,
        hypotheses: &Hypotheses<'_>,
        drawn: Drawn<'_>,
        body: &mut Body<'_>,
    ) -> Judged {
        self.begin(hypotheses, drawn, body);
        let proposals = &self.crooked[..self.count(hypotheses)];
        let measurement = &mut self.measurement;
        let mut evidence = |noise| measurement.evidence(proposals, hypotheses, noise, drawn.marks);
        let mut crooked = (f64::NEG_INFINITY, CROOKED[0]);
        for noise in CROOKED {
            let likely = evidence(noise);
            if likely > crooked.0 {
                crooked = (likely, noise);
            }
        }
        Judged {
            crooked: crooked.1,
            exact_over_crooked: evidence(EXACT) - crooked.0,
        }
    }

    /// The bodies, pulled onto the drawing, in the order of the hypotheses.
    pub(super) fn refine(
        &mut self,
        hypotheses: &Hypotheses<'_>,
        drawn: Drawn<'_>,
        body: &mut Body<'_>,
    ) -> &[Proposal] {
        let judged = self.judge(hypotheses, drawn, body);
        let mut exactness = exactness(judged.exact_over_crooked - self.exact_from);
        let count = self.count(hypotheses);
        let measurement = &mut self.measurement;
        let (crooked, exact) = (&mut self.crooked[..count], &mut self.exact[..count]);
        if drawn.marks.contains(&JointMark::Pinned) {
            // A body between two that hold a joint need not hold it.
            exactness = exactness.round();
        }
        if exactness > UNLIKELY {
            for (proposal, begun) in exact.iter_mut().zip(crooked.iter()) {
                proposal.copy_from(begun);
                // Close to an exact drawing slopes may be quite others than where Encoder2D's answer was.
                measurement.pull(proposal, EXACT, drawn.marks);
                proposal.look(body, drawn);
                proposal.differentiate(body, &mut self.slopes);
                proposal.strains.fill(1.0);
            }
            settle(exact, hypotheses, EXACT, measurement, drawn, body);
        }
        if exactness >= 1.0 - UNLIKELY {
            return exact;
        }
        settle(
            crooked,
            hypotheses,
            judged.crooked,
            measurement,
            drawn,
            body,
        );
        if exactness > UNLIKELY {
            for (proposal, exact) in crooked.iter_mut().zip(exact) {
                proposal.come_nearer(exact, exactness as f32);
                proposal.look(body, drawn);
            }
        }
        crooked
    }
}

/// Pulls bodies onto the drawing, and says how likely each is.
fn settle(
    proposals: &mut [Proposal],
    hypotheses: &Hypotheses<'_>,
    noise: Noise,
    measurement: &mut Measurement,
    drawn: Drawn<'_>,
    body: &mut Body<'_>,
) {
    for (index, proposal) in proposals.iter_mut().enumerate() {
        // The slopes hardly change on so short a way, and cost most.
        for _ in 0..STEPS {
            proposal.log_weight = noise.trust * measurement.pull(proposal, noise, drawn.marks)
                + f64::from(hypotheses.log_probability(index));
            proposal.look(body, drawn);
        }
    }
}
