//! One training run from rig and poses to a model.

use std::path::Path;

use burn::optim::GradientsParams;
use burn::tensor::{Device, Tensor};
use rayon::prelude::*;
use stick3d_figure::figure::Figure;
use stick3d_figure::regressor::JointRegressor;
use stick3d_model::Model;
use stick3d_model::digest::sha256_hex;

use super::adam::Adam;
use super::checkpoint::Checkpoint;
use super::export;
use super::init::initial_weights;
use super::log::{LossLog, LossRecord};
use super::losses::{CodeScale, Losses, Tensors, Terms, values};
use super::networks::{NetworkWeights, Networks};
use super::{Progress, StageConfig, StageName, TrainConfig, TrainError, plot};
use crate::dataset::{BasisFit, Batcher, BodySet, PoseStreams, SkinBasis, random, rounded};
use crate::rig::{Pose, Rig, regressor};

/// What a run learns from.
pub struct TrainInput<'a> {
    /// What is drawn.
    pub figure: &'a Figure,
    /// The body.
    pub rig: &'a Rig,
    /// Poses of the library, mirror images included.
    pub library: &'a [Pose],
    /// Sampled poses.
    pub streams: &'a PoseStreams<'a>,
    /// Names of library poses that are not among them; kept in the model for its evaluation.
    pub held_out_poses: Vec<String>,
}

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

/// Streams from this number on make the meshes that the basis comes from; bodies come from lower ones.
const BASIS_STREAM: u64 = 1 << 32;

/// Trains a model. With a `run_folder` it leaves there, as it goes, `checkpoint.safetensors`, `losses.csv` and
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
    let run = Run::prepare(input, config, progress)?;
    let path = run_folder.map(|folder| folder.join("checkpoint.safetensors"));
    let fresh = || Checkpoint::start(run.initial_weights());
    let checkpoint = match &path {
        Some(path) if resume && path.exists() => Checkpoint::load(path, &run.identity, fresh())?,
        _ => fresh(),
    };
    let (weights, log) = run.stages(checkpoint, run_folder, progress)?;
    let model = export::model(input, config, &run, weights)?;
    Ok(Trained {
        model,
        log,
        basis_fit: run.basis_fit,
    })
}

/// Everything that stays the same over a run.
pub(super) struct Run<'r, 'a> {
    input: &'r TrainInput<'a>,
    config: &'r TrainConfig,
    device: Device,
    pub(super) regressor: JointRegressor,
    pub(super) basis: SkinBasis,
    pub(super) basis_fit: BasisFit,
    pub(super) scale: CodeScale,
    pub(super) extent_m: f32,
    pub(super) data_hash: String,
    pub(super) bodies: BodySet,
    losses: Losses,
    /// Tells checkpoints of this run from others: hash of configuration and data.
    identity: String,
}

impl<'r, 'a> Run<'r, 'a> {
    fn prepare(
        input: &'r TrainInput<'a>,
        config: &'r TrainConfig,
        progress: &dyn Progress,
    ) -> Result<Self, TrainError> {
        config.validate()?;
        let TrainInput { figure, rig, .. } = *input;
        let regressor = regressor(figure, rig)?;
        let root = figure.root;

        progress.begin("fitting the skin", config.basis.poses);
        let sample = |count, first_stream| sample_poses(input, count, first_stream);
        let poses = sample(config.basis.poses, BASIS_STREAM);
        let basis = SkinBasis::fit(rig, &regressor, root, config.basis, &poses)?;
        progress.advance(config.basis.poses);
        let basis_fit = basis.measure(rig, &regressor, root, &sample(64, 2 * BASIS_STREAM));
        progress.note(&format!(
            "skin of {} bones: vertices off by {:.2} mm on average, {:.2} mm for 99 %, {:.1} mm at most",
            basis.rotations().bone_count,
            1e3 * basis_fit.mean_m,
            1e3 * basis_fit.p99_m,
            1e3 * basis_fit.max_m
        ));

        progress.begin("posing bodies", config.sampled_bodies + input.library.len());
        let advance = |steps| progress.advance(steps);
        let mut bodies =
            BodySet::sample(rig, &basis, input.streams, config.sampled_bodies, &advance);
        let library = BodySet::from_poses(rig, &basis, input.library.iter().cloned(), &advance);
        for _ in 0..config.library_repeats {
            bodies.extend(library.clone());
        }
        if bodies.len == 0 {
            return Err(TrainError::Config(
                "there are no bodies to train on".to_owned(),
            ));
        }
        let scale = code_scale(&bodies, config);
        let (low, high) = rig.mesh.bounds();
        let extent_m = (high - low).max_element() / 2.0;
        let device = Device::flex().autodiff();
        let losses = Losses::new(figure, &basis, &scale, extent_m, config.loss, &device);
        let data_hash = bodies.hash();
        let identity = sha256_hex(format!("{config:?} {data_hash}").as_bytes());
        Ok(Self {
            input,
            config,
            device,
            regressor,
            basis,
            basis_fit,
            scale,
            extent_m,
            data_hash,
            bodies,
            losses,
            identity,
        })
    }

