//! A joint in hand, which takes along what hangs on it.

use glam::Vec2;
use serde::{Deserialize, Serialize};

use super::nearest_joint;
use super::reach::Reach;
use crate::figure::Figure;
use crate::sketch::{Sketch, SketchError};

/// How joints are dragged.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Grip {
    /// Whether the joint moves alone, wherever the pointer goes.
    pub is_free: bool,
    /// Per joint whether it is pinned. None is where this is empty.
    pub pins: Vec<bool>,
    /// Per bone how long it may become, in the sketch's unit: as it was before it was foreshortened. Bones become no
    /// longer than they are where this is empty.
    pub longest: Vec<f32>,
}

/// A joint in hand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drag {
    joint: usize,
    /// From the pointer to the joint when it was taken, so that it does not jump.
    offset: Vec2,
    /// The sketch at that time: where everything goes depends on the pointer alone, not on its way.
    start: Sketch,
}

impl Drag {
    /// Takes the joint nearest to the pointer, if one is within `radius`.
    pub fn begin(sketch: &Sketch, pointer: Vec2, radius: f32) -> Option<Self> {
        let joint = nearest_joint(sketch, pointer, radius)?;
        Some(Self {
            joint,
            offset: sketch.points()[joint] - pointer,
            start: sketch.clone(),
        })
    }

    /// Which joint it is.
    pub fn joint(&self) -> usize {
        self.joint
    }

    /// The same joint taken anew where the pointer is now, as the sketch is now.
    #[must_use]
    pub fn taken_anew(&self, sketch: &Sketch, pointer: Vec2) -> Self {
        let joint = sketch.points().get(self.joint);
        Self {
            joint: self.joint,
            offset: joint.map_or(self.offset, |joint| *joint - pointer),
            start: sketch.clone(),
        }
    }

    /// The sketch with the joint moved with the pointer.
    ///
    /// Bones keep their drawn lengths where that is possible. The joint pulls at the limb between it and the nearest
    /// joint above it that stays: a branching, a pin, or the root. Of a limb of several bones the middle follows, bent
    /// the way it was; a single bone turns. What hangs on the joint comes along as it is. The root moves the whole
    /// figure. Where the pointer is beyond the limb's reach the joint stops at the reach, where it is too near the
    /// bones are foreshortened: a limb that points toward the viewer is drawn shorter. Pinned joints stay where they
    /// are; their limbs bend, and bound how far the others may go.
    ///
    /// No joint moves by more than a small multiple of the pointer's motion.
    ///
    /// # Errors
    /// [`SketchError`] when the pointer is nowhere (NaN, huge), or the sketch is of another figure.
    pub fn moved(
        &self,
        figure: &Figure,
        pointer: Vec2,
        grip: &Grip,
    ) -> Result<Sketch, SketchError> {
        let target = pointer + self.offset;
        let mut moved = self.start.clone();
        moved.set_point(figure, self.joint, target)?;
        if grip.is_free {
            return Ok(moved);
        }
        // A sketch of another figure is refused before its bones are looked for.
        let start = Sketch::new(figure, self.start.points().to_vec())?;
        let reach = Reach::new(figure, start.points(), self.joint, grip);
        Sketch::new(figure, reach.pulled_to(target))
    }
}

