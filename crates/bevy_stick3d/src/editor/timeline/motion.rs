//! What is made of a scene: the latents of its keys, and the motion through them.

use bevy::math::Vec3;
use stick3d_figure::Sketch;
use stick3d_model::latent::{Easing, MotionSettings, PathError};
use stick3d_model::{LatentKey, LatentPath, Motion};

use super::player::Course;
use super::state::{ChosenBody, KeyId, Scene};
use crate::inference::ReadyModel;

/// A drawn key.
#[derive(Clone, Debug, PartialEq)]
struct SourceKey {
    id: KeyId,
    time_s: f32,
    easing: Easing,
    sketch: Sketch,
    body: Option<ChosenBody>,
}

/// What a motion was made of: it is made again when this is another.
#[derive(Clone, Debug, PartialEq)]
struct Source {
    keys: Vec<SourceKey>,
    settings: MotionSettings,
    generation: u64,
}

impl Source {
    fn of(scene: &Scene, generation: u64) -> Self {
        let keys = scene.complete().map(|(key, sketch)| SourceKey {
            id: key.id,
            time_s: key.time_s,
            easing: key.easing,
            sketch: sketch.clone(),
            body: key.body.clone(),
        });
        Self {
            keys: keys.collect(),
            settings: scene.settings(),
            generation,
        }
    }
}

/// Where a body stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Standing {
    /// Of the entity, metres of the model.
    pub(crate) translation: Vec3,
    /// Whether its lowest vertex is to be put on the ground; else its root joint is at the translation.
    pub(crate) on_lowest: bool,
}

impl Standing {
    /// At rest where figures stand.
    pub(crate) const AT_REST: Self = Self {
        translation: Vec3::ZERO,
        on_lowest: true,
    };
}

/// The latents of the drawn keys, and the motion if there are enough.
#[derive(Default)]
pub(crate) struct Performance {
    source: Option<Source>,
    /// Those of the drawn keys, by rising time.
    latents: Vec<(KeyId, f32, Vec<f32>)>,
    motion: Option<Motion>,
    /// The path alone, while something is in hand: a motion takes several frames' time to make.
    draft: Option<LatentPath>,
    problem: Option<String>,
}

impl Performance {
    /// Follows the scene. While something is in hand, only as far as it takes no time.
    pub(crate) fn follow(&mut self, scene: &Scene, ready: &mut ReadyModel, is_in_hand: bool) {
        let source = Source::of(scene, ready.generation);
        let is_due = self.draft.is_some() && !is_in_hand;
        if self.source.as_ref() == Some(&source) && !is_due {
            return;
        }
        let made = self.make(&source, ready, is_in_hand);
        self.source = Some(source);
        self.problem = made.err();
        if self.problem.is_some() {
            (self.motion, self.draft) = (None, None);
        }
    }

    fn make(
        &mut self,
        source: &Source,
        ready: &mut ReadyModel,
        is_in_hand: bool,
    ) -> Result<(), String> {
        self.latents.clear();
        for key in &source.keys {
            let latent_len = ready.inference.latent_len();
            let body = key.body.as_deref().filter(|body| body.len() == latent_len);
            let latent = match body {
                Some(body) => body,
                None => ready
                    .encode(&key.sketch)
                    .map_err(|error| error.to_string())?,
            };
            self.latents.push((key.id, key.time_s, latent.to_vec()));
        }
        let keys: Vec<LatentKey> = source
            .keys
            .iter()
            .zip(&self.latents)
            .map(|(key, (.., latent))| LatentKey {
                latent: latent.clone(),
                time_s: key.time_s,
                easing: key.easing,
            })
            .collect();
        let settings = source.settings;
        let said = |error: PathError| error.to_string();
        if keys.len() < super::state::FEWEST_KEYS {
            (self.motion, self.draft) = (None, None);
        } else if is_in_hand && self.motion.is_some() {
            let path = LatentPath::new(&keys, settings.interpolation, settings.repeat);
            self.draft = Some(path.map_err(said)?);
        } else {
            let motion = Motion::new(&keys, settings, &mut ready.inference);
            (self.motion, self.draft) = (Some(motion.map_err(said)?), None);
        }
        Ok(())
    }

    /// The motion, once it is made; none while something is in hand.
    pub(crate) fn motion(&self) -> Option<&Motion> {
        self.motion.as_ref().filter(|_| self.draft.is_none())
    }

    /// Why there is no motion though there are keys.
    pub(crate) fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    fn path(&self) -> Option<&LatentPath> {
        self.draft
            .as_ref()
            .or(self.motion.as_ref().map(Motion::path))
    }

    /// From when to when there is something to see.
    pub(crate) fn course(&self) -> Option<Course> {
        self.path().map(Course::of)
    }

    /// Writes the latent at a time. Says whether there is one.
    pub(crate) fn sample_into(&self, time_s: f32, latent: &mut Vec<f32>) -> bool {
        let Some(path) = self.path() else {
            return false;
        };
        latent.resize(path.latent_len(), 0.0);
        path.sample_into(time_s, latent).is_ok()
    }

    /// Where the body stands at a time.
    pub(crate) fn standing(&self, time_s: f32) -> Standing {
        let root = self
            .motion
            .as_ref()
            .and_then(|motion| motion.root_translation(time_s));
        match (root, &self.draft) {
            (Some(translation), None) => Standing {
                translation,
                on_lowest: false,
            },
            // How high the root is, is not known yet.
            (Some(root), Some(_)) => Standing {
                translation: root.with_y(0.0),
                on_lowest: true,
            },
            (None, _) => Standing::AT_REST,
        }
    }

    /// The latent of a drawn key.
    pub(crate) fn latent_of(&self, id: KeyId) -> Option<&[f32]> {
        let mut latents = self.latents.iter();
        latents
            .find(|(key, ..)| *key == id)
            .map(|(.., latent)| latent.as_slice())
    }

    /// The latent of the first drawn key.
    pub(crate) fn first_latent(&self) -> Option<&[f32]> {
        self.latents.first().map(|(.., latent)| latent.as_slice())
    }

    /// The drawn keys before and after a clock's time, if they are at least `apart_s` from it: the clock's time of each, and its
    /// latent. In a motion that goes round, the first key comes after the last.
    pub(crate) fn neighbours(&self, clock_s: f32, apart_s: f32) -> [Option<(f32, &[f32])>; 2] {
        let Some(course) = self.course() else {
            return [None, None];
        };
        let time_s = course.folded(clock_s);
        let round_s = course.round_start_s(clock_s) - course.start_s;
        let before = self
            .latents
            .iter()
            .rev()
            .find(|(_, key_s, _)| *key_s <= time_s - apart_s);
        let after = self
            .latents
            .iter()
            .find(|(_, key_s, _)| *key_s >= time_s + apart_s);
        let next_round = self.latents.first().filter(|_| course.goes_round());
        let span_s = course.end_s - course.start_s;
        [
            before.map(|(_, key_s, latent)| (round_s + key_s, latent.as_slice())),
            match (after, next_round) {
                (Some((_, key_s, latent)), _) => Some((round_s + key_s, latent.as_slice())),
                (None, Some((_, key_s, latent))) => {
                    Some((round_s + span_s + key_s, latent.as_slice()))
                }
                (None, None) => None,
            },
        ]
    }
}
