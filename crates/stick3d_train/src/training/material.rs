//! What a run learns from, made ready: the shape of the bodies, and the bodies in it.

use glam::Vec3;
use rayon::prelude::*;
use stick3d_figure::figure::Figure;
use stick3d_figure::regressor::JointRegressor;

use super::{Progress, TrainConfig, TrainError};
use crate::dataset::{
    BasisFit, BodySet, PoseStreams, Shape, SkinBasis, centre, posed, principal_shape,
};
use crate::meshes::{MeshSet, joint_regressor};
use crate::rig::{Pose, Rig, regressor};

/// What a run with a rig learns from.
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

/// What a run without a rig learns from.
pub struct MeshTrainInput<'a> {
    /// What is drawn; its joints are lists of vertices.
    pub figure: &'a Figure,
    /// The meshes.
    pub set: &'a MeshSet,
    /// Names of meshes of the set that are not learnt from; kept in the model for its evaluation.
    pub held_out: Vec<String>,
}

/// Streams from this number on make the meshes that the basis comes from; bodies come from lower ones.
const BASIS_STREAM: u64 = 1 << 32;

/// How many fresh poses a basis is measured on.
const MEASURED_POSES: usize = 64;

/// The same from either source.
pub(super) struct Material<'a> {
    pub(super) figure: &'a Figure,
    pub(super) regressor: JointRegressor,
    pub(super) shape: Shape,
    pub(super) basis_fit: BasisFit,
    /// Half of the largest extent of the mesh at rest, metres.
    pub(super) extent_m: f32,
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) colors: &'a [[u8; 4]],
    pub(super) held_out: &'a [String],
    pub(super) bodies: BodySet,
}

impl<'a> Material<'a> {
    /// Fits a shape to a rig and poses its bodies.
    pub(super) fn of_rig(
        input: &'a TrainInput<'_>,
        config: &TrainConfig,
        progress: &dyn Progress,
    ) -> Result<Self, TrainError> {
        let TrainInput { figure, rig, .. } = *input;
        let regressor = regressor(figure, rig)?;
        let (shape, basis_fit, bodies) = match config.principal_components {
            None => skin(input, &regressor, config, progress)?,
            Some(components) => {
                let meshes = posed_meshes(input, &regressor, config);
                let fresh = sample_poses(input, MEASURED_POSES, 2 * BASIS_STREAM);
                let fresh = meshes_of(input, &regressor, &fresh);
                principal(&regressor, &meshes, &fresh, components, config, progress)?
            }
        };
        let (low, high) = rig.mesh.bounds();
        Ok(Self {
            figure,
            regressor,
            shape,
            basis_fit,
            extent_m: (high - low).max_element() / 2.0,
            triangles: &rig.mesh.triangles,
            colors: &rig.colors,
            held_out: &input.held_out_poses,
            bodies,
        })
    }

    /// Finds the principal components of a mesh set.
    pub(super) fn of_meshes(
        input: &'a MeshTrainInput<'_>,
        config: &TrainConfig,
        progress: &dyn Progress,
    ) -> Result<Self, TrainError> {
        let MeshTrainInput { figure, set, .. } = *input;
        let regressor = joint_regressor(figure, set.vertex_count())?;
        let components = config.principal_components.ok_or_else(|| {
            TrainError::Config("meshes without a rig need principal components".to_owned())
        })?;
        let (mut meshes, mut fresh) = (vec![], vec![]);
        for mesh in &set.meshes {
            let mut positions = mesh.positions.clone();
            centre(&regressor, figure.root, &mut positions);
            if input.held_out.contains(&mesh.name) {
                fresh.push(positions);
            } else {
                meshes.push(positions);
            }
        }
        let (shape, basis_fit, bodies) =
            principal(&regressor, &meshes, &fresh, components, config, progress)?;
        Ok(Self {
            figure,
            regressor,
            shape,
            basis_fit,
            extent_m: set.extent_m(),
            triangles: &set.triangles,
            colors: &set.colors,
            held_out: &input.held_out,
            bodies,
        })
    }
}

