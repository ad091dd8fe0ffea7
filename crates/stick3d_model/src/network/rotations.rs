//! From a head's raw numbers to rotation matrices, as tensors; the plain form is
//! [`Rotations`](crate::final_layer::Rotations).

use burn::tensor::{Int, Tensor, TensorData};

use crate::final_layer::{LEAST_COSINE, SMALLEST_SQUARE};

/// Makes rotations of raw numbers: two columns a bone by Gram and Schmidt, and the half-way rotations of pairs.
///
/// # Shapes
/// - `code`: `[batch, 3 · 2 · bones]`, that is `[batch][axis][bone][two columns]`
/// - `halves`: the pairs one after the other
/// - result: `[batch · 3, 3 · (bones + pairs)]`, that is `[batch][axis]` by `[bone or pair][three columns]`
#[must_use]
pub fn rotation_features(code: Tensor<2>, bones: usize, halves: &[usize]) -> Tensor<2> {
    let [batch, _] = code.dims();
    let columns = code.reshape([batch, 3, bones, 2]);
    let u = columns.clone().narrow(3, 0, 1);
    let v = columns.narrow(3, 1, 1);
    let x = unit(u);
    let along = (x.clone() * v.clone()).sum_dim(1);
    let y = unit(v - along * x.clone());
    let z = cross(x.clone(), y.clone());
    // [batch, axis, bone, column]
    let turns = Tensor::cat(vec![x, y, z], 3);
    if halves.is_empty() {
        return turns.reshape([3 * batch, 3 * bones]);
    }
    let between = half_way(turns.clone(), halves, batch);
    let pairs = halves.len() / 2;
    Tensor::cat(vec![turns, between], 2).reshape([3 * batch, 3 * (bones + pairs)])
}

fn unit(v: Tensor<4>) -> Tensor<4> {
    let length = (v.clone().square().sum_dim(1) + SMALLEST_SQUARE).sqrt();
    v / length
}

/// Cross product along dimension 1.
fn cross(a: Tensor<4>, b: Tensor<4>) -> Tensor<4> {
    let part = |t: &Tensor<4>, axis: usize| t.clone().narrow(1, axis, 1);
    let component = |i: usize, j: usize| part(&a, i) * part(&b, j) - part(&a, j) * part(&b, i);
    Tensor::cat(vec![component(1, 2), component(2, 0), component(0, 1)], 1)
}

/// `[batch, axis, pair, column]` from `[batch, axis, bone, column]`, by Rodrigues' formula.
fn half_way(turns: Tensor<4>, halves: &[usize], batch: usize) -> Tensor<4> {
    let device = turns.device();
    let pairs = halves.len() / 2;
    let pick = |offset: usize| {
        let bones: Vec<i64> = halves
            .iter()
            .skip(offset)
            .step_by(2)
            .map(|bone| *bone as i64)
            .collect();
        let indices = Tensor::<1, Int>::from_data(TensorData::new(bones, [pairs]), &device);
        // [batch · pair, axis, column]
        turns
            .clone()
            .select(2, indices)
            .swap_dims(1, 2)
            .reshape([batch * pairs, 3, 3])
    };
    let (a, b) = (pick(0), pick(1));
    let between = a.clone().swap_dims(1, 2).matmul(b);
    let entry = |i: usize| between.clone().narrow(1, i, 1).narrow(2, i, 1);
    let trace = entry(0) + entry(1) + entry(2);
    let cosine = ((trace + 1.0).clamp_min(1e-9).sqrt() * 0.5).clamp_min(LEAST_COSINE);
    let transposed = between.clone().swap_dims(1, 2);
    let identity = Tensor::<2>::eye(3, &device).unsqueeze::<3>();
    let turn = (between.clone() - transposed.clone()) / (cosine.clone() * 4.0);
    let bend = (between + transposed - identity.clone() * 2.0) / ((cosine + 1.0) * 4.0);
    let half = a.matmul(identity + turn + bend);
    half.reshape([batch, pairs, 3, 3]).swap_dims(1, 2)
}
