//! A motion as frames.

use glam::Vec3;

use super::AnimationError;
use crate::infer::Inference;
use crate::latent::{LatentPath, Motion, Repeat};

/// The most frames of one clip: a minute at 30 a second, about half a gigabyte while it is written.
pub const MOST_FRAMES: usize = 1800;

/// Which frames of a motion are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameSettings {
    /// Frames a second.
    pub fps: f32,
    /// How long the clip goes on after its last key, seconds; one that repeats goes on after its first round, which begins and
    /// ends at the first key.
    pub past_s: f32,
}

impl Default for FrameSettings {
    fn default() -> Self {
        Self {
            fps: 30.0,
            past_s: 0.0,
        }
    }
}

/// The body at one time of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Since the first key, seconds.
    pub time_s: f32,
    /// Metres, the figure's root joint at the origin.
    pub positions: Vec<[f32; 3]>,
    /// Unit vectors.
    pub normals: Vec<[f32; 3]>,
    /// Where the root joint is, metres; `None` for a motion that is not grounded.
    pub root: Option<Vec3>,
}

impl Frame {
    /// Moves the body itself to where the root joint is; `root` is then nothing more to add.
    pub fn apply_root(&mut self) {
        if let Some(root) = self.root.take() {
            let moved = |position: &[f32; 3]| (Vec3::from(*position) + root).to_array();
            self.positions.iter_mut().for_each(|p| *p = moved(p));
        }
    }
}

/// The frames of a motion from its first key to its last and on; the last of them is at the end itself, sooner than the
/// frame rate says where the duration is no multiple of it.
///
/// # Errors
/// [`AnimationError::FrameRate`], [`AnimationError::Past`], [`AnimationError::TooManyFrames`]; [`AnimationError::Infer`] for a
/// motion that is unbounded and goes on until no body is left.
pub fn sample_frames(
    motion: &Motion,
    settings: FrameSettings,
    inference: &mut Inference,
) -> Result<Vec<Frame>, AnimationError> {
    let path = motion.path();
    let start_s = path.key_times_s().first().copied().unwrap_or(0.0);
    let mut latent = vec![0.0; path.latent_len()];
    let frame = |since_s: f64| -> Result<Frame, AnimationError> {
        let time_s = (f64::from(start_s) + since_s) as f32;
        motion.sample_into(time_s, &mut latent)?;
        let count = inference.vertex_count();
        let mut frame = Frame {
            time_s: since_s as f32,
            positions: vec![[0.0; 3]; count],
            normals: vec![[0.0; 3]; count],
            root: motion.root_translation(time_s),
        };
        inference.decode(&latent, &mut frame.positions, &mut frame.normals)?;
        Ok(frame)
    };
    times_s(path, settings)?.into_iter().map(frame).collect()
}

/// When the frames are, since the first key, seconds.
fn times_s(path: &LatentPath, settings: FrameSettings) -> Result<Vec<f64>, AnimationError> {
    let FrameSettings { fps, past_s } = settings;
    if !(fps.is_finite() && fps > 0.0) {
        return Err(AnimationError::FrameRate { fps });
    }
    if !(past_s.is_finite() && past_s >= 0.0) {
        return Err(AnimationError::Past { past_s });
    }
    let one_way_s = path.duration_s();
    let round_s = match path.repeat() {
        Repeat::Once | Repeat::Loop { .. } => one_way_s,
        Repeat::PingPong => 2.0 * one_way_s,
    };
    let end_s = f64::from(round_s) + f64::from(past_s);
    // A frame that would be less than a hundredth of the distance of frames before the end is the end.
    let steps = (end_s * f64::from(fps) - 0.01).ceil().max(1.0);
    if steps >= MOST_FRAMES as f64 {
        return Err(AnimationError::TooManyFrames {
            seconds: end_s as f32,
            fps,
        });
    }
    let inner = (0..steps as usize).map(|step| step as f64 / f64::from(fps));
    Ok(inner.chain([end_s]).collect())
}
