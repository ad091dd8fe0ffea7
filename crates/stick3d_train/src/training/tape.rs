//! From codes to the features that points are linear in, with the derivative by hand.
//!
//! Rotations of some fifty bones are thousands of tiny products a batch, which take longer as tensor operations than all
//! networks together. So the graph is cut there: features are leaves of their own, losses of points are differentiated down to
//! these, and what that gives is handed on to the networks as the derivative of a sum.

use burn::tensor::{Device, Gradients, Tensor, TensorData};
use glam::Vec3;
use rayon::prelude::*;
use stick3d_model::final_layer::Rotations;

use super::TrainError;

/// The features of one pass, which losses of points are differentiated by.
struct Pass {
    /// The codes in their own scale, `[batch, 3 · code_columns]`; a part of the networks' graph.
    raw: Tensor<2>,
    numbers: Vec<f32>,
    features: Vec<f32>,
    /// The features as a leaf, `[batch · 3, features]`.
    leaf: Tensor<2>,
}

/// The passes of one step.
#[derive(Default)]
pub(crate) struct Tape {
    passes: Vec<Pass>,
}

/// How codes turn into features.
#[derive(Debug, Clone)]
pub(crate) struct Expansion {
    /// `None` where codes are features.
    rotations: Option<Rotations>,
}

impl Expansion {
    pub(super) fn new(rotations: Option<&Rotations>) -> Self {
        Self {
            rotations: rotations.cloned(),
        }
    }

    /// The features of codes, `[batch · 3, features]`. With a tape they can be differentiated.
    pub(super) fn features(
        &self,
        raw: Tensor<2>,
        tape: Option<&mut Tape>,
    ) -> Result<Tensor<2>, TrainError> {
        let (device, [batch, _]) = (raw.device(), raw.dims());
        let numbers = numbers(raw.clone().detach())?;
        let features = self.expand(&numbers, batch);
        let shape = [3 * batch, features.len() / (3 * batch)];
        let leaf = Tensor::<2>::from_data(TensorData::new(features.clone(), shape), &device);
        let Some(tape) = tape else {
            return Ok(leaf);
        };
        let leaf = leaf.require_grad();
        tape.passes.push(Pass {
            raw,
            numbers,
            features,
            leaf: leaf.clone(),
        });
        Ok(leaf)
    }

    fn expand(&self, numbers: &[f32], batch: usize) -> Vec<f32> {
        let Some(rotations) = &self.rotations else {
            return numbers.to_vec();
        };
        let width = 3 * rotations.feature_columns();
        let mut features = vec![0.0; batch * width];
        let bodies = features.par_chunks_exact_mut(width);
        bodies
            .zip(numbers.par_chunks_exact(3 * rotations.code_columns()))
            .for_each(|(features, code)| rotations.expand(code, features));
        features
    }

    fn pull_back(&self, pass: &Pass, by_features: Vec<f32>) -> Vec<f32> {
        let Some(rotations) = &self.rotations else {
            return by_features;
        };
        let (columns, width) = (
            3 * rotations.code_columns(),
            3 * rotations.feature_columns(),
        );
        let mut by_code = vec![0.0; pass.numbers.len()];
        by_code
            .par_chunks_exact_mut(columns)
            .zip(pass.numbers.par_chunks_exact(columns))
            .zip(pass.features.par_chunks_exact(width))
            .zip(by_features.par_chunks_exact(width))
            .for_each_init(
                || vec![Vec3::ZERO; rotations.bone_count],
                |torques, (((by_code, code), features), by_features)| {
                    rotations.pull_back(code, features, by_features, torques, by_code);
                },
            );
        by_code
    }

    /// A number whose derivative by the networks is that of a loss of points, whose `gradients` reach down to the features.
    pub(super) fn carry_on(
        &self,
        tape: Tape,
        gradients: &Gradients,
        device: &Device,
    ) -> Result<Tensor<1>, TrainError> {
        let mut sum = Tensor::<1>::zeros([1], device);
        for pass in tape.passes {
            // A pass that no loss looks at has none.
            let Some(by_features) = pass.leaf.grad(gradients) else {
                continue;
            };
            let by_code = self.pull_back(&pass, numbers(by_features)?);
            let by_code = TensorData::new(by_code, pass.raw.dims());
            sum = sum + (pass.raw * Tensor::<2>::from_data(by_code, device)).sum();
        }
        Ok(sum)
    }
}

fn numbers(tensor: Tensor<2>) -> Result<Vec<f32>, TrainError> {
    let data = tensor
        .try_into_data()
        .map_err(|error| TrainError::Backend(format!("{error:?}")))?;
    data.try_into_vec()
        .map_err(|error| TrainError::Backend(format!("{error:?}")))
}

#[cfg(test)]
mod tests {
    use stick3d_model::network::rotation_features;

    use super::*;

    #[test]
    fn derivatives_are_those_of_the_graph() {
        let device = Device::flex().autodiff();
        let rotations = Rotations {
            bone_count: 3,
            halves: vec![[0, 1], [1, 2]],
        };
        let code: Vec<f32> = (0..36).map(|i| (1.9 * i as f32).sin()).collect();
        let code = || {
            let data = TensorData::new(code.clone(), [2, 18]);
            Tensor::<2>::from_data(data, &device).require_grad()
        };
        let loss = |features: Tensor<2>| (features.clone().square() * 0.7 + features.exp()).sum();

        let whole = code();
        let gradients = loss(rotation_features(whole.clone() * 2.0, 3, &[0, 1, 1, 2])).backward();
        let expected = numbers(whole.grad(&gradients).unwrap()).unwrap();

        let cut = code();
        let (expansion, mut tape) = (Expansion::new(Some(&rotations)), Tape::default());
        let features = expansion
            .features(cut.clone() * 2.0, Some(&mut tape))
            .unwrap();
        let of_features = loss(features).backward();
        let carried = expansion.carry_on(tape, &of_features, &device).unwrap();
        let found = numbers(cut.grad(&carried.backward()).unwrap()).unwrap();

        assert!(expected.iter().any(|x| x.abs() > 0.1));
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-3, "{found} {expected}");
        }
    }
}
