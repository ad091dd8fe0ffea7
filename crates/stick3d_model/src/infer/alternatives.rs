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
    log_weight: f64,
}

impl Alternative {
    /// How far the end of a limb is nearer to the viewer than its base, metres; negative where it points away.
    #[must_use]
    pub fn toward_viewer_m(&self, limb: &Limb) -> f32 {
        self.joints[limb.end()].z - self.joints[limb.base].z
    }

    /// Mean distance between joints, metres.
    #[must_use]
    pub fn distance_m(&self, other: &Self) -> f32 {
        let pairs = self.joints.iter().zip(&other.joints);
        pairs.map(|(a, b)| a.distance(*b)).sum::<f32>() / self.joints.len().max(1) as f32
    }

    /// Largest distance between joints, metres.
    fn farthest_m(&self, other: &Self) -> f32 {
        let pairs = self.joints.iter().zip(&other.joints);
        pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
    }
}

/// The first answer is at least so likely, share of the likeliest one's probability.
const LIKELY_SHARE: f32 = 0.25;

/// Alternatives, the first answer first, then the likeliest, and memory for them that is used again.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Alternatives {
    list: Vec<Alternative>,
    len: usize,
}

impl Alternatives {
    /// The most that there are of one drawing.
    pub const MOST: usize = 8;

    /// The alternatives: the first answer, which is nearest to all the likely ones, then the others, the likeliest first.
    /// Empty before the first [`Inference::infer`](super::Inference::infer).
    #[must_use]
    pub fn as_slice(&self) -> &[Alternative] {
        &self.list[..self.len]
    }

    /// The first answer.
    #[must_use]
    pub fn first(&self) -> Option<&Alternative> {
        self.as_slice().first()
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds one; `log_weight` is the logarithm of its probability up to a constant.
    pub(super) fn add(&mut self, latent: &[f32], joints: &[Vec3], log_weight: f64) {
        if self.len == self.list.len() {
            self.list.push(Alternative::default());
        }
        let place = &mut self.list[self.len];
        self.len += 1;
        place.latent.clear();
        place.latent.extend_from_slice(latent);
        place.joints.clear();
        place.joints.extend_from_slice(joints);
        place.log_weight = log_weight;
    }

    /// Makes probabilities of the weights, merges those of which no joint is as far apart as `same_m`, and puts the first
    /// answer first: of the likely ones that which is nearest to all, each counted by its probability; then the likeliest.
    pub(super) fn rank(&mut self, same_m: f32) {
        let list = &mut self.list[..self.len];
        list.sort_unstable_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
        let highest = list.first().map_or(0.0, |first| first.log_weight);
        let sum: f64 = list.iter().map(|a| (a.log_weight - highest).exp()).sum();
        for alternative in list.iter_mut() {
            alternative.probability = ((alternative.log_weight - highest).exp() / sum) as f32;
        }
        self.merge(same_m);
        let list = &mut self.list[..self.len];
        let regret = |candidate: &Alternative| -> f32 {
            let others = list.iter();
            others
                .map(|other| other.probability * candidate.distance_m(other))
                .sum()
        };
        let highest = list.iter().map(|a| a.probability).fold(0.0, f32::max);
        let likely =
            (0..list.len()).filter(|index| list[*index].probability >= LIKELY_SHARE * highest);
        let first = likely.min_by(|a, b| regret(&list[*a]).total_cmp(&regret(&list[*b])));
        if let Some(first) = first {
            list[..=first].rotate_right(1);
        }
        self.len = self.len.min(Self::MOST);
        let list = &mut self.list[..self.len];
        let sum: f32 = list.iter().map(|a| a.probability).sum();
        list.iter_mut().for_each(|a| a.probability /= sum);
    }

    fn merge(&mut self, same_m: f32) {
        let mut kept = 0;
        for index in 0..self.len {
            let (before, rest) = self.list.split_at_mut(index);
            let same = before[..kept]
                .iter_mut()
                .find(|other| other.farthest_m(&rest[0]) < same_m);
            match same {
                Some(other) => other.probability += rest[0].probability,
                None => {
                    self.list.swap(kept, index);
                    kept += 1;
                }
            }
        }
        self.len = kept;
    }
}
