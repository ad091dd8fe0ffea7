//! A person who draws in any order: strokes cut, turned round and shuffled at will, a head as a loop, limbs left out.

use glam::Vec2;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::{Hand, line, wobble};
use crate::figure::{Figure, Side};
use crate::stroke::Stroke;

/// How the strokes are made.
#[derive(Clone, Copy, Debug)]
pub struct Habits {
    /// How often the pen goes on into the next bone.
    pub go_on: f64,
    /// How often a bone is cut into two strokes.
    pub cut: f64,
    /// How often the head is a loop.
    pub loop_head: f64,
    /// How large its radius is, in parts of the bone to it.
    pub loop_radius: (f32, f32),
}

impl Habits {
    /// How a figure is usually drawn.
    pub fn of(figure: &Figure) -> Self {
        Self {
            go_on: 0.6,
            cut: 0.12,
            loop_head: 0.35,
            loop_radius: if figure.views.both_ways {
                // A long neck carries a small head.
                (0.15, 0.3)
            } else {
                (0.45, 0.8)
            },
        }
    }

    /// One stroke for each bone.
    pub fn bone_by_bone(figure: &Figure) -> Self {
        Self {
            go_on: 0.0,
            cut: 0.0,
            loop_head: 0.0,
            ..Self::of(figure)
        }
    }
}

/// How far bones of a flat pose turn from the template, degrees either way.
#[derive(Clone, Copy, Debug)]
struct Freedom {
    /// The whole body.
    roll: f32,
    /// Bones of the body's middle.
    center: f32,
    /// Bones of limbs that hang on the middle.
    first: f32,
    /// Bones farther out.
    later: f32,
}

impl Freedom {
    fn of(figure: &Figure) -> Self {
        if figure.views.both_ways {
            // Walking, grazing, rearing.
            Self {
                roll: 25.0,
                center: 35.0,
                first: 28.0,
                later: 30.0,
            }
        } else {
            // Arms raised and crossing.
            Self {
                roll: 35.0,
                center: 30.0,
                first: 110.0,
                later: 100.0,
            }
        }
    }
}

/// The template with its bones turned in the plane (freely; less so where the figure is seen from its side), lengthened or
/// shortened by up to 15 %, metres. A bone's angle is relative to the bone it hangs on.
pub fn flat_pose(figure: &Figure, rng: &mut ChaCha8Rng) -> Vec<Vec2> {
    let freedom = Freedom::of(figure);
    let facing = Vec2::new(
        if figure.views.both_ways && rng.random::<bool>() {
            -1.0
        } else {
            1.0
        },
        1.0,
    );
    let roll = rng.random_range(-freedom.roll..freedom.roll);
    let mut placed = vec![(Vec2::ZERO, roll); figure.joint_count()];
    for [from, to] in figure.bones_outward() {
        let (at, turned) = placed[from];
        let sides = [figure.joints[from].side, figure.joints[to].side];
        let far = match sides {
            [Side::Center, Side::Center] => freedom.center,
            [Side::Center, _] => freedom.first,
            _ => freedom.later,
        };
        let turn = turned + rng.random_range(-far..far);
        let bone = (figure.template[to] - figure.template[from]) * facing;
        let bone = Vec2::from_angle(turn.to_radians()).rotate(bone);
        placed[to] = (at + bone * rng.random_range(0.85..1.15), turn);
    }
    placed.into_iter().map(|(at, _)| at).collect()
}

/// A pose (metres) as someone draws it who misjudges its bones, each by up to `stretch` of its length, and turns the sheet by up
/// to `roll_rad`.
pub fn misdrawn(
    figure: &Figure,
    pose: &[Vec2],
    stretch: f32,
    roll_rad: f32,
    rng: &mut ChaCha8Rng,
) -> Vec<Vec2> {
    let roll = Vec2::from_angle(rng.random_range(-roll_rad..roll_rad));
    let mut drawn = pose.to_vec();
    for [from, to] in figure.bones_outward() {
        let bone = roll.rotate(pose[to] - pose[from]);
        drawn[to] = drawn[from] + rng.random_range(1.0 - stretch..1.0 + stretch) * bone;
    }
    drawn
}