    fn initial_weights(&self) -> NetworkWeights {
        let figure = self.input.figure;
        let vertex_count = self.input.rig.mesh.positions.len();
        let architecture = self.config.architecture(self.basis.code_columns());
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
            figure: self.input.figure,
            bodies: &self.bodies,
            rotations: self.config.rotations,
            augmentation: self.config.augmentation,
            batch_size: self.config.batch_size,
            seed: self.config.seed,
        }
    }

    fn stages(
        &self,
        mut state: Checkpoint,
        run_folder: Option<&Path>,
        progress: &dyn Progress,
    ) -> Result<(NetworkWeights, LossLog), TrainError> {
        let mut networks = Networks::new(&state.weights, &self.device);
        let stages = self.config.named_stages();
        while let Some((name, stage)) = stages.get(state.stage) {
            if state.epoch == 0 {
                state.adam = Adam::default();
            }
            while state.epoch < stage.epochs {
                let (trained, record) =
                    self.epoch(networks, *name, *stage, &mut state, progress)?;
                networks = trained;
                progress.epoch(&record);
                check_loss(&record)?;
                state.log.records.push(record);
                state.epoch += 1;
                let stop = progress.should_stop();
                let due = state
                    .epoch
                    .is_multiple_of(self.config.checkpoint_every.max(1))
                    || state.epoch == stage.epochs;
                if let Some(folder) = run_folder.filter(|_| stop || due) {
                    state.weights = networks.to_weights()?;
                    self.leave(folder, &mut state)?;
                }
                if stop {
                    return Err(TrainError::Stopped {
                        epochs: state.log.records.len(),
                    });
                }
            }
            state.stage += 1;
            state.epoch = 0;
        }
        Ok((networks.to_weights()?, state.log))
    }

    /// Writes checkpoint, log and plot.
    fn leave(&self, folder: &Path, state: &mut Checkpoint) -> Result<(), TrainError> {
        state.save(&folder.join("checkpoint.safetensors"), &self.identity)?;
        let write = |name: &str, bytes: &[u8]| {
            let path = folder.join(name);
            stick3d_model::files::write_atomically(&path, bytes)
                .map_err(|source| TrainError::Io { path, source })
        };
        write("losses.csv", state.log.to_csv().as_bytes())?;
        write("losses.png", &plot::png(&state.log)?)
    }

    fn epoch(
        &self,
        mut networks: Networks,
        name: StageName,
        stage: StageConfig,
        state: &mut Checkpoint,
        progress: &dyn Progress,
    ) -> Result<(Networks, LossRecord), TrainError> {
        let batcher = self.batcher();
        // Every epoch of every stage has its own random numbers.
        let epoch = ((state.stage as u64) << 16) | state.epoch as u64;
        let order = batcher.order(epoch);
        let count = batcher.batches_per_epoch();
        progress.begin(
            &format!("{} {}/{}", name.label(), state.epoch + 1, stage.epochs),
            count,
        );
        let mut sums: Vec<(String, f64)> = vec![];
        let mut loss_sum = 0.0;
        for index in 0..count {
            let batch = batcher.batch(epoch, index, &order)?;
            let noise = batcher.noise(epoch, index, batch.len * self.config.latent_len);
            let tensors = self
                .losses
                .tensors(&batch, noise, &self.scale, &self.device);
            let rate =
                stage.learning_rate * schedule(state.epoch * count + index, stage.epochs * count);
            let (stepped, terms) = self.step(networks, name, &tensors, &mut state.adam, rate)?;
            networks = stepped;
            for (term, value) in values(terms)? {
                match sums.iter_mut().find(|(known, _)| known == term) {
                    _ if term == "loss" => loss_sum += value,
                    Some((_, sum)) => *sum += value,
                    None => sums.push((term.to_owned(), value)),
                }
            }
            progress.advance(1);
        }
        sums.iter_mut()
            .for_each(|(_, sum)| *sum = rounded(*sum / count as f64));
        let record = LossRecord {
            stage: name,
            epoch: state.epoch,
            epochs: stage.epochs,
            loss: rounded(loss_sum / count as f64),
            terms: sums,
        };
        Ok((networks, record))
    }

    /// One step of one stage: which loss, and which networks it moves.
    fn step(
        &self,
        networks: Networks,
        stage: StageName,
        batch: &Tensors,
        adam: &mut Adam,
        rate: f64,
    ) -> Result<(Networks, Terms), TrainError> {
        use burn::module::Module as _;
        let backend = TrainError::Backend;
        let Networks { vae, encoder2d } = networks;
        match stage {
            StageName::Autoencoder => {
                let (loss, terms) = self.losses.autoencoder(&vae, batch);
                let (gradients, terms) = (loss.backward(), with_loss(loss, terms));
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
                let (loss, terms) = self.losses.sketch(&frozen, mean.detach(), batch);
                let (gradients, terms) = (loss.backward(), with_loss(loss, terms));
                let encoder2d = frozen.encoder2d;
                let gradients = GradientsParams::from_grads(gradients, &encoder2d);
                let encoder2d = adam.step(encoder2d, gradients, rate).map_err(backend)?;
                Ok((Networks { vae, encoder2d }, terms))
            }
            StageName::Joint => {
                let networks = Networks { vae, encoder2d };
                let (autoencoder, mut terms) = self.losses.autoencoder(&networks.vae, batch);
                let (mean, _) = networks.vae.encoder3d.forward(batch.codes.clone());
                let (sketch, sketch_terms) = self.losses.sketch(&networks, mean, batch);
                terms.extend(sketch_terms);
                let loss = sketch + autoencoder * self.losses.autoencoder_weight();
                let (gradients, terms) = (loss.backward(), with_loss(loss, terms));
                let gradients = GradientsParams::from_grads(gradients, &networks);
                Ok((
                    adam.step(networks, gradients, rate).map_err(backend)?,
                    terms,
                ))
            }
        }
    }
}

