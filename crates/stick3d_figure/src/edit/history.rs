//! Undo and redo.

use serde::{Deserialize, Serialize};

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

    /// Makes `state` the present in place of what that was: no step, and what was undone can still be done again.
    pub fn amend(&mut self, state: T) {
        self.present = state;
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
        fn an_amended_state_is_no_step(steps in 1usize..6, back in 0usize..6) {
            let mut history = History::new(0, 100);
            for state in 1..=steps {
                history.push(state);
            }
            let back = (0..back).filter(|_| history.undo().is_some()).count();
            history.amend(99);
            prop_assert_eq!(*history.present(), 99);
            prop_assert_eq!(history.can_redo(), back > 0);
            prop_assert_eq!(history.undo().copied(), (steps - back).checked_sub(1));
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
