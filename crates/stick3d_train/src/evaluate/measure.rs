//! Measuring many cases side by side: the same numbers whatever the number of cores.

use std::time::Instant;

use glam::{Quat, Vec2, Vec3};
use rayon::prelude::*;
use stick3d_figure::sketch::Sketch;
use stick3d_model::{Alternatives, Inference, Model};

use super::recognition::readable_flat_pose;
use super::report::{Latency, PartReport, Report, Row, TestSet};
use super::spread::Spread;
use super::ways::{Body, CROOKED, Drawing, WAYS, Way, drawn_in_all_ways};
use super::{Baseline, Collector, EvalConfig, EvalError, Recognition};
use crate::dataset::{drawn, random, rounded};
use crate::training::Progress;

/// Cases that are measured one after the other. What is found is put together group by group, in order, so that sums do not
/// depend on which thread was first.
const GROUP: usize = 10;

/// A part of the test set: bodies, each of which is turned once.
pub(super) struct Part<C> {
    pub(super) name: &'static str,
    pub(super) cases: Vec<C>,
}

/// Whose answer is compared with the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    /// The likeliest of the model's alternatives.
    First,
    /// The one nearest to the truth.
    Best,
    /// The first, but for the limb whose depth had best be the other way round, if any: what one click makes of it.
    Flipped,
    /// What Encoder2D alone holds for likeliest, not pulled onto the drawing.
    Plain,
    /// The baseline's.
    Nearest,
}

const ANSWERS: [Answer; 5] = [
    Answer::First,
    Answer::Best,
    Answer::Flipped,
    Answer::Plain,
    Answer::Nearest,
];

impl Answer {
    fn name(self) -> &'static str {
        match self {
            Self::First => "first answer",
            Self::Best => "best alternative",
            Self::Flipped => "one limb flipped",
            Self::Plain => "network alone",
            Self::Nearest => "nearest neighbour",
        }
    }
}

/// Measures a model on parts of a test set; `body` makes the body of a case.
pub(super) fn measure<C: Sync>(
    model: &Model,
    baseline: &Baseline,
    parts: &[Part<C>],
    body: &(dyn Fn(&C) -> Body + Sync),
    config: &EvalConfig,
    progress: &dyn Progress,
) -> Result<Report, EvalError> {
    let setup = Setup {
        model,
        baseline,
        config,
        ways: Way::all(model.figure()),
        progress,
    };
    let cases = parts.iter().map(|part| part.cases.len()).sum::<usize>();
    progress.begin("measuring", cases);
    let mut reports = vec![];
    let mut sketches = vec![];
    for part in parts.iter().filter(|part| !part.cases.is_empty()) {
        let found = setup.part(part, body)?;
        reports.push(found.report(&setup, part.name, part.cases.len()));
        sketches.extend(found.clean);
    }
    Ok(Report {
        test: TestSet {
            figure: model.figure().name.clone(),
            seed: config.seed,
            baseline_meshes: baseline.len(),
        },
        parts: reports,
        flat_any_order: setup.flat_any_order(),
        latency: match config.latency {
            true => Some(latency(model, &sketches, progress)?),
            false => None,
        },
    })
}

/// What all cases share.
struct Setup<'a> {
    model: &'a Model,
    baseline: &'a Baseline,
    config: &'a EvalConfig,
    ways: [Way; WAYS],
    progress: &'a dyn Progress,
}

/// What some cases have yielded.
#[derive(Debug, Default)]
struct Found {
    /// Per way of drawing and answer.
    collectors: [[Collector; ANSWERS.len()]; WAYS],
    /// Per way of drawing, how many alternatives there were.
    choice: [Spread; WAYS],
    any_order: Recognition,
    /// The clean sketches.
    clean: Vec<Sketch>,
}

impl Setup<'_> {
    fn part<C: Sync>(
        &self,
        part: &Part<C>,
        body: &(dyn Fn(&C) -> Body + Sync),
    ) -> Result<Found, EvalError> {
        let groups: Vec<Found> = part
            .cases
            .par_chunks(GROUP)
            .enumerate()
            .map(|(group, cases)| {
                let mut bench = Bench::new(self)?;
                for (i, case) in cases.iter().enumerate() {
                    bench.case(part.name, group * GROUP + i, &body(case))?;
                    self.progress.advance(1);
                }
                Ok(bench.found)
            })
            .collect::<Result<_, EvalError>>()?;
        let mut all = Found::default();
        groups.into_iter().for_each(|found| all.merge(found));
        Ok(all)
    }

    fn flat_any_order(&self) -> Recognition {
        let figure = self.model.figure();
        let counts: Vec<Recognition> = (0..self.config.flat_drawings as u64)
            .into_par_iter()
            .map(|number| {
                let mut rng = random(self.config.seed, "flat drawings", number);
                let mut count = Recognition::default();
                if let Some(pose) = readable_flat_pose(figure, &mut rng) {
                    count.add(figure, &pose, 1, &mut rng);
                }
                count
            })
            .collect();
        let mut all = Recognition::default();
        counts.iter().for_each(|count| all.merge(count));
        all
    }
}