fn with_loss(loss: Tensor<1>, mut terms: Terms) -> Terms {
    terms.push(("loss", loss.detach()));
    terms
}

fn check_loss(record: &LossRecord) -> Result<(), TrainError> {
    if record.loss.is_finite() {
        return Ok(());
    }
    Err(TrainError::Diverged {
        stage: record.stage.label(),
        epoch: record.epoch,
        loss: record.loss,
    })
}

/// The learning rate's factor at one of `steps` steps: up to 1 over the first few, then down to a hundredth along half
/// a cosine.
fn schedule(step: usize, steps: usize) -> f64 {
    let warm_up = ((step + 1) as f64 / (steps as f64 / 20.0).clamp(1.0, 100.0)).min(1.0);
    let done = step as f64 / steps.max(1) as f64;
    warm_up * (0.01 + 0.99 * 0.5 * (1.0 + (std::f64::consts::PI * done).cos()))
}

/// Some poses, from several streams side by side.
fn sample_poses(input: &TrainInput<'_>, count: usize, first_stream: u64) -> Vec<Pose> {
    const STREAMS: usize = 16;
    (0..STREAMS)
        .into_par_iter()
        .flat_map_iter(|stream| {
            let share = count / STREAMS + usize::from(stream < count % STREAMS);
            (input.streams)(first_stream + stream as u64)
                .take(share)
                .collect::<Vec<_>>()
        })
        .collect()
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
