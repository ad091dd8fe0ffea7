//! The clip file, `*.clip.ron`: a motion as its author made it.
//!
//! ```ron
//! Clip(
//!     figure: "human",
//!     interpolation: Cubic,                          // Linear if not given
//!     repeat: Loop(closing_s: 0.3),                  // Once if not given; or PingPong
//!     extrapolation: Bounded(least_trust: 0.5),      // if not given; or Hold, PingPong(), Unbounded
//!     grounded: true,                                // if not given
//!     keys: [
//!         (time_s: 0.0, pose: Sketch("walk_1.json")),
//!         (time_s: 0.3, easing: InOut, pose: Joints({"forehead": (0.0, 1.7), "neck": (0.0, 1.5)})),
//!         (time_s: 0.6, pose: Latent([0.1, -0.2])),
//!     ],
//! )
//! ```
//!
//! Sketch files are of any form that [`interchange`](stick3d_figure::interchange) reads; their paths count from the
//! clip file's folder. Joints need all of the figure's, x right, y up, any unit. A latent means its pose only to the model
//! that made it: sketches outlive a new training, latents do not.

mod error;

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use glam::Vec2;
use serde::{Deserialize, Serialize};
use stick3d_figure::figure::Figure;
use stick3d_figure::interchange::InterchangeError;
use stick3d_figure::sketch::Sketch;

pub use error::ClipError;

use super::extrapolation::Extrapolation;
use super::motion::{Motion, MotionSettings};
use super::path::{Interpolation, LatentKey};
use super::{Easing, Repeat};
use crate::files::write_atomically;
use crate::infer::Inference;

/// What a clip file holds. What it says is checked when it becomes a [`Motion`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Clip", deny_unknown_fields)]
pub struct ClipFile {
    /// The figure that moves, by name.
    pub figure: String,
    /// What is between two keys.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// What comes after the last key.
    #[serde(default)]
    pub repeat: Repeat,
    /// What is beyond the first and the last key.
    #[serde(default)]
    pub extrapolation: Extrapolation,
    /// Whether the figure stands on the ground, and walks on it.
    #[serde(default = "yes")]
    pub grounded: bool,
    /// The poses, by rising time.
    pub keys: Vec<ClipKey>,
}

/// One pose of a clip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClipKey {
    /// When, seconds.
    pub time_s: f32,
    /// How time passes from here to the next key.
    #[serde(default)]
    pub easing: Easing,
    /// The pose.
    pub pose: ClipPose,
}

/// A pose in one of three forms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ClipPose {
    /// A sketch file; its path counts from the clip file's folder.
    Sketch(String),
    /// A sketch: a point for each of the figure's joints, by name; x right, y up, any unit.
    Joints(BTreeMap<String, (f32, f32)>),
    /// A latent of the model that plays the clip.
    Latent(Vec<f32>),
}

fn yes() -> bool {
    true
}

impl ClipPose {
    /// A sketch of a figure, to be kept in the clip file itself.
    #[must_use]
    pub fn of_sketch(figure: &Figure, sketch: &Sketch) -> Self {
        let names = figure.joints.iter().map(|joint| joint.name.clone());
        let points = sketch.points().iter().map(|point| (point.x, point.y));
        Self::Joints(names.zip(points).collect())
    }
}

impl ClipFile {
    /// An empty clip of a figure, to be given keys.
    #[must_use]
    pub fn new(figure: &str, settings: MotionSettings) -> Self {
        let MotionSettings {
            interpolation,
            repeat,
            extrapolation,
            grounded,
        } = settings;
        Self {
            figure: figure.to_owned(),
            interpolation,
            repeat,
            extrapolation,
            grounded,
            keys: vec![],
        }
    }

    /// Reads a clip from RON text.
    ///
    /// # Errors
    /// [`ClipError::Syntax`], with line and column.
    pub fn from_ron(text: &str) -> Result<Self, ClipError> {
        let options = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        options.from_str(text).map_err(|error| ClipError::Syntax {
            line: error.span.start.line,
            column: error.span.start.col,
            message: error.code.to_string(),
        })
    }

    /// Writes the clip as RON text that [`ClipFile::from_ron`] reads back to an equal clip.
    ///
    /// # Errors
    /// [`ClipError::Write`] when the serialiser gives up.
    pub fn to_ron(&self) -> Result<String, ClipError> {
        let style = ron::ser::PrettyConfig::new()
            .depth_limit(3)
            .struct_names(true);
        let options = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        let text = options.to_string_pretty(self, style);
        text.map_err(|error| ClipError::Write(error.to_string()))
    }

