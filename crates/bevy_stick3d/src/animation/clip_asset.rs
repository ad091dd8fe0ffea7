//! Clips as Bevy assets: sketches or latents at times, from a `.clip.ron` file or from code, and their loader.

use std::collections::BTreeMap;
use std::io;

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext, ParseAssetPathError, ReadAssetBytesError};
use bevy::prelude::*;
use stick3d_figure::{Figure, Sketch, SketchError};
use stick3d_model::latent::{
    ClipError, ClipFile, ClipKey, ClipPose, Easing, Extrapolation, Interpolation, MotionSettings,
    Repeat,
};
use stick3d_model::{Inference, Motion};
use thiserror::Error;

/// A motion as its author made it: sketches or latents at times. The files end in `.clip.ron`; see `docs/motion.md`.
///
/// It becomes a Bevy [`AnimationClip`] once it and a model of its figure are loaded: [`PlayStickClip`](super::PlayStickClip) does
/// all of it, [`StickClips::animation`](super::StickClips::animation) is for graphs of your own.
#[derive(Asset, Clone, Debug, PartialEq, Reflect)]
#[reflect(opaque, Clone, Debug, PartialEq)]
pub struct StickClip {
    file: ClipFile,
    /// The sketch files that it names, by these names.
    sketch_files: BTreeMap<String, Vec<u8>>,
}

impl StickClip {
    /// A clip from a file whose keys name no sketch files.
    pub fn new(file: ClipFile) -> Self {
        Self {
            file,
            sketch_files: BTreeMap::new(),
        }
    }

    /// A clip of a figure, from code.
    ///
    /// ```
    /// use bevy_stick3d::prelude::*;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let standing = StickSketch::new(Figure::human().template.clone());
    /// # let waving = standing.clone();
    /// let clip = StickClip::builder(Figure::human())
    ///     .sketch(0.0, standing)
    ///     .sketch(0.8, waving)
    ///     .easing(Easing::InOut)
    ///     .repeat(Repeat::PingPong)
    ///     .build()?;
    /// # assert_eq!(clip.file().keys.len(), 2);
    /// # Ok(())
    /// # }
    /// ```
    pub fn builder(figure: &Figure) -> StickClipBuilder<'_> {
        StickClipBuilder {
            figure,
            file: ClipFile::new(&figure.name, MotionSettings::default()),
            error: None,
        }
    }

    /// What the clip says.
    pub fn file(&self) -> &ClipFile {
        &self.file
    }

    /// The motion of the clip for a model.
    ///
    /// Decodes some dozens of bodies.
    ///
    /// # Errors
    /// [`ClipError`], for a model of another figure and for keys that are no path.
    pub fn motion(&self, inference: &mut Inference) -> Result<Motion, ClipError> {
        self.file.motion(inference, |name| {
            let bytes = self.sketch_files.get(name).cloned();
            bytes.ok_or_else(|| io::ErrorKind::NotFound.into())
        })
    }
}

/// Makes a [`StickClip`]: a key after the other, by rising time.
///
/// Times, and whether there are enough keys, are checked when the clip becomes a motion.
#[derive(Clone, Debug)]
pub struct StickClipBuilder<'a> {
    figure: &'a Figure,
    file: ClipFile,
    error: Option<BuildClipError>,
}

/// Why a key is none of the clip's figure. Keys are counted from 1.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("key {key} is no sketch of figure \"{figure}\": {source}")]
pub struct BuildClipError {
    /// Which key.
    pub key: usize,
    /// The clip's figure.
    pub figure: String,
    /// What is wrong with the sketch.
    pub source: SketchError,
}

