//! Measuring motions: what is between sketched keys and beyond them, beside what else could be done.
//!
//! A case is a true motion of the rig, turned, of which a few poses are drawn: those are the keys. What a method puts
//! between them is compared with the true meshes of those moments, centred on the root joint. Methods: straight and curved
//! paths through latent space; the vertices of the keys' meshes, straight from one to the next; and the sketches' bones,
//! turned from one to the next and encoded anew (paper section 5.3).

mod cases;
mod gait;
mod measures;
mod methods;
mod report;
mod sketch_level;

pub use cases::{TrueMotion, clip_gaits, clip_motions, held_out_motions};
pub use report::{BetweenReport, BeyondReport, GaitReport, MotionReport, MotionTestSet};
pub(crate) use sketch_level::between as sketch_between;

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};
use stick3d_figure::mesh::unique_edges;
use stick3d_model::latent::{LatentKey, Motion, MotionSettings};
use stick3d_model::{Inference, Model};

use super::EvalError;
use crate::dataset::PoseStream;
use crate::rig::{Pose, Rig};
use crate::training::Progress;
use cases::DrawnMotion;
use measures::{Between, EdgeLengths};
use methods::Method;

/// Which way motions are turned about y before they are drawn, as shares of how far the figure's views are turned at most.
const YAW_SHARES: [f32; 3] = [0.0, 0.5, 0.9];
/// How far beyond the last key extrapolations are followed, in units of the distance between the last two keys.
const FARTHEST: f32 = 8.0;
/// Steps of an extrapolation in one such unit.
const STEPS_BEYOND: usize = 16;
/// The edge stretch that ends the horizon of an extrapolation.
const BROKEN: f32 = 0.05;

/// What a measurement of motions is made of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MotionEvalConfig {
    /// Poses of the sampler by which it is known how long edges may be, beside all poses of the library.
    pub edge_poses: usize,
    /// Frames a second in which motions are looked at.
    pub frames_per_s: f32,
}

impl Default for MotionEvalConfig {
    fn default() -> Self {
        Self {
            edge_poses: 1500,
            frames_per_s: 30.0,
        }
    }
}

/// What motions are measured on.
pub struct MotionEvalInput<'a> {
    /// The body.
    pub rig: &'a Rig,
    /// Motions whose moments between the keys were never trained on.
    pub motions: &'a [TrueMotion],
    /// Motions that walk, run or gallop; loops.
    pub gaits: &'a [TrueMotion],
    /// All poses of the library.
    pub library: &'a [Pose],
    /// Sampled poses.
    pub stream: PoseStream<'a>,
}

/// Measures what a model makes of sketched motions.
///
/// # Errors
/// [`EvalError`].
pub fn evaluate_motion(
    model: &Model,
    input: MotionEvalInput<'_>,
    config: &MotionEvalConfig,
    progress: &dyn Progress,
) -> Result<MotionReport, EvalError> {
    let MotionEvalInput {
        rig,
        motions,
        gaits,
        library,
        stream,
    } = input;
    model.require_topology(&stick3d_model::metadata::topology_hash(
        rig.mesh.positions.len(),
        &rig.mesh.triangles,
    ))?;
    if motions.is_empty() && gaits.is_empty() {
        return Err(EvalError::NoMotions);
    }
    let poses: Vec<Pose> = stream
        .take(config.edge_poses)
        .chain(library.iter().cloned())
        .collect();
    let edges =
        EdgeLengths::longest(rig, unique_edges(&rig.mesh.triangles), &poses).or_as_trained(model);
    let yaws_deg = YAW_SHARES.map(|share| share * model.figure().views.yaw_deg);
    let turns = yaws_deg.map(|yaw_deg| Quat::from_rotation_y(yaw_deg.to_radians()));
    progress.begin(
        "measuring motions",
        (motions.len() + gaits.len()) * turns.len(),
    );
    let mut evaluation = MotionEvaluation {
        model,
        inference: Inference::new(model)?,
        edges,
        config,
        between: Method::ALL.iter().map(|_| Between::default()).collect(),
        truth: Between::default(),
        beyond: vec![],
        gaits: vec![],
    };
    for motion in motions {
        for turn in turns {
            let drawn = DrawnMotion::new(model, rig, motion, turn, config.frames_per_s)?;
            evaluation.case(&drawn)?;
            progress.advance(1);
        }
    }
    for gait in gaits {
        for turn in turns {
            let drawn = DrawnMotion::new(model, rig, gait, turn, config.frames_per_s)?;
            let measured = gait::measure(&drawn, &mut evaluation.inference, config.frames_per_s)?;
            evaluation.gaits.push(measured);
            progress.advance(1);
        }
    }
    Ok(evaluation.report(motions, gaits, &yaws_deg))
}

