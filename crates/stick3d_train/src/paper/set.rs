//! The paper's data (section 4.1): key meshes in 21 turns, and sketches of them.

use glam::{Quat, Vec3};
use rand::seq::SliceRandom as _;
use serde::{Deserialize, Serialize};
use sha2::Digest as _;
use stick3d_figure::figure::Figure;
use stick3d_figure::regressor::JointRegressor;
use stick3d_figure::sketch::{Sketch, SketchError};
use stick3d_model::digest::hex;
use stick3d_model::metadata::topology_hash;

use crate::dataset::{Rotations, centre, drawn, posed, random};
use crate::meshes::{MeshSet, joint_regressor};
use crate::rig::{Pose, Rig, regressor};
use crate::training::TrainError;

/// Where the farthest vertex of the key meshes is in the networks' units: a tanh comes near 1 but not to it.
const FARTHEST: f32 = 0.95;

/// A key mesh, not turned.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyMesh {
    /// What it is called.
    pub name: String,
    /// Metres, the root joint at the origin.
    pub positions: Vec<Vec3>,
    /// Likewise.
    pub joints: Vec<Vec3>,
}

/// Key meshes of one topology, and the turns they are shown in.
#[derive(Debug, Clone)]
pub struct PaperSet {
    /// What is drawn.
    pub figure: Figure,
    /// Its joints on the meshes.
    pub regressor: JointRegressor,
    /// The meshes' triangles.
    pub triangles: Vec<[u32; 3]>,
    /// One per vertex: linear red, green, blue and coverage, 255 = 1.
    pub colors: Vec<[u8; 4]>,
    /// Half of the largest extent at rest, metres: the unit of normalised distances.
    pub extent_m: f32,
    /// The key meshes.
    pub meshes: Vec<KeyMesh>,
    /// Which vertices of the body these meshes have, where they have not all.
    pub kept: Option<Vec<u32>>,
    /// The 21 turns.
    pub turns: Vec<Quat>,
}

/// A key mesh in one of the turns: indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Sample {
    /// Which mesh.
    pub mesh: usize,
    /// Which turn.
    pub turn: usize,
}

/// What is kept out of training.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Split {
    /// A tenth of the turned meshes: most of them are there in other turns.
    Random,
    /// Whole key meshes in all turns: poses that were never seen.
    Pose,
    /// Whole key meshes, and a tenth of what remains: one training, measured both ways.
    Both,
}

/// The samples of a set, parted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Samples {
    /// What is learnt from.
    pub train: Vec<Sample>,
    /// Turned meshes that are not, though their meshes are.
    pub random: Vec<Sample>,
    /// All turns of meshes that are not.
    pub pose: Vec<Sample>,
}

/// One in so many turned meshes is kept out.
const KEPT_OUT: usize = 10;

impl PaperSet {
    /// Poses a rig: each name with its pose is a key mesh.
    ///
    /// # Errors
    /// [`TrainError::Rig`] when the rig has not the figure's joints, [`TrainError::Config`] without poses.
    pub fn of_rig(
        figure: &Figure,
        rig: &Rig,
        poses: &[(String, Pose)],
    ) -> Result<Self, TrainError> {
        let regressor = regressor(figure, rig)?;
        let meshes = poses.iter().map(|(name, pose)| {
            let mut positions = vec![];
            let joints = posed(rig, &regressor, figure.root, pose, &mut positions);
            KeyMesh {
                name: name.clone(),
                positions,
                joints,
            }
        });
        let (low, high) = rig.mesh.bounds();
        Self {
            figure: figure.clone(),
            meshes: meshes.collect(),
            triangles: rig.mesh.triangles.clone(),
            colors: rig.colors.clone(),
            extent_m: (high - low).max_element() / 2.0,
            regressor,
            kept: None,
            turns: Rotations::paper_list(),
        }
        .checked()
    }

    /// Takes registered meshes.
    ///
    /// # Errors
    /// [`TrainError::Meshes`] when the figure's joints are not on the meshes.
    pub fn of_meshes(figure: &Figure, set: &MeshSet) -> Result<Self, TrainError> {
        let regressor = joint_regressor(figure, set.vertex_count())?;
        let meshes = set.meshes.iter().map(|mesh| {
            let mut positions = mesh.positions.clone();
            let joints = centre(&regressor, figure.root, &mut positions);
            KeyMesh {
                name: mesh.name.clone(),
                positions,
                joints,
            }
        });
        Self {
            figure: figure.clone(),
            meshes: meshes.collect(),
            triangles: set.triangles.clone(),
            colors: set.colors.clone(),
            extent_m: set.extent_m(),
            regressor,
            kept: None,
            turns: Rotations::paper_list(),
        }
        .checked()
    }