/// Whether a flat drawing of a pose, metres, says where its joints are: limbs are not folded flat, ends do not lie on the
/// bones of other limbs.
pub fn is_readable(figure: &Figure, joints: &[Vec2]) -> bool {
    let bones_at = |joint: usize| {
        figure
            .bones
            .iter()
            .filter(move |bone| bone.contains(&joint))
    };
    let unfolded = (0..joints.len()).all(|joint| {
        let other = |bone: &[usize; 2]| joints[bone[0] + bone[1] - joint] - joints[joint];
        bones_at(joint).all(|one| {
            bones_at(joint).all(|two| one == two || other(one).angle_to(other(two)).abs() > 0.3)
        })
    });
    unfolded
        && (0..joints.len()).all(|joint| {
            figure
                .bones
                .iter()
                .filter(|bone| !bone.contains(&joint))
                .all(|&[a, b]| {
                    let line = joints[b] - joints[a];
                    let along = (joints[joint] - joints[a]).dot(line) / line.length_squared();
                    let nearest = joints[a] + line * along.clamp(0.0, 1.0);
                    joints[joint].distance(nearest) > 0.07
                })
        })
}

/// The strokes of a drawing of `joints_px` in any order, direction and pieces. The bones of these numbers in `undrawn` are
/// left out.
pub fn draw(
    figure: &Figure,
    rng: &mut ChaCha8Rng,
    joints_px: &[Vec2],
    undrawn: &[usize],
    hand: Hand,
    habits: Habits,
) -> Vec<Stroke> {
    let mut corners: Vec<Vec<Vec2>> = Vec::new();
    let mut left: Vec<[usize; 2]> = (0..figure.bones.len())
        .filter(|bone| !undrawn.contains(bone))
        .map(|bone| figure.bones[bone])
        .collect();
    left.shuffle(rng);
    let mut head = None;
    let is_head = |bone: &[usize; 2]| bone.contains(&figure.path[0]);
    if rng.random_bool(habits.loop_head)
        && let Some(at) = left.iter().position(is_head)
    {
        let [a, b] = left.remove(at);
        let (center, neck) = if a == figure.path[0] { (a, b) } else { (b, a) };
        head = Some((joints_px[center], joints_px[neck]));
    }
    while let Some([a, b]) = left.pop() {
        let mut walk = if rng.random() { vec![a, b] } else { vec![b, a] };
        while rng.random_bool(habits.go_on) {
            let at = walk[walk.len() - 1];
            let Some(next) = left.iter().position(|bone| bone.contains(&at)) else {
                break;
            };
            let [a, b] = left.remove(next);
            walk.push(a + b - at);
        }
        let mut stroke = Vec::new();
        for pair in walk.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|joint| joints_px[joint]);
            stroke.push(from + wobble(rng, hand.aim_px));
            if rng.random_bool(habits.cut) {
                let cut = from.lerp(to, rng.random_range(0.25..0.75));
                stroke.push(cut + wobble(rng, hand.aim_px));
                corners.push(std::mem::take(&mut stroke));
                stroke.push(cut + wobble(rng, hand.aim_px));
            }
        }
        stroke.push(joints_px[walk[walk.len() - 1]] + wobble(rng, hand.aim_px));
        corners.push(stroke);
    }
    if let Some((center, neck)) = head {
        corners.extend(looped(rng, center, neck, habits));
    }
    corners.shuffle(rng);
    let mut time_s = 0.0;
    corners
        .into_iter()
        .map(|mut corners| {
            if rng.random() {
                corners.reverse();
            }
            time_s += 0.3;
            line(rng, &corners, hand, &mut time_s)
        })
        .collect()
}

/// A loop round the head and the line from it to the neck, in one stroke or in two.
fn looped(rng: &mut ChaCha8Rng, center: Vec2, neck: Vec2, habits: Habits) -> Vec<Vec<Vec2>> {
    let (least, most) = habits.loop_radius;
    let radius = center.distance(neck) * rng.random_range(least..most);
    let down = (neck - center).normalize();
    let tall = rng.random_range(0.9..1.15);
    let point = |turn: f32| {
        let (sin, cos) = turn.sin_cos();
        center + down * radius * tall * cos + down.perp() * radius * sin
    };
    // A loop is seldom closed exactly.
    let begin = if rng.random() {
        0.0
    } else {
        rng.random_range(0.0..std::f32::consts::TAU)
    };
    let whole = std::f32::consts::TAU * rng.random_range(0.96..1.05);
    let mut ring: Vec<Vec2> = (0..=24)
        .map(|i| point(begin + whole * i as f32 / 24.0))
        .collect();
    let line = vec![point(0.0), neck];
    if begin == 0.0 && rng.random() {
        ring.push(neck);
        return vec![ring];
    }
    vec![ring, line]
}