impl StickClipBuilder<'_> {
    /// A key: what was drawn, at a time in seconds.
    #[must_use]
    pub fn sketch(mut self, time_s: f32, sketch: impl Into<crate::StickSketch>) -> Self {
        let sketch: Result<Sketch, SketchError> = sketch.into().to_sketch(self.figure);
        match sketch {
            Ok(sketch) => {
                let pose = ClipPose::of_sketch(self.figure, &sketch);
                self.key(time_s, pose)
            }
            Err(source) => {
                let key = self.file.keys.len() + 1;
                let figure = self.figure.name.clone();
                self.error.get_or_insert(BuildClipError {
                    key,
                    figure,
                    source,
                });
                self
            }
        }
    }

    /// A key: a latent of the model that will play the clip, at a time in seconds.
    #[must_use]
    pub fn latent(self, time_s: f32, latent: impl Into<Vec<f32>>) -> Self {
        self.key(time_s, ClipPose::Latent(latent.into()))
    }

    /// How time passes from the last key so far to the next.
    #[must_use]
    pub fn easing(mut self, easing: Easing) -> Self {
        if let Some(key) = self.file.keys.last_mut() {
            key.easing = easing;
        }
        self
    }

    /// What is between two keys.
    #[must_use]
    pub fn interpolation(mut self, interpolation: Interpolation) -> Self {
        self.file.interpolation = interpolation;
        self
    }

    /// What comes after the last key.
    #[must_use]
    pub fn repeat(mut self, repeat: Repeat) -> Self {
        self.file.repeat = repeat;
        self
    }

    /// What is beyond the last key of a clip that does not repeat.
    #[must_use]
    pub fn extrapolation(mut self, extrapolation: Extrapolation) -> Self {
        self.file.extrapolation = extrapolation;
        self
    }

    /// Whether the figure stands on the ground, and walks on it.
    #[must_use]
    pub fn grounded(mut self, grounded: bool) -> Self {
        self.file.grounded = grounded;
        self
    }

    /// The clip.
    ///
    /// # Errors
    /// [`BuildClipError`], for the first key that is no sketch of the figure.
    pub fn build(self) -> Result<StickClip, BuildClipError> {
        match self.error {
            Some(error) => Err(error),
            None => Ok(StickClip::new(self.file)),
        }
    }

    fn key(mut self, time_s: f32, pose: ClipPose) -> Self {
        self.file.keys.push(ClipKey {
            time_s,
            easing: Easing::default(),
            pose,
        });
        self
    }
}

/// Why a `.clip.ron` file could not be loaded.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StickClipLoaderError {
    /// The file could not be read.
    #[error("the clip file could not be read: {0}")]
    Io(#[from] io::Error),
    /// The file was read, and is no text.
    #[error("the clip file is no UTF-8 text: {0}")]
    Utf8(#[from] std::str::Utf8Error),
    /// The file was read, and is no clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// The clip names a sketch file by what is no path.
    #[error("the clip names the sketch file \"{file}\", which is no path: {source}")]
    SketchPath {
        /// As the clip names it.
        file: String,
        /// Why it is none.
        source: ParseAssetPathError,
    },
    /// The clip names a sketch file that could not be read.
    #[error("the clip's sketch file \"{file}\" could not be read: {source}")]
    SketchFile {
        /// As the clip names it.
        file: String,
        /// What the asset source said.
        source: ReadAssetBytesError,
    },
}

/// Loads `.clip.ron` files, and the sketch files that they name: a change of either loads the clip anew where Bevy
/// watches files.
#[derive(Debug, Default, Clone, Copy, TypePath)]
pub struct StickClipLoader;

impl AssetLoader for StickClipLoader {
    type Asset = StickClip;
    type Settings = ();
    type Error = StickClipLoaderError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        context: &mut LoadContext<'_>,
    ) -> Result<StickClip, StickClipLoaderError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let file = ClipFile::from_ron(str::from_utf8(&bytes)?)?;
        let mut sketch_files = BTreeMap::new();
        for name in file.sketch_files() {
            if sketch_files.contains_key(name) {
                continue;
            }
            let path = context.path().resolve_embed_str(name).map_err(|source| {
                let file = name.to_owned();
                StickClipLoaderError::SketchPath { file, source }
            })?;
            let bytes = context.read_asset_bytes(path).await.map_err(|source| {
                let file = name.to_owned();
                StickClipLoaderError::SketchFile { file, source }
            })?;
            sketch_files.insert(name.to_owned(), bytes);
        }
        Ok(StickClip { file, sketch_files })
    }

    fn extensions(&self) -> &[&str] {
        &["clip.ron"]
    }
}
