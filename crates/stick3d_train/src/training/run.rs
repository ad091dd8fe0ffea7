//! One training run from bodies to a model.

use std::path::Path;

use burn::optim::GradientsParams;
use burn::tensor::Device;
use rand::Rng as _;
use stick3d_model::Model;
use stick3d_model::digest::sha256_hex;

use super::adam::Adam;
use super::export;
use super::init::initial_weights;
use super::log::{LossLog, LossRecord};
use super::losses::{CodeScale, Loss, Losses, Tensors, Terms};
use super::material::{Material, MeshTrainInput, TrainInput};
use super::networks::{NetworkWeights, Networks};
use super::sketch_loss::Relaxation;
use super::stages::{Epoch, Staged};
use super::tape::Tape;
use super::{Progress, StageName, TrainConfig, TrainError};
use crate::dataset::{BasisFit, Batcher, BodySet, random};

/// What a run yields.
#[derive(Debug, Clone)]
pub struct Trained {
    /// The model, not yet measured.
    pub model: Model,
    /// The losses, epoch by epoch.
    pub log: LossLog,
    /// How well the final layer holds posed meshes.
    pub basis_fit: BasisFit,
}

/// Trains a model of a rigged body. With a `run_folder` it leaves there, as it goes, `checkpoint.safetensors`, `losses.csv` and
/// `losses.png`; with `resume` it goes on from that checkpoint if there is one.
///
/// # Errors
/// [`TrainError`]; a checkpoint written before stays usable.
pub fn train(
    input: &TrainInput<'_>,
    config: &TrainConfig,
    run_folder: Option<&Path>,
    resume: bool,
    progress: &dyn Progress,
) -> Result<Trained, TrainError> {
    config.validate()?;
    let material = Material::of_rig(input, config, progress)?;
    run(material, config, run_folder, resume, progress)
}

/// Trains a model of registered meshes, on their principal components; otherwise as [`train`].
///
/// # Errors
/// [`TrainError`]; a checkpoint written before stays usable.
pub fn train_meshes(
    input: &MeshTrainInput<'_>,
    config: &TrainConfig,
    run_folder: Option<&Path>,
    resume: bool,
    progress: &dyn Progress,
) -> Result<Trained, TrainError> {
    config.validate()?;
    let material = Material::of_meshes(input, config, progress)?;
    run(material, config, run_folder, resume, progress)
}

fn run(
    material: Material<'_>,
    config: &TrainConfig,
    run_folder: Option<&Path>,
    resume: bool,
    progress: &dyn Progress,
) -> Result<Trained, TrainError> {
    let run = Run::new(material, config)?;
    let first = run.initial_weights();
    let (networks, log) = run.run_stages(first, run_folder, resume, progress)?;
    let weights = networks.to_weights()?;
    let model = export::model(config, &run, weights)?;
    Ok(Trained {
        model,
        log,
        basis_fit: run.material.basis_fit,
    })
}

/// Everything that stays the same over a run.
pub(super) struct Run<'a> {
    config: &'a TrainConfig,
    device: Device,
    pub(super) material: Material<'a>,
    pub(super) scale: CodeScale,
    pub(super) data_hash: String,
    losses: Losses,
    /// Tells checkpoints of this run from others: hash of configuration and data.
    identity: String,
}