    fn checked(self) -> Result<Self, TrainError> {
        if self.meshes.is_empty() {
            return Err(TrainError::Config(
                "there are no key meshes; give at least two".to_owned(),
            ));
        }
        Ok(self)
    }

    /// How many vertices every mesh has.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.colors.len()
    }

    /// SHA-256 of the topology; see [`topology_hash`].
    #[must_use]
    pub fn topology_hash(&self) -> String {
        topology_hash(self.vertex_count(), &self.triangles)
    }

    /// What 1 means in the networks' units, metres: no turn takes a vertex of these meshes past 0.95.
    #[must_use]
    pub fn scale_m(&self) -> f32 {
        let vertices = self.meshes.iter().flat_map(|mesh| &mesh.positions);
        let farthest = vertices.map(|p| p.length_squared()).fold(0.0, f32::max);
        farthest.sqrt().max(f32::MIN_POSITIVE) / FARTHEST
    }

    /// Parts the samples. `held_out` names the meshes that are kept out as a whole.
    ///
    /// # Errors
    /// [`TrainError::Config`] when a name is no mesh's, or nothing is left to train on.
    pub fn samples(
        &self,
        split: Split,
        held_out: &[String],
        seed: u64,
    ) -> Result<Samples, TrainError> {
        let names: Vec<&str> = self.meshes.iter().map(|mesh| mesh.name.as_str()).collect();
        if let Some(unknown) = held_out.iter().find(|n| !names.contains(&n.as_str())) {
            let nearest = stick3d_figure::names::nearest(unknown, names.iter().copied());
            return Err(TrainError::Config(format!(
                "no key mesh is called {unknown}; the nearest is {}",
                nearest.unwrap_or("none")
            )));
        }
        let turns = self.turns.len();
        let all = (0..self.meshes.len())
            .flat_map(|mesh| (0..turns).map(move |turn| Sample { mesh, turn }));
        let kept_whole = split != Split::Random;
        let (pose, mut train): (Vec<Sample>, Vec<Sample>) = all.partition(|sample| {
            kept_whole && held_out.iter().any(|name| *name == names[sample.mesh])
        });
        let mut random_part = vec![];
        if split != Split::Pose {
            train.shuffle(&mut random(seed, "paper split", 0));
            random_part = train.split_off(train.len() - train.len() / KEPT_OUT);
            train.sort_unstable();
            random_part.sort_unstable();
        }
        if train.is_empty() {
            return Err(TrainError::Config(
                "all key meshes are held out; leave some to train on".to_owned(),
            ));
        }
        Ok(Samples {
            train,
            random: random_part,
            pose,
        })
    }

    /// The vertices of a sample, metres.
    #[must_use]
    pub fn vertices(&self, sample: Sample) -> Vec<Vec3> {
        let turn = self.turns[sample.turn];
        let positions = self.meshes[sample.mesh].positions.iter();
        positions.map(|point| turn * *point).collect()
    }

    /// Its joints, metres.
    #[must_use]
    pub fn joints(&self, sample: Sample) -> Vec<Vec3> {
        let turn = self.turns[sample.turn];
        let joints = self.meshes[sample.mesh].joints.iter();
        joints.map(|joint| turn * *joint).collect()
    }

    /// Its sketch: the joints on the x-y plane.
    ///
    /// # Errors
    /// [`SketchError`] when all joints coincide there.
    pub fn sketch(&self, sample: Sample) -> Result<Sketch, SketchError> {
        let joints = &self.meshes[sample.mesh].joints;
        Sketch::new(&self.figure, drawn(self.turns[sample.turn], joints))
    }

    /// Its input vector.
    ///
    /// # Errors
    /// [`SketchError`] when all joints coincide on the x-y plane.
    pub fn input_vector(&self, sample: Sample) -> Result<Vec<f32>, SketchError> {
        self.sketch(sample)?.input_vector(&self.figure)
    }

    /// SHA-256 of meshes, topology and split, in hexadecimal digits.
    #[must_use]
    pub fn hash(&self, samples: &Samples) -> String {
        let mut hasher = sha2::Sha256::new();
        hasher.update(self.topology_hash());
        for point in self.meshes.iter().flat_map(|mesh| &mesh.positions) {
            hasher.update(bytemuck::cast_slice::<f32, u8>(&point.to_array()));
        }
        for sample in &samples.train {
            hasher.update((sample.mesh as u64).to_le_bytes());
            hasher.update((sample.turn as u64).to_le_bytes());
        }
        hex(&hasher.finalize())
    }
}
