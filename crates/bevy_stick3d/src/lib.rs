//! A Bevy plugin that turns drawn stick figures into posed 3D bodies.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_stick3d::prelude::*;
//!
//! fn main() {
//!     App::new()
//!         .add_plugins((DefaultPlugins, Stick3dPlugin))
//!         .add_systems(Startup, |mut commands: Commands| {
//!             let sketch = StickSketch::new(Figure::human().template.clone());
//!             commands.spawn((StickFigure::human(), sketch));
//!         })
//!         .run();
//! }
//! ```
//!
//! # Figures
//! A figure is chosen by its model and by nothing else: [`StickFigure::human`], [`StickFigure::horse`], or
//! `StickFigure(asset_server.load("fox.stick3d"))` for one of your own. Sketches and canvases follow the
//! figure of the model.
//!
//! # Authored and generated
//! You write [`StickFigure`] (which model), [`StickSketch`] (the drawing) or [`Latent`] (the pose as the
//! networks know it). The plugin writes [`StreamedBody`], [`FigureStatus`], [`SketchAlternatives`], and the entity's `Mesh3d`.
//! A change of the first becomes a change of the second in the same frame; see [`Stick3dSystems`].
//!
//! # Several bodies look like one drawing
//! A drawing says nothing about depth. [`SketchAlternatives`] has the bodies that it may mean, the likeliest first, which is
//! shown; [`ChooseAlternative`] shows another, and [`FlipLimb`] turns one limb's depth round:
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_stick3d::prelude::*;
//! fn next(figures: Query<(Entity, &SketchAlternatives)>, mut choose: MessageWriter<ChooseAlternative>) {
//!     for (figure, alternatives) in &figures {
//!         let count = alternatives.as_slice().len().max(1);
//!         let index = alternatives.chosen().map_or(0, |index| (index + 1) % count);
//!         choose.write(ChooseAlternative { figure, index });
//!     }
//! }
//! # bevy::ecs::system::assert_is_system(next);
//! ```
//!
//! # Motions
//! Several sketches are a clip, and a clip is a Bevy animation: `(StickFigure::human(), PlayStickClip(clip))` plays it, and a
//! grounded walk walks on. See [`animation`].
//!
//! # Plugins
//! [`Stick3dPlugin`] is nothing but these, and each can be left out or replaced:
//!
//! | plugin | duty |
//! | --- | --- |
//! | [`Stick3dSchedulePlugin`] | orders [`Stick3dSystems`] |
//! | [`Stick3dModelPlugin`] | models as assets; the embedded man and horse |
//! | [`Stick3dSketchInputPlugin`] | pointer input over a [`SketchCanvas`] becomes strokes and sketches |
//! | [`Stick3dInferencePlugin`] | sketches become latents, of the alternative that is chosen |
//! | [`Stick3dAnimationPlugin`] | clips of sketches become Bevy animations that move latents and figures; see [`animation`] |
//! | [`Stick3dStreamPlugin`] | latents become meshes |
//! | [`Stick3dMaterialPlugin`] | figures without a material get one |
//!
//! # Features
//! | feature | default | what |
//! | --- | --- | --- |
//! | `human` | yes | embeds the trained model of the man |
//! | `horse` | yes | embeds the trained model of the horse |
//! | `editor` | no | the pose editor, on `bevy_egui`; `launch`, which takes pictures without a window |
//!
//! # When something is wrong
//! Nothing panics: [`Stick3dStatus`] says what is wrong with models and clips, [`FigureStatus`] what is wrong with a figure.

mod alternatives;
pub mod animation;
#[cfg(feature = "editor")]
pub mod editor;
mod embedded;
mod figure;
mod inference;
#[cfg(feature = "editor")]
pub mod launch;
mod material;
mod model_asset;
mod schedule;
pub mod sketch_input;
mod status;
mod stream;

use bevy::app::{PluginGroup, PluginGroupBuilder};

pub use alternatives::{ChooseAlternative, FlipLimb, SketchAlternatives};
pub use animation::Stick3dAnimationPlugin;
#[cfg(feature = "horse")]
pub use embedded::HORSE_MODEL;
#[cfg(feature = "human")]
pub use embedded::HUMAN_MODEL;
pub use embedded::{EMBEDDED_MODELS, EmbeddedModel};
pub use figure::{FigureStatus, Grounded, Latent, StickFigure, StickSketch};
pub use inference::{ReadyModel, Stick3dInferencePlugin, StickInference};
pub use material::{DefaultFigureMaterial, OwnMaterial, Stick3dMaterialPlugin};
pub use model_asset::{Stick3dModelPlugin, StickModel, StickModelLoader, StickModelLoaderError};
pub use schedule::{Stick3dSchedulePlugin, Stick3dSystems};
pub use sketch_input::{SketchCanvas, Stick3dSketchInputPlugin};
pub use status::Stick3dStatus;
pub use stick3d_figure as figure_data;
pub use stick3d_model as model_data;
pub use stream::{Stick3dStreamPlugin, StreamError, StreamedBody};

/// What most apps need.
pub mod prelude {
    pub use stick3d_figure::{Figure, Sketch};
    pub use stick3d_model::latent::{Easing, Extrapolation, Interpolation, Repeat};

    pub use crate::animation::{PlayStickClip, RootMotion, StickClip, StickClips};
    pub use crate::sketch_input::{
        CanvasArea, DrawingOrder, SketchCanvas, SketchChanged, SketchCompleted, SketchDrawing,
        StrokeFinished, StrokeUndone,
    };
    pub use crate::{
        ChooseAlternative, FigureStatus, FlipLimb, Grounded, Latent, SketchAlternatives,
        Stick3dPlugin, Stick3dStatus, Stick3dSystems, StickFigure, StickModel, StickSketch,
    };
}

/// Everything of the plugin. See the crate's page for its parts.
///
/// To leave one out: `Stick3dPlugin.build().disable::<Stick3dMaterialPlugin>()`.
#[derive(Debug, Default, Clone, Copy)]
pub struct Stick3dPlugin;

impl PluginGroup for Stick3dPlugin {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(Stick3dSchedulePlugin)
            .add(Stick3dModelPlugin)
            .add(Stick3dSketchInputPlugin)
            .add(Stick3dInferencePlugin)
            .add(Stick3dAnimationPlugin)
            .add(Stick3dStreamPlugin)
            .add(Stick3dMaterialPlugin)
    }
}
