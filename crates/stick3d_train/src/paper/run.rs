//! One run through the paper's three stages (section 4.3).

use std::path::Path;

use burn::module::Module;
use burn::optim::GradientsParams;
use burn::tensor::{Device, Tensor, TensorData};
use rand::seq::SliceRandom as _;
use rayon::prelude::*;
use stick3d_model::Model;
use stick3d_model::digest::sha256_hex;

use super::losses::{autoencoder, equation_2};
use super::networks::{PaperAutoencoder, PaperNetworks, PaperWeights};
use super::{PaperConfig, PaperSet, Sample, Samples, export};
use crate::dataset::{normal_pair, random};
use crate::training::adam::Adam;
use crate::training::stages::{Epoch, Staged};
use crate::training::{LossLog, LossRecord, Progress, StageName, Terms, TrainError};

/// Samples whose means are found at once.
const CHUNK: usize = 128;

/// A reconstruction that leaves more than this share of the data's variance has learnt little but the mean mesh.
const COLLAPSED: f64 = 0.5;

/// What a run yields.
#[derive(Debug, Clone)]
pub struct PaperTrained {
    /// The model.
    pub model: Model,
    /// The losses, epoch by epoch.
    pub log: LossLog,
}

/// Trains the paper's networks. With a `run_folder` it leaves there, as it goes, `checkpoint.safetensors`, `losses.csv` and
/// `losses.png`; with `resume` it goes on from that checkpoint if there is one. The same seed gives the same model.
///
/// # Errors
/// [`TrainError`]; a checkpoint written before stays usable.
pub fn train_paper(
    set: &PaperSet,
    samples: &Samples,
    config: &PaperConfig,
    run_folder: Option<&Path>,
    resume: bool,
    progress: &dyn Progress,
) -> Result<PaperTrained, TrainError> {
    config.validate()?;
    let run = Run::new(set, samples, config)?;
    let first = PaperWeights::initial(config, set.figure.input_len(), set.vertex_count());
    let (networks, log) = run.run_stages(first, run_folder, resume, progress)?;
    let latents = run.latents(&networks)?;
    let data_hash = set.hash(samples);
    let weights = networks.to_weights()?;
    let model = export::model(set, samples, config, weights, &latents, data_hash)?;
    Ok(PaperTrained { model, log })
}

/// Everything that stays the same over a run.
struct Run<'a> {
    set: &'a PaperSet,
    samples: &'a [Sample],
    config: &'a PaperConfig,
    device: Device,
    scale_m: f32,
    /// Input vectors of the training samples' sketches.
    inputs: Vec<Vec<f32>>,
    /// Tells checkpoints of this run from others: hash of configuration and data.
    identity: String,
}

impl Staged for Run<'_> {
    type Networks = PaperNetworks;
    type Weights = PaperWeights;
    /// What Encoder2D is to learn, where Encoder3D stands still.
    type Fixed = Option<Tensor<2>>;

    fn identity(&self) -> &str {
        &self.identity
    }

    fn checkpoint_every(&self) -> usize {
        self.config.checkpoint_every
    }

    fn epochs(&self) -> [usize; 3] {
        self.config.epochs
    }

    fn networks(&self, weights: &PaperWeights) -> PaperNetworks {
        PaperNetworks::new(weights, &self.device)
    }

    fn weights(&self, networks: &PaperNetworks) -> Result<PaperWeights, TrainError> {
        networks.to_weights()
    }

    fn fixed(
        &self,
        stage: StageName,
        networks: &PaperNetworks,
    ) -> Result<Option<Tensor<2>>, TrainError> {
        match stage {
            StageName::Encoder2d => Ok(Some(self.means(&networks.vae)?)),
            StageName::Autoencoder | StageName::Joint => Ok(None),
        }
    }

    fn epoch(
        &self,
        mut networks: PaperNetworks,
        at: Epoch,
        means: &Option<Tensor<2>>,
        adam: &mut Adam,
        progress: &dyn Progress,
    ) -> Result<(PaperNetworks, LossRecord), TrainError> {
        // Every epoch of every stage has its own random numbers.
        let epoch = ((at.stage as u64) << 32) | at.index as u64;
        let batches = self.batches(epoch);
        progress.begin(&at.label(), batches.len());
        let mut record = at.record();
        for (index, batch) in batches.iter().enumerate() {
            let noise = self.noise(epoch, index, batch.len());
            let (stepped, terms) =
                self.step(networks, at.name, batch, noise, means.as_ref(), adam)?;
            networks = stepped;
            record.add(terms, batch.len() as f64 / self.samples.len() as f64)?;
            progress.advance(1);
        }
        record.round();
        Ok((networks, record))
    }

    fn stage_is_over(&self, stage: StageName, log: &LossLog, progress: &dyn Progress) {
        if stage == StageName::Autoencoder {
            self.say_whether_collapsed(log, progress);
        }
    }
}

