//! The bodies that a figure's sketch may mean, which of them is shown, and the messages that choose another.

mod nearness;

use bevy::prelude::*;
use stick3d_figure::Sketch;
use stick3d_figure::figure::Limb;
use stick3d_model::{Alternative, Alternatives, InferError, Inference, JointMark, MarkedSketch};

use crate::figure::{Latent, StickFigure, StickSketch};
use crate::inference::StickInference;
use nearness::{farthest_elsewhere_m, is_flipped, is_same_drawing, nearest, turned};

/// Joints nearer than this share of the figure's size are where they were.
const AS_IT_WAS_SHARE: f32 = 0.06;
/// A body with a joint farther than this share of its size from where it was has jumped.
const MOVED_SHARE: f32 = 0.04;

/// Shows another of the bodies that the sketch may mean. Without effect where there is no such figure or body.
///
/// Taken in [`Stick3dSystems::Encode`](crate::Stick3dSystems::Encode): sent in `Update`, it is seen in the same frame.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
pub struct ChooseAlternative {
    /// A [`StickFigure`] with a sketch.
    pub figure: Entity,
    /// Which of [`SketchAlternatives::as_slice`].
    pub index: usize,
}

/// Turns the depth of a limb round: what points toward the viewer points away. Everything else stays as it is.
///
/// Without effect where there is no such figure, where the joint is of the trunk, or where no body has the limb the other
/// way round. Taken in [`Stick3dSystems::Encode`](crate::Stick3dSystems::Encode).
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
pub struct FlipLimb {
    /// A [`StickFigure`] with a sketch.
    pub figure: Entity,
    /// Any joint of the limb, in the order of the figure's joints.
    pub joint: usize,
}

/// The bodies that a figure's [`StickSketch`](crate::StickSketch) may mean, the likeliest first, and which of them is
/// shown. Written by the plugin.
///
/// A sketch says nothing about depth: several bodies look like it. The first is taken, until a [`ChooseAlternative`] or a
/// [`FlipLimb`] says otherwise. Whatever is shown is kept while the sketch changes by little, as when a joint is dragged:
/// then the body nearest to it is shown, and not the first. Another sketch, or one that is not finished yet, begins with the
/// first again.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(opaque, Component, Debug, Default, Clone)]
pub struct SketchAlternatives {
    found: Alternatives,
    /// Of which they are.
    sketch: Option<Sketch>,
    /// What its joints say.
    marks: Vec<JointMark>,
    /// It is unfinished.
    is_draft: bool,
    shown: Alternative,
    /// What was shown before; memory that is used again.
    before: Alternative,
    chosen: Option<usize>,
    wish: Wish,
    choices: u64,
}

/// What is shown of the bodies that are found next.
#[derive(Clone, Debug, Default, PartialEq)]
enum Wish {
    /// What is nearest to the body shown, if the sketch is nearly as it was.
    #[default]
    Same,
    First,
    /// The body of this latent.
    Body(Vec<f32>),
}

impl SketchAlternatives {
    /// The bodies, the likeliest first; none without a sketch.
    pub fn as_slice(&self) -> &[Alternative] {
        self.found.as_slice()
    }

    /// Which of them is shown; `None` when it is another body, whose limb was flipped or which was kept while the sketch
    /// changed, or when there is none.
    pub fn chosen(&self) -> Option<usize> {
        self.chosen
    }

    /// The body that is shown of the sketch. Its probability means something only if it is one of the alternatives.
    pub fn shown(&self) -> Option<&Alternative> {
        self.sketch.as_ref().map(|_| &self.shown)
    }

    /// How often a message has chosen another body: what is shown may change without one, when the sketch does.
    pub fn choices(&self) -> u64 {
        self.choices
    }

    /// Shows the likeliest body, however little the sketch changes, when systems run next.
    pub fn take_first(&mut self) {
        self.wish = Wish::First;
    }

    /// Shows a body that was [shown](SketchAlternatives::shown) of the sketch that the figure now has or gets, when systems
    /// run next: for undo.
    pub fn take_body(&mut self, latent: &[f32]) {
        self.wish = Wish::Body(latent.to_vec());
    }

    /// Whether something else was asked for than to go on.
    pub(crate) fn has_wish(&self) -> bool {
        self.wish != Wish::Same
    }

    /// Whether there is nothing to forget.
    pub(crate) fn is_blank(&self) -> bool {
        self.sketch.is_none()
    }

    /// What was found is of another model, or of a sketch that is gone.
    pub(crate) fn forget(&mut self) {
        self.found = Alternatives::default();
        self.sketch = None;
        self.chosen = None;
    }

    /// Finds the bodies of a sketch, and which to show. `is_draft`: it will become another with the next stroke.
    pub(crate) fn follow(
        &mut self,
        inference: &mut Inference,
        drawn: &StickSketch,
        is_draft: bool,
    ) -> Result<(), String> {
        let wish = std::mem::take(&mut self.wish);
        let figure = inference.figure();
        let sketch = drawn.to_sketch(figure).map_err(|error| error.to_string())?;
        drawn.write_marks(figure, &mut self.marks)?;
        let before = self.sketch.take();
        self.chosen = None;
        let marked = MarkedSketch {
            sketch: &sketch,
            marks: &self.marks,
        };
        inference
            .infer(marked, &mut self.found)
            .map_err(|error| error.to_string())?;
        let was_draft = std::mem::replace(&mut self.is_draft, is_draft);
        let is_whole = !is_draft && !was_draft;
        let is_same = is_whole
            && before.is_some_and(|before| is_same_drawing(before.points(), &drawn.points));
        match wish {
            Wish::Body(latent) if self.show_latent(inference, &latent).is_ok() => {}
            Wish::Same if is_same => self
                .show_nearest(inference, &sketch)
                .map_err(|error| error.to_string())?,
            _ => self.show(0),
        }
        self.sketch = Some(sketch);
        Ok(())
    }

