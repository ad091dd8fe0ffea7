//! Mean, deviation and percentiles of very many distances, in little memory.

/// Ranges into which every doubling is cut: percentiles are right to a part in so many.
const RANGES: usize = 1 << RANGE_BITS;
const RANGE_BITS: u32 = 7;
/// Bits of a number below those of its range.
const LOW_BITS: u32 = f32::MANTISSA_DIGITS - 1 - RANGE_BITS;
/// The first range begins at 2^-20: a micrometre, when numbers are metres. All below is in it.
const LEAST: f32 = 1.0 / (1 << 20) as f32;
/// Doublings from there on: the last range is that of 2^12 and more.
const DOUBLINGS: usize = 32;

/// How numbers that are not negative are spread.
#[derive(Debug, Clone, Default)]
pub(super) struct Spread {
    count: u64,
    sum: f64,
    squares: f64,
    /// How many numbers are in each range; empty before the first one.
    ranges: Vec<u32>,
}

impl Spread {
    /// Adds a number.
    pub(super) fn add(&mut self, number: f32) {
        if self.ranges.is_empty() {
            self.ranges = vec![0; RANGES * DOUBLINGS + 1];
        }
        self.count += 1;
        self.sum += f64::from(number);
        self.squares += f64::from(number) * f64::from(number);
        self.ranges[range_of(number)] += 1;
    }

    /// Adds the numbers of another spread.
    pub(super) fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.squares += other.squares;
        if self.ranges.is_empty() {
            self.ranges.clone_from(&other.ranges);
        } else {
            let both = self.ranges.iter_mut().zip(&other.ranges);
            both.for_each(|(sum, more)| *sum += more);
        }
    }

    /// Their mean; 0 without any.
    pub(super) fn mean(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }

    /// The mean of their squares; 0 without any.
    pub(super) fn mean_square(&self) -> f64 {
        self.squares / self.count.max(1) as f64
    }

    /// Their standard deviation.
    pub(super) fn deviation(&self) -> f64 {
        (self.mean_square() - self.mean() * self.mean())
            .max(0.0)
            .sqrt()
    }

    /// So many of a hundred are less, to within a hundredth part.
    pub(super) fn percentile(&self, percent: f64) -> f64 {
        let wanted = percent / 100.0 * self.count as f64;
        let mut before = 0.0;
        for (range, &count) in self.ranges.iter().enumerate() {
            let count = f64::from(count);
            if count > 0.0 && before + count >= wanted {
                let [low, high] = [range, range + 1].map(|range| f64::from(start_of(range)));
                return low + (high - low) * ((wanted - before) / count).max(0.0);
            }
            before += count;
        }
        0.0
    }
}

/// The number of the range that a number lies in. The bits of a float are its doubling and, below that, its evenly spaced
/// place in it.
fn range_of(number: f32) -> usize {
    let above = number.max(LEAST).to_bits() - LEAST.to_bits();
    ((above >> LOW_BITS) as usize).min(RANGES * DOUBLINGS)
}

/// Where a range begins.
fn start_of(range: usize) -> f32 {
    f32::from_bits(LEAST.to_bits() + ((range as u32) << LOW_BITS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_sorted_list() {
        let numbers: Vec<f32> = (0..10_000_u32)
            .map(|i| (f32::from((i * 7919 % 10_007) as u16) / 10_007.0).powi(2))
            .collect();
        let mut halves = [Spread::default(), Spread::default()];
        for (i, number) in numbers.iter().enumerate() {
            halves[i % 2].add(*number);
        }
        let [mut all, other] = halves;
        all.merge(&other);
        let mut sorted = numbers.clone();
        sorted.sort_by(f32::total_cmp);
        for percent in [10, 25, 50, 95, 99] {
            let expected = f64::from(sorted[percent * sorted.len() / 100]);
            let found = all.percentile(percent as f64);
            assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
        }
        let mean = numbers.iter().copied().map(f64::from).sum::<f64>() / 1e4;
        assert!((all.mean() - mean).abs() < 1e-9 && all.deviation() > 0.1);
    }

    #[test]
    fn nothing_and_extremes_are_no_trouble() {
        let none = Spread::default();
        assert_eq!(
            [none.mean(), none.deviation(), none.percentile(95.0)],
            [0.0; 3]
        );
        let mut spread = Spread::default();
        spread.merge(&none);
        spread.add(0.0);
        assert!(spread.percentile(50.0) <= f64::from(start_of(1)));
        for huge in [1e9, f32::INFINITY] {
            spread.add(huge);
        }
        assert!(spread.percentile(99.0) >= 4096.0);
        assert_eq!(range_of(start_of(77)), 77);
    }
}
