//! Adam in one pass over the parameters, in place and on all cores.
//!
//! Burn's optimiser runs some ten tensor operations per parameter, which takes longer than the gradients of networks this
//! small, and of networks as large as the paper's. This one is a plain loop, and its state is plain arrays, which a
//! checkpoint stores as they are. Every number is stepped by itself, so the result is the same on any number of cores.
//! Source: [Kingma and Ba](https://arxiv.org/abs/1412.6980), algorithm 1.

use burn::module::{Module, ModuleMapper, Param};
use burn::optim::GradientsParams;
use burn::tensor::Tensor;
use rayon::prelude::*;

/// Decay of the mean of the gradients.
const BETA_1: f32 = 0.9;
/// Decay of the mean of their squares.
const BETA_2: f32 = 0.999;
/// Keeps a vanishing gradient from being divided by zero.
const EPSILON: f32 = 1e-8;
/// Parameters that one task steps.
const TASK: usize = 1 << 15;

/// The optimiser's memory: two numbers per parameter.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Adam {
    /// How many steps were made.
    pub(crate) steps: u64,
    /// Per parameter array, in the order of the module: running mean of the gradient.
    pub(crate) means: Vec<Vec<f32>>,
    /// The same of its square.
    pub(crate) squares: Vec<Vec<f32>>,
}

impl Adam {
    /// One step against the gradient. Parameters without a gradient stay.
    ///
    /// # Errors
    /// What the backend says when it does not hand its numbers out.
    pub(crate) fn step<M: Module>(
        &mut self,
        module: M,
        gradients: GradientsParams,
        learning_rate: f64,
    ) -> Result<M, String> {
        self.steps += 1;
        let correction = |beta: f32| 1.0 - f64::from(beta).powi(self.steps as i32);
        let mut stepper = Stepper {
            rate: (learning_rate / correction(BETA_1)) as f32,
            square_scale: (1.0 / correction(BETA_2)) as f32,
            adam: self,
            gradients,
            index: 0,
            error: None,
        };
        let module = module.map(&mut stepper);
        stepper.error.map_or(Ok(module), Err)
    }
}

struct Stepper<'a> {
    adam: &'a mut Adam,
    gradients: GradientsParams,
    index: usize,
    rate: f32,
    square_scale: f32,
    error: Option<String>,
}

impl Stepper<'_> {
    /// Takes the tensor's own memory where nothing else holds it, and hands it back.
    fn stepped<const D: usize>(
        &mut self,
        tensor: Tensor<D>,
        gradient: Tensor<D>,
    ) -> Result<Tensor<D>, String> {
        let device = tensor.device();
        let read = |t: Tensor<D>| t.try_into_data().map_err(|e| format!("{e:?}"));
        let gradient = read(gradient)?;
        let slope = gradient.as_slice::<f32>().map_err(|e| format!("{e:?}"))?;
        let mut data = read(tensor.detach())?;
        let values = data.as_mut_slice::<f32>().map_err(|e| format!("{e:?}"))?;
        let (means, squares) = (&mut self.adam.means, &mut self.adam.squares);
        while means.len() <= self.index {
            means.push(vec![]);
            squares.push(vec![]);
        }
        let (mean, square) = (&mut means[self.index], &mut squares[self.index]);
        mean.resize(slope.len(), 0.0);
        square.resize(slope.len(), 0.0);
        let (rate, square_scale) = (self.rate, self.square_scale);
        values
            .par_chunks_mut(TASK)
            .zip(slope.par_chunks(TASK))
            .zip(mean.par_chunks_mut(TASK))
            .zip(square.par_chunks_mut(TASK))
            .for_each(|(((values, slope), mean), square)| {
                let numbers = values.iter_mut().zip(slope).zip(mean).zip(square);
                for (((value, g), mean), square) in numbers {
                    *mean = BETA_1 * *mean + (1.0 - BETA_1) * g;
                    *square = BETA_2 * *square + (1.0 - BETA_2) * g * g;
                    *value -= rate * *mean / ((*square * square_scale).sqrt() + EPSILON);
                }
            });
        Ok(Tensor::from_data(data, &device).require_grad())
    }
}

impl ModuleMapper for Stepper<'_> {
    fn map_float<const D: usize>(&mut self, param: Param<Tensor<D>>) -> Param<Tensor<D>> {
        let (id, mut tensor, mapper) = param.consume();
        if let Some(gradient) = self.gradients.remove::<D>(id) {
            let (shape, device) = (tensor.dims(), tensor.device());
            tensor = self.stepped(tensor, gradient).unwrap_or_else(|error| {
                // The step as a whole fails then, and the module is lost with it.
                self.error = Some(error);
                Tensor::zeros(shape, &device)
            });
        }
        self.index += 1;
        Param::from_mapped_value(id, tensor, mapper)
    }
}
