//! Editing a sketch: picking and dragging joints, mirroring, undo and redo.

use glam::Vec2;
use serde::{Deserialize, Serialize};

use crate::figure::Figure;
use crate::recognize::any_order::sides;
use crate::sketch::{Sketch, SketchError};

/// The joint nearest to `at` among those not farther than `radius`; of joints at one place the last.
pub fn nearest_joint(sketch: &Sketch, at: Vec2, radius: f32) -> Option<usize> {
    let mut nearest = None;
    let mut least = radius;
    for (joint, point) in sketch.points().iter().enumerate() {
        let distance = point.distance(at);
        if distance <= least {
            (nearest, least) = (Some(joint), distance);
        }
    }
    nearest
}

/// A joint in hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drag {
    joint: usize,
    /// From the pointer to the joint when it was taken, so that it does not jump.
    offset: Vec2,
}

impl Drag {
    /// Takes the joint nearest to the pointer, if one is within `radius`.
    pub fn begin(sketch: &Sketch, pointer: Vec2, radius: f32) -> Option<Self> {
        let joint = nearest_joint(sketch, pointer, radius)?;
        Some(Self {
            joint,
            offset: sketch.points()[joint] - pointer,
        })
    }

    /// Which joint it is.
    pub fn joint(&self) -> usize {
        self.joint
    }

    /// Moves the joint with the pointer.
    ///
    /// # Errors
    /// [`SketchError`] when the pointer is nowhere (NaN, huge); the sketch is then unchanged.
    pub fn move_to(
        &self,
        figure: &Figure,
        sketch: &mut Sketch,
        pointer: Vec2,
    ) -> Result<(), SketchError> {
        sketch.set_point(figure, self.joint, pointer + self.offset)
    }
}

/// The sketch mirrored where it is: sides exchanged, x turned round the middle of its extent.
#[must_use]
pub fn mirrored_in_place(figure: &Figure, sketch: &Sketch) -> Sketch {
    let xs = || sketch.points().iter().map(|p| p.x);
    let (low, high) = (
        xs().fold(f32::INFINITY, f32::min),
        xs().fold(f32::NEG_INFINITY, f32::max),
    );
    let mirrored = sketch.mirrored(figure);
    let mut moved = mirrored.clone();
    for (joint, point) in mirrored.points().iter().enumerate() {
        let target = Vec2::new(point.x + low + high, point.y);
        // Points stay within the extent they had, so none can leave the valid range.
        if moved.set_point(figure, joint, target).is_err() {
            return mirrored;
        }
    }
    moved
}

/// Exchanges the limb to which a joint belongs with the one of the other side: which leg is the right one cannot be
/// seen in every drawing. Says whether the joint belongs to a pair; the sketch is otherwise unchanged.
pub fn swap_pair(figure: &Figure, sketch: &mut Sketch, joint: usize) -> bool {
    let Some(pair) = sides::pair_of(figure, joint) else {
        return false;
    };
    let mut points = sketch.points().to_vec();
    sides::swap(&pair, &mut points);
    match Sketch::new(figure, points) {
        Ok(swapped) => *sketch = swapped,
        Err(_) => return false,
    }
    true
}

/// Past and undone states of something that is edited.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct History<T> {
    past: Vec<T>,
    present: T,
    /// The next to redo is the last.
    undone: Vec<T>,
    limit: usize,
}

impl<T: Clone + PartialEq> History<T> {
    /// A history that remembers up to `limit` steps.
    pub fn new(present: T, limit: usize) -> Self {
        Self {
            past: Vec::new(),
            present,
            undone: Vec::new(),
            limit,
        }
    }

    /// The state now.
    pub fn present(&self) -> &T {
        &self.present
    }

    /// Makes `state` the present; what was undone is forgotten. A state equal to the present is no step.
    pub fn push(&mut self, state: T) {
        if state == self.present {
            return;
        }
        self.past.push(std::mem::replace(&mut self.present, state));
        if self.past.len() > self.limit {
            self.past.remove(0);
        }
        self.undone.clear();
    }

    /// One step back: the state then, or none at the beginning.
    pub fn undo(&mut self) -> Option<&T> {
        let earlier = self.past.pop()?;
        self.undone
            .push(std::mem::replace(&mut self.present, earlier));
        Some(&self.present)
    }

    /// One step forward again: the state then, or none where nothing was undone.
    pub fn redo(&mut self) -> Option<&T> {
        let later = self.undone.pop()?;
        self.past.push(std::mem::replace(&mut self.present, later));
        Some(&self.present)
    }

    /// Is there a step to undo?
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Is there a step to redo?
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_nearest_joint_is_dragged_without_a_jump() {
        let human = Figure::human();
        let mut sketch = Sketch::template(human);
        let knee = human.joint_index("knee_l").unwrap();
        let near_knee = sketch.points()[knee] + Vec2::new(0.03, 0.01);
        assert_eq!(Drag::begin(&sketch, Vec2::new(3.0, 3.0), 0.1), None);
        let drag = Drag::begin(&sketch, near_knee, 0.1).unwrap();
        assert_eq!(drag.joint(), knee);
        drag.move_to(human, &mut sketch, near_knee + Vec2::new(0.2, 0.1))
            .unwrap();
        let expected = human.template[knee] + Vec2::new(0.2, 0.1);
        assert!(sketch.points()[knee].distance(expected) < 1.0e-6);
        let before = sketch.clone();
        assert!(drag.move_to(human, &mut sketch, Vec2::NAN).is_err());
        assert_eq!(sketch, before);
    }

    #[test]
    fn mirroring_in_place_keeps_the_place() {
        let human = Figure::human();
        let points = human
            .template
            .iter()
            .map(|p| (*p + Vec2::new(0.2 * p.y, 0.0)) * 100.0);
        let sketch = Sketch::new(human, points.map(|p| p + Vec2::splat(300.0)).collect()).unwrap();
        let mirrored = mirrored_in_place(human, &sketch);
        let left = |s: &Sketch| s.points().iter().map(|p| p.x).fold(f32::INFINITY, f32::min);
        assert!((left(&sketch) - left(&mirrored)).abs() < 1.0e-3);
        assert!(mirrored != sketch);
        for (a, b) in mirrored_in_place(human, &mirrored)
            .points()
            .iter()
            .zip(sketch.points())
        {
            assert!(a.distance(*b) < 1.0e-3);
        }
    }

    proptest! {
        #[test]
        fn history_goes_back_and_forth(states in prop::collection::vec(0u8..5, 1..30), back in 0usize..40) {
            let mut history = History::new(9, 100);
            let mut distinct = vec![9];
            for state in states {
                history.push(state);
                if distinct.last() != Some(&state) {
                    distinct.push(state);
                }
            }
            let steps = back.min(distinct.len() - 1);
            for _ in 0..back {
                history.undo();
            }
            prop_assert_eq!(*history.present(), distinct[distinct.len() - 1 - steps]);
            prop_assert_eq!(history.can_redo(), steps > 0);
            for _ in 0..back {
                history.redo();
            }
            prop_assert_eq!(Some(history.present()), distinct.last());
            prop_assert!(!history.can_redo());
        }

        #[test]
        fn history_forgets_beyond_its_limit(limit in 0usize..6, count in 0usize..12) {
            let mut history = History::new(0, limit);
            for state in 1..=count {
                history.push(state);
            }
            let mut steps = 0;
            while history.undo().is_some() {
                steps += 1;
            }
            prop_assert_eq!(steps, limit.min(count));
        }
    }
}
