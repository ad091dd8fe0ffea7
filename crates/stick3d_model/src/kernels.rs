//! The arithmetic loops of a frame: safe Rust that the compiler vectorises, once per instruction set, chosen at run time.
//!
//! All loops multiply and add separately and in a fixed order, so a result does not depend on the instruction set.

use macerator::{AutoArch, Simd, WithSimd};

/// How many outputs are worked on at a time, so that they stay in the nearest cache while the rows stream by.
const TILE: usize = 2048;

/// Runs a loop compiled for the best instruction set that this processor has. The closure must be `#[inline(always)]`,
/// or it is compiled for the least one.
#[inline(always)]
pub(crate) fn vectorised(run: impl FnOnce()) {
    struct Loop<F>(F);
    impl<F: FnOnce()> WithSimd for Loop<F> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self) {
            self.0();
        }
    }
    AutoArch::new().dispatch(Loop(run));
}

/// `output[j] += Σ_i input[i] · rows[i][j]`; rows of zero inputs (half of them after a ReLU) are not read.
///
/// # Shapes
/// - `input`: `[I]`
/// - `rows`: `[I][J]`, contiguous
/// - `output`: `[J]`
pub(crate) fn accumulate(input: &[f32], rows: &[f32], output: &mut [f32]) {
    let row_len = output.len();
    debug_assert_eq!(rows.len(), input.len() * row_len);
    vectorised(
        #[inline(always)]
        || {
            for (tile, out) in output.chunks_mut(TILE).enumerate() {
                accumulate_tile(input, rows, row_len, tile * TILE, out);
            }
        },
    );
}

#[inline(always)]
fn accumulate_tile(input: &[f32], rows: &[f32], row_len: usize, start: usize, out: &mut [f32]) {
    let len = out.len();
    let row = |i: usize| &rows[i * row_len + start..][..len];
    let mut pending = [(0.0_f32, 0_usize); 4];
    let mut count = 0;
    for (i, &value) in input.iter().enumerate() {
        if value == 0.0 {
            continue;
        }
        pending[count] = (value, i);
        count += 1;
        if count == 4 {
            let [a, b, c, d] = pending.map(|(value, _)| value);
            let [row_a, row_b, row_c, row_d] = pending.map(|(_, i)| row(i));
            for j in 0..len {
                out[j] += (a * row_a[j] + b * row_b[j]) + (c * row_c[j] + d * row_d[j]);
            }
            count = 0;
        }
    }
    for &(value, i) in &pending[..count] {
        for (out, weight) in out.iter_mut().zip(row(i)) {
            *out += value * weight;
        }
    }
}

/// So many rows at a time stay in a near cache while all inputs are worked through.
const ROWS: usize = 32;

/// [`accumulate`] for several inputs: rows are fetched from far memory once for all of them.
///
/// # Shapes
/// - `inputs`: `[N][I]`, contiguous; quickest where zeros of the first and the second, the third and the fourth, … are at the
///   same places
/// - `rows`: `[I][J]`, contiguous
/// - `outputs`: `[N][J]`, contiguous
pub(crate) fn accumulate_several(
    inputs: &[f32],
    input_len: usize,
    rows: &[f32],
    outputs: &mut [f32],
) {
    let row_len = rows.len() / input_len.max(1);
    if row_len == 0 {
        return;
    }
    debug_assert_eq!(inputs.len() / input_len, outputs.len() / row_len);
    vectorised(
        #[inline(always)]
        || {
            for (block, rows) in rows.chunks(ROWS * row_len).enumerate() {
                let of_block = block * ROWS..block * ROWS + rows.len() / row_len;
                let pairs = inputs.chunks(2 * input_len);
                for (inputs, outputs) in pairs.zip(outputs.chunks_mut(2 * row_len)) {
                    let (first, second) = inputs.split_at(input_len);
                    let (out, other) = outputs.split_at_mut(row_len);
                    let first = &first[of_block.clone()];
                    if second.is_empty() {
                        accumulate_tile(first, rows, row_len, 0, out);
                    } else {
                        accumulate_pair([first, &second[of_block.clone()]], rows, [out, other]);
                    }
                }
            }
        },
    );
}

