//! The networks, ready to run: one set per model in use, and the system that turns sketches into latents.

use bevy::asset::AssetLoadFailedEvent;
use bevy::ecs::system::SystemChangeTick;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use stick3d_figure::Sketch;
use stick3d_model::{InferError, Inference, ModelError};

use crate::alternatives::{ChooseAlternative, FlipLimb, SketchAlternatives, choose_alternatives};
use crate::figure::{FigureStatus, Latent, StickFigure, StickSketch};
use crate::model_asset::StickModel;
use crate::schedule::Stick3dSystems;
use crate::sketch_input::SketchPreview;
use crate::status::Stick3dStatus;
use crate::stream::StreamedBody;

/// The networks and the scratch memory of one model.
pub struct ReadyModel {
    /// The asset this was made from.
    pub model: StickModel,
    /// The networks.
    pub inference: Inference,
    /// Different for every model that was made ready, also when the same asset was loaded anew: a body
    /// that was made by another generation is made again.
    pub generation: u64,
    latent: Vec<f32>,
}

impl ReadyModel {
    fn new(model: &StickModel, generation: u64) -> Result<Self, ModelError> {
        let inference = Inference::new(model.model())?;
        Ok(Self {
            latent: vec![0.0; inference.latent_len()],
            model: model.clone(),
            inference,
            generation,
        })
    }

    /// The latent of a sketch.
    ///
    /// # Errors
    /// As [`Inference::encode`].
    pub fn encode(&mut self, sketch: &Sketch) -> Result<&[f32], InferError> {
        self.inference.encode(sketch, &mut self.latent)?;
        Ok(&self.latent)
    }
}

/// The models in use, ready to run. Filled in [`Stick3dSystems::Models`].
#[derive(Resource, Default)]
pub struct StickInference {
    ready: HashMap<AssetId<StickModel>, ReadyModel>,
    /// Models that were loaded and cannot be run; tried again when they change.
    unusable: HashSet<AssetId<StickModel>>,
    generations: u64,
}

impl StickInference {
    /// The ready networks of a model; `None` while it loads, or when it does not work.
    pub fn get(&self, model: impl Into<AssetId<StickModel>>) -> Option<&ReadyModel> {
        self.ready.get(&model.into())
    }

    /// As [`StickInference::get`], to run them.
    pub fn get_mut(&mut self, model: impl Into<AssetId<StickModel>>) -> Option<&mut ReadyModel> {
        self.ready.get_mut(&model.into())
    }

    fn forget(&mut self, id: AssetId<StickModel>) {
        self.ready.remove(&id);
        self.unusable.remove(&id);
    }

    /// Makes a model ready once; says so in the status when that fails.
    fn make_ready(
        &mut self,
        id: AssetId<StickModel>,
        model: &StickModel,
        status: &mut Stick3dStatus,
    ) {
        if self.ready.contains_key(&id) || self.unusable.contains(&id) {
            return;
        }
        self.generations += 1;
        match ReadyModel::new(model, self.generations) {
            Ok(ready) => {
                self.ready.insert(id, ready);
                status.clear(id);
            }
            Err(error) => {
                self.unusable.insert(id);
                status.fail(id, format!("the model cannot be run: {error}"));
            }
        }
    }
}

/// Runs the networks: models are made ready, changed sketches become latents, and other bodies of theirs are chosen.
#[derive(Debug, Default, Clone, Copy)]
pub struct Stick3dInferencePlugin;

impl Plugin for Stick3dInferencePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<StickInference>()
            .init_resource::<Stick3dStatus>()
            .register_type::<Stick3dStatus>()
            .register_type::<StickFigure>()
            .register_type::<StickSketch>()
            .register_type::<Latent>()
            .register_type::<FigureStatus>()
            .register_type::<SketchAlternatives>()
            .register_type::<ChooseAlternative>()
            .register_type::<FlipLimb>()
            .add_message::<ChooseAlternative>()
            .add_message::<FlipLimb>()
            .add_systems(
                PostUpdate,
                (
                    (forget_changed_models, note_failed_models, make_models_ready)
                        .chain()
                        .in_set(Stick3dSystems::Models),
                    (encode_sketches, choose_alternatives)
                        .chain()
                        .in_set(Stick3dSystems::Encode),
                ),
            );
    }
}

