//! A rigged body with its poses: what training learns from and evaluation measures on.

use stick3d_model::Model;
use stick3d_train::dataset::PoseStream;
use stick3d_train::pose::{Controls, PoseLibrary, PoseSampler, SampleKind};
use stick3d_train::rig::{Pose, Rig};

use crate::args::BodyFiles;
use crate::failure::{Failure, Outcome};
use crate::inputs;

/// Which share of the library is kept out of training, for the evaluation.
const HELD_OUT: f32 = 0.1;

/// A body and its poses, as read.
pub(crate) struct Corpus {
    pub(crate) rig: Rig,
    pub(crate) controls: Controls,
    pub(crate) library: PoseLibrary,
}

impl Corpus {
    /// Reads the three files.
    pub(crate) fn read(files: &BodyFiles) -> Outcome<Self> {
        let BodyFiles {
            rig: rig_path,
            controls: controls_path,
            poses: poses_path,
        } = files;
        let named = |path: &std::path::Path| format!("cannot use {}", path.display());
        let rig = Rig::from_glb(&inputs::bytes(rig_path)?)
            .map_err(|error| Failure::input(error).context(named(rig_path)))?;
        let controls = Controls::from_ron(&inputs::text(controls_path)?, &rig)
            .map_err(|error| Failure::input(error).context(named(controls_path)))?;
        let library = PoseLibrary::from_ron(&inputs::text(poses_path)?, &controls)
            .map_err(|error| Failure::input(error).context(named(poses_path)))?;
        Ok(Self {
            rig,
            controls,
            library,
        })
    }

    /// The library in two: what is trained on, and a tenth that is not.
    pub(crate) fn split(&self, seed: u64) -> (PoseLibrary, PoseLibrary) {
        self.library.split(seed, HELD_OUT)
    }

    /// The library in two, as it was when `model` was trained.
    pub(crate) fn split_of(&self, model: &Model) -> (PoseLibrary, PoseLibrary) {
        let held_out = &model.metadata().held_out_poses;
        let (unseen, trained) = self
            .library
            .poses
            .iter()
            .cloned()
            .partition(|pose| held_out.contains(&pose.name));
        (
            PoseLibrary { poses: trained },
            PoseLibrary { poses: unseen },
        )
    }

    /// The poses of a library.
    pub(crate) fn poses(&self, library: &PoseLibrary) -> Vec<Pose> {
        library
            .poses
            .iter()
            .map(|pose| self.controls.pose(&pose.values))
            .collect()
    }

    /// The poses of a library and their mirror images.
    pub(crate) fn poses_both_ways(&self, library: &PoseLibrary) -> Vec<Pose> {
        let mut poses = self.poses(library);
        poses.extend(
            library
                .poses
                .iter()
                .map(|pose| self.controls.pose(&self.controls.mirror(&pose.values))),
        );
        poses
    }

    /// Endless sampled poses around those of `library`; one seed, one stream.
    pub(crate) fn stream<'a>(&'a self, library: &PoseLibrary, seed: u64) -> PoseStream<'a> {
        let mut sampler = PoseSampler::new(&self.rig, &self.controls, library, seed);
        Box::new(std::iter::repeat_with(move || {
            sampler.sample(SampleKind::Mixed)
        }))
    }
}
