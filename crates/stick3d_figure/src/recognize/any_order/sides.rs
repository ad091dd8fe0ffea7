//! Left and right: which limb of a pair is which, by the rule that [`recognize_any`](super::recognize_any) states.

use glam::Vec2;

use crate::figure::{Figure, Side};

/// Limbs of a pair nearer to each other than this part of their distance in the template can be told apart by a hair
/// only,
const CLOSE_PAIR: f32 = 0.25;
/// or than this part of the length of a limb.
const CLOSE_LIMB: f32 = 0.06;

/// Two limbs that mirror each other, each from the trunk outwards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pair {
    pub(crate) left: Vec<usize>,
    pub(crate) right: Vec<usize>,
    /// The joint of the middle on which both hang; none where they hang on different ones.
    pub(crate) from: Option<usize>,
}

/// All pairs of limbs of a figure. A limb is a largest group of joined joints that belong to one side.
pub(crate) fn pairs(figure: &Figure) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = Vec::new();
    for joint in 0..figure.joint_count() {
        let known = pairs.iter().any(|pair| pair.left.contains(&joint));
        if figure.joints[joint].side != Side::Left || known {
            continue;
        }
        let (left, from) = limb(figure, joint);
        let right: Vec<usize> = left.iter().map(|&joint| figure.mirror_of(joint)).collect();
        let other = right.first().and_then(|&joint| limb(figure, joint).1);
        pairs.push(Pair {
            left,
            right,
            from: from.filter(|_| from == other),
        });
    }
    pairs
}

/// The pair to which a joint belongs.
pub(crate) fn pair_of(figure: &Figure, joint: usize) -> Option<Pair> {
    let mut pairs = pairs(figure).into_iter();
    pairs.find(|pair| pair.left.contains(&joint) || pair.right.contains(&joint))
}

/// The joints of one side that are joined with `joint`, from the trunk outwards, and the joint on which they hang.
fn limb(figure: &Figure, joint: usize) -> (Vec<usize>, Option<usize>) {
    let side = figure.joints[joint].side;
    let neighbours = |at: usize| {
        let bones = figure.bones.iter();
        bones.filter_map(move |&[a, b]| match at {
            _ if at == a => Some(b),
            _ if at == b => Some(a),
            _ => None,
        })
    };
    let spread = |first: usize| {
        let mut limb = vec![first];
        let mut next = 0;
        while let Some(&at) = limb.get(next) {
            for neighbour in neighbours(at) {
                if figure.joints[neighbour].side == side && !limb.contains(&neighbour) {
                    limb.push(neighbour);
                }
            }
            next += 1;
        }
        limb
    };
    let of_trunk = |at: usize| neighbours(at).find(|&next| figure.joints[next].side != side);
    let whole = spread(joint);
    match whole.iter().find_map(|&at| Some((at, of_trunk(at)?))) {
        Some((first, from)) => (spread(first), Some(from)),
        None => (whole, None),
    }
}

/// How the template lies on a drawing: x turned about or not, then rotated and scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    facing: Vec2,
    rotation: Vec2,
    scale: f32,
}

impl Frame {
    /// From the drawn joints of the middle of the body. None with fewer than two of them.
    fn of(figure: &Figure, joints: &[Option<Vec2>]) -> Option<Self> {
        let middle: Vec<(Vec2, Vec2)> = (0..figure.joint_count())
            .filter(|&joint| figure.joints[joint].side == Side::Center)
            .filter_map(|joint| Some((figure.template[joint], (*joints.get(joint)?)?)))
            .collect();
        let count = middle.len() as f32;
        let sums = middle
            .iter()
            .fold((Vec2::ZERO, Vec2::ZERO), |s, p| (s.0 + p.0, s.1 + p.1));
        let frames = [1.0, -1.0].map(|facing| {
            let facing = Vec2::new(facing, 1.0);
            let mut turned = Vec2::ZERO;
            let mut squares = 0.0;
            for (there, here) in &middle {
                let (there, here) = ((*there - sums.0 / count) * facing, *here - sums.1 / count);
                turned += Vec2::new(there.dot(here), there.perp_dot(here));
                squares += there.length_squared();
            }
            Self {
                facing,
                rotation: turned.normalize_or_zero(),
                scale: turned.length() / squares,
            }
        });
        let ways = if figure.views.both_ways { 2 } else { 1 };
        let best = frames
            .into_iter()
            .take(ways)
            .max_by(|a, b| a.scale.total_cmp(&b.scale));
        best.filter(|frame| middle.len() > 1 && frame.scale > 0.0 && frame.scale.is_finite())
    }

    fn direction(&self, template: Vec2) -> Vec2 {
        self.rotation.rotate(template * self.facing)
    }
}

/// Exchanges the limbs of a pair. A limb that is not there moves its absence.
pub(crate) fn swap<T>(pair: &Pair, joints: &mut [T]) {
    for (&left, &right) in pair.left.iter().zip(&pair.right) {
        if left.max(right) < joints.len() {
            joints.swap(left, right);
        }
    }
}

/// Puts the limbs of every pair on the sides that the rule gives them. Gives the pairs that lie too close together for
/// the rule to mean much.
pub(in crate::recognize) fn put_on_sides(
    figure: &Figure,
    joints: &mut [Option<Vec2>],
) -> Vec<Pair> {
    let mut ambiguous = Vec::new();
    let Some(frame) = Frame::of(figure, joints) else {
        return ambiguous;
    };
    for pair in pairs(figure) {
        // Limbs that hang on different joints are told apart by those.
        let Some(ahead) = pair
            .from
            .and_then(|from| left_ahead(figure, &pair, from, &frame, joints))
        else {
            continue;
        };
        if ahead.by < 0.0 {
            swap(&pair, joints);
        }
        if ahead.by.abs() < ahead.close {
            ambiguous.push(pair);
        }
    }
    ambiguous
}

struct Ahead {
    /// How far the left limb lies from the right one toward where the template has it, metres of the template.
    by: f32,
    /// Less than this may be chance.
    close: f32,
}

fn left_ahead(
    figure: &Figure,
    pair: &Pair,
    from: usize,
    frame: &Frame,
    joints: &[Option<Vec2>],
) -> Option<Ahead> {
    let root = joints[from]?;
    let template_mean = |limb: &[usize]| {
        let sum: Vec2 = limb
            .iter()
            .map(|&j| figure.template[j] - figure.template[from])
            .sum();
        sum / limb.len() as f32
    };
    let (left, right) = (template_mean(&pair.left), template_mean(&pair.right));
    let apart = left - right;
    let toward = frame.direction(apart).normalize_or_zero();
    let along = |limb: &[usize]| {
        let drawn: Vec<f32> = limb
            .iter()
            .filter_map(|&joint| Some((joints[joint]? - root).dot(toward) / frame.scale))
            .collect();
        (!drawn.is_empty()).then(|| drawn.iter().sum::<f32>() / drawn.len() as f32)
    };
    let middle = 0.5 * frame.direction(left + right).dot(toward);
    let by = match (along(&pair.left), along(&pair.right)) {
        (Some(left), Some(right)) => left - right,
        (Some(left), None) => 2.0 * (left - middle),
        (None, Some(right)) => 2.0 * (middle - right),
        (None, None) => return None,
    };
    Some(Ahead {
        by,
        close: (CLOSE_PAIR * apart.length()).max(CLOSE_LIMB * (left.length() + right.length())),
    })
}
