//! How every test case is turned, and the ways in which it is drawn.

use glam::{Quat, Vec2, Vec3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use stick3d_figure::complete_from_template;
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::{Sketch, SketchError};
use stick3d_model::{JointMark, MarkedSketch};

use crate::dataset::{Rotations, SketchNoise, drawn};
use crate::size::relative_size;

/// How far joints are jittered on a figure of usual size, metres, and how much bones are scaled.
const JITTER_M: f32 = 0.025;
const BONE_SCALE: f32 = 0.15;

/// A mesh centred on the root joint, and its joints.
pub(super) type Body = (Vec<Vec3>, Vec<Vec3>);

/// A way to draw a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    /// Its name.
    pub(super) name: &'static str,
    /// What is done to the sketch.
    pub(super) noise: SketchNoise,
    /// Whether a limb is left out.
    pub(super) incomplete: bool,
    /// Whether what takes long is measured, too: the nearest neighbour, and the first answer with one limb flipped.
    pub(super) in_full: bool,
}

/// A test case as it was drawn.
#[derive(Debug, Clone)]
pub(super) struct Drawing {
    pub(super) sketch: Sketch,
    /// What each joint says; none where all were drawn.
    pub(super) marks: Vec<JointMark>,
}

impl Drawing {
    pub(super) fn marked(&self) -> MarkedSketch<'_> {
        MarkedSketch {
            sketch: &self.sketch,
            marks: &self.marks,
        }
    }
}

/// Ways to draw one figure,
pub(super) const WAYS: usize = 5;
/// and which of them disturbs both joints and bones.
pub(super) const CROOKED: usize = 3;

impl Way {
    /// All ways to draw a figure; the first is to draw it as it is. A small figure is jittered less ([`relative_size`]).
    pub(super) fn all(figure: &Figure) -> [Self; WAYS] {
        let jitter_m = JITTER_M * relative_size(figure.template_extent_m());
        let way = |name, jitter_m, bone_scale| Self {
            name,
            noise: SketchNoise {
                jitter_m,
                bone_scale,
            },
            incomplete: false,
            in_full: false,
        };
        let clean = way("clean", 0.0, 0.0);
        [
            Self {
                in_full: true,
                ..clean
            },
            way("jittered", jitter_m, 0.0),
            way("scaled", 0.0, BONE_SCALE),
            Self {
                in_full: true,
                ..way("both", jitter_m, BONE_SCALE)
            },
            Self {
                name: "incomplete",
                incomplete: true,
                ..clean
            },
        ]
    }

    /// A sketch drawn this way of joints on the sketch plane, metres. `case` says which limb is left out: each in turn. What is
    /// not drawn is filled in as it is while a person draws.
    pub(super) fn draw(
        &self,
        figure: &Figure,
        mut joints: Vec<Vec2>,
        case: usize,
        rng: &mut impl Rng,
    ) -> Result<Drawing, SketchError> {
        self.noise.apply(figure, &mut joints, rng);
        let limbs = figure.limbs();
        let left_out = limbs.get(case % limbs.len().max(1));
        if let (true, Some(limb)) = (self.incomplete, left_out) {
            let mut placed: Vec<Option<Vec2>> = joints.iter().copied().map(Some).collect();
            limb.joints.iter().for_each(|joint| placed[*joint] = None);
            // A figure that is a single limb has nothing left to fill it in from, and is drawn whole.
            if let Some(sketch) = complete_from_template(figure, &placed) {
                let marks = placed.iter().map(|place| match place {
                    Some(_) => JointMark::Drawn,
                    None => JointMark::Guessed,
                });
                let marks = marks.collect();
                return Ok(Drawing { sketch, marks });
            }
        }
        let sketch = Sketch::new(figure, joints)?;
        Ok(Drawing {
            sketch,
            marks: vec![],
        })
    }
}

/// A body turned at random, and its sketches, one per way of drawing.
pub(super) fn drawn_in_all_ways(
    figure: &Figure,
    ways: &[Way; WAYS],
    (mesh, joints): &Body,
    case: usize,
    rng: &mut ChaCha8Rng,
) -> Result<(Body, Vec<Drawing>), SketchError> {
    let turn = Rotations::test_of(&figure.views).sample(rng);
    let turned = |points: &[Vec3]| points.iter().map(|point| turn * *point).collect();
    let truth: Body = (turned(mesh), turned(joints));
    let flat: Vec<Vec2> = drawn(Quat::IDENTITY, &truth.1);
    let sketches = ways
        .iter()
        .map(|way| way.draw(figure, flat.clone(), case, rng))
        .collect::<Result<_, _>>()?;
    Ok((truth, sketches))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::random;

    #[test]
    fn every_limb_is_left_out_in_turn_and_the_rest_stays() {
        for figure in Figure::shipped() {
            let way = Way::all(figure)[WAYS - 1];
            let limbs = figure.limbs();
            let bent: Vec<Vec2> = (0..figure.joint_count())
                .map(|i| figure.template[i] + 0.1 * Vec2::from_angle(i as f32))
                .collect();
            for (case, limb) in limbs.iter().enumerate() {
                let rng = &mut random(1, "test", 0);
                let drawing = way.draw(figure, bent.clone(), case, rng).unwrap();
                for (joint, point) in drawing.sketch.points().iter().enumerate() {
                    let drawn = !limb.joints.contains(&joint);
                    assert_eq!(*point == bent[joint], drawn, "{} {joint}", figure.name);
                    assert_eq!(drawing.marks[joint] == JointMark::Drawn, drawn);
                }
            }
        }
    }
}
