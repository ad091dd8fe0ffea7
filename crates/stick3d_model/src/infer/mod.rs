//! Running a model at frame rate: sketch to latent, latent to mesh, on plain arrays.

mod alternatives;
mod decoding;
mod flip;
mod gaussian;
mod hypotheses;
mod joint_map;
mod marks;
mod measurement;
mod noise;
mod perceptron;
mod proposal;
mod refine;
mod slope;

pub use alternatives::{Alternative, Alternatives};
pub use hypotheses::Hypotheses;
pub use marks::{JointMark, MarkedSketch};

use glam::Vec3;
use stick3d_figure::figure::{Figure, Limb};
use stick3d_figure::mesh::NormalAdjacency;
use stick3d_figure::sketch::{Sketch, SketchError};
use thiserror::Error;

use self::decoding::Decoding;
use self::perceptron::Perceptron;
use self::proposal::Drawn;
use self::refine::Refiner;
use crate::file::ModelError;
use crate::latent::{LongestEdges, Probe, Trust};
use crate::model::Model;

/// Why one inference did not run. Nothing is written then.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum InferError {
    /// The sketch is not one of this model's figure, or says nothing.
    #[error(transparent)]
    Sketch(#[from] SketchError),
    /// A buffer or a latent has another length than the model needs.
    #[error("{what} has room for {found}, the model needs {expected}")]
    Length {
        /// Which one.
        what: &'static str,
        /// What the model needs.
        expected: usize,
        /// What it has.
        found: usize,
    },
    /// A latent has NaN, infinity or something huge in it, or makes the networks give such.
    #[error("the {what} has a number that is not finite, or huge, at index {index}")]
    NotFinite {
        /// Of what.
        what: &'static str,
        /// Where.
        index: usize,
    },
}

/// The largest number that a latent or a coefficient may have: far beyond any body, far from overflow.
const LARGEST: f32 = 1e9;

/// The ready networks of one model with all memory they need. Running them allocates nothing.
#[derive(Debug, Clone)]
pub struct Inference {
    figure: Figure,
    encoder2d: Perceptron,
    decoding: Decoding,
    adjacency: NormalAdjacency,
    probe: Probe,
    /// `None` where the joints are not linear in rotations or coefficients, or it is not known how answers are off.
    refiner: Option<Refiner>,
    latent_len: usize,
    input: Vec<f32>,
    /// What the joints of the sketch say.
    marks: Vec<JointMark>,
    /// Memory for [`Inference::encode`].
    alternatives: Alternatives,
    /// Memory for one body's joints.
    found: Vec<Vec3>,
}

impl Inference {
    /// Makes a model ready to run.
    ///
    /// # Errors
    /// [`ModelError::TriangleOutOfRange`] when the mesh is not sound, which a [`Model`] excludes.
    pub fn new(model: &Model) -> Result<Self, ModelError> {
        let vertex_count = model.vertex_count();
        let adjacency = NormalAdjacency::new(model.triangles(), vertex_count)
            .map_err(|error| ModelError::Metadata(error.to_string()))?;
        Ok(Self {
            figure: model.figure().clone(),
            encoder2d: Perceptron::new(model.encoder2d()),
            decoding: Decoding::new(model),
            refiner: refiner(model),
            probe: Probe::new(model)?,
            adjacency,
            latent_len: model.latent_len(),
            input: vec![0.0; model.figure().input_len()],
            marks: vec![JointMark::Drawn; model.figure().joint_count()],
            alternatives: Alternatives::default(),
            found: vec![Vec3::ZERO; model.figure().joint_count()],
        })
    }

    /// The figure it draws.
    #[must_use]
    pub fn figure(&self) -> &Figure {
        &self.figure
    }

    /// Length of the latent.
    #[must_use]
    pub fn latent_len(&self) -> usize {
        self.latent_len
    }

