//! The components of a figure: what a game writes, and what the plugin writes.

use bevy::prelude::*;
use stick3d_figure::{Figure, Sketch, SketchError};
use stick3d_model::JointMark;

use crate::alternatives::SketchAlternatives;
use crate::model_asset::StickModel;
use crate::stream::StreamedBody;

/// A body that takes the pose of a [`StickSketch`] or of a [`Latent`].
///
/// The model is all there is to say what it is: a man, a horse, or what you trained yourself and load as an
/// asset. Another handle makes another body of it.
///
/// # Mandatory components
/// Added by themselves: [`Latent`], [`Grounded`], [`FigureStatus`], [`SketchAlternatives`], [`StreamedBody`],
/// [`Transform`], [`Visibility`].
///
/// # Optional components
/// - [`StickSketch`]: the drawing. Without one, and without a latent, the figure stands as its template does.
/// - [`PlayStickClip`](crate::animation::PlayStickClip), or an `AnimationPlayer` with a graph: motions. See
///   [`animation`](crate::animation).
/// - A material. Without one the body gets the colours of its model, see
///   [`Stick3dMaterialPlugin`](crate::Stick3dMaterialPlugin).
///
/// # Change detection
/// A changed [`StickSketch`] is encoded into the [`Latent`] of the body that is chosen of its [`SketchAlternatives`]; a changed [`Latent`] is decoded into the
/// entity's own mesh, in the same frame. A figure of which neither changed costs a comparison.
#[derive(Component, Clone, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
#[require(
    Latent,
    Grounded,
    FigureStatus,
    SketchAlternatives,
    StreamedBody,
    Transform,
    Visibility
)]
pub struct StickFigure(pub Handle<StickModel>);

impl StickFigure {
    /// The man that ships with the plugin.
    #[cfg(feature = "human")]
    pub const fn human() -> Self {
        Self(crate::embedded::HUMAN_MODEL)
    }

    /// The horse that ships with the plugin.
    #[cfg(feature = "horse")]
    pub const fn horse() -> Self {
        Self(crate::embedded::HORSE_MODEL)
    }
}

/// What was drawn: one point per joint of the figure, x right, y up, in any unit.
///
/// The points are checked when they are used, so that any tool may edit them: a wrong number of them,
/// a coordinate that is not finite, or joints that all coincide leave the body as it was, and
/// [`FigureStatus`] says why.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Debug, Default, PartialEq, Clone)]
pub struct StickSketch {
    /// One point per joint, in the order of the figure's joints.
    pub points: Vec<Vec2>,
    /// Joints that were not drawn: they stand somewhere, and say nothing of the body.
    pub guessed: Vec<usize>,
    /// Joints that the body has to have where they are, however crooked the rest is drawn.
    pub pinned: Vec<usize>,
}

impl StickSketch {
    /// A sketch from one point per joint, in the order of the figure's joints; checked when it is used.
    pub fn new(points: impl Into<Vec<Vec2>>) -> Self {
        Self {
            points: points.into(),
            ..default()
        }
    }

    /// The sketch with some joints that were not drawn.
    #[must_use]
    pub fn with_guessed(mut self, joints: impl IntoIterator<Item = usize>) -> Self {
        self.guessed.extend(joints);
        self
    }

    /// The sketch with some joints that hold the body.
    #[must_use]
    pub fn with_pinned(mut self, joints: impl IntoIterator<Item = usize>) -> Self {
        self.pinned.extend(joints);
        self
    }

    /// A sketch of any figure from named joints: `[("forehead", vec2(0.0, 1.7)), ...]`.
    ///
    /// # Errors
    /// As [`Sketch::from_named`]: an unknown, missing or doubled joint, a coordinate that is not finite.
    pub fn named<'a>(
        figure: &Figure,
        joints: impl IntoIterator<Item = (&'a str, Vec2)>,
    ) -> Result<Self, SketchError> {
        Sketch::from_named(figure, joints).map(Self::from)
    }

    /// A sketch of the man from named joints.
    ///
    /// # Errors
    /// As [`StickSketch::named`].
    pub fn human<'a>(
        joints: impl IntoIterator<Item = (&'a str, Vec2)>,
    ) -> Result<Self, SketchError> {
        Self::named(Figure::human(), joints)
    }

    /// A sketch of the horse from named joints.
    ///
    /// # Errors
    /// As [`StickSketch::named`].
    pub fn horse<'a>(
        joints: impl IntoIterator<Item = (&'a str, Vec2)>,
    ) -> Result<Self, SketchError> {
        Self::named(Figure::horse(), joints)
    }

    /// What each joint of a figure says of the body.
    ///
    /// # Errors
    /// A sentence that names a joint which the figure does not have; nothing is written then.
    pub(crate) fn write_marks(
        &self,
        figure: &Figure,
        marks: &mut Vec<JointMark>,
    ) -> Result<(), String> {
        let count = figure.joint_count();
        let mut all = self.guessed.iter().chain(&self.pinned);
        if let Some(joint) = all.find(|joint| **joint >= count) {
            return Err(format!(
                "the sketch guesses or pins joint {joint}, but {} has joints 0 to {}",
                figure.name,
                count - 1
            ));
        }
        marks.clear();
        marks.resize(count, JointMark::Drawn);
        self.guessed
            .iter()
            .for_each(|joint| marks[*joint] = JointMark::Guessed);
        self.pinned
            .iter()
            .for_each(|joint| marks[*joint] = JointMark::Pinned);
        Ok(())
    }

    /// The checked sketch of a figure.
    ///
    /// # Errors
    /// As [`Sketch::new`].
    pub fn to_sketch(&self, figure: &Figure) -> Result<Sketch, SketchError> {
        Sketch::new(figure, self.points.clone())
    }
}

impl From<Sketch> for StickSketch {
    fn from(sketch: Sketch) -> Self {
        Self::new(sketch.points())
    }
}

impl From<&Sketch> for StickSketch {
    fn from(sketch: &Sketch) -> Self {
        Self::new(sketch.points())
    }
}

/// The pose as the networks know it: the 256 numbers z of the paper.
///
/// Empty until the figure is first posed. Written by the plugin when the [`StickSketch`] changes, and in every frame by clips
/// that play, see [`animation`](crate::animation); free to be written by anything else: a blend of two poses, a slider.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Debug, Default, PartialEq, Clone)]
pub struct Latent(pub Vec<f32>);

/// Whether the body stands on the ground: its lowest vertex at y = 0 of the entity, or above while a clip has it in flight. On by
/// default.
///
/// When off, the figure's root joint (a man's abdomen, a horse's hip) is at the entity's origin.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Debug, Default, PartialEq, Clone)]
pub struct Grounded(pub bool);

impl Default for Grounded {
    fn default() -> Self {
        Self(true)
    }
}

/// How it stands with one figure. Written by the plugin.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Debug, Default, PartialEq, Clone)]
pub enum FigureStatus {
    /// The model, or the clip to play, is not there yet.
    #[default]
    Waiting,
    /// The body shows the sketch or latent.
    Ready,
    /// The body could not follow, and shows what it showed before. The text says why.
    Failed(String),
}

impl FigureStatus {
    /// Why the body does not follow; `None` while all is well.
    pub fn problem(&self) -> Option<&str> {
        match self {
            Self::Failed(message) => Some(message),
            Self::Waiting | Self::Ready => None,
        }
    }
}
