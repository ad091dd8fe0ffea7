//! The keys of a motion and how they are edited: pure, without any history.

use std::sync::Arc;

use stick3d_figure::Sketch;
use stick3d_model::latent::{Easing, Interpolation, MotionSettings, Repeat};

use crate::sketch_input::Ink;

/// There are never fewer keys: a source and a target.
pub(crate) const FEWEST_KEYS: usize = 2;
/// Keys are never nearer to each other, seconds.
pub(crate) const LEAST_GAP_S: f32 = 0.05;
/// No key is later, seconds.
pub(crate) const LATEST_S: f32 = 120.0;
/// From the source to the target, until that is changed, seconds.
const FIRST_GAP_S: f32 = 1.0;

/// Which key it is, wherever it moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct KeyId(u32);

/// The latent of a body that was chosen among those that a drawing may mean.
pub(crate) type ChosenBody = Arc<[f32]>;

/// One drawing at one time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Key {
    pub(crate) id: KeyId,
    pub(crate) time_s: f32,
    /// How time passes from here to the next key.
    pub(crate) easing: Easing,
    /// What was drawn so far.
    pub(crate) ink: Ink,
    /// The body that is shown of the sketch; `None` for the first.
    pub(crate) body: Option<ChosenBody>,
}

impl Key {
    /// The sketch, once it is complete.
    pub(crate) fn sketch(&self) -> Option<&Sketch> {
        self.ink.sketch.as_ref()
    }
}

/// The keys by rising time, and how they become a motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scene {
    keys: Vec<Key>,
    settings: MotionSettings,
    next_id: u32,
}

impl Default for Scene {
    /// A blank source and a blank target.
    fn default() -> Self {
        let mut scene = Self {
            keys: vec![],
            settings: MotionSettings::default(),
            next_id: 0,
        };
        scene.pad();
        scene
    }
}

impl Scene {
    /// A scene of keys (time, easing, drawing) by rising time.
    pub(crate) fn of_keys(
        keys: impl IntoIterator<Item = (f32, Easing, Ink)>,
        settings: MotionSettings,
    ) -> Self {
        let mut scene = Self {
            keys: vec![],
            settings,
            next_id: 0,
        };
        for (time_s, easing, ink) in keys {
            scene.push(time_s, easing, ink);
        }
        scene.pad();
        scene
    }

    pub(crate) fn keys(&self) -> &[Key] {
        &self.keys
    }

    pub(crate) fn settings(&self) -> MotionSettings {
        self.settings
    }

    pub(crate) fn index_of(&self, id: KeyId) -> Option<usize> {
        self.keys.iter().position(|key| key.id == id)
    }

    pub(crate) fn key(&self, id: KeyId) -> Option<&Key> {
        self.keys.iter().find(|key| key.id == id)
    }

    fn key_mut(&mut self, id: KeyId) -> Option<&mut Key> {
        self.keys.iter_mut().find(|key| key.id == id)
    }

    /// The keys that are drawn, with their sketches.
    pub(crate) fn complete(&self) -> impl Iterator<Item = (&Key, &Sketch)> {
        self.keys
            .iter()
            .filter_map(|key| Some((key, key.sketch()?)))
    }

    /// Whether there are enough sketches for a motion.
    pub(crate) fn can_move(&self) -> bool {
        self.complete().count() >= FEWEST_KEYS
    }

    /// When the last key is, seconds.
    pub(crate) fn last_s(&self) -> f32 {
        self.keys.last().map_or(0.0, |key| key.time_s)
    }
}

/// The edits.
impl Scene {
    pub(crate) fn set_ink(&mut self, id: KeyId, ink: Ink) {
        if let Some(key) = self.key_mut(id) {
            key.ink = ink;
            key.body = key.body.take().filter(|_| key.ink.sketch.is_some());
        }
    }

    pub(crate) fn set_body(&mut self, id: KeyId, body: Option<ChosenBody>) {
        if let Some(key) = self.key_mut(id) {
            key.body = body;
        }
    }

    pub(crate) fn set_easing(&mut self, id: KeyId, easing: Easing) {
        if let Some(key) = self.key_mut(id) {
            key.easing = easing;
        }
    }

