//! How long an epoch of the paper's autoencoder takes: 1,512 samples of 37,500 numbers, hidden width 512, latent 256.
//!
//! `cargo bench --bench paper_epoch -- [EPOCHS [BATCH]]` (with `--workspace --profile dev` it reuses what the tests have
//! built). `paper_epoch.py` beside this file does the same with `PyTorch`, and runs both in turns.
#![allow(
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a benchmark says what it measured, and stops when it cannot"
)]

use std::sync::Mutex;
use std::time::Instant;

use glam::Vec3;
use stick3d_figure::figure::Figure;
use stick3d_figure::regressor::JointRegressor;
use stick3d_train::dataset::Rotations;
use stick3d_train::paper::{KeyMesh, PaperConfig, PaperSet, Split, train_paper};
use stick3d_train::training::{LossRecord, Progress};

const MESHES: usize = 72;
const VERTICES: usize = 12_500;

/// Prints how long each epoch took.
struct Clock(Mutex<Instant>);

impl Progress for Clock {
    fn begin(&self, _: &str, _: usize) {
        if let Ok(mut start) = self.0.lock() {
            *start = Instant::now();
        }
    }

    fn epoch(&self, _: &LossRecord) {
        if let Ok(start) = self.0.lock() {
            println!("epoch_s {:.3}", start.elapsed().as_secs_f64());
        }
    }
}

/// Meshes that cost as much as real ones: what the numbers are makes no difference.
fn meshes() -> PaperSet {
    let figure = Figure::human().clone();
    let number = |seed: usize| ((seed as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f32;
    let point = |seed: usize| {
        let [x, y, z] = [3 * seed, 3 * seed + 1, 3 * seed + 2].map(number);
        Vec3::new(x, y, z) / (1 << 23) as f32 - Vec3::ONE
    };
    let mesh = |mesh: usize| {
        let positions: Vec<Vec3> = (0..VERTICES)
            .map(|v| point(v) + 0.2 * point(mesh * VERTICES + v))
            .collect();
        KeyMesh {
            name: format!("mesh {mesh}"),
            joints: positions[..figure.joint_count()].to_vec(),
            positions,
        }
    };
    PaperSet {
        meshes: (0..MESHES).map(mesh).collect(),
        regressor: JointRegressor {
            rows: (0..figure.joint_count() as u32)
                .map(|vertex| vec![(vertex, 1.0)])
                .collect(),
        },
        figure,
        triangles: vec![[0, 1, 2]],
        colors: vec![[150, 150, 150, 255]; VERTICES],
        extent_m: 1.0,
        kept: None,
        turns: Rotations::paper_list(),
    }
}

fn main() {
    let mut numbers = std::env::args()
        .skip(1)
        .filter_map(|text| text.parse().ok());
    let (epochs, batch_size) = (
        numbers.next().unwrap_or(3),
        numbers
            .next()
            .unwrap_or(PaperConfig::published(MESHES).batch_size),
    );
    let set = meshes();
    let samples = set
        .samples(Split::Pose, &[], 1)
        .expect("nothing is held out");
    let config = PaperConfig {
        epochs: [epochs, 0, 0],
        batch_size,
        ..PaperConfig::published(MESHES)
    };
    let clock = Clock(Mutex::new(Instant::now()));
    train_paper(&set, &samples, &config, None, false, &clock).expect("it trains");
}
