//! What is on the timeline with its history: one for the drawings and for the keys.

use stick3d_figure::History;

use super::state::{KeyId, Scene};

/// So many steps can be undone.
const MAX_UNDO: usize = 200;

/// What a step of the history changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    /// Only the drawing of a key, or the body that is shown of it.
    Drawing(KeyId),
    /// Keys, times, or how they become a motion.
    Timeline,
}

/// A scene, which of its keys is looked at, and the scenes before.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    /// What is shown: the history's present, but for what is in hand.
    scene: Scene,
    history: History<Scene>,
    selected: KeyId,
}

impl Default for Document {
    fn default() -> Self {
        Self::new(Scene::default())
    }
}

impl Document {
    /// A scene without a past, with its first key selected. (A scene has keys.)
    pub(crate) fn new(scene: Scene) -> Self {
        Self {
            selected: scene.keys()[0].id,
            history: History::new(scene.clone(), MAX_UNDO),
            scene,
        }
    }

    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// To edit what is shown. It is no step of the history before [`Document::commit`].
    pub(crate) fn scene_mut(&mut self) -> &mut Scene {
        &mut self.scene
    }

    /// Which key is looked at. There always is one.
    pub(crate) fn selected(&self) -> KeyId {
        self.selected
    }

    /// Its place among the keys.
    pub(crate) fn selected_index(&self) -> usize {
        self.scene.index_of(self.selected).unwrap_or(0)
    }

    /// Looks at a key, if it is there.
    pub(crate) fn select(&mut self, id: KeyId) {
        if self.scene.index_of(id).is_some() {
            self.selected = id;
        }
    }

    /// Makes what is shown a step that can be undone. What is shown already is none.
    pub(crate) fn commit(&mut self) {
        self.history.push(self.scene.clone());
        self.keep_selected(0);
    }

    /// Makes what is shown the last step, in place of what that was: it followed from it by itself.
    pub(crate) fn amend(&mut self) {
        self.history.amend(self.scene.clone());
    }

    /// As [`Document::commit`], when what is shown may be what was there one step before: then that step is undone.
    pub(crate) fn commit_taken_back(&mut self) {
        let mut back = self.history.clone();
        if back.undo() == Some(&self.scene) {
            self.history = back;
        }
        self.commit();
    }

    /// Puts another scene in place of this one, which can be undone.
    pub(crate) fn replace(&mut self, scene: Scene) {
        self.scene = scene;
        self.selected = self.scene.keys()[0].id;
        self.commit();
    }

    pub(crate) fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    pub(crate) fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Takes back the last step, and looks at what it changed.
    pub(crate) fn undo(&mut self) -> Option<Change> {
        let scene = self.history.undo()?.clone();
        Some(self.show(scene))
    }

    /// Does again what was undone last, and looks at what it changed.
    pub(crate) fn redo(&mut self) -> Option<Change> {
        let scene = self.history.redo()?.clone();
        Some(self.show(scene))
    }

    fn show(&mut self, scene: Scene) -> Change {
        let before = std::mem::replace(&mut self.scene, scene);
        let (keys, old) = (self.scene.keys(), before.keys());
        let place = (0..keys.len()).find(|&at| old.get(at) != keys.get(at));
        if let Some(place) = place {
            self.selected = keys[place].id;
        }
        self.keep_selected(place.unwrap_or(keys.len() - 1));
        self.change_from(&before)
    }

    fn change_from(&self, before: &Scene) -> Change {
        let mut without_ink = before.clone();
        for key in self.scene.keys() {
            without_ink.set_ink(key.id, key.ink.clone());
            without_ink.set_body(key.id, key.body.clone());
        }
        let same_otherwise = without_ink.keys() == self.scene.keys()
            && without_ink.settings() == self.scene.settings();
        if same_otherwise {
            Change::Drawing(self.selected)
        } else {
            Change::Timeline
        }
    }

    /// A selected key that is gone gives way to the one at or before this place.
    fn keep_selected(&mut self, place: usize) {
        if self.scene.index_of(self.selected).is_none() {
            let keys = self.scene.keys();
            self.selected = keys[place.min(keys.len() - 1)].id;
        }
    }

    /// Removes the selected key, and selects the one before it.
    pub(crate) fn remove_selected(&mut self) {
        let place = self.selected_index();
        self.scene.remove(self.selected);
        self.keep_selected(place.saturating_sub(1));
        self.commit();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use stick3d_model::latent::Easing;

    use super::super::state::tests::{drawn, edits};
    use super::*;
    use crate::sketch_input::Ink;

    proptest! {
        #[test]
        fn undo_and_redo_restore_every_scene(edits in edits()) {
            let mut document = Document::default();
            let mut scenes = vec![document.scene().clone()];
            for edit in edits {
                edit.apply(document.scene_mut());
                document.commit();
                if scenes.last() != Some(document.scene()) {
                    scenes.push(document.scene().clone());
                }
            }
            for scene in scenes.iter().rev().skip(1) {
                prop_assert!(document.undo().is_some());
                prop_assert_eq!(document.scene(), scene);
                prop_assert!(scene.index_of(document.selected()).is_some());
            }
            prop_assert!(!document.can_undo());
            for scene in &scenes[1..] {
                prop_assert!(document.redo().is_some());
                prop_assert_eq!(document.scene(), scene);
                prop_assert!(scene.index_of(document.selected()).is_some());
            }
            prop_assert!(!document.can_redo());
        }
    }

    #[test]
    fn undo_looks_at_what_it_changed() {
        let mut document = Document::default();
        let [source, target] = [0, 1].map(|at| document.scene().keys()[at].id);
        document.scene_mut().set_ink(target, drawn(1.0));
        document.commit();
        document.scene_mut().retime(target, 2.0);
        document.scene_mut().retime(target, 3.0);
        document.commit();
        document.scene_mut().set_easing(source, Easing::In);
        document.commit();
        assert_eq!(document.undo(), Some(Change::Timeline));
        assert_eq!(document.selected(), source);
        assert_eq!(document.undo(), Some(Change::Timeline));
        assert_eq!(document.scene().keys()[1].time_s, 1.0, "one drag, one step");
        assert_eq!(document.undo(), Some(Change::Drawing(target)));
        assert_eq!(document.undo(), None);
    }

    #[test]
    fn a_stroke_that_is_taken_back_is_a_step_back() {
        let mut document = Document::default();
        let source = document.selected();
        document.scene_mut().set_ink(source, drawn(1.0));
        document.commit();
        document.scene_mut().set_ink(source, drawn(2.0));
        document.commit();
        document.scene_mut().set_ink(source, drawn(1.0));
        document.commit_taken_back();
        assert!(document.can_redo());
        document.undo();
        assert_eq!(document.scene().key(source).unwrap().ink, Ink::default());
        document.scene_mut().set_ink(source, drawn(3.0));
        document.commit_taken_back();
        assert!(!document.can_redo());
    }

    #[test]
    fn the_key_before_a_removed_one_is_selected() {
        let mut document = Document::default();
        let third = document.scene_mut().add_last().unwrap();
        document.commit();
        document.select(third);
        document.remove_selected();
        assert_eq!(document.selected_index(), 1);
        assert_eq!(document.undo(), Some(Change::Timeline));
        assert_eq!(document.selected(), third);
    }
}