    pub(crate) fn set_interpolation(&mut self, interpolation: Interpolation) {
        self.settings.interpolation = interpolation;
    }

    pub(crate) fn set_repeat(&mut self, repeat: Repeat) {
        self.settings.repeat = repeat;
    }

    /// Moves a key in time, as far as its neighbours let it.
    pub(crate) fn retime(&mut self, id: KeyId, time_s: f32) {
        let Some(index) = self.index_of(id).filter(|_| time_s.is_finite()) else {
            return;
        };
        let low = match index.checked_sub(1) {
            Some(before) => self.keys[before].time_s + LEAST_GAP_S,
            None => 0.0,
        };
        let high = match self.keys.get(index + 1) {
            Some(after) => after.time_s - LEAST_GAP_S,
            None => LATEST_S,
        };
        // Where a file put them nearer than that, they stay.
        if low <= high {
            self.keys[index].time_s = time_s.clamp(low, high);
        }
    }

    /// Another blank key after the last, as far from it as keys are from each other; none where there is no time left.
    pub(crate) fn add_last(&mut self) -> Option<KeyId> {
        let first_s = self.keys.first().map_or(0.0, |key| key.time_s);
        let steps = self.keys.len().saturating_sub(1).max(1);
        let time_s = self.last_s() + ((self.last_s() - first_s) / steps as f32).max(LEAST_GAP_S);
        (time_s <= LATEST_S).then(|| self.push(time_s, Easing::default(), Ink::default()))
    }

    /// A drawing at a time; none where another key is too near, or the time is no time.
    pub(crate) fn insert(&mut self, time_s: f32, ink: Ink) -> Option<KeyId> {
        let free = self
            .keys
            .iter()
            .all(|key| (key.time_s - time_s).abs() >= LEAST_GAP_S);
        if !free || !(0.0..=LATEST_S).contains(&time_s) {
            return None;
        }
        let at = self.keys.partition_point(|key| key.time_s < time_s);
        let easing = match at.checked_sub(1) {
            Some(before) => self.keys[before].easing,
            None => Easing::default(),
        };
        let id = self.push(time_s, easing, ink);
        self.keys.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        Some(id)
    }

    /// Removes a key; of the last two only the drawing.
    pub(crate) fn remove(&mut self, id: KeyId) {
        if self.keys.len() > FEWEST_KEYS {
            self.keys.retain(|key| key.id != id);
        } else {
            self.set_ink(id, Ink::default());
        }
    }

    fn push(&mut self, time_s: f32, easing: Easing, ink: Ink) -> KeyId {
        let id = KeyId(self.next_id);
        self.next_id += 1;
        self.keys.push(Key {
            id,
            time_s,
            easing,
            ink,
            body: None,
        });
        id
    }

