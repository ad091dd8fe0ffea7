//! How many drawings with strokes in any order are recognised.

use glam::Vec2;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use stick3d_figure::figure::Figure;
use stick3d_figure::simulate::any_order::{Habits, flat_pose, is_readable};
use stick3d_figure::simulate::{Hand, is_recognised};

use crate::dataset::rounded;
use crate::size::relative_size;

/// Attempts at a flat pose that can be read.
const ATTEMPTS: usize = 1000;

/// How many drawings were recognised: every joint within 6 % of the figure's height of where it is meant, left and right
/// by the stated rule ([`recognize_any`](stick3d_figure::recognize_any)).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Recognition {
    /// How many poses were looked at.
    pub poses: usize,
    /// Those whose joints lie apart enough for a flat drawing to say where they are; only these are drawn.
    pub readable: usize,
    /// How many drawings were made of them, each in an order, with directions and pieces of its own.
    pub drawings: usize,
    /// How many of these were recognised.
    pub recognised: usize,
    /// The same of a hundred.
    pub percent: f64,
}

impl Recognition {
    /// Draws a pose (joints on the sketch plane, metres) some times, if it can be read.
    pub(super) fn add(
        &mut self,
        figure: &Figure,
        joints: &[Vec2],
        times: usize,
        rng: &mut ChaCha8Rng,
    ) {
        let joints = of_usual_size(figure, joints);
        self.poses += 1;
        if !is_readable(figure, &joints) {
            return;
        }
        self.readable += 1;
        for _ in 0..times {
            self.drawings += 1;
            let hand = Hand::any_order();
            self.recognised += usize::from(is_recognised(
                figure,
                rng,
                &joints,
                hand,
                Habits::of(figure),
            ));
        }
        self.percent = self.share();
    }

    /// Adds the drawings of another count.
    pub(super) fn merge(&mut self, other: &Self) {
        self.poses += other.poses;
        self.readable += other.readable;
        self.drawings += other.drawings;
        self.recognised += other.recognised;
        self.percent = self.share();
    }

    fn share(&self) -> f64 {
        rounded(100.0 * self.recognised as f64 / self.drawings.max(1) as f64)
    }
}

/// A flat pose of a figure that can be read, metres, if one is found.
pub(super) fn readable_flat_pose(figure: &Figure, rng: &mut ChaCha8Rng) -> Option<Vec<Vec2>> {
    (0..ATTEMPTS)
        .map(|_| flat_pose(figure, rng))
        .find(|pose| is_readable(figure, &of_usual_size(figure, pose)))
}

/// A pose as large as if its figure were of usual size.
fn of_usual_size(figure: &Figure, joints: &[Vec2]) -> Vec<Vec2> {
    let size = relative_size(figure.template_extent_m());
    joints.iter().map(|joint| *joint / size).collect()
}
