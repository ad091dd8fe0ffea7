//! The clips in use: stick clips on one side, Bevy's animation clips on the other, built as soon as clip and model are there.

use std::sync::Arc;

use bevy::asset::AssetLoadFailedEvent;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

use super::clip_asset::StickClip;
use super::curve::LatentCurve;
use super::player::PlayStickClip;
use crate::figure::StickFigure;
use crate::inference::StickInference;
use crate::model_asset::StickModel;
use crate::status::Stick3dStatus;

/// A clip as one model plays it.
type Key = (AssetId<StickClip>, AssetId<StickModel>);

/// The [`StickClip`]s in use, as Bevy [`AnimationClip`]s.
///
/// Sketches become latents by a model, so there is one animation clip for every pair of a clip and a model. It is empty until both are
/// loaded, and built anew, under the same handle, when one of them changes. It is dropped with its last handle.
#[derive(Resource, Default)]
pub struct StickClips {
    entries: HashMap<Key, Entry>,
}

/// One animation clip.
pub(super) struct Entry {
    clip: Handle<StickClip>,
    model: Handle<StickModel>,
    animation: Handle<AnimationClip>,
    /// A graph of this clip alone, for the figures that play nothing else.
    graph: Option<(Handle<AnimationGraph>, AnimationNodeIndex)>,
    curve: Option<LatentCurve>,
    /// Which ready model the last build, good or bad, was for; 0 when it has to be built.
    generation: u64,
    /// Counts the good builds.
    version: u64,
    problem: Option<String>,
    finishers: Vec<Finisher>,
}

/// What is done to an animation clip whenever it was built.
type Finisher = Box<dyn Fn(&mut AnimationClip) + Send + Sync>;

impl StickClips {
    /// The animation clip of a clip, for graphs of your own: add it to an `AnimationGraph`, and put the graph and an
    /// `AnimationPlayer` on a [`StickFigure`](crate::StickFigure) of that model.
    ///
    /// The same handle for the same two, always.
    pub fn animation(
        &mut self,
        clip: &Handle<StickClip>,
        model: &Handle<StickModel>,
        animations: &Assets<AnimationClip>,
    ) -> Handle<AnimationClip> {
        self.entry(clip, model, animations).animation.clone()
    }

    /// Does something to the animation clip of a clip whenever it is built, such as adding events.
    pub fn finish_with(
        &mut self,
        clip: &Handle<StickClip>,
        model: &Handle<StickModel>,
        animations: &mut Assets<AnimationClip>,
        finish: impl Fn(&mut AnimationClip) + Send + Sync + 'static,
    ) {
        let entry = self.entry(clip, model, animations);
        if let Some(mut built) = animations.get_mut(&entry.animation) {
            finish(&mut built);
        }
        entry.finishers.push(Box::new(finish));
    }

    /// The motion of a clip; `None` until clip and model are loaded, or when they do not fit.
    pub fn curve(
        &self,
        clip: impl Into<AssetId<StickClip>>,
        model: impl Into<AssetId<StickModel>>,
    ) -> Option<&LatentCurve> {
        self.entries
            .get(&(clip.into(), model.into()))?
            .curve
            .as_ref()
    }

    /// Why a clip cannot be played by figures of a model; `None` while all is well.
    pub fn problem(
        &self,
        clip: impl Into<AssetId<StickClip>>,
        model: impl Into<AssetId<StickModel>>,
    ) -> Option<&str> {
        self.entries
            .get(&(clip.into(), model.into()))?
            .problem
            .as_deref()
    }

    pub(super) fn entry(
        &mut self,
        clip: &Handle<StickClip>,
        model: &Handle<StickModel>,
        animations: &Assets<AnimationClip>,
    ) -> &mut Entry {
        let key = (clip.id(), model.id());
        self.entries.entry(key).or_insert_with(|| Entry {
            clip: clip.clone(),
            model: model.clone(),
            animation: animations.reserve_handle(),
            graph: None,
            curve: None,
            generation: 0,
            version: 0,
            problem: None,
            finishers: vec![],
        })
    }

    /// Notes a problem of some pairs of a clip.
    fn fail(&mut self, clip: AssetId<StickClip>, status: &mut Stick3dStatus, message: &str) {
        for (_, entry) in self.entries.iter_mut().filter(|(key, _)| key.0 == clip) {
            entry.problem = Some(message.to_owned());
        }
        status.fail(clip, message);
    }
}

impl Entry {
    /// The motion, and how often it was built.
    pub(super) fn curve(&self) -> Option<(&LatentCurve, u64)> {
        self.curve.as_ref().map(|curve| (curve, self.version))
    }