    /// How many vertices its meshes have.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.decoding.vertex_count()
    }

    /// The likeliest latent of a sketch: that of the first of its [alternatives](Inference::infer).
    ///
    /// # Shapes
    /// - `latent`: `[latent_len]`
    ///
    /// # Errors
    /// [`InferError::Sketch`] when the sketch is of another figure or all its joints coincide, [`InferError::Length`].
    pub fn encode(&mut self, sketch: &Sketch, latent: &mut [f32]) -> Result<(), InferError> {
        require("the latent", latent.len(), self.latent_len)?;
        let mut alternatives = std::mem::take(&mut self.alternatives);
        let inferred = self.infer(sketch, &mut alternatives);
        if let (Ok(()), Some(first)) = (&inferred, alternatives.first()) {
            latent.copy_from_slice(&first.latent);
        }
        self.alternatives = alternatives;
        inferred
    }

    /// What Encoder2D alone (paper section 4.2) holds for likeliest: not refined, and not weighed against the drawing.
    ///
    /// # Shapes
    /// - `latent`: `[latent_len]`
    ///
    /// # Errors
    /// As [`Inference::encode`].
    pub fn encode_plain(&mut self, sketch: &Sketch, latent: &mut [f32]) -> Result<(), InferError> {
        require("the latent", latent.len(), self.latent_len)?;
        let output = encoder2d_output(&mut self.encoder2d, &mut self.input, &self.figure, sketch)?;
        latent.copy_from_slice(Hypotheses::new(output, self.latent_len).likeliest());
        Ok(())
    }

    /// The bodies that a sketch may mean: one per hypothesis of Encoder2D, pulled onto the drawing, those that are alike
    /// merged. Their order is that of [`Alternatives`].
    ///
    /// A plain `&Sketch` is one of which every joint was drawn.
    ///
    /// # Errors
    /// As [`Inference::encode`], and [`InferError::Length`] for marks of another number of joints.
    pub fn infer<'s>(
        &mut self,
        sketch: impl Into<MarkedSketch<'s>>,
        alternatives: &mut Alternatives,
    ) -> Result<(), InferError> {
        alternatives.clear();
        let MarkedSketch { sketch, marks } = sketch.into();
        self.take_marks(marks)?;
        let output = encoder2d_output(&mut self.encoder2d, &mut self.input, &self.figure, sketch)?;
        let hypotheses = Hypotheses::new(output, self.latent_len);
        match (&mut self.refiner, self.decoding.body()) {
            (Some(refiner), Some(mut body)) => {
                let drawn = Drawn {
                    points: sketch.points(),
                    marks: &self.marks,
                };
                for found in refiner.refine(&hypotheses, drawn, &mut body) {
                    alternatives.add(&found.latent, &found.joints, found.log_weight);
                }
            }
            _ => {
                for index in 0..hypotheses.len().min(Alternatives::MOST) {
                    let latent = hypotheses.latent(index);
                    self.decoding.write_joints(latent, &mut self.found)?;
                    let log_weight = f64::from(hypotheses.log_probability(index));
                    alternatives.add(latent, &self.found, log_weight);
                }
            }
        }
        alternatives.rank(self.figure.template_extent_m());
        Ok(())
    }

    /// The natural logarithm of how much likelier a sketch is as an exact drawing of a body than as a crooked one; what training
    /// measures [`exact_from`](crate::latent::TrainingStatistics::exact_from) with. `None` where the model does not know how
    /// its answers are off.
    ///
    /// # Errors
    /// As [`Inference::encode`].
    pub fn exact_over_crooked(&mut self, sketch: &Sketch) -> Result<Option<f64>, InferError> {
        self.take_marks(&[])?;
        let output = encoder2d_output(&mut self.encoder2d, &mut self.input, &self.figure, sketch)?;
        let hypotheses = Hypotheses::new(output, self.latent_len);
        let (Some(refiner), Some(mut body)) = (&mut self.refiner, self.decoding.body()) else {
            return Ok(None);
        };
        let drawn = Drawn {
            points: sketch.points(),
            marks: &self.marks,
        };
        let judged = refiner.judge(&hypotheses, drawn, &mut body);
        Ok(Some(judged.exact_over_crooked))
    }

    /// What the joints say; none at all: that all were drawn.
    fn take_marks(&mut self, marks: &[JointMark]) -> Result<(), InferError> {
        if marks.is_empty() {
            self.marks.fill(JointMark::Drawn);
            return Ok(());
        }
        require("the list of marks", marks.len(), self.marks.len())?;
        self.marks.copy_from_slice(marks);
        Ok(())
    }

    /// The body that is as that of `latent`, but for a limb, whose depth is the other way round: it points away from the
    /// viewer where it pointed toward him. Its joints stay where they are drawn. Where the model does not know how its
    /// answers are off, the latent stays as it is.
    ///
    /// # Shapes
    /// - `latent`, `flipped`: `[latent_len]`
    ///
    /// # Errors
    /// [`InferError::Sketch`] when the sketch is of another figure, [`InferError::Length`], [`InferError::NotFinite`].
    pub fn flip_limb<'s>(
        &mut self,
        sketch: impl Into<MarkedSketch<'s>>,
        latent: &[f32],
        limb: &Limb,
        flipped: &mut [f32],
    ) -> Result<(), InferError> {
        require("the flipped latent", flipped.len(), self.latent_len)?;
        self.decoding.coefficients(latent)?;
        let mut alternatives = Alternatives::default();
        let sketch = sketch.into();
        self.infer(sketch, &mut alternatives)?;
        flipped.copy_from_slice(latent);
        let (Some(refiner), Some(mut body)) = (&mut self.refiner, self.decoding.body()) else {
            return Ok(());
        };
        flip::write_joints(&mut body, latent, &mut self.found);
        let depth = self.found[limb.end()].z - self.found[limb.base].z;
        let drawn = Drawn {
            points: sketch.sketch.points(),
            marks: &self.marks,
        };
        let goals = flip::goals_of(&self.found, limb, drawn);
        // From a body whose limb is flipped already it is a short way.
        let others = alternatives.as_slice().iter();
        let others = others.filter(|other| other.toward_viewer_m(limb) * depth < 0.0);
        let starts = others.map(|other| other.latent.as_slice()).chain([latent]);
        let mut pulled = vec![0.0; latent.len()];
        let mut least = f32::INFINITY;
        for start in starts {
            let off = refiner.pull_to(start, &goals, &mut body, &mut pulled);
            if off < least {
                least = off;
                flipped.copy_from_slice(&pulled);
            }
        }
        require_finite("flipped limb's latent", flipped)
    }

    /// The mesh of a latent (paper section 4.2, Decoder) and its unit normals; metres, the figure's root joint at the
    /// origin, +x to the right of the sketch, +y up, +z toward the viewer.
    ///
    /// # Shapes
    /// - `latent`: `[latent_len]`
    /// - `positions`, `normals`: `[vertex_count]`
    ///
    /// # Errors
    /// [`InferError::Length`], [`InferError::NotFinite`].
    pub fn decode(
        &mut self,
        latent: &[f32],
        positions: &mut [[f32; 3]],
        normals: &mut [[f32; 3]],
    ) -> Result<(), InferError> {
        require("the normals", normals.len(), self.vertex_count())?;
        self.decode_positions(latent, positions)?;
        self.adjacency.vertex_normals(positions, normals);
        Ok(())
    }

    /// [`Inference::decode`] without the normals.
    ///
    /// # Errors
    /// [`InferError::Length`], [`InferError::NotFinite`].
    pub fn decode_positions(
        &mut self,
        latent: &[f32],
        positions: &mut [[f32; 3]],
    ) -> Result<(), InferError> {
        require("the positions", positions.len(), self.vertex_count())?;
        self.decoding.write_positions(latent, positions)
    }

    /// The joints of a latent's mesh, without making the mesh where the final layer is linear; metres, the space of
    /// [`Inference::decode`].
    ///
    /// # Shapes
    /// - `latent`: `[latent_len]`
    /// - `joints`: one point per joint of the figure
    ///
    /// # Errors
    /// [`InferError::Length`], [`InferError::NotFinite`].
    pub fn joints(&mut self, latent: &[f32], joints: &mut [Vec3]) -> Result<(), InferError> {
        require("the joints", joints.len(), self.figure.joint_count())?;
        self.decoding.write_joints(latent, joints)
    }

    /// How far a latent is to be trusted to be a body. Looks at some of the mesh's edges; see
    /// [`Trust`].
    ///
    /// # Errors
    /// [`InferError::Length`], [`InferError::NotFinite`].
    pub fn trust(&mut self, latent: &[f32]) -> Result<Trust, InferError> {
        self.trust_beside(latent, None)
    }

    /// [`Inference::trust`] where edges may be as long as `longest` says.
    pub(crate) fn trust_beside(
        &mut self,
        latent: &[f32],
        longest: Option<&LongestEdges>,
    ) -> Result<Trust, InferError> {
        let coefficients = self.decoding.coefficients(latent)?;
        Ok(self.probe.trust(latent, coefficients, longest))
    }

    /// How long edges may be beside some bodies: as long as trained or drawn.
    pub(crate) fn longest_edges<'a>(
        &mut self,
        latents: impl Iterator<Item = &'a [f32]>,
    ) -> Result<LongestEdges, InferError> {
        let mut longest = self.probe.longest_edges();
        for latent in latents {
            let coefficients = self.decoding.coefficients(latent)?;
            self.probe.allow(coefficients, &mut longest);
        }
        Ok(longest)
    }
}