/// [`accumulate`] for two inputs at once.
#[inline(always)]
fn accumulate_pair(inputs: [&[f32]; 2], rows: &[f32], outputs: [&mut [f32]; 2]) {
    let [first, second] = outputs;
    let row_len = first.len();
    let mut pending = [0_usize; 4];
    let mut count = 0;
    for index in 0..inputs[0].len() {
        if inputs[0][index] == 0.0 && inputs[1][index] == 0.0 {
            continue;
        }
        pending[count] = index;
        count += 1;
        if count == 4 {
            let row = pending.map(|i| &rows[i * row_len..][..row_len]);
            let a = pending.map(|i| inputs[0][i]);
            let b = pending.map(|i| inputs[1][i]);
            let (first, second) = (&mut first[..row_len], &mut second[..row_len]);
            for j in 0..row_len {
                let column = [row[0][j], row[1][j], row[2][j], row[3][j]];
                first[j] +=
                    (a[0] * column[0] + a[1] * column[1]) + (a[2] * column[2] + a[3] * column[3]);
                second[j] +=
                    (b[0] * column[0] + b[1] * column[1]) + (b[2] * column[2] + b[3] * column[3]);
            }
            count = 0;
        }
    }
    for &index in &pending[..count] {
        let row = &rows[index * row_len..][..row_len];
        for ((first, second), weight) in first.iter_mut().zip(second.iter_mut()).zip(row) {
            *first += inputs[0][index] * weight;
            *second += inputs[1][index] * weight;
        }
    }
}

/// The sum of products, in lanes.
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    const LANES: usize = 16;
    let mut sums = [0.0_f32; LANES];
    let (chunks_a, rest_a) = a.as_chunks::<LANES>();
    let (chunks_b, rest_b) = b.as_chunks::<LANES>();
    for (a, b) in chunks_a.iter().zip(chunks_b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest: f32 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f32>() + rest
}

/// Hyperbolic tangent as a ratio of polynomials, within 1e-6 of the exact one: branch-free, so that it vectorises.
///
/// The coefficients are those of the widely used odd 13/6 fit (Eigen, XNNPACK).
#[inline(always)]
pub(crate) fn tanh(x: f32) -> f32 {
    let x = x.clamp(-7.905_31, 7.905_31);
    let square = x * x;
    let odd = [
        -2.760_768_5e-16,
        2.000_188e-13,
        -8.604_672e-11,
        5.122_297e-8,
        1.485_722_4e-5,
        6.372_619_3e-4,
        4.893_524_6e-3,
    ];
    let even = [1.198_258_4e-6, 1.185_347e-4, 2.268_434_6e-3, 4.893_525e-3];
    let numerator = odd.iter().fold(0.0, |sum, c| sum * square + c);
    let denominator = even.iter().fold(0.0, |sum, c| sum * square + c);
    x * numerator / denominator
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accumulate_is_the_matrix_product() {
        let (rows_count, row_len) = (11, 2 * TILE + 37);
        let rows: Vec<f32> = (0..rows_count * row_len)
            .map(|i| ((i * 31 % 101) as f32 - 50.0) / 64.0)
            .collect();
        let input: Vec<f32> = (0..rows_count)
            .map(|i| {
                if i % 3 == 1 {
                    0.0
                } else {
                    i as f32 / 4.0 - 1.0
                }
            })
            .collect();
        let mut output = vec![0.5; row_len];
        accumulate(&input, &rows, &mut output);
        for (j, out) in output.iter().enumerate() {
            let expected: f32 = 0.5
                + (0..rows_count)
                    .map(|i| input[i] * rows[i * row_len + j])
                    .sum::<f32>();
            assert!((out - expected).abs() < 1e-5, "{j}: {out} {expected}");
        }
        accumulate(&input, &[], &mut []);
    }

    #[test]
    fn several_are_as_many_single_ones() {
        let (input_len, row_len) = (2 * ROWS + 23, 37);
        let number = |i: usize| ((i * 37 % 89) as f32 - 44.0) / 64.0;
        let rows: Vec<f32> = (0..input_len * row_len).map(number).collect();
        for count in [1, 2, 5] {
            let zeroed = |i: usize| if i % 4 == 2 { 0.0 } else { number(i + 5) };
            let inputs: Vec<f32> = (0..count * input_len).map(zeroed).collect();
            let mut found = vec![0.25; count * row_len];
            accumulate_several(&inputs, input_len, &rows, &mut found);
            for (input, found) in inputs.chunks(input_len).zip(found.chunks(row_len)) {
                let mut expected = vec![0.25; row_len];
                accumulate(input, &rows, &mut expected);
                for (a, b) in found.iter().zip(&expected) {
                    assert!((a - b).abs() < 1e-4, "{a} {b}");
                }
            }
        }
        accumulate_several(&[], 3, &[], &mut []);
        assert_eq!(dot(&[1.0, 2.0, 3.0], &[4.0, -5.0, 6.0]), 12.0);
    }

    #[test]
    fn tanh_is_close_everywhere() {
        for i in -120_000..=120_000 {
            let x = i as f32 * 1e-4;
            assert!(
                (tanh(x) - x.tanh()).abs() < 1e-6,
                "{x}: {} {}",
                tanh(x),
                x.tanh()
            );
        }
        assert!(tanh(f32::NAN).is_nan());
    }
}
