//! The several bodies that one drawing may mean, ranked.

use glam::Vec3;
use stick3d_figure::figure::Limb;

/// One body that a drawing may mean.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Alternative {
    /// Its latent, `[latent_len]`.
    pub latent: Vec<f32>,
    /// How likely it is among the alternatives of its drawing; these sum to 1.
    pub probability: f32,
    /// Its joints, metres, the root joint at the origin: one per joint of the figure, in the space of
    /// [`Inference::decode`](super::Inference::decode).
    pub joints: Vec<Vec3>,
}

impl Alternative {
    /// How far the end of a limb is nearer to the viewer than its base, metres; negative where it points away.
    #[must_use]
    pub fn toward_viewer_m(&self, limb: &Limb) -> f32 {
        self.joints[limb.end()].z - self.joints[limb.base].z
    }
}

/// Alternatives, the likeliest first, and memory for them that is used again.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Alternatives {
    list: Vec<Alternative>,
    len: usize,
}

impl Alternatives {
    /// The most that there are of one drawing.
    pub const MOST: usize = 8;

    /// The alternatives, the likeliest first; empty before the first [`Inference::infer`](super::Inference::infer).
    #[must_use]
    pub fn as_slice(&self) -> &[Alternative] {
        &self.list[..self.len]
    }

    /// The likeliest.
    #[must_use]
    pub fn first(&self) -> Option<&Alternative> {
        self.as_slice().first()
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// A place at the end for one more.
    pub(super) fn add(&mut self) -> &mut Alternative {
        if self.len == self.list.len() {
            self.list.push(Alternative::default());
        }
        self.len += 1;
        &mut self.list[self.len - 1]
    }
}