/// A model that was loaded anew or removed has to be made ready again, or is gone.
fn forget_changed_models(
    mut events: MessageReader<AssetEvent<StickModel>>,
    mut inference: ResMut<StickInference>,
) {
    for event in events.read() {
        if let AssetEvent::Modified { id } | AssetEvent::Removed { id } = event {
            inference.forget(*id);
        }
    }
}

fn note_failed_models(
    mut failures: MessageReader<AssetLoadFailedEvent<StickModel>>,
    mut status: ResMut<Stick3dStatus>,
) {
    for failure in failures.read() {
        status.fail(
            failure.id,
            format!("{} could not be loaded: {}", failure.path, failure.error),
        );
    }
}

/// Makes the models ready that some figure uses.
fn make_models_ready(
    mut figures: Query<(&StickFigure, &StreamedBody, &mut FigureStatus)>,
    models: Res<Assets<StickModel>>,
    mut inference: ResMut<StickInference>,
    mut status: ResMut<Stick3dStatus>,
) {
    for (figure, body, mut figure_status) in &mut figures {
        let id = figure.0.id();
        if let Some(model) = models.get(id) {
            inference.make_ready(id, model, &mut status);
        }
        match (inference.get(id), status.problem(id)) {
            (Some(ready), _) if ready.generation != body.generation() => {
                figure_status.set_if_neq(FigureStatus::Waiting);
            }
            (None, Some(problem)) => {
                figure_status.set_if_neq(FigureStatus::Failed(problem.to_owned()));
            }
            _ => {}
        }
    }
}

/// Changed sketches, and those of figures whose model changed, become latents.
fn encode_sketches(
    mut figures: Query<(
        Ref<StickFigure>,
        Option<Ref<StickSketch>>,
        Has<SketchPreview>,
        &StreamedBody,
        &mut SketchAlternatives,
        &mut Latent,
        &mut FigureStatus,
    )>,
    mut inference: ResMut<StickInference>,
    ticks: SystemChangeTick,
) {
    for (figure, sketch, is_draft, body, mut alternatives, mut latent, mut status) in &mut figures {
        let Some(ready) = inference.get_mut(&figure.0) else {
            continue;
        };
        let other_model = body.generation() != ready.generation;
        // A latent from before the model was exchanged means nothing to the new one.
        let mut foreign = body.model().is_some_and(|before| before != figure.0.id())
            && figure
                .last_changed()
                .is_newer_than(latent.last_changed(), ticks.this_run());
        if (other_model || sketch.is_none()) && !alternatives.is_blank() {
            alternatives.forget();
        }
        if let Some(sketch) = sketch
            && (other_model || sketch.is_changed() || alternatives.has_wish())
        {
            match alternatives.follow(&mut ready.inference, &sketch, is_draft) {
                Ok(()) => {
                    if let Some(shown) = alternatives.shown() {
                        latent.0.clone_from(&shown.latent);
                    }
                    foreign = false;
                    status.set_if_neq(FigureStatus::Ready)
                }
                Err(problem) => status.set_if_neq(FigureStatus::Failed(problem)),
            };
        }
        // A figure without a usable pose stands as its template does.
        if other_model && (foreign || latent.0.len() != ready.inference.latent_len()) {
            let template = ready.model.model().figure().template.clone();
            if let Err(problem) = encode_points(ready, &template, &mut latent) {
                status.set_if_neq(FigureStatus::Failed(problem));
            }
        }
    }
}

/// Writes the latent of the drawn points; leaves it untouched when they are no sketch.
fn encode_points(
    ready: &mut ReadyModel,
    points: &[Vec2],
    latent: &mut Mut<Latent>,
) -> Result<(), String> {
    let sketch = Sketch::new(ready.model.model().figure(), points.to_vec())
        .map_err(|error| error.to_string())?;
    let numbers = ready.encode(&sketch).map_err(|error| error.to_string())?;
    latent.0.clear();
    latent.0.extend_from_slice(numbers);
    Ok(())
}