type Fitted = (Shape, BasisFit, BodySet);

/// The shape of a skin, its fit to fresh poses, and all bodies.
fn skin(
    input: &TrainInput<'_>,
    regressor: &JointRegressor,
    config: &TrainConfig,
    progress: &dyn Progress,
) -> Result<Fitted, TrainError> {
    let TrainInput { figure, rig, .. } = *input;
    let root = figure.root;
    progress.begin("fitting the skin", config.basis.poses);
    let poses = sample_poses(input, config.basis.poses, BASIS_STREAM);
    let basis = SkinBasis::fit(rig, regressor, root, config.basis, &poses)?;
    progress.advance(config.basis.poses);
    let fresh = sample_poses(input, MEASURED_POSES, 2 * BASIS_STREAM);
    let fit = basis.measure(rig, regressor, root, &fresh);
    let bones = basis.rotations().bone_count;
    note_fit(&format!("skin of {bones} bones"), &fit, progress);

    progress.begin("posing bodies", config.sampled_bodies + input.library.len());
    let advance = |steps| progress.advance(steps);
    let mut bodies = BodySet::sample(rig, &basis, input.streams, config.sampled_bodies, &advance);
    let library = BodySet::from_poses(rig, &basis, input.library.iter().cloned(), &advance);
    for _ in 0..config.library_repeats {
        bodies.extend(library.clone());
    }
    Ok((basis.shape().clone(), fit, bodies))
}

/// The components of meshes, their fit to fresh ones, and the meshes as bodies.
fn principal(
    regressor: &JointRegressor,
    meshes: &[Vec<Vec3>],
    fresh: &[Vec<Vec3>],
    components: usize,
    config: &TrainConfig,
    progress: &dyn Progress,
) -> Result<Fitted, TrainError> {
    progress.begin("finding components", 1);
    let shape = principal_shape(regressor, meshes, components)?;
    progress.advance(1);
    let fit = shape.measure(fresh.iter().filter_map(|mesh| {
        let code = shape.layer().project(mesh)?;
        Some((mesh.clone(), code))
    }));
    let found = shape.code_columns();
    note_fit(
        &format!("{found} components of {} meshes; on others", meshes.len()),
        &fit,
        progress,
    );
    let advance = |steps| progress.advance(steps);
    progress.begin("projecting meshes", meshes.len());
    let once = BodySet::from_meshes(&shape, meshes.iter().map(Vec::as_slice), &advance);
    let mut bodies = BodySet::default();
    for _ in 0..config.library_repeats {
        bodies.extend(once.clone());
    }
    Ok((shape, fit, bodies))
}

fn note_fit(what: &str, fit: &BasisFit, progress: &dyn Progress) {
    progress.note(&format!(
        "{what}: vertices off by {:.2} mm on average, {:.2} mm for 99 %, {:.1} mm at most",
        1e3 * fit.mean_m,
        1e3 * fit.p99_m,
        1e3 * fit.max_m
    ));
}

/// Sampled bodies and those of the library as meshes.
fn posed_meshes(
    input: &TrainInput<'_>,
    regressor: &JointRegressor,
    config: &TrainConfig,
) -> Vec<Vec<Vec3>> {
    let mut poses = sample_poses(input, config.sampled_bodies, 0);
    poses.extend(input.library.iter().cloned());
    meshes_of(input, regressor, &poses)
}

fn meshes_of(input: &TrainInput<'_>, regressor: &JointRegressor, poses: &[Pose]) -> Vec<Vec<Vec3>> {
    let mesh = |pose: &Pose| {
        let mut mesh = vec![];
        posed(input.rig, regressor, input.figure.root, pose, &mut mesh);
        mesh
    };
    poses.par_iter().map(mesh).collect()
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