impl Staged for Run<'_> {
    type Networks = Networks;
    type Weights = NetworkWeights;
    type Fixed = ();

    fn identity(&self) -> &str {
        &self.identity
    }

    fn checkpoint_every(&self) -> usize {
        self.config.checkpoint_every
    }

    fn epochs(&self) -> [usize; 3] {
        self.config.stages.map(|stage| stage.epochs)
    }

    fn networks(&self, weights: &NetworkWeights) -> Networks {
        Networks::new(weights, &self.device)
    }

    fn weights(&self, networks: &Networks) -> Result<NetworkWeights, TrainError> {
        networks.to_weights()
    }

    fn fixed(&self, _stage: StageName, _networks: &Networks) -> Result<(), TrainError> {
        Ok(())
    }

    fn epoch(
        &self,
        mut networks: Networks,
        at: Epoch,
        _fixed: &(),
        adam: &mut Adam,
        progress: &dyn Progress,
    ) -> Result<(Networks, LossRecord), TrainError> {
        let batcher = self.batcher();
        // Every epoch of every stage has its own random numbers.
        let epoch = ((at.stage as u64) << 16) | at.index as u64;
        let order = batcher.order(epoch);
        let count = batcher.batches_per_epoch();
        progress.begin(&at.label(), count);
        let mut record = at.record();
        for index in 0..count {
            let batch = batcher.batch(epoch, index, &order)?;
            let noise = batcher.noise(epoch, index, batch.len * self.config.latent_len);
            let tensors = self
                .losses
                .tensors(&batch, noise, &self.scale, &self.device)?;
            let (step, steps) = (at.index * count + index, at.count * count);
            let rate = self.config.stages[at.stage].learning_rate * schedule(step, steps);
            let done = step as f64 / steps as f64;
            let relaxation = self.relaxation(at.name, (epoch, index), done, batch.len);
            let (stepped, terms) =
                self.step(networks, at.name, &tensors, &relaxation, adam, rate)?;
            networks = stepped;
            record.add(terms, 1.0 / count as f64)?;
            progress.advance(1);
        }
        record.round();
        Ok((networks, record))
    }
}

impl<'a> Run<'a> {
    fn new(material: Material<'a>, config: &'a TrainConfig) -> Result<Self, TrainError> {
        let Material { figure, shape, .. } = &material;
        if material.bodies.len == 0 {
            return Err(TrainError::Config(
                "there are no bodies to train on".to_owned(),
            ));
        }
        let scale = code_scale(&material.bodies, config);
        let device = config.device.open()?;
        let extent_m = material.extent_m;
        let losses = Losses::new(figure, shape, &scale, extent_m, config.loss, &device);
        let data_hash = material.bodies.hash();
        let identity = sha256_hex(format!("{config:?} {data_hash}").as_bytes());
        Ok(Self {
            config,
            device,
            material,
            scale,
            data_hash,
            losses,
            identity,
        })
    }

    fn initial_weights(&self) -> NetworkWeights {
        let Material { figure, shape, .. } = &self.material;
        let vertex_count = shape.layer().vertex_count();
        let architecture = self.config.architecture(shape.code_columns());
        let sizes = architecture.sizes(figure.input_len(), self.config.latent_len, vertex_count);
        let (encoder3d, head, encoder2d) = initial_weights(&sizes, self.config.seed);
        NetworkWeights {
            encoder3d,
            head,
            encoder2d,
        }
    }