impl<'a> Run<'a> {
    fn new(
        set: &'a PaperSet,
        samples: &'a Samples,
        config: &'a PaperConfig,
    ) -> Result<Self, TrainError> {
        let inputs = samples.train.iter().map(|sample| set.input_vector(*sample));
        Ok(Self {
            inputs: inputs.collect::<Result<_, _>>()?,
            identity: sha256_hex(format!("{config:?} {}", set.hash(samples)).as_bytes()),
            set,
            samples: &samples.train,
            config,
            device: config.device.open()?,
            scale_m: set.scale_m(),
        })
    }

    /// One step of one stage: which loss, and which networks it moves.
    fn step(
        &self,
        networks: PaperNetworks,
        stage: StageName,
        batch: &[usize],
        noise: Vec<f32>,
        means: Option<&Tensor<2>>,
        adam: &mut Adam,
    ) -> Result<(PaperNetworks, Terms), TrainError> {
        let PaperNetworks { vae, encoder2d } = networks;
        let tensor = |numbers: Vec<f32>| self.tensor(numbers, batch.len(), &self.device);
        match stage {
            StageName::Autoencoder => {
                let coordinates = tensor(self.coordinates(batch));
                let found = autoencoder(&vae, self.config, coordinates, tensor(noise));
                let (vae, terms) = self.moved(vae, found.loss, found.terms, adam)?;
                Ok((PaperNetworks { vae, encoder2d }, terms))
            }
            StageName::Encoder2d => {
                let means = means.ok_or_else(|| {
                    TrainError::Backend("the means of Encoder3D are missing".to_owned())
                })?;
                let rows: Vec<i64> = batch.iter().map(|sample| *sample as i64).collect();
                let rows = Tensor::from_data(TensorData::new(rows, [batch.len()]), &self.device);
                let latent = encoder2d.forward(tensor(self.inputs_of(batch)));
                let loss = equation_2(latent, means.clone().select(0, rows));
                let (encoder2d, terms) = self.moved(encoder2d, loss, vec![], adam)?;
                Ok((PaperNetworks { vae, encoder2d }, terms))
            }
            StageName::Joint => {
                let networks = PaperNetworks { vae, encoder2d };
                let coordinates = tensor(self.coordinates(batch));
                let found = autoencoder(&networks.vae, self.config, coordinates, tensor(noise));
                let latent = networks.encoder2d.forward(tensor(self.inputs_of(batch)));
                let latent = equation_2(latent, found.mean);
                let mut terms = found.terms;
                terms.push(("latent", latent.clone().detach()));
                self.moved(networks, found.loss + latent, terms, adam)
            }
        }
    }

    /// A module one step of Adam further, and the terms with the loss among them.
    fn moved<M: Module>(
        &self,
        module: M,
        loss: Tensor<1>,
        mut terms: Terms,
        adam: &mut Adam,
    ) -> Result<(M, Terms), TrainError> {
        let gradients = GradientsParams::from_grads(loss.backward(), &module);
        terms.push(("loss", loss.detach()));
        let rate = self.config.learning_rate;
        let module = adam
            .step(module, gradients, rate)
            .map_err(TrainError::Backend)?;
        Ok((module, terms))
    }

    /// The samples in a new order, in batches of nearly the same size.
    fn batches(&self, epoch: u64) -> Vec<Vec<usize>> {
        let mut order: Vec<usize> = (0..self.samples.len()).collect();
        order.shuffle(&mut random(self.config.seed, "paper order", epoch));
        let count = (order.len() as f64 / self.config.batch_size as f64).round();
        let size = order.len().div_ceil((count as usize).max(1));
        order.chunks(size.max(1)).map(<[usize]>::to_vec).collect()
    }

    /// Standard normal numbers for a batch.
    fn noise(&self, epoch: u64, index: usize, batch: usize) -> Vec<f32> {
        let count = batch * self.config.latent_len;
        let mut rng = random(
            self.config.seed,
            "paper noise",
            (epoch << 16) | index as u64,
        );
        (0..count.div_ceil(2))
            .flat_map(|_| normal_pair(&mut rng))
            .take(count)
            .collect()
    }

