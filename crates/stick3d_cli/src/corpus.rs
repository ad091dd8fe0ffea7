//! A rigged body with its poses: what training learns from and evaluation measures on.

use std::path::{Path, PathBuf};

use stick3d_figure::figure::Figure;
use stick3d_model::Model;
use stick3d_train::dataset::PoseStream;
use stick3d_train::evaluate::{broad_poses, natural_poses};
use stick3d_train::pose::{Controls, PoseLibrary, PoseSampler, SampleKind, default_controls};
use stick3d_train::rig::{Pose, Rig, RigFile, Weld};

use crate::args::BodyFiles;
use crate::failure::{Failure, Outcome};
use crate::inputs;

/// Which share of the library is kept out of training, for the evaluation.
const HELD_OUT: f32 = 0.1;

/// How many moments of the clips are poses where there is no pose library.
const CLIP_POSES: usize = 240;

/// A rig whose clips and library give fewer poses than this gets more from its joints' limits.
const LEAST_POSES: usize = 80;

/// The human's three files.
const HUMAN: [&str; 3] = [
    "assets/rigs/human.glb",
    "assets/rigs/human.controls.ron",
    "assets/poses/human.ron",
];

/// A body and its poses, as read.
pub(crate) struct Corpus {
    pub(crate) rig: Rig,
    pub(crate) controls: Controls,
    pub(crate) library: PoseLibrary,
    /// What was read and put right, line by line.
    pub(crate) said: Vec<String>,
}

/// The files that were named; without any of them the human's.
struct Named {
    rig: PathBuf,
    controls: Option<PathBuf>,
    poses: Option<PathBuf>,
    clip_poses: usize,
}

impl Named {
    fn new(files: &BodyFiles) -> Self {
        let [rig, controls, poses] = HUMAN.map(PathBuf::from);
        let own = files.rig.clone();
        let or_human = |given: &Option<PathBuf>, human: PathBuf| {
            given.clone().or(own.is_none().then_some(human))
        };
        let poses = or_human(&files.poses, poses);
        Self {
            controls: or_human(&files.controls, controls),
            clip_poses: files
                .clip_poses
                .unwrap_or(if poses.is_some() { 0 } else { CLIP_POSES }),
            poses,
            rig: own.unwrap_or(rig),
        }
    }
}

/// A failure to use a file, with its name.
fn cannot_use<E: Into<anyhow::Error>>(path: &Path) -> impl Fn(E) -> Failure {
    move |error| Failure::input(error).context(format!("cannot use {}", path.display()))
}

/// A rig that stands as the figure does, and what was read and put right.
fn read_rig(path: &Path, figure: Option<&Figure>) -> Outcome<(Rig, Vec<String>)> {
    let RigFile {
        mut rig, report, ..
    } = RigFile::read(path, Weld::default()).map_err(cannot_use(path))?;
    let mut said = vec![format!(
        "{}: {} bones, {} vertices, {} triangles, {} clips",
        path.display(),
        rig.skeleton.bones.len(),
        rig.mesh.positions.len(),
        rig.mesh.triangles.len(),
        rig.clips.len()
    )];
    said.extend(report.lines());
    if let Some(figure) = figure {
        let placement = rig.place(figure).map_err(cannot_use(path))?;
        if !placement.is_none() {
            said.push(format!(
                "turned by {:.0}° about the upright and scaled by {} to stand as the figure {} does",
                placement.yaw_deg, placement.scale, figure.name
            ));
        }
    }
    Ok((rig, said))
}

impl Corpus {
    /// Reads a body, turns it as the figure stands, and gathers its controls and poses. Without a figure it stays as it
    /// is, and its controls must be named.
    pub(crate) fn read(files: &BodyFiles, figure: Option<&Figure>) -> Outcome<Self> {
        let named = Named::new(files);
        let (rig, mut said) = read_rig(&named.rig, figure)?;
        let controls = match (&named.controls, figure) {
            (Some(path), _) => {
                Controls::from_ron(&inputs::text(path)?, &rig).map_err(cannot_use(path))?
            }
            (None, Some(figure)) => default_controls(&rig, figure)
                .and_then(|spec| Controls::bind(&spec, &rig))
                .map_err(cannot_use(&named.rig))?,
            (None, None) => {
                return Err(Failure::input(anyhow::anyhow!(
                    "what {} can do is found with a figure; name its file with --figure, or its controls with --controls",
                    named.rig.display()
                )));
            }
        };
        let mut library = match &named.poses {
            Some(path) => {
                PoseLibrary::from_ron(&inputs::text(path)?, &controls).map_err(cannot_use(path))?
            }
            None => PoseLibrary::default(),
        };
        let authored = library.poses.len();
        if named.clip_poses > 0 {
            let moments = PoseLibrary::from_clips(&controls, named.clip_poses);
            library.poses.extend(moments.poses);
        }
        let from_clips = library.poses.len() - authored;
        if named.poses.is_none() {
            library.fill(&rig, &controls, LEAST_POSES);
        }
        said.push(format!(
            "{} controls, {} poses: {authored} of a library, {from_clips} of the clips, {} inside the joints' limits",
            controls.list().len(),
            library.poses.len(),
            library.poses.len() - authored - from_clips
        ));
        Ok(Self {
            rig,
            controls,
            library,
            said,
        })
    }

    /// The library in two: what is trained on, and a tenth that is not.
    pub(crate) fn split(&self, seed: u64) -> (PoseLibrary, PoseLibrary) {
        self.library.split(seed, HELD_OUT)
    }

    /// The library in two, as it was when `model` was trained.
    pub(crate) fn split_of(&self, model: &Model) -> Outcome<(PoseLibrary, PoseLibrary)> {
        let held_out = &model.metadata().held_out_poses;
        let known = |name: &&String| self.library.get(name).is_some();
        if let Some(missing) = held_out.iter().find(|name| !known(name)) {
            return Err(Failure::input(anyhow::anyhow!(
                "pose `{missing}`, which the model did not learn from, is not among the poses; name the rig, \
                 the controls and the poses that it was trained on"
            )));
        }
        let (unseen, trained) = self
            .library
            .poses
            .iter()
            .cloned()
            .partition(|pose| held_out.contains(&pose.name));
        Ok((
            PoseLibrary { poses: trained },
            PoseLibrary { poses: unseen },
        ))
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

    /// Endless natural poses to measure on: those of `held_out` and perturbations of them.
    pub(crate) fn natural<'a>(&'a self, held_out: &'a PoseLibrary, seed: u64) -> PoseStream<'a> {
        natural_poses(&self.rig, &self.controls, held_out, seed)
    }

    /// Endless broad poses to measure on: any inside the joints' limits.
    pub(crate) fn broad(&self, seed: u64) -> PoseStream<'_> {
        broad_poses(&self.rig, &self.controls, seed)
    }
}
