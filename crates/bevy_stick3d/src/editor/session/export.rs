//! Writing the motion for other programs, while the editor goes on.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use stick3d_model::export::animation::{
    AnimationError, AnimationMesh, AnimationReport, DEFAULT_TOLERANCE_M, FrameSettings,
    sample_frames, save_glb_animation,
};
use stick3d_model::{Inference, Motion};

use super::{Choice, Desk, Session};
use crate::inference::ReadyModel;
use crate::model_asset::StickModel;

/// A motion that is being written.
pub(super) struct Export {
    path: PathBuf,
    task: Task<Result<AnimationReport, AnimationError>>,
}

impl Desk<'_, '_> {
    /// Begins to write the motion of the figure that is drawn as binary glTF, beside its clip file.
    pub(super) fn export(&mut self) {
        let Some(choice) = self.session.choice() else {
            return;
        };
        if self.session.export.is_some() {
            return self
                .session
                .status
                .note("The last export is still being written");
        }
        let Some(motion) = choice.performance.motion() else {
            return self.session.status.note("Draw a source and a target first");
        };
        let path = path_beside(choice);
        let Some(ready) = self.ready_model(choice.body) else {
            return self.session.status.note("The model is not ready yet");
        };
        let task = begin(motion.clone(), ready, path.clone());
        let note = format!("Writing {}", path.display());
        self.session.status.note(note);
        self.session.export = Some(Export { path, task });
    }
}

/// `walk.glb` for `walk.clip.ron`.
fn path_beside(choice: &Choice) -> PathBuf {
    let clip = Path::new(choice.files.clip.trim());
    let stem = clip.with_extension("");
    let stem = match stem.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("clip") => stem.with_extension(""),
        _ => stem,
    };
    if stem.file_name().is_none() {
        return PathBuf::from(format!("{}.glb", choice.figure.figure().name));
    }
    let mut name = stem.into_os_string();
    name.push(".glb");
    PathBuf::from(name)
}

fn begin(
    motion: Motion,
    ready: &ReadyModel,
    path: PathBuf,
) -> Task<Result<AnimationReport, AnimationError>> {
    let (model, mut inference) = (ready.model.clone(), ready.inference.clone());
    AsyncComputeTaskPool::get().spawn(async move { write(&motion, &model, &mut inference, &path) })
}

fn write(
    motion: &Motion,
    model: &StickModel,
    inference: &mut Inference,
    path: &Path,
) -> Result<AnimationReport, AnimationError> {
    let frames = sample_frames(motion, FrameSettings::default(), inference)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let mesh = AnimationMesh::of(model.model(), &name);
    save_glb_animation(path, &mesh, frames, DEFAULT_TOLERANCE_M)
}

/// Says how the writing ended.
pub(super) fn finish_export(mut session: ResMut<Session>) {
    let Some(export) = &mut session.bypass_change_detection().export else {
        return;
    };
    let Some(ended) = check_ready(&mut export.task) else {
        return;
    };
    let path = export.path.display().to_string();
    session.export = None;
    match ended {
        Ok(report) => session.status.note(format!(
            "Exported {path}: {:.1} s, {:.1} MB",
            report.duration_s,
            report.byte_count as f32 / 1.0e6
        )),
        Err(error) => session
            .status
            .problem(format!("{path} was not written: {error}")),
    }
}
