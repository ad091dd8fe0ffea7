//! The several bodies that one drawing may mean, ranked.

use glam::Vec3;
use stick3d_figure::figure::Limb;

/// One body that a drawing may mean.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Alternative {
    /// Its latent, `[latent_len]`.
    pub latent: Vec<f32>,
    /// How likely a body about like this one was drawn: its own likelihood and, the less the farther they are, those of the
    /// other alternatives. Over the alternatives of a drawing these sum to 1. They are seldom far apart: that a limb points
    /// toward the viewer is about as likely as that it points away.
    pub probability: f32,
    /// Its joints, metres, the root joint at the origin: one per joint of the figure, in the space of
    /// [`Inference::decode`](super::Inference::decode).
    pub joints: Vec<Vec3>,
    log_weight: f64,
    /// How likely it is for itself, a share of the likeliest one's.
    own: f32,
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

/// Bodies of which no joint is farther apart than this share of the figure's size are one.
const SAME_SHARE: f32 = 0.02;
/// Bodies whose joints are on average so far apart, share of the figure's size, count for one another by 1/e.
const ALIKE_SHARE: f32 = 0.15;

/// Alternatives, the likeliest first, and memory for them that is used again.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Alternatives {
    list: Vec<Alternative>,
    len: usize,
}

impl Alternatives {
    /// The most that there are of one drawing.
    pub const MOST: usize = 8;

    /// The alternatives, the likeliest first: that is the first answer. Empty before the first [`Inference::infer`](super::Inference::infer).
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

    /// Merges those of which no joint is as far apart as 2 % of a figure's size, `size_m`, keeps the likeliest, makes probabilities of
    /// the weights, and puts the likeliest first.
    pub(super) fn rank(&mut self, size_m: f32) {
        let list = &mut self.list[..self.len];
        list.sort_unstable_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
        let highest = list.first().map_or(0.0, |first| first.log_weight);
        for alternative in list.iter_mut() {
            alternative.own = (alternative.log_weight - highest).exp() as f32;
        }
        self.merge(SAME_SHARE * size_m);
        self.len = self.len.min(Self::MOST);
        self.count_the_like(ALIKE_SHARE * size_m);
        let list = &mut self.list[..self.len];
        list.sort_unstable_by(|a, b| b.probability.total_cmp(&a.probability));
    }

    /// Makes the likelihoods of single bodies probabilities of bodies like them. One that is likely for itself and nothing like
    /// the others is a worse answer than one in the middle of many.
    fn count_the_like(&mut self, alike_m: f32) {
        let mut sum = 0.0;
        for index in 0..self.len {
            let list = &self.list[..self.len];
            let like = |other: &Alternative| (-list[index].distance_m(other) / alike_m).exp();
            let probability = list.iter().map(|other| other.own * like(other)).sum();
            self.list[index].probability = probability;
            sum += probability;
        }
        for alternative in &mut self.list[..self.len] {
            alternative.probability /= sum;
        }
    }

    fn merge(&mut self, same_m: f32) {
        let mut kept = 0;
        for index in 0..self.len {
            let (before, rest) = self.list.split_at_mut(index);
            let same = before[..kept]
                .iter_mut()
                .find(|other| other.farthest_m(&rest[0]) < same_m);
            match same {
                Some(other) => other.own += rest[0].own,
                None => {
                    self.list.swap(kept, index);
                    kept += 1;
                }
            }
        }
        self.len = kept;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bodies of one joint, at these places on the x axis, metres, with these probabilities.
    fn ranked(bodies: &[(f32, f64)]) -> Alternatives {
        let mut alternatives = Alternatives::default();
        for (x, probability) in bodies {
            alternatives.add(&[*x], &[Vec3::new(*x, 0.0, 0.0)], probability.ln());
        }
        alternatives.rank(1.0);
        alternatives
    }

    fn places(alternatives: &Alternatives) -> Vec<f32> {
        alternatives
            .as_slice()
            .iter()
            .map(|a| a.latent[0])
            .collect()
    }

    #[test]
    fn one_in_the_middle_of_likely_ones_is_before_a_likelier_one_that_is_alone() {
        let found = ranked(&[(5.0, 0.34), (0.1, 0.22), (0.0, 0.22), (-0.1, 0.22)]);
        assert_eq!(places(&found)[0], 0.0);
        assert_eq!(places(&found)[3], 5.0);
        let alone = ranked(&[(5.0, 0.7), (0.1, 0.1), (0.0, 0.1), (-0.1, 0.1)]);
        assert_eq!(places(&alone)[0], 5.0);
        for found in [found, alone] {
            let list = found.as_slice();
            assert!(list.is_sorted_by(|a, b| a.probability >= b.probability));
            let sum: f32 = list.iter().map(|a| a.probability).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        }
    }

    #[test]
    fn bodies_that_are_one_count_as_one() {
        let found = ranked(&[(0.0, 0.3), (0.01, 0.3), (3.0, 0.4)]);
        assert_eq!(found.as_slice().len(), 2);
        assert_eq!(places(&found)[0], 0.0);
        assert!((found.as_slice()[0].probability - 0.6).abs() < 1e-4);
    }

    #[test]
    fn the_least_likely_of_too_many_are_left_out() {
        let bodies: Vec<(f32, f64)> = (0_u8..12)
            .map(|i| (f32::from(i), 1.0 + f64::from(i)))
            .collect();
        let found = ranked(&bodies);
        assert_eq!(found.as_slice().len(), Alternatives::MOST);
        assert!(places(&found).iter().all(|x| *x >= 4.0));
    }
}