    /// The coordinates of samples, `[batch][3 · vertex_count]`, the networks' units.
    fn coordinates(&self, batch: &[usize]) -> Vec<f32> {
        let width = 3 * self.set.vertex_count();
        let mut all = vec![0.0; batch.len() * width];
        let per_metre = self.scale_m.recip();
        all.par_chunks_mut(width.max(1))
            .zip(batch)
            .for_each(|(row, index)| {
                let Sample { mesh, turn } = self.samples[*index];
                let turn = glam::Mat3::from_quat(self.set.turns[turn]) * per_metre;
                let points = &self.set.meshes[mesh].positions;
                for (out, point) in row.as_chunks_mut::<3>().0.iter_mut().zip(points) {
                    *out = (turn * *point).to_array();
                }
            });
        all
    }

    fn inputs_of(&self, batch: &[usize]) -> Vec<f32> {
        batch
            .iter()
            .flat_map(|index| &self.inputs[*index])
            .copied()
            .collect()
    }

    fn tensor(&self, numbers: Vec<f32>, rows: usize, device: &Device) -> Tensor<2> {
        let shape = [rows, numbers.len() / rows.max(1)];
        Tensor::from_data(TensorData::new(numbers, shape), device)
    }

    /// Encoder3D's mean of every training sample, `[sample, latent_len]`.
    fn means(&self, vae: &PaperAutoencoder) -> Result<Tensor<2>, TrainError> {
        let rows = self.body_latents(vae)?;
        Ok(self.tensor(rows, self.samples.len(), &self.device))
    }

    /// The device where nothing is noted for differentiation.
    fn tapeless_device(&self) -> Device {
        self.device.clone().inner()
    }

    /// The same on a plain array.
    fn body_latents(&self, vae: &PaperAutoencoder) -> Result<Vec<f32>, TrainError> {
        let (encoder, device) = (vae.encoder3d.valid(), self.tapeless_device());
        let order: Vec<usize> = (0..self.samples.len()).collect();
        let mut latents = vec![];
        for chunk in order.chunks(CHUNK) {
            let coordinates = self.tensor(self.coordinates(chunk), chunk.len(), &device);
            latents.extend(numbers(encoder.forward(coordinates).0)?);
        }
        Ok(latents)
    }

    /// The latents of the training samples, from their bodies and from their sketches.
    fn latents(&self, networks: &PaperNetworks) -> Result<Vec<Vec<f32>>, TrainError> {
        let order: Vec<usize> = (0..self.samples.len()).collect();
        let device = self.tapeless_device();
        let inputs = self.tensor(self.inputs_of(&order), order.len(), &device);
        let mut latents = self.body_latents(&networks.vae)?;
        latents.extend(numbers(networks.encoder2d.valid().forward(inputs))?);
        let len = self.config.latent_len;
        Ok(latents.chunks_exact(len).map(<[f32]>::to_vec).collect())
    }

    /// Says so if the autoencoder has learnt little but the mean mesh.
    fn say_whether_collapsed(&self, log: &LossLog, progress: &dyn Progress) {
        let of_autoencoder = |record: &&LossRecord| record.stage == StageName::Autoencoder;
        let last = log.records.iter().rfind(of_autoencoder);
        let Some(squared) = last.and_then(|record| record.term("mse_per_mille")) else {
            return;
        };
        let left = squared / 1e3 / self.variance();
        let verdict = if left > COLLAPSED {
            ": little more than the mean mesh is learnt; train longer, or lower the learning rate or the first log-variance"
        } else {
            ""
        };
        progress.note(&format!(
            "the autoencoder leaves {:.2} % of the variance of its meshes{verdict}",
            100.0 * left
        ));
    }

    /// The mean squared distance of the training samples' coordinates from their mean, the networks' units.
    fn variance(&self) -> f64 {
        let (mut sum, mut squares) = (vec![0.0_f64; 3 * self.set.vertex_count()], 0.0_f64);
        for index in 0..self.samples.len() {
            for (sum, x) in sum.iter_mut().zip(self.coordinates(&[index])) {
                *sum += f64::from(x);
                squares += f64::from(x) * f64::from(x);
            }
        }
        let count = self.samples.len() as f64;
        let of_mean: f64 = sum.iter().map(|x| (x / count).powi(2)).sum();
        ((squares / count - of_mean) / sum.len().max(1) as f64).max(f64::MIN_POSITIVE)
    }
}

/// A tensor's numbers.
fn numbers(tensor: Tensor<2>) -> Result<Vec<f32>, TrainError> {
    let fault = |e: &dyn std::fmt::Debug| TrainError::Backend(format!("{e:?}"));
    let data = tensor.try_into_data().map_err(|e| fault(&e))?;
    data.try_to_vec::<f32>().map_err(|e| fault(&e))
}