    fn batcher(&self) -> Batcher<'_> {
        Batcher {
            figure: self.material.figure,
            bodies: &self.material.bodies,
            rotations: self.config.rotations,
            augmentation: self.config.augmentation,
            batch_size: self.config.batch_size,
            seed: self.config.seed,
        }
    }

    /// What the hypotheses that are not the nearest learn in a step. In the beginning much, so that none is left behind.
    fn relaxation(
        &self,
        stage: StageName,
        (epoch, index): (u64, usize),
        done: f64,
        len: usize,
    ) -> Relaxation {
        const LEAST_SHARE: f64 = 0.03;
        let share = match stage {
            StageName::Encoder2d => LEAST_SHARE.max(0.5 * (1.0 - 1.5 * done)),
            StageName::Autoencoder | StageName::Joint => LEAST_SHARE,
        };
        let mut rng = random(self.config.seed, "others", (epoch << 24) | index as u64);
        let others = (0..len)
            .map(|_| rng.random_range(0..self.config.hypotheses))
            .collect();
        Relaxation { share, others }
    }

    /// One step of one stage: which loss, and which networks it moves.
    fn step(
        &self,
        networks: Networks,
        stage: StageName,
        batch: &Tensors,
        relaxation: &Relaxation,
        adam: &mut Adam,
        rate: f64,
    ) -> Result<(Networks, Terms), TrainError> {
        use burn::module::Module as _;
        let backend = TrainError::Backend;
        let mut tape = Tape::default();
        let Networks { vae, encoder2d } = networks;
        match stage {
            StageName::Autoencoder => {
                let (loss, terms) = self.losses.autoencoder(&vae, batch, &mut tape)?;
                let terms = with_loss(&loss, terms);
                let gradients = self.losses.backward(loss, tape)?;
                let gradients = GradientsParams::from_grads(gradients, &vae);
                let vae = adam.step(vae, gradients, rate).map_err(backend)?;
                Ok((Networks { vae, encoder2d }, terms))
            }
            StageName::Encoder2d => {
                let frozen = Networks {
                    vae: vae.clone().no_grad(),
                    encoder2d,
                };
                let (mean, _) = frozen.vae.encoder3d.forward(batch.codes.clone());
                let mean = mean.detach();
                let losses = &self.losses;
                let (loss, terms) = losses.sketch(&frozen, mean, batch, relaxation, &mut tape)?;
                let terms = with_loss(&loss, terms);
                let gradients = self.losses.backward(loss, tape)?;
                let encoder2d = frozen.encoder2d;
                let gradients = GradientsParams::from_grads(gradients, &encoder2d);
                let encoder2d = adam.step(encoder2d, gradients, rate).map_err(backend)?;
                Ok((Networks { vae, encoder2d }, terms))
            }
            StageName::Joint => {
                let networks = Networks { vae, encoder2d };
                let losses = &self.losses;
                let (autoencoder, mut terms) =
                    losses.autoencoder(&networks.vae, batch, &mut tape)?;
                let (mean, _) = networks.vae.encoder3d.forward(batch.codes.clone());
                let (sketch, sketch_terms) =
                    losses.sketch(&networks, mean, batch, relaxation, &mut tape)?;
                terms.extend(sketch_terms);
                let loss = sketch.plus(autoencoder, losses.autoencoder_weight());
                let terms = with_loss(&loss, terms);
                let gradients = losses.backward(loss, tape)?;
                let gradients = GradientsParams::from_grads(gradients, &networks);
                Ok((
                    adam.step(networks, gradients, rate).map_err(backend)?,
                    terms,
                ))
            }
        }
    }
}

fn with_loss(loss: &Loss, mut terms: Terms) -> Terms {
    terms.push(("loss", loss.value()));
    terms
}

/// The learning rate's factor at one of `steps` steps: up to 1 over the first few, then down to a hundredth along half
/// a cosine.
fn schedule(step: usize, steps: usize) -> f64 {
    let warm_up = ((step + 1) as f64 / (steps as f64 / 20.0).clamp(1.0, 100.0)).min(1.0);
    let done = step as f64 / steps.max(1) as f64;
    warm_up * (0.01 + 0.99 * 0.5 * (1.0 + (std::f64::consts::PI * done).cos()))
}

/// The mean of turned bodies' codes, and how far a number of a code is from it on average.
fn code_scale(bodies: &BodySet, config: &TrainConfig) -> CodeScale {
    let width = bodies.code_of(0).len();
    let mut rng = random(config.seed, "scale", 0);
    let draws = bodies.len.max(5000);
    let (mut sum, mut squares) = (vec![0.0_f64; width], 0.0_f64);
    let mut turned = vec![0.0; width];
    for draw in 0..draws {
        let turn = config.rotations.sample(&mut rng);
        crate::dataset::turn_coefficients(turn, bodies.code_of(draw % bodies.len), &mut turned);
        sum.iter_mut()
            .zip(&turned)
            .for_each(|(sum, x)| *sum += f64::from(*x));
        squares += turned.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>();
    }
    let count = draws as f64;
    let mean: Vec<f32> = sum.iter().map(|x| (x / count) as f32).collect();
    let of_mean: f64 = mean.iter().map(|x| f64::from(*x).powi(2)).sum();
    let variance = (squares / count - of_mean).max(1e-12) / width as f64;
    CodeScale {
        mean,
        scale: variance.sqrt() as f32,
    }
}
