//! What an authored pose wants to achieve: feet flat, hands on hips, weight over the feet.
//!
//! Angles alone put a hand nearly on a hip. A pose may therefore state goals and which controls may
//! give way; they are found by damped least squares (Levenberg-Marquardt) inside the limits, as near
//! to the authored angles as the goals permit.

use glam::Vec3;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::controls::{Controls, PoseValues};
use super::error::PoseError;
use super::posing::BoneTransforms;
use super::spec::Half;

/// Rounds of the solver. Authored poses start close and need about ten.
const ROUNDS: usize = 40;
/// Step of the finite differences, degrees.
const STEP_DEG: f32 = 0.2;
/// Cost of leaving the authored angles, per degree: 30 degrees weigh like 3 mm.
const STAY_PER_DEG: f32 = 0.001;
/// Cost of a metre, against one of a unit direction.
const PER_METRE: f32 = 10.0;

/// One thing that a pose shall achieve. Parts are those of the file of controls; `@` means both sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Goal {
    /// A part's bone is as level as in the neutral stance: soles flat.
    Level(String),
    /// These parts are on the ground (at the height of the body's lowest point).
    Ground(Vec<String>),
    /// The middle of `part` is at the point `at` (metres, axes of the rest) seen from bone `of`.
    Reach {
        /// The part.
        part: String,
        /// The bone that carries the point.
        of: String,
        /// The point, offset from that bone's head, metres.
        at: Vec3,
    },
    /// A direction fixed to a part (`axis`, as it stands in the neutral stance) points `toward` a
    /// direction of the world. With `@`, both are written for the left side.
    Face {
        /// The part.
        part: String,
        /// Direction in the neutral stance.
        axis: Vec3,
        /// Direction in the posed world.
        toward: Vec3,
    },
    /// The centre of mass is over the middle of these parts.
    Balance(Vec<String>),
}

/// A goal with its names looked up.
enum Bound {
    Level(usize),
    Ground(Vec<usize>),
    Reach {
        part: usize,
        bone: usize,
        at: Vec3,
    },
    Face {
        part: usize,
        axis: Vec3,
        toward: Vec3,
    },
    Balance(Vec<usize>),
}

impl Goal {
    fn bind(&self, controls: &Controls, into: &mut Vec<Bound>) -> Result<(), PoseError> {
        let body = controls.body();
        let all = |names: &[String]| -> Result<Vec<usize>, PoseError> {
            let halves = |name: &String| -> Vec<String> {
                Half::of(name).iter().map(|half| half.name(name)).collect()
            };
            names
                .iter()
                .flat_map(halves)
                .map(|name| body.index(&name))
                .collect()
        };
        match self {
            Self::Ground(names) => into.push(Bound::Ground(all(names)?)),
            Self::Balance(names) => into.push(Bound::Balance(all(names)?)),
            Self::Level(name) => into.extend(
                all(std::slice::from_ref(name))?
                    .into_iter()
                    .map(Bound::Level),
            ),
            Self::Reach { part, of, at } => {
                for &half in Half::of(part) {
                    let bone = controls.skeleton.bone_index(&half.name(of))?;
                    let part = body.index(&half.name(part))?;
                    into.push(Bound::Reach {
                        part,
                        bone,
                        at: half.direction(*at, controls.lateral),
                    });
                }
            }
            Self::Face { part, axis, toward } => {
                for &half in Half::of(part) {
                    let part = body.index(&half.name(part))?;
                    let side = |v: &Vec3| half.direction(*v, controls.lateral);
                    let (axis, toward) = (side(axis), side(toward));
                    into.push(Bound::Face {
                        part,
                        axis,
                        toward: toward.normalize_or_zero(),
                    });
                }
            }
        }
        Ok(())
    }
}

impl Bound {
    /// Appends how far the goal is missed, metres times [`PER_METRE`] and unit directions.
    fn residuals(&self, controls: &Controls, transforms: &BoneTransforms, out: &mut Vec<f32>) {
        let body = controls.body();
        let turned = |part: usize, axis: Vec3| {
            let bone = body.parts()[part].bone;
            transforms[bone].0 * (controls.neutral[bone].inverse() * axis)
        };
        match self {
            Self::Level(part) => {
                let up = turned(*part, Vec3::Y);
                out.extend([up.x, up.z, (1.0 - up.y) * 0.5]);
            }
            Self::Ground(parts) => {
                let lowest = body.lowest_m(transforms);
                out.extend(
                    parts
                        .iter()
                        .map(|&part| (body.lowest_of_m(part, transforms) - lowest) * PER_METRE),
                );
            }
            Self::Reach { part, bone, at } => {
                let (rotation, head) = transforms[*bone];
                let miss = body.middle(*part, transforms) - (head + rotation * *at);
                out.extend((miss * PER_METRE).to_array());
            }
            Self::Face { part, axis, toward } => {
                out.extend((turned(*part, *axis) - *toward).to_array());
            }
            Self::Balance(parts) => {
                let support = parts.iter().map(|&part| body.middle(part, transforms));
                let miss = body.centre_of_mass(transforms)
                    - support.sum::<Vec3>() / parts.len().max(1) as f32;
                out.extend([miss.x * PER_METRE * 0.5, miss.z * PER_METRE * 0.5]);
            }
        }
    }
}

/// Moves the `free` controls until the goals are met as well as they can be. Returns the largest miss
/// that is left (metres times ten, or length of a difference of unit directions).
pub(super) fn solve(
    controls: &Controls,
    values: &mut PoseValues,
    goals: &[Goal],
    free: &[usize],
) -> Result<f32, PoseError> {
    let mut bound = Vec::new();
    for goal in goals {
        goal.bind(controls, &mut bound)?;
    }
    let start = values.clone();
    let evaluate = |values: &PoseValues| -> DVector<f32> {
        let transforms = controls.transforms(&controls.rotations(values));
        let mut out = Vec::new();
        for goal in &bound {
            goal.residuals(controls, &transforms, &mut out);
        }
        for &index in free {
            out.push((values.degrees[index] - start.degrees[index]) * STAY_PER_DEG);
        }
        DVector::from_vec(out)
    };
    let mut residual = evaluate(values);
    let mut damping = 1e-3;
    for _ in 0..ROUNDS {
        let mut jacobian = DMatrix::zeros(residual.len(), free.len());
        for (column, &index) in free.iter().enumerate() {
            let mut moved = values.clone();
            moved.degrees[index] += STEP_DEG;
            jacobian.set_column(column, &((evaluate(&moved) - &residual) / STEP_DEG));
        }
        let mut normal = jacobian.transpose() * &jacobian;
        let gradient = jacobian.transpose() * &residual;
        for i in 0..free.len() {
            normal[(i, i)] += damping * (normal[(i, i)] + 1e-6);
        }
        let Some(step) = normal.cholesky().map(|c| c.solve(&gradient)) else {
            break;
        };
        let mut moved = values.clone();
        for (i, &index) in free.iter().enumerate() {
            moved.degrees[index] -= step[i].clamp(-20.0, 20.0);
        }
        controls.clamp(&mut moved);
        let next = evaluate(&moved);
        if next.norm_squared() < residual.norm_squared() {
            (*values, residual) = (moved, next);
            damping *= 0.3;
        } else {
            damping *= 5.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    Ok(residual.rows(0, residual.len() - free.len()).amax())
}
