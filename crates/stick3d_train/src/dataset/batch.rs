//! Batches for training: bodies turned at random, and sketches of them.

use glam::{Quat, Vec2, Vec3};
use rand::seq::SliceRandom as _;
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::{Sketch, SketchError};

use super::rotation::turn_coefficients;
use super::{Augmentation, BodySet, Rotations, normal_pair, random};

/// Some turned bodies and the sketches of them, on plain arrays.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// How many.
    pub len: usize,
    /// `[len][3][code_columns]`: see [`Shape`](super::Shape).
    pub codes: Vec<f32>,
    /// `[len][input_len]`: input vectors of the sketches.
    pub inputs: Vec<f32>,
}

/// Makes batches from a set of bodies. Which ones depends on the seed, the epoch and the number of the batch alone.
#[derive(Debug, Clone)]
pub struct Batcher<'a> {
    /// The figure that is drawn.
    pub figure: &'a Figure,
    /// The bodies.
    pub bodies: &'a BodySet,
    /// How they are turned.
    pub rotations: Rotations,
    /// How their sketches are disturbed.
    pub augmentation: Augmentation,
    /// Bodies in a batch.
    pub batch_size: usize,
    /// What the random numbers depend on.
    pub seed: u64,
}

impl Batcher<'_> {
    /// How many batches an epoch has. Bodies that do not fill a batch are left out; other ones each epoch.
    #[must_use]
    pub fn batches_per_epoch(&self) -> usize {
        (self.bodies.len / self.batch_size.max(1)).max(1)
    }

    /// The order in which bodies come in an epoch.
    #[must_use]
    pub fn order(&self, epoch: u64) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.bodies.len).collect();
        order.shuffle(&mut random(self.seed, "order", epoch));
        order
    }

    /// Batch number `index` of an epoch whose order is `order`.
    ///
    /// # Errors
    /// [`SketchError`] when a sketch is degenerate, which bodies are not.
    pub fn batch(&self, epoch: u64, index: usize, order: &[usize]) -> Result<Batch, SketchError> {
        let mut rng = random(self.seed, "batch", (epoch << 24) | index as u64);
        let chosen: Vec<usize> = order
            .iter()
            .cycle()
            .skip(index * self.batch_size)
            .take(self.batch_size)
            .copied()
            .collect();
        let width = self.bodies.codes.len() / self.bodies.len.max(1);
        let input_len = self.figure.input_len();
        let mut batch = Batch {
            len: chosen.len(),
            codes: vec![0.0; chosen.len() * width],
            inputs: vec![0.0; chosen.len() * input_len],
        };
        for (slot, body) in chosen.into_iter().enumerate() {
            let turn = self.rotations.sample(&mut rng);
            let code = &mut batch.codes[slot * width..][..width];
            turn_coefficients(turn, self.bodies.code_of(body), code);
            let joints = self.bodies.joints_of(body);
            let mut drawn = drawn(turn, joints);
            self.augmentation.apply(self.figure, &mut drawn, &mut rng);
            let input = &mut batch.inputs[slot * input_len..][..input_len];
            Sketch::new(self.figure, drawn)?.write_input_vector(self.figure, input)?;
        }
        Ok(batch)
    }

    /// `count` standard normal numbers for batch number `index` of an epoch.
    #[must_use]
    pub fn noise(&self, epoch: u64, index: usize, count: usize) -> Vec<f32> {
        let mut rng = random(self.seed, "noise", (epoch << 24) | index as u64);
        (0..count.div_ceil(2))
            .flat_map(|_| normal_pair(&mut rng))
            .take(count)
            .collect()
    }
}

/// The orthographic projection of turned joints on the sketch plane (paper section 4.1).
pub(crate) fn drawn(turn: Quat, joints: &[Vec3]) -> Vec<Vec2> {
    joints
        .iter()
        .map(|joint| (turn * *joint).truncate())
        .collect()
}