/// The length of every bone as it is drawn.
pub fn bone_lengths(figure: &Figure, points: &[Vec2]) -> Vec<f32> {
    let length = |&[a, b]: &[usize; 2]| match (points.get(a), points.get(b)) {
        (Some(a), Some(b)) => a.distance(*b),
        _ => 0.0,
    };
    figure.bones.iter().map(length).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A man of 500 units with his limbs bent as the numbers say.
    fn man(bends: &[f32]) -> Sketch {
        let human = Figure::human();
        let mut points: Vec<Vec2> = human.template.iter().map(|p| *p * 300.0).collect();
        for (joint, point) in points.iter_mut().enumerate() {
            let bend = bends
                .get(joint % bends.len().max(1))
                .copied()
                .unwrap_or(0.0);
            *point += Vec2::new(bend, 0.6 * bend);
        }
        Sketch::new(human, points).unwrap()
    }

    fn joint(name: &str) -> usize {
        Figure::human().joint_index(name).unwrap()
    }

    fn pinned(names: &[&str]) -> Grip {
        let mut pins = vec![false; 11];
        names.iter().for_each(|name| pins[joint(name)] = true);
        Grip {
            pins,
            ..Grip::default()
        }
    }

    fn taken(sketch: &Sketch, name: &str) -> Drag {
        Drag::begin(sketch, sketch.points()[joint(name)], 1.0).unwrap()
    }

    #[test]
    fn the_nearest_joint_is_taken_without_a_jump() {
        let human = Figure::human();
        let sketch = Sketch::template(human);
        let knee = joint("knee_l");
        let near_knee = sketch.points()[knee] + Vec2::new(0.03, 0.01);
        assert_eq!(Drag::begin(&sketch, Vec2::new(3.0, 3.0), 0.1), None);
        let drag = Drag::begin(&sketch, near_knee, 0.1).unwrap();
        assert_eq!(drag.joint(), knee);
        let free = Grip {
            is_free: true,
            ..Grip::default()
        };
        let moved = drag
            .moved(human, near_knee + Vec2::new(0.2, 0.1), &free)
            .unwrap();
        assert!(moved.points()[knee].distance(human.template[knee] + Vec2::new(0.2, 0.1)) < 1.0e-6);
        for grip in [free, Grip::default()] {
            let still = drag.moved(human, near_knee, &grip).unwrap();
            for (a, b) in still.points().iter().zip(sketch.points()) {
                assert!(a.distance(*b) < 1.0e-4);
            }
            assert!(drag.moved(human, Vec2::NAN, &grip).is_err());
        }
        let other = Sketch::template(Figure::horse());
        let drag = Drag::begin(&other, other.points()[0], 0.1).unwrap();
        assert!(drag.moved(human, Vec2::ONE, &Grip::default()).is_err());
    }

    #[test]
    fn a_hand_bends_its_elbow_and_stops_at_its_reach() {
        let human = Figure::human();
        let sketch = man(&[0.0]);
        let [neck, elbow, hand] = ["neck", "elbow_l", "hand_l"].map(joint);
        let drag = taken(&sketch, "hand_l");
        let at = |target: Vec2| drag.moved(human, target, &Grip::default()).unwrap();
        let near = sketch.points()[neck] + Vec2::new(120.0, -40.0);
        let bent = at(near);
        assert!(bent.points()[hand].distance(near) < 0.1);
        let before = bone_lengths(human, sketch.points());
        for (bone, (after, before)) in bone_lengths(human, bent.points())
            .iter()
            .zip(&before)
            .enumerate()
        {
            assert!(
                (after - before).abs() < 0.03 * before,
                "bone {bone}: {before} {after}"
            );
        }
        let arm = |s: &Sketch| {
            let p = s.points();
            p[neck].distance(p[elbow]) + p[elbow].distance(p[hand])
        };
        let far = at(sketch.points()[neck] + Vec2::new(2000.0, 0.0));
        assert!((far.points()[hand] - far.points()[neck]).length() <= arm(&sketch) * 1.001);
        assert!(far.points()[neck] == sketch.points()[neck]);
        // Near the shoulder the arm points toward the viewer.
        let folded = at(sketch.points()[neck] + Vec2::new(6.0, 0.0));
        assert!(arm(&folded) < 0.3 * arm(&sketch));
    }

    #[test]
    fn an_elbow_takes_the_hand_along_and_the_root_the_whole() {
        let human = Figure::human();
        let sketch = man(&[0.0, 14.0, -9.0]);
        let [neck, elbow, hand] = ["neck", "elbow_r", "hand_r"].map(joint);
        let target = sketch.points()[neck] + Vec2::new(-90.0, 180.0);
        let moved = taken(&sketch, "elbow_r")
            .moved(human, target, &Grip::default())
            .unwrap();
        let lengths = [&sketch, &moved].map(|s| bone_lengths(human, s.points()));
        for (a, b) in lengths[0].iter().zip(&lengths[1]) {
            assert!((a - b).abs() < 0.1, "{a} {b}");
        }
        let bend = |s: &Sketch| {
            let p = s.points();
            (p[elbow] - p[neck]).angle_to(p[hand] - p[elbow])
        };
        assert!((bend(&moved) - bend(&sketch)).abs() < 1.0e-3);
        let by = Vec2::new(31.0, -7.0);
        let at = sketch.points()[human.root];
        let moved = Drag::begin(&sketch, at, 1.0)
            .unwrap()
            .moved(human, at + by, &Grip::default());
        for (after, before) in moved.unwrap().points().iter().zip(sketch.points()) {
            assert!(after.distance(*before + by) < 1.0e-3);
        }
    }

    #[test]
    fn a_pinned_foot_stays_and_its_knee_bends() {
        let human = Figure::human();
        let sketch = man(&[0.0]);
        let at = sketch.points()[human.root];
        let grip = pinned(&["foot_l", "foot_r"]);
        let squat = taken(&sketch, "abdomen")
            .moved(human, at - Vec2::Y * 60.0, &grip)
            .unwrap();
        for name in ["foot_l", "foot_r"] {
            assert_eq!(squat.points()[joint(name)], sketch.points()[joint(name)]);
        }
        assert!(squat.points()[human.root].distance(at - Vec2::Y * 60.0) < 1.0);
        let [before, after] = [&sketch, &squat].map(|s| bone_lengths(human, s.points()));
        for (a, b) in before.iter().zip(&after) {
            assert!((a - b).abs() < 0.03 * a, "{a} {b}");
        }
        // Whoever holds his feet cannot fly.
        let jump = taken(&sketch, "abdomen")
            .moved(human, at + Vec2::Y * 500.0, &grip)
            .unwrap();
        let rise = jump.points()[human.root].y - at.y;
        assert!(rise.abs() < 8.0, "{rise}");
        // A pinned joint may be taken itself.
        let foot = sketch.points()[joint("foot_l")];
        let step = taken(&sketch, "foot_l")
            .moved(human, foot + Vec2::new(30.0, 60.0), &grip)
            .unwrap();
        assert!(step.points()[joint("foot_l")].distance(foot + Vec2::new(30.0, 60.0)) < 1.0);
    }

    #[test]
    fn a_foreshortened_bone_may_become_as_long_as_it_was() {
        let human = Figure::human();
        let sketch = man(&[0.0]);
        let neck = sketch.points()[joint("neck")];
        let grip = Grip {
            longest: bone_lengths(human, sketch.points()),
            ..Grip::default()
        };
        let short = taken(&sketch, "hand_l")
            .moved(human, neck + Vec2::new(3.0, -3.0), &grip)
            .unwrap();
        let again = Drag::begin(&short, short.points()[joint("hand_l")], 1.0).unwrap();
        let long = again
            .moved(human, neck + Vec2::new(500.0, 0.0), &grip)
            .unwrap();
        let [before, after] = [&sketch, &long].map(|s| bone_lengths(human, s.points()));
        for (a, b) in before.iter().zip(&after) {
            assert!((a - b).abs() < 0.02 * a, "{a} {b}");
        }
    }

    proptest! {
        #[test]
        fn lengths_are_kept_and_nothing_jumps(
            bends in prop::collection::vec(-25.0f32..25.0, 11),
            taken in 0usize..11,
            pins in prop::collection::vec(prop::bool::weighted(0.2), 11),
            radius in 5.0f32..250.0,
            centre in (-120.0f32..120.0, -120.0f32..120.0),
        ) {
            let human = Figure::human();
            let sketch = man(&bends);
            let lengths = bone_lengths(human, sketch.points());
            let grip = Grip { pins: pins.clone(), ..Grip::default() };
            let at = sketch.points()[taken];
            let drag = Drag::begin(&sketch, at, 0.5).unwrap();
            let taken = drag.joint();
            let centre = Vec2::from(centre);
            // From the joint to a circle, and round it in steps of three units.
            let steps = (radius * std::f32::consts::TAU / 3.0).ceil() as usize;
            let to_circle = (centre + Vec2::X * radius).length() / 3.0;
            let way_in = (0..=to_circle as usize).map(|i| {
                (centre + Vec2::X * radius) * (i as f32 / to_circle.max(1.0))
            });
            let round = (0..=steps).map(|i| {
                centre + Vec2::from_angle(i as f32 / steps as f32 * std::f32::consts::TAU) * radius
            });
            let mut before: Option<(Vec2, Sketch)> = None;
            for offset in way_in.chain(round) {
                let now = drag.moved(human, at + offset, &grip).unwrap();
                for (bone, (now, drawn)) in bone_lengths(human, now.points()).iter().zip(&lengths).enumerate() {
                    prop_assert!(*now <= drawn * 1.02 + 0.5, "bone {bone}: {drawn} became {now}");
                }
                for (joint, point) in now.points().iter().enumerate() {
                    let is_held = pins[joint] && joint != taken;
                    prop_assert!(!is_held || *point == sketch.points()[joint], "{joint} is pinned");
                }
                if let Some((offset_before, before)) = &before {
                    let step = offset.distance(*offset_before);
                    for (joint, (a, b)) in now.points().iter().zip(before.points()).enumerate() {
                        prop_assert!(
                            a.distance(*b) <= 8.0 * step + 0.5,
                            "joint {joint} jumped by {} for {step}", a.distance(*b)
                        );
                    }
                }
                before = Some((offset, now));
            }
        }

        #[test]
        fn any_figure_and_any_target_make_a_sketch(
            horse in prop::bool::ANY,
            joint in 0usize..11,
            target in (-3.0f32..3.0, -3.0f32..3.0),
            pins in prop::collection::vec(prop::bool::weighted(0.3), 0..12),
        ) {
            let figure = if horse { Figure::horse() } else { Figure::human() };
            let sketch = Sketch::template(figure);
            let drag = Drag::begin(&sketch, sketch.points()[joint], 0.01).unwrap();
            let grip = Grip { pins, ..Grip::default() };
            let moved = drag.moved(figure, Vec2::from(target), &grip).unwrap();
            prop_assert!(moved.points().iter().all(|point| point.is_finite()));
        }
    }
}