struct MotionEvaluation<'a> {
    model: &'a Model,
    inference: Inference,
    edges: EdgeLengths,
    config: &'a MotionEvalConfig,
    /// One per method.
    between: Vec<Between>,
    truth: Between,
    beyond: Vec<Beyond>,
    gaits: Vec<gait::Skating>,
}

/// What one extrapolation yields, key distances and shares.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Beyond {
    /// Until edge stretch passes [`BROKEN`]; for the paper's endless straight line.
    unbounded: f32,
    /// The same for the vertices' straight line.
    vertex_linear: f32,
    /// How far the bounded one goes.
    bounded: f32,
    /// The largest edge stretch at any time: bounded, unbounded.
    stretch: [f32; 2],
}

impl MotionEvaluation<'_> {
    fn case(&mut self, drawn: &DrawnMotion) -> Result<(), EvalError> {
        let figure = self.model.figure();
        let keys = drawn.latent_keys(&mut self.inference)?;
        for (method, between) in Method::ALL.into_iter().zip(&mut self.between) {
            let meshes = method.meshes(drawn, &keys, &mut self.inference)?;
            between.add(figure, self.model.regressor(), drawn, &meshes, &self.edges);
        }
        let truth: Vec<Vec<Vec3>> = drawn
            .frames
            .iter()
            .map(|frame| frame.mesh.clone())
            .collect();
        self.truth
            .add(figure, self.model.regressor(), drawn, &truth, &self.edges);
        let beyond = self.beyond(&keys)?;
        self.beyond.push(beyond);
        Ok(())
    }

    /// Follows a motion past its last key.
    fn beyond(&mut self, keys: &[LatentKey]) -> Result<Beyond, EvalError> {
        let settings = MotionSettings {
            grounded: false,
            ..MotionSettings::default()
        };
        let bounded = Motion::new(keys, settings, &mut self.inference)?;
        let unbounded = bounded.path().clone().unbounded();
        let [.., before, last] = keys else {
            return Err(EvalError::NoMotions);
        };
        let meshes = keys
            .iter()
            .map(|key| self.mesh(&key.latent))
            .collect::<Result<Vec<_>, _>>()?;
        // What is wrong with a key is not the extrapolation's fault.
        let edges = self.edges.clone().or_as_on(&meshes);
        let [.., from, to] = meshes.as_slice() else {
            return Err(EvalError::NoMotions);
        };
        let interval_s = last.time_s - before.time_s;
        let mut latent = vec![0.0; last.latent.len()];
        let mut stretch = [0.0_f32; 2];
        let mut horizons = [FARTHEST; 2];
        for step in 1..=(FARTHEST as usize * STEPS_BEYOND) {
            let distance = step as f32 / STEPS_BEYOND as f32;
            let time_s = last.time_s + distance * interval_s;
            bounded.sample_into(time_s, &mut latent)?;
            let mesh = self.mesh(&latent)?;
            stretch[0] = stretch[0].max(edges.stretch(&mesh));
            unbounded.sample_into(time_s, &mut latent)?;
            let mesh = self.mesh(&latent)?;
            let here = edges.stretch(&mesh);
            stretch[1] = stretch[1].max(here);
            let straight: Vec<Vec3> = from
                .iter()
                .zip(to)
                .map(|(a, b)| *b + distance * (*b - *a))
                .collect();
            let straight = edges.stretch(&straight);
            for (horizon, stretch) in horizons.iter_mut().zip([here, straight]) {
                if stretch > BROKEN {
                    *horizon = horizon.min(distance);
                }
            }
        }
        Ok(Beyond {
            unbounded: horizons[0],
            vertex_linear: horizons[1],
            bounded: bounded.path().horizons()[1],
            stretch,
        })
    }

    fn mesh(&mut self, latent: &[f32]) -> Result<Vec<Vec3>, EvalError> {
        methods::mesh(latent, &mut self.inference)
    }

    fn report(
        self,
        motions: &[TrueMotion],
        gaits: &[TrueMotion],
        yaws_deg: &[f32],
    ) -> MotionReport {
        let names = |motions: &[TrueMotion]| motions.iter().map(|m| m.name.clone()).collect();
        MotionReport {
            test: MotionTestSet {
                motions: names(motions),
                gaits: names(gaits),
                yaws_deg: yaws_deg.to_vec(),
                frames_per_s: self.config.frames_per_s,
            },
            between: Method::ALL
                .iter()
                .map(|method| method.name())
                .zip(&self.between)
                .chain([("the true motion", &self.truth)])
                .map(|(name, between)| between.report(name))
                .collect(),
            beyond: report::beyond(&self.beyond),
            gaits: report::gaits(&self.gaits),
        }
    }
}

#[cfg(test)]
mod tests;