    /// Reads a clip file.
    ///
    /// # Errors
    /// [`ClipError::Io`], [`ClipError::Syntax`].
    pub fn load(path: &Path) -> Result<Self, ClipError> {
        let text = std::fs::read_to_string(path).map_err(|source| ClipError::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::from_ron(&text)
    }

    /// Writes a clip file: to a temporary one beside it, then renamed.
    ///
    /// # Errors
    /// [`ClipError::Io`], [`ClipError::Write`].
    pub fn save(&self, path: &Path) -> Result<(), ClipError> {
        write_atomically(path, self.to_ron()?.as_bytes()).map_err(|source| ClipError::Io {
            path: path.to_owned(),
            source,
        })
    }

    /// How the keys become a motion.
    #[must_use]
    pub fn settings(&self) -> MotionSettings {
        MotionSettings {
            interpolation: self.interpolation,
            repeat: self.repeat,
            extrapolation: self.extrapolation,
            grounded: self.grounded,
        }
    }

    /// The sketch files that it names, in the order of the keys.
    pub fn sketch_files(&self) -> impl Iterator<Item = &str> {
        self.keys.iter().filter_map(|key| match &key.pose {
            ClipPose::Sketch(file) => Some(file.as_str()),
            ClipPose::Joints(_) | ClipPose::Latent(_) => None,
        })
    }

    /// The sketch of every key; `None` for those that are latents. `read` gives the bytes of a sketch file by the name that
    /// the clip uses, see [`ClipFile::sketch_files`]; [`ClipFile::beside`] makes one.
    ///
    /// # Errors
    /// [`ClipError::OtherFigure`], [`ClipError::SketchFile`], [`ClipError::Sketch`].
    pub fn sketches(
        &self,
        figure: &Figure,
        mut read: impl FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Vec<Option<Sketch>>, ClipError> {
        if self.figure != figure.name {
            return Err(ClipError::OtherFigure {
                expected: figure.name.clone(),
                found: self.figure.clone(),
            });
        }
        let sketch = |(index, key): (usize, &ClipKey)| -> Result<Option<Sketch>, ClipError> {
            let key_number = index + 1;
            let wrong = |source: InterchangeError| ClipError::Sketch {
                key: key_number,
                source,
            };
            match &key.pose {
                ClipPose::Sketch(file) => {
                    let bytes = read(file).map_err(|source| ClipError::SketchFile {
                        key: key_number,
                        file: file.clone(),
                        source,
                    })?;
                    Sketch::from_json(figure, &bytes).map(Some).map_err(wrong)
                }
                ClipPose::Joints(joints) => {
                    let named = joints
                        .iter()
                        .map(|(name, at)| (name.as_str(), Vec2::from(*at)));
                    let sketch = Sketch::from_named(figure, named);
                    sketch.map(Some).map_err(|error| wrong(error.into()))
                }
                ClipPose::Latent(_) => Ok(None),
            }
        };
        self.keys.iter().enumerate().map(sketch).collect()
    }

    /// The keys as latents. `read` as in [`ClipFile::sketches`].
    ///
    /// # Errors
    /// Those of [`ClipFile::sketches`], and [`ClipError::Encode`].
    pub fn latent_keys(
        &self,
        inference: &mut Inference,
        read: impl FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Vec<LatentKey>, ClipError> {
        let sketches = self.sketches(inference.figure(), read)?;
        let mut keys = Vec::with_capacity(self.keys.len());
        for (index, (key, sketch)) in self.keys.iter().zip(sketches).enumerate() {
            let mut latent = vec![];
            if let ClipPose::Latent(given) = &key.pose {
                latent.clone_from(given);
            }
            if let Some(sketch) = sketch {
                latent.resize(inference.latent_len(), 0.0);
                let encoded = inference.encode(&sketch, &mut latent);
                encoded.map_err(|source| ClipError::Encode {
                    key: index + 1,
                    source,
                })?;
            }
            keys.push(LatentKey {
                latent,
                time_s: key.time_s,
                easing: key.easing,
            });
        }
        Ok(keys)
    }

    /// The motion. `read` as in [`ClipFile::sketches`].
    ///
    /// # Errors
    /// Those of [`ClipFile::latent_keys`], and [`ClipError::Path`].
    pub fn motion(
        &self,
        inference: &mut Inference,
        read: impl FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Motion, ClipError> {
        let keys = self.latent_keys(inference, read)?;
        Ok(Motion::new(&keys, self.settings(), inference)?)
    }

    /// Reads the sketch files of the clip file at `path`.
    pub fn beside(path: &Path) -> impl Fn(&str) -> io::Result<Vec<u8>> + use<> {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        move |file| std::fs::read(folder.join(file))
    }
}

#[cfg(test)]
mod tests;