    /// Blank keys until there are enough.
    fn pad(&mut self) {
        while self.keys.len() < FEWEST_KEYS {
            let time_s = match self.keys.last() {
                Some(last) => last.time_s + FIRST_GAP_S,
                None => 0.0,
            };
            self.push(time_s, Easing::default(), Ink::default());
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use proptest::prelude::*;
    use stick3d_figure::Figure;

    use super::*;

    /// A complete drawing of the man, of this height.
    pub(crate) fn drawn(height: f32) -> Ink {
        let human = Figure::human();
        let points = human.template.iter().map(|p| *p * height).collect();
        Ink::of_sketch(Sketch::new(human, points).unwrap())
    }

    /// Something that a user does to a scene; keys are named by their place.
    #[derive(Clone, Debug)]
    pub(crate) enum Edit {
        Ink(usize, f32),
        Retime(usize, f32),
        AddLast,
        Insert(f32),
        Remove(usize),
        Easing(usize, usize),
        Repeat(bool),
        Cubic(bool),
    }

    impl Edit {
        pub(crate) fn apply(&self, scene: &mut Scene) {
            let id = |scene: &Scene, at: usize| scene.keys[at % scene.keys.len()].id;
            match *self {
                Self::Ink(at, height) => scene.set_ink(id(scene, at), drawn(height)),
                Self::Retime(at, time_s) => scene.retime(id(scene, at), time_s),
                Self::AddLast => {
                    scene.add_last();
                }
                Self::Insert(time_s) => {
                    scene.insert(time_s, drawn(3.0));
                }
                Self::Remove(at) => scene.remove(id(scene, at)),
                Self::Easing(at, easing) => {
                    scene.set_easing(id(scene, at), Easing::ALL[easing % Easing::ALL.len()]);
                }
                Self::Repeat(is_loop) => scene.set_repeat(if is_loop {
                    Repeat::Loop { closing_s: None }
                } else {
                    Repeat::PingPong
                }),
                Self::Cubic(is_cubic) => scene.set_interpolation(if is_cubic {
                    Interpolation::Cubic
                } else {
                    Interpolation::Linear
                }),
            }
        }
    }

    pub(crate) fn edits() -> impl Strategy<Value = Vec<Edit>> {
        let time = prop_oneof![
            -1.0_f32..5.0,
            Just(f32::NAN),
            Just(f32::INFINITY),
            100.0_f32..200.0
        ];
        let edit = prop_oneof![
            (0_usize..9, 1.0_f32..500.0).prop_map(|(at, height)| Edit::Ink(at, height)),
            (0_usize..9, time.clone()).prop_map(|(at, time_s)| Edit::Retime(at, time_s)),
            Just(Edit::AddLast),
            time.prop_map(Edit::Insert),
            (0_usize..9).prop_map(Edit::Remove),
            (0_usize..9, 0_usize..4).prop_map(|(at, easing)| Edit::Easing(at, easing)),
            any::<bool>().prop_map(Edit::Repeat),
            any::<bool>().prop_map(Edit::Cubic),
        ];
        prop::collection::vec(edit, 0..40)
    }

    proptest! {
        #[test]
        fn whatever_is_done_keys_are_in_order_apart_and_enough(edits in edits()) {
            let mut scene = Scene::default();
            for edit in edits {
                edit.apply(&mut scene);
                prop_assert!(scene.keys.len() >= FEWEST_KEYS);
                for pair in scene.keys.windows(2) {
                    prop_assert!(pair[1].time_s - pair[0].time_s > 0.99 * LEAST_GAP_S, "{edit:?}");
                    prop_assert!(pair[0].id != pair[1].id);
                }
                prop_assert!(scene.keys.iter().all(|key| (0.0..=LATEST_S).contains(&key.time_s)));
            }
        }
    }

    #[test]
    fn a_key_stops_before_its_neighbours() {
        let mut scene = Scene::default();
        let [source, target] = [0, 1].map(|at| scene.keys[at].id);
        scene.retime(source, 7.0);
        assert_eq!(scene.keys[0].time_s, FIRST_GAP_S - LEAST_GAP_S);
        scene.retime(source, -7.0);
        assert_eq!(scene.keys[0].time_s, 0.0);
        scene.retime(target, 3.0);
        let third = scene.add_last().unwrap();
        assert_eq!(scene.key(third).unwrap().time_s, 6.0);
        scene.retime(target, f32::NAN);
        assert_eq!(scene.keys[1].time_s, 3.0);
    }

    #[test]
    fn the_last_two_keys_can_only_be_wiped() {
        let mut scene = Scene::default();
        let source = scene.keys[0].id;
        scene.set_ink(source, drawn(1.0));
        assert!(!scene.can_move());
        let third = scene.add_last().unwrap();
        scene.set_ink(third, drawn(2.0));
        assert!(scene.can_move());
        scene.remove(scene.keys[1].id);
        assert_eq!(scene.keys.len(), 2);
        assert!(scene.can_move());
        scene.remove(source);
        assert_eq!(scene.keys.len(), 2);
        assert!(scene.key(source).unwrap().sketch().is_none());
    }

    #[test]
    fn a_key_between_two_goes_between_them() {
        let mut scene = Scene::default();
        scene.set_easing(scene.keys[0].id, Easing::InOut);
        let middle = scene.insert(0.5, drawn(1.0)).unwrap();
        assert_eq!(scene.index_of(middle), Some(1));
        assert_eq!(scene.keys[1].easing, Easing::InOut);
        assert_eq!(scene.insert(0.5, drawn(1.0)), None, "there is one already");
        assert_eq!(scene.insert(-1.0, drawn(1.0)), None);
    }
}