fn refiner(model: &Model) -> Option<Refiner> {
    let statistics = model.statistics()?;
    let ways = &statistics.answer_ways;
    if ways.is_empty() || model.final_layer().matrix_columns() == 0 {
        return None;
    }
    let hypotheses = hypotheses_of(model);
    Some(Refiner::new(
        model.figure(),
        model.head(),
        model.final_layer(),
        ways,
        statistics.exact_from,
        hypotheses,
    ))
}

/// How many hypotheses a model's Encoder2D has, of which at most [`Alternatives::MOST`] are looked at.
fn hypotheses_of(model: &Model) -> usize {
    let output = model.encoder2d().widths().last().copied().unwrap_or(0);
    let several = output / (model.latent_len() + 1);
    several.clamp(1, Alternatives::MOST)
}

/// What Encoder2D gives to a sketch.
fn encoder2d_output<'a>(
    encoder2d: &'a mut Perceptron,
    input: &mut [f32],
    figure: &Figure,
    sketch: &Sketch,
) -> Result<&'a [f32], InferError> {
    sketch.write_input_vector(figure, input)?;
    let output = encoder2d.run(input);
    require_finite("sketch's latent", output)?;
    Ok(output)
}

fn require(what: &'static str, found: usize, expected: usize) -> Result<(), InferError> {
    if found == expected {
        Ok(())
    } else {
        Err(InferError::Length {
            what,
            expected,
            found,
        })
    }
}

fn require_finite(what: &'static str, numbers: &[f32]) -> Result<(), InferError> {
    match numbers.iter().position(|x| x.is_nan() || x.abs() > LARGEST) {
        Some(index) => Err(InferError::NotFinite { what, index }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
