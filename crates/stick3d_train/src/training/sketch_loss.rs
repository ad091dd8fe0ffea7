//! What is minimised in Encoder2D: several latents for a sketch, of which the nearest is led.
//!
//! A drawing says nothing about depth, so one latent for it lies between the bodies that it may mean. With several, the one
//! whose body is nearest to the body drawn learns from it, the others only a little ("winner takes most":
//! [Rupprecht et al. 2017](https://arxiv.org/abs/1612.00197), section 3), and a score for each learns which one that will be.
//! All have to fit the drawing and to have bones of the right length.

use burn::tensor::activation::log_softmax;
use burn::tensor::{Int, Tensor, TensorData};
use stick3d_model::network::Mlp;

use super::losses::{Loss, Losses, Points, Tensors, Terms, length};
use super::networks::Networks;
use super::tape::Tape;
use super::{LossWeights, TrainError};

/// How the hypotheses of one step are treated.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Relaxation {
    /// How much those learn that are not the nearest, against the nearest's 1.
    pub(crate) share: f64,
    /// One hypothesis of each sketch that learns so, whichever is nearest.
    pub(crate) others: Vec<usize>,
}

/// Distances between decoded and true bodies, each a mean over everything.
struct Distances {
    /// Vertices, centimetres.
    vertices: Tensor<1>,
    /// Joints, centimetres.
    joints: Tensor<1>,
    /// Joints on the sketch plane, centimetres.
    reprojection: Tensor<1>,
    /// Lengths of bones, per cent.
    bones: Tensor<1>,
}

impl Losses {
    /// Equation 2, and how far the body decoded from the sketch is from the body drawn.
    pub(crate) fn sketch(
        &self,
        networks: &Networks,
        target_mean: Tensor<2>,
        batch: &Tensors,
        relaxation: &Relaxation,
        tape: &mut Tape,
    ) -> Result<(Loss, Terms), TrainError> {
        let output = networks.encoder2d.forward(batch.inputs.clone());
        let head = &networks.vae.head;
        let [_, latent_len] = target_mean.dims();
        let [_, width] = output.dims();
        if width == latent_len {
            return self.nearest(head, output, target_mean, batch, tape);
        }
        let count = width / (latent_len + 1);
        let [len, _] = output.dims();
        let latents = output
            .clone()
            .narrow(1, 0, count * latent_len)
            .reshape([len, count, latent_len]);
        let scores = output.narrow(1, count * latent_len, count);
        let winners = self.winners(head, latents.clone(), batch)?;
        let winner = pick(&latents, winners.clone());
        let (loss, mut terms) = self.nearest(head, winner, target_mean, batch, tape)?;

        let others = relaxation.others.iter().map(|h| *h as i64).collect();
        let others = Tensor::<2, Int>::from_data(
            TensorData::new::<i64, _>(others, [len, 1]),
            &latents.device(),
        );
        let found = self.points(head.forward(pick(&latents, others)), Some(tape))?;
        let other = distances(found, &batch.truth);
        let weights = self.weights;
        let miss = -log_softmax(scores, 1).gather(1, winners).mean();
        terms.push((
            "others_reprojection_cm",
            other.reprojection.clone().detach(),
        ));
        terms.push(("score", miss.clone().detach()));
        let of_others = Loss {
            of_points: (other.vertices * weights.vertices + other.joints * weights.joints)
                * relaxation.share
                + other.reprojection * weights.reprojection
                + other.bones * weights.bones,
            of_codes: miss * weights.score,
        };
        Ok((loss.plus(of_others, 1.0), terms))
    }

    /// The loss of one latent for each sketch.
    fn nearest(
        &self,
        head: &Mlp,
        latent: Tensor<2>,
        target_mean: Tensor<2>,
        batch: &Tensors,
        tape: &mut Tape,
    ) -> Result<(Loss, Terms), TrainError> {
        let equation_2 = (latent.clone() - target_mean).square().mean();
        let points = self.points(head.forward(latent), Some(tape))?;
        let found = distances(points, &batch.truth);
        let LossWeights {
            latent,
            vertices,
            joints,
            reprojection,
            bones,
            ..
        } = self.weights;
        let loss = Loss {
            of_points: found.vertices.clone() * vertices
                + found.joints.clone() * joints
                + found.reprojection.clone() * reprojection
                + found.bones.clone() * bones,
            of_codes: equation_2.clone() * latent,
        };
        let terms = vec![
            ("latent", equation_2.detach()),
            ("vertices_cm", found.vertices.detach()),
            ("joints_cm", found.joints.detach()),
            ("reprojection_cm", found.reprojection.detach()),
            ("bones_percent", found.bones.detach()),
        ];
        Ok((loss, terms))
    }

    /// Which of the latents `[batch, hypotheses, latent_len]` have their joints nearest to the truth, `[batch, 1]`. Not
    /// differentiated.
    fn winners(
        &self,
        head: &Mlp,
        latents: Tensor<3>,
        batch: &Tensors,
    ) -> Result<Tensor<2, Int>, TrainError> {
        use burn::module::Module as _;
        let [len, count, latent_len] = latents.dims();
        let head = head.clone().no_grad();
        let codes = head.forward(latents.detach().reshape([len * count, latent_len]));
        let found = self.joints(codes)?;
        let [_, _, joints] = found.dims();
        let truth = batch.truth.joints.clone().detach();
        let truth = truth.reshape([len, 1, 3 * joints]);
        let difference = found.reshape([len, count, 3 * joints]) - truth;
        let distances = length(difference.reshape([len * count, 3, joints])).mean_dim(2);
        Ok(distances.reshape([len, count]).argmin(1))
    }
}

/// One latent of each sketch, `[batch, latent_len]`; `indices`: `[batch, 1]`.
fn pick(latents: &Tensor<3>, indices: Tensor<2, Int>) -> Tensor<2> {
    let [len, _, latent_len] = latents.dims();
    let indices = indices.reshape([len, 1, 1]).repeat_dim(2, latent_len);
    latents
        .clone()
        .gather(1, indices)
        .reshape([len, latent_len])
}

fn distances(found: Points, truth: &Points) -> Distances {
    let difference = found.joints - truth.joints.clone();
    let lengths = length(truth.bones.clone());
    Distances {
        vertices: length(found.probes - truth.probes.clone()).mean() * 100.0,
        reprojection: length(difference.clone().narrow(1, 0, 2)).mean() * 100.0,
        joints: length(difference).mean() * 100.0,
        bones: ((length(found.bones) - lengths.clone()).abs() / lengths).mean() * 100.0,
    }
}