    /// Shows one of the bodies; says whether there is such.
    fn choose(&mut self, index: usize) -> bool {
        let is_there = index < self.as_slice().len();
        if is_there {
            self.show(index);
            self.choices += 1;
        }
        is_there
    }

    /// Turns the depth of the limb of a joint round; says whether a body was found that has it so.
    fn flip(&mut self, inference: &mut Inference, joint: usize) -> Result<bool, InferError> {
        let limbs = inference.figure().limbs();
        let (Some(limb), Some(sketch)) = (
            limbs.iter().find(|limb| limb.joints.contains(&joint)),
            &self.sketch,
        ) else {
            return Ok(false);
        };
        let near_m = AS_IT_WAS_SHARE * inference.figure().template_extent_m();
        let goal = turned(&self.shown, limb);
        let flipped = |other: &Alternative| {
            is_flipped(&self.shown, other, limb)
                && farthest_elsewhere_m(&self.shown, other, limb) < near_m
        };
        if let Some(index) = nearest(self.as_slice(), &goal, flipped) {
            return Ok(self.choose(index));
        }
        let mut latent = vec![0.0; inference.latent_len()];
        let marked = MarkedSketch {
            sketch,
            marks: &self.marks,
        };
        inference.flip_limb(marked, &self.shown.latent, limb, &mut latent)?;
        let before = self.shown.clone();
        self.show_latent(inference, &latent)?;
        let is_done = is_flipped(&before, &self.shown, limb);
        if is_done {
            self.choices += 1;
        } else {
            self.show_latent(inference, &before.latent)?;
        }
        Ok(is_done)
    }

    /// Shows what is nearest to the body shown: one of those that were found or, where that has jumped, the body shown
    /// itself, pulled onto the sketch.
    fn show_nearest(
        &mut self,
        inference: &mut Inference,
        sketch: &Sketch,
    ) -> Result<(), InferError> {
        let index = nearest(self.as_slice(), &self.shown, |_| true);
        std::mem::swap(&mut self.shown, &mut self.before);
        self.show(index.unwrap_or(0));
        // A limb without joints: nothing is turned round.
        let nothing = Limb {
            base: inference.figure().root,
            joints: vec![],
        };
        let jump_m = farthest_elsewhere_m(&self.before, &self.shown, &nothing);
        if jump_m < MOVED_SHARE * inference.figure().template_extent_m() {
            return Ok(());
        }
        let mut pulled = vec![0.0; inference.latent_len()];
        let marked = MarkedSketch {
            sketch,
            marks: &self.marks,
        };
        inference.flip_limb(marked, &self.before.latent, &nothing, &mut pulled)?;
        self.show_latent(inference, &pulled)?;
        if farthest_elsewhere_m(&self.before, &self.shown, &nothing) >= jump_m {
            self.show(index.unwrap_or(0));
        }
        Ok(())
    }

    fn index_of(&self, latent: &[f32]) -> Option<usize> {
        self.as_slice().iter().position(|a| a.latent == latent)
    }

    fn show(&mut self, index: usize) {
        let Some(alternative) = self.found.as_slice().get(index) else {
            return;
        };
        let shown = &mut self.shown;
        shown.latent.clone_from(&alternative.latent);
        shown.joints.clone_from(&alternative.joints);
        shown.probability = alternative.probability;
        self.chosen = Some(index);
    }

    /// Shows the body of a latent, whether it is one of those that were found or not.
    fn show_latent(&mut self, inference: &mut Inference, latent: &[f32]) -> Result<(), InferError> {
        if let Some(index) = self.index_of(latent) {
            self.show(index);
            return Ok(());
        }
        let shown = &mut self.shown;
        shown
            .joints
            .resize(inference.figure().joint_count(), Vec3::ZERO);
        inference.joints(latent, &mut shown.joints)?;
        shown.latent.clear();
        shown.latent.extend_from_slice(latent);
        shown.probability = 0.0;
        self.chosen = None;
        Ok(())
    }
}

/// Does what was chosen. Runs after changed sketches have been followed.
pub(crate) fn choose_alternatives(
    mut chosen: MessageReader<ChooseAlternative>,
    mut flips: MessageReader<FlipLimb>,
    mut figures: Query<(&StickFigure, &mut SketchAlternatives, &mut Latent)>,
    mut inference: ResMut<StickInference>,
) {
    for choice in chosen.read() {
        if let Ok((_, mut alternatives, mut latent)) = figures.get_mut(choice.figure)
            && alternatives.choose(choice.index)
        {
            latent.0.clone_from(&alternatives.shown.latent);
        }
    }
    for flip in flips.read() {
        if let Ok((figure, mut alternatives, mut latent)) = figures.get_mut(flip.figure)
            && let Some(ready) = inference.get_mut(&figure.0)
            && alternatives.flip(&mut ready.inference, flip.joint) == Ok(true)
        {
            latent.0.clone_from(&alternatives.shown.latent);
        }
    }
}
