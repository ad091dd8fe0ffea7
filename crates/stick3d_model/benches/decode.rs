//! How long a frame takes, beside the time to read the final layer's bytes once.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use stick3d_figure::sketch::Sketch;
use stick3d_model::{Inference, Model};

const MODEL: &[u8] = include_bytes!("../../../assets/models/human.stick3d");

/// Coefficients of the dense basis that the skinned layer replaces, for orientation.
const DENSE_RANK: usize = 288;

struct Frame {
    inference: Inference,
    sketch: Sketch,
    latent: Vec<f32>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
}

impl Frame {
    fn new(model: &Model) -> Self {
        let inference = Inference::new(model).expect("the shipped model runs");
        Self {
            sketch: Sketch::template(model.figure()),
            latent: vec![0.0; inference.latent_len()],
            positions: vec![[0.0; 3]; inference.vertex_count()],
            normals: vec![[0.0; 3]; inference.vertex_count()],
            inference,
        }
    }

    fn encode(&mut self) {
        self.inference
            .encode(&self.sketch, &mut self.latent)
            .expect("the template is a sketch");
    }

    fn positions(&mut self) {
        self.inference
            .decode_positions(&self.latent, &mut self.positions)
            .expect("the latent is sound");
    }

    fn decode(&mut self) {
        self.inference
            .decode(&self.latent, &mut self.positions, &mut self.normals)
            .expect("the latent is sound");
    }
}

/// Reads all bytes once, as wide as the compiler makes it.
fn read(numbers: &[f32]) -> f32 {
    let (chunks, _) = numbers.as_chunks::<64>();
    let mut sums = [0.0_f32; 64];
    for chunk in chunks {
        for (sum, x) in sums.iter_mut().zip(chunk) {
            *sum += x;
        }
    }
    sums.iter().sum()
}

fn median(mut run: impl FnMut()) -> Duration {
    let mut times: Vec<Duration> = (0..400)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed()
        })
        .collect();
    times.sort();
    times[times.len() / 2]
}

#[allow(clippy::print_stdout, reason = "a benchmark prints")]
fn ratios(model: &Model, frame: &mut Frame) {
    let own = vec![1.0_f32; model.final_layer().byte_len() / 4];
    let dense = vec![1.0_f32; 3 * model.vertex_count() * DENSE_RANK];
    let read_own = median(|| {
        black_box(read(black_box(&own)));
    });
    let read_dense = median(|| {
        black_box(read(black_box(&dense)));
    });
    let encode = median(|| frame.encode());
    let positions = median(|| frame.positions());
    let decode = median(|| frame.decode());
    let whole = median(|| {
        frame.encode();
        frame.decode();
    });
    let us = |time: Duration| 1e6 * time.as_secs_f64();
    println!(
        "medians: encode {:.0} us, decode without normals {:.0} us, with normals {:.0} us",
        us(encode),
        us(positions),
        us(decode)
    );
    println!("encode + decode + normals {:.0} us", us(whole));
    let ratio = |bytes: usize, time: Duration, name: &str| {
        println!(
            "reading {name} once ({:.2} MB): {:.0} us; encode + decode + normals takes {:.2} times that, decode + normals {:.2} times",
            bytes as f64 / 1e6,
            us(time),
            whole.as_secs_f64() / time.as_secs_f64(),
            decode.as_secs_f64() / time.as_secs_f64()
        );
    };
    ratio(4 * own.len(), read_own, "this final layer's bytes");
    ratio(
        4 * dense.len(),
        read_dense,
        "a dense final layer of 288 coefficients",
    );
}

fn frame(criterion: &mut Criterion) {
    let model = Model::from_bytes(MODEL).expect("the shipped model is sound");
    let mut frame = Frame::new(&model);
    ratios(&model, &mut frame);
    criterion.bench_function("encode", |b| b.iter(|| frame.encode()));
    criterion.bench_function("decode positions", |b| b.iter(|| frame.positions()));
    criterion.bench_function("decode with normals", |b| b.iter(|| frame.decode()));
}

criterion_group!(benches, frame);
criterion_main!(benches);