    /// A graph of this clip alone, and the clip's node in it.
    pub(super) fn graph(
        &mut self,
        graphs: &mut Assets<AnimationGraph>,
    ) -> (Handle<AnimationGraph>, AnimationNodeIndex) {
        let graph = self.graph.get_or_insert_with(|| {
            let (graph, node) = AnimationGraph::from_clip(self.animation.clone());
            (graphs.add(graph), node)
        });
        graph.clone()
    }

    /// Whether nobody else holds what was made.
    fn is_unused(&self) -> bool {
        let graph_unused = |(graph, _): &(Handle<AnimationGraph>, _)| holders(graph) == 1;
        // The own graph holds the clip too.
        self.graph.as_ref().is_none_or(graph_unused)
            && holders(&self.animation) == 1 + usize::from(self.graph.is_some())
    }

    /// Builds the animation clip, if clip and model are there and one of them is new.
    fn build(
        &mut self,
        clips: &Assets<StickClip>,
        inference: &mut StickInference,
        animations: &mut Assets<AnimationClip>,
    ) -> Built {
        let Some(ready) = inference.get_mut(&self.model) else {
            return Built::Not;
        };
        if self.generation == ready.generation {
            return Built::Not;
        }
        let Some(clip) = clips.get(&self.clip) else {
            return Built::Not;
        };
        self.generation = ready.generation;
        let curve = match clip.motion(&mut ready.inference) {
            Ok(motion) => LatentCurve::new(motion).for_model(&self.model),
            Err(error) => {
                let message = format!("{}: {error}", name_of(&self.clip));
                self.problem = Some(message.clone());
                return Built::Failed(message);
            }
        };
        let mut animation = curve.clone().into_clip();
        for finish in &self.finishers {
            finish(&mut animation);
        }
        if let Err(error) = animations.insert(&self.animation, animation) {
            self.problem = Some(error.to_string());
            return Built::Failed(error.to_string());
        }
        self.curve = Some(curve);
        self.version += 1;
        self.problem = None;
        Built::Well
    }
}

/// What became of a build.
enum Built {
    /// There was nothing to build.
    Not,
    Well,
    Failed(String),
}

/// How many handles there are to an asset.
fn holders<A: Asset>(handle: &Handle<A>) -> usize {
    match handle {
        Handle::Strong(shared) => Arc::strong_count(shared),
        Handle::Uuid(..) => usize::MAX,
    }
}

/// What to call a clip in a message.
fn name_of(clip: &Handle<StickClip>) -> String {
    clip.path()
        .map_or_else(|| "a clip".to_owned(), ToString::to_string)
}

/// Changed clips have to be built anew; clips that could not be loaded are named; those that nobody uses are dropped.
pub(super) fn note_changed_clips(
    mut changes: MessageReader<AssetEvent<StickClip>>,
    mut failures: MessageReader<AssetLoadFailedEvent<StickClip>>,
    figures: Query<(&PlayStickClip, &StickFigure)>,
    mut clips: ResMut<StickClips>,
    mut status: ResMut<Stick3dStatus>,
) {
    clips.entries.retain(|key, entry| {
        let asks =
            |(play, figure): (&PlayStickClip, &StickFigure)| (play.0.id(), figure.0.id()) == *key;
        !entry.is_unused() || figures.iter().any(asks)
    });
    for change in changes.read() {
        let AssetEvent::Modified { id } = change else {
            continue;
        };
        for (_, entry) in clips.entries.iter_mut().filter(|(key, _)| key.0 == *id) {
            entry.generation = 0;
        }
    }
    for failure in failures.read() {
        let message = format!("{} could not be loaded: {}", failure.path, failure.error);
        clips.fail(failure.id, &mut status, &message);
    }
}

/// Builds the animation clips of which clip and model are there.
pub(super) fn build_clips(
    mut clips: ResMut<StickClips>,
    assets: Res<Assets<StickClip>>,
    mut inference: ResMut<StickInference>,
    mut animations: ResMut<Assets<AnimationClip>>,
    mut status: ResMut<Stick3dStatus>,
) {
    let mut well = vec![];
    for (key, entry) in &mut clips.entries {
        match entry.build(&assets, &mut inference, &mut animations) {
            Built::Not => {}
            Built::Well => well.push(key.0),
            Built::Failed(message) => status.fail(key.0, message),
        }
    }
    for clip in well {
        let of_clip = |(key, entry): (&Key, &Entry)| key.0 == clip && entry.problem.is_some();
        if !clips.entries.iter().any(of_clip) {
            status.clear(clip);
        }
    }
}