impl Found {
    fn merge(&mut self, other: Self) {
        for (ours, theirs) in self.collectors.iter_mut().zip(&other.collectors) {
            for (ours, theirs) in ours.iter_mut().zip(theirs) {
                ours.merge(theirs);
            }
        }
        for (ours, theirs) in self.choice.iter_mut().zip(&other.choice) {
            ours.merge(theirs);
        }
        self.any_order.merge(&other.any_order);
        self.clean.extend(other.clean);
    }

    fn report(&self, setup: &Setup<'_>, name: &str, cases: usize) -> PartReport {
        let extent_m = setup.model.metadata().normalisation.extent_m;
        let row = |(index, answer): (usize, &Answer), way: usize| -> Option<Row> {
            let collector = &self.collectors[way][index];
            (collector.cases() > 0).then(|| Row {
                answer: answer.name().to_owned(),
                drawn: setup.ways[way].name.to_owned(),
                noise: setup.ways[way].noise,
                choice: match answer {
                    Answer::Best => rounded(self.choice[way].mean()),
                    _ => 1.0,
                },
                metrics: collector.metrics(extent_m),
            })
        };
        let rows = ANSWERS
            .iter()
            .enumerate()
            .flat_map(|answer| (0..WAYS).filter_map(move |way| row(answer, way)));
        PartReport {
            name: name.to_owned(),
            cases,
            rows: rows.collect(),
            any_order: self.any_order,
        }
    }
}

/// What a thread works with.
struct Bench<'a> {
    setup: &'a Setup<'a>,
    inference: Inference,
    alternatives: Alternatives,
    positions: Vec<[f32; 3]>,
    found: Found,
}

impl<'a> Bench<'a> {
    fn new(setup: &'a Setup<'a>) -> Result<Self, EvalError> {
        let inference = Inference::new(setup.model)?;
        Ok(Self {
            positions: vec![[0.0; 3]; inference.vertex_count()],
            inference,
            setup,
            alternatives: Alternatives::default(),
            found: Found::default(),
        })
    }

    /// Turns a body, draws it in all ways, and compares what comes of it.
    fn case(&mut self, part: &str, case: usize, body: &Body) -> Result<(), EvalError> {
        let (figure, config) = (self.setup.model.figure(), self.setup.config);
        let mut rng = random(config.seed, part, case as u64);
        let (truth, drawings) = drawn_in_all_ways(figure, &self.setup.ways, body, case, &mut rng)?;
        for (way, drawing) in drawings.iter().enumerate() {
            self.compare(way, drawing, &truth)?;
        }
        let clean = drawings.into_iter().next();
        self.found.clean.extend(clean.map(|drawing| drawing.sketch));
        let flat: Vec<Vec2> = drawn(Quat::IDENTITY, &truth.1);
        let times = config.drawings_per_case;
        self.found.any_order.add(figure, &flat, times, &mut rng);
        Ok(())
    }

    /// Compares all answers to a sketch with the truth.
    fn compare(&mut self, way: usize, drawing: &Drawing, truth: &Body) -> Result<(), EvalError> {
        let figure = self.setup.model.figure();
        let sketch = &drawing.sketch;
        self.inference
            .infer(drawing.marked(), &mut self.alternatives)?;
        let alternatives = self.alternatives.as_slice().iter();
        let latents: Vec<Vec<f32>> = alternatives.map(|found| found.latent.clone()).collect();
        let answers = self.meshes(&latents)?;
        self.found.choice[way].add(answers.len() as f32);
        let best = nearest_to(truth, &answers);
        let mut latent = vec![0.0; self.inference.latent_len()];
        self.inference.encode_plain(sketch, &mut latent)?;
        let plain = self.meshes(&[latent])?.pop();
        let (mut flipped, mut nearest) = (None, None);
        if self.setup.ways[way].in_full {
            if let Some(first) = latents.first() {
                flipped = self.one_limb_flipped(drawing, first, truth)?;
            }
            nearest = Some(self.setup.baseline.nearest(figure, sketch)?);
        }
        for (index, answer) in ANSWERS.iter().enumerate() {
            let mesh = match answer {
                Answer::First => answers.first(),
                Answer::Best => best,
                Answer::Flipped => flipped.as_ref(),
                Answer::Plain => plain.as_ref(),
                Answer::Nearest => nearest.as_ref(),
            };
            if let Some(mesh) = mesh {
                let joints = self.setup.model.regressor().joints(mesh);
                self.found.collectors[way][index].add(
                    figure,
                    (mesh, &joints),
                    (&truth.0, &truth.1),
                );
            }
        }
        Ok(())
    }

