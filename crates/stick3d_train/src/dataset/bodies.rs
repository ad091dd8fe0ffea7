//! Many posed bodies as codes and joints.

use glam::Vec3;
use rayon::prelude::*;
use sha2::Digest as _;
use stick3d_figure::regressor::JointRegressor;
use stick3d_model::digest::hex;

use super::{Shape, SkinBasis};
use crate::rig::{Pose, Rig};

/// An endless source of poses.
pub type PoseStream<'a> = Box<dyn Iterator<Item = Pose> + 'a>;

/// Makes the source of poses number `n`. Sources with different numbers are independent, so that they can run side by
/// side, and the same number gives the same poses.
pub type PoseStreams<'a> = dyn Fn(u64) -> PoseStream<'a> + Sync + 'a;

/// How many streams a set is drawn from: more than any machine has cores to spare, and never dependent on them.
const STREAMS: usize = 16;

/// Posed bodies, centred on the root joint, not turned.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BodySet {
    /// `[body][3][code_columns]`: see [`Shape`].
    pub codes: Vec<f32>,
    /// `[body][joint]`, metres.
    pub joints: Vec<Vec3>,
    /// How many bodies there are.
    pub len: usize,
}

impl BodySet {
    /// Draws `count` bodies from streams of poses, several streams at once. Calls `done(1)` after each.
    pub fn sample(
        rig: &Rig,
        basis: &SkinBasis,
        streams: &PoseStreams<'_>,
        count: usize,
        done: &(dyn Fn(usize) + Sync),
    ) -> Self {
        let parts: Vec<Self> = (0..STREAMS)
            .into_par_iter()
            .map(|stream| {
                let share = count / STREAMS + usize::from(stream < count % STREAMS);
                Self::from_poses(rig, basis, streams(stream as u64).take(share), done)
            })
            .collect();
        let mut set = Self::default();
        parts.into_iter().for_each(|part| set.extend(part));
        set
    }

    /// The bodies of given poses. Calls `done(1)` after each.
    pub fn from_poses(
        rig: &Rig,
        basis: &SkinBasis,
        poses: impl IntoIterator<Item = Pose>,
        done: &(dyn Fn(usize) + Sync),
    ) -> Self {
        let mut set = Self::default();
        for pose in poses {
            let code = basis.code(rig, &pose);
            set.push(basis.shape(), code);
            done(1);
        }
        set
    }

    /// The bodies of given meshes, centred on the root joint, in a shape that is linear in its codes. Calls `done(1)`
    /// after each.
    ///
    /// # Panics
    /// When a mesh has another number of vertices than the shape.
    pub fn from_meshes<'m>(
        shape: &Shape,
        meshes: impl IntoIterator<Item = &'m [Vec3]>,
        done: &(dyn Fn(usize) + Sync),
    ) -> Self {
        let mut set = Self::default();
        for mesh in meshes {
            if let Some(code) = shape.layer().project(mesh) {
                set.push(shape, code);
            }
            done(1);
        }
        set
    }

    fn push(&mut self, shape: &Shape, code: Vec<f32>) {
        self.joints.extend(shape.joints(&code));
        self.codes.extend(code);
        self.len += 1;
    }

    /// Adds the bodies of another set.
    pub fn extend(&mut self, other: Self) {
        self.codes.extend(other.codes);
        self.joints.extend(other.joints);
        self.len += other.len;
    }

    /// The code of one body, `[3][code_columns]`.
    #[must_use]
    pub fn code_of(&self, body: usize) -> &[f32] {
        let width = self.codes.len() / self.len.max(1);
        &self.codes[body * width..][..width]
    }

    /// The joints of one body, metres.
    #[must_use]
    pub fn joints_of(&self, body: usize) -> &[Vec3] {
        let width = self.joints.len() / self.len.max(1);
        &self.joints[body * width..][..width]
    }

    /// SHA-256 of everything in the set, in hexadecimal digits.
    #[must_use]
    pub fn hash(&self) -> String {
        let mut hasher = sha2::Sha256::new();
        hasher.update((self.len as u64).to_le_bytes());
        hasher.update(bytemuck::cast_slice::<f32, u8>(&self.codes));
        for joint in &self.joints {
            hasher.update(bytemuck::cast_slice::<f32, u8>(&joint.to_array()));
        }
        hex(&hasher.finalize())
    }
}

/// Poses the rig into `positions`, centred on joint `root`, and returns the joints.
pub(crate) fn posed(
    rig: &Rig,
    regressor: &JointRegressor,
    root: usize,
    pose: &Pose,
    positions: &mut Vec<Vec3>,
) -> Vec<Vec3> {
    rig.skin(pose, positions);
    centre(regressor, root, positions)
}

/// Moves a mesh so that joint `root` is at the origin, and returns the joints.
pub(crate) fn centre(regressor: &JointRegressor, root: usize, positions: &mut [Vec3]) -> Vec<Vec3> {
    let mut joints = regressor.joints(positions);
    let centre = joints[root];
    positions
        .iter_mut()
        .chain(&mut joints)
        .for_each(|point| *point -= centre);
    joints
}
