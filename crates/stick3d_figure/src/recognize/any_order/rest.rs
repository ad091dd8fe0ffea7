//! What is still to come: bounds for the search, of what the chains that a reading has not placed can do for it.

use std::rc::Rc;

use super::cost::{LEFTOVER_COST, MISSING_COST};
use super::lines::Samples;
use super::search::{Reading, Search};
use super::ways::Way;

/// What a chain can do for a reading at best, as if no other chain were there.
#[derive(Clone, Debug)]
pub(super) struct Rest {
    /// What it adds to the cost with leftover ink,
    pub(super) gain: f32,
    /// and the second best of its ways.
    second_gain: f32,
    /// What it adds to the cost without leftover ink.
    cost: f32,
    /// The ink that it may explain.
    reach: Samples,
    /// Its ways that are better than to be missing, the best first; none before they are known.
    pub(super) ways: Option<Vec<Rc<Way>>>,
}

/// So many of them are tried.
const MAX_WAYS: usize = 64;

impl Rest {
    const MISSING: Self = Self {
        gain: MISSING_COST,
        second_gain: MISSING_COST,
        cost: MISSING_COST,
        reach: Samples::NONE,
        ways: None,
    };
    const ANYTHING: Self = Self {
        gain: f32::NEG_INFINITY,
        second_gain: f32::NEG_INFINITY,
        cost: 0.0,
        reach: Samples::ALL,
        ways: None,
    };

    fn consider(&mut self, gain: f32, cost: f32) {
        if gain < self.gain {
            (self.gain, self.second_gain) = (gain, self.gain);
        } else {
            self.second_gain = self.second_gain.min(gain);
        }
        self.cost = self.cost.min(cost);
    }
}

impl Search<'_> {
    /// What the other chains can do for a reading of the first one at best.
    pub(super) fn rest(&self, trunk: &Reading) -> Vec<Rest> {
        let best_of = |index: usize, mark: usize| {
            let mut rest = Rest::MISSING;
            let mut ways: Vec<(f32, &Rc<Way>)> = Vec::new();
            for way in self.ways_from(index, mark) {
                let step = self.step(index, trunk, Some(way), 1.0, None);
                let gain = step.total_cost - trunk.total_cost;
                rest.consider(gain, step.cost - trunk.cost);
                if gain < MISSING_COST {
                    ways.push((gain, way));
                }
            }
            ways.sort_by(|a, b| a.0.total_cmp(&b.0));
            ways.truncate(MAX_WAYS);
            for (_, way) in &ways {
                self.ink_of(way, &mut rest.reach);
            }
            rest.ways = Some(ways.into_iter().map(|(_, way)| way.clone()).collect());
            rest
        };
        self.rest_of(trunk, best_of)
    }

    /// The same without regard to the trunk.
    pub(super) fn rough_rest(&self, trunk: &Reading) -> Vec<Rest> {
        let unit = self.ink.tolerance_length;
        let best_of = |index: usize, mark: usize| {
            let rest = self.rough[index * self.places.len() + mark].get_or_init(|| {
                let mut rest = Rest::MISSING;
                let ways = self.ways_from(index, mark);
                self.count(ways.len());
                for way in ways {
                    self.ink_of(way, &mut rest.reach);
                    let ink = self.ink_of(way, &mut Samples::NONE.clone()).0;
                    rest.consider(way.cost - LEFTOVER_COST * ink / unit, way.cost);
                }
                rest
            });
            rest.clone()
        };
        self.rest_of(trunk, best_of)
    }

    fn rest_of(&self, trunk: &Reading, best_of: impl Fn(usize, usize) -> Rest) -> Vec<Rest> {
        let chains = self.body.chains.iter().enumerate();
        chains
            .map(
                |(index, chain)| match (index, self.mark_of(trunk, chain.from)) {
                    (0, _) => Rest::MISSING,
                    (_, Some(mark)) => {
                        let mut rest = best_of(index, mark);
                        if chain.twin.is_some() {
                            rest.gain = rest.second_gain;
                        }
                        rest
                    }
                    // It hangs on a chain that is not placed yet, and may explain anything.
                    (_, None) => Rest::ANYTHING,
                },
            )
            .collect()
    }

    /// What a whole reading that begins like this one costs at least.
    pub(super) fn least_cost(&self, reading: &Reading, rest: &[Rest]) -> f32 {
        let rest = &rest[reading.ways.len()..];
        let unit = self.ink.tolerance_length;
        let gain: f32 = rest.iter().map(|chain| chain.gain).sum();
        let cost: f32 = rest.iter().map(|chain| chain.cost).sum();
        let mut reached = reading.covered;
        for chain in rest {
            reached.add(&chain.reach);
        }
        let out_of_reach = self.all.sum_without(&reached, &self.marks.weights);
        let alone = reading.total_cost + gain;
        alone.max(reading.cost + cost + LEFTOVER_COST * out_of_reach / unit)
    }
}