    /// The first answer, but for the limb whose depth had best be the other way round, if any.
    fn one_limb_flipped(
        &mut self,
        drawing: &Drawing,
        first: &[f32],
        truth: &Body,
    ) -> Result<Option<Vec<Vec3>>, EvalError> {
        let mut choice = vec![first.to_vec()];
        for limb in self.setup.model.figure().limbs() {
            let mut flipped = first.to_vec();
            self.inference
                .flip_limb(drawing.marked(), first, &limb, &mut flipped)?;
            choice.push(flipped);
        }
        let meshes = self.meshes(&choice)?;
        Ok(nearest_to(truth, &meshes).cloned())
    }

    fn meshes(&mut self, latents: &[Vec<f32>]) -> Result<Vec<Vec<Vec3>>, EvalError> {
        let mesh = |latent: &Vec<f32>| {
            self.inference
                .decode_positions(latent, &mut self.positions)?;
            Ok(self.positions.iter().copied().map(Vec3::from).collect())
        };
        latents.iter().map(mesh).collect()
    }
}

/// The mesh of which vertices are nearest to those of the truth.
fn nearest_to<'a>(truth: &Body, meshes: &'a [Vec<Vec3>]) -> Option<&'a Vec<Vec3>> {
    let distance = |mesh: &Vec<Vec3>| -> f64 {
        let pairs = mesh.iter().zip(&truth.0);
        pairs.map(|(a, b)| f64::from(a.distance(*b))).sum()
    };
    meshes
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The first sketches of every part, `count` in all, named after part, number and way: clean ones, and every third as
/// crooked as they are measured.
pub(super) fn sketches<C>(
    model: &Model,
    parts: &[Part<C>],
    body: &dyn Fn(&C) -> Body,
    config: &EvalConfig,
    count: usize,
) -> Result<Vec<(String, Sketch)>, EvalError> {
    let figure = model.figure();
    let ways = Way::all(figure);
    let parts: Vec<&Part<C>> = parts.iter().filter(|part| !part.cases.is_empty()).collect();
    let each = count.div_ceil(parts.len().max(1));
    let mut list = vec![];
    for part in parts {
        for (number, case) in part.cases.iter().take(each).enumerate() {
            let mut rng = random(config.seed, part.name, number as u64);
            let (_, drawings) = drawn_in_all_ways(figure, &ways, &body(case), number, &mut rng)?;
            let way = if number % 3 == 2 { CROOKED } else { 0 };
            if let Some(drawing) = drawings.into_iter().nth(way) {
                let label = format!("{} {}, {}", part.name, number + 1, ways[way].name);
                list.push((label, drawing.sketch));
            }
        }
    }
    list.truncate(count);
    Ok(list)
}

/// How long all answers to each sketch take.
fn latency(
    model: &Model,
    sketches: &[Sketch],
    progress: &dyn Progress,
) -> Result<Latency, EvalError> {
    progress.begin("measuring latency", sketches.len());
    let mut inference = Inference::new(model)?;
    let mut alternatives = Alternatives::default();
    // Memory is taken while the first ones are answered.
    for sketch in sketches.iter().take(GROUP) {
        inference.infer(sketch, &mut alternatives)?;
    }
    let mut spread = Spread::default();
    for sketch in sketches {
        let start = Instant::now();
        inference.infer(sketch, &mut alternatives)?;
        spread.add(start.elapsed().as_secs_f32());
        progress.advance(1);
    }
    Ok(Latency {
        sketches: sketches.len(),
        p50_ms: rounded(1e3 * spread.percentile(50.0)),
        p99_ms: rounded(1e3 * spread.percentile(99.0)),
    })
}
