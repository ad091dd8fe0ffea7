//! Limbs that reach for a place with bones of the length they are drawn at.

use glam::Vec2;

use super::drag::{Grip, bone_lengths};
use crate::figure::Figure;
use crate::preview;

/// A single bone keeps its length while the pointer is so near to its circle, in parts of its length.
const STICKY: f32 = 0.2;
/// A limb of two bones is foreshortened where its end comes so near to its beginning, in parts of the shorter bone.
const FOLDED: f32 = 0.35;
/// How fast the middle of a limb may come out while its end comes in: a straight limb would bend at once.
const BEND_SPEED: f32 = 2.0;
/// What is left of the start's own shape fades over this part of a limb's length.
const START_FADES: f32 = 0.25;
/// Bones may be longer than drawn by this factor, so that no limb has to be stretched to a point.
const SLACK: f32 = 1.01;
/// A limb bent by less than this part of its length counts as straight, and bends the way the template does.
const STRAIGHT: f32 = 0.02;
/// How often a place is moved into all circles that bound it.
const ROUNDS: usize = 60;
/// How finely the way to a place is searched that a pin forbids.
const HALVINGS: usize = 20;

/// A circle within which a joint has to stay.
#[derive(Clone, Copy, Debug)]
struct Bound {
    centre: Vec2,
    radius: f32,
}

/// The place nearest to `at` that is within all bounds, about. Two places never come out farther apart than they went in.
fn within(bounds: &[Bound], at: Vec2) -> Vec2 {
    let mut at = at;
    for _ in 0..ROUNDS {
        let before = at;
        for bound in bounds {
            at = bound.centre + (at - bound.centre).clamp_length_max(bound.radius);
        }
        if at == before {
            break;
        }
    }
    at
}

/// The joints of a limb, from the one that stays to the one that is pulled.
type Limb = Vec<usize>;

/// A figure with one joint in hand.
pub(super) struct Reach<'a> {
    figure: &'a Figure,
    start: &'a [Vec2],
    /// Per joint the joint it hangs on, and the longest that the bone between them may be.
    above: Vec<Option<(usize, f32)>>,
    held: Vec<bool>,
    joint: usize,
    /// From where the joint is pulled; only the joint for the root.
    limb: Limb,
    /// The joints that come along, in the order of the tree.
    along: Vec<usize>,
    /// The limbs whose ends are pinned while their beginnings move.
    pinned: Vec<Limb>,
    /// Which way round the figure is, compared with the template: 1 or -1.
    facing: f32,
}

impl<'a> Reach<'a> {
    pub(super) fn new(figure: &'a Figure, start: &'a [Vec2], joint: usize, grip: &Grip) -> Self {
        let lengths = bone_lengths(figure, start);
        let longest = |bone: usize| {
            let before = grip.longest.get(bone).copied().unwrap_or(0.0);
            lengths[bone].max(before)
        };
        let (above, order) = tree(figure, longest);
        let held = (0..start.len())
            .map(|at| at != joint && grip.pins.get(at) == Some(&true))
            .collect();
        let placed: Vec<Option<Vec2>> = start.iter().copied().map(Some).collect();
        let turned = preview::turned(figure, &placed);
        let mut reach = Self {
            figure,
            start,
            above,
            held,
            joint,
            limb: Vec::new(),
            along: Vec::new(),
            pinned: Vec::new(),
            facing: turned.x * turned.y,
        };
        reach.limb = reach.limb_to(joint);
        for at in order {
            let Some((from, _)) = reach.above[at] else {
                continue;
            };
            if at == joint || !(from == joint || reach.along.contains(&from)) {
                continue;
            }
            if reach.held[at] {
                reach.pinned.push(reach.limb_to(at));
            } else {
                reach.along.push(at);
            }
        }
        reach
    }

    /// From the nearest joint above that stays or where limbs meet.
    fn limb_to(&self, end: usize) -> Limb {
        let mut limb = vec![end];
        let mut at = end;
        while let Some((from, _)) = self.above[at] {
            limb.push(from);
            at = from;
            let bones = self.figure.bones.iter().filter(|bone| bone.contains(&at));
            if bones.count() > 2 || self.held[at] || at == self.joint {
                break;
            }
        }
        limb.reverse();
        limb
    }

    /// How far the end of a limb can be from its beginning.
    fn longest(&self, limb: &[usize]) -> f32 {
        let bones = limb[1..].iter().filter_map(|&at| self.above[at]);
        bones.map(|(_, longest)| longest).sum()
    }

    /// The joints when the one in hand is pulled to `target`.
    pub(super) fn pulled_to(&self, target: Vec2) -> Vec<Vec2> {
        let points = self.tried(target);
        if self.is_possible(&points) {
            return points;
        }
        // Pins far along the figure bound the way.
        let from = self.start[self.joint];
        let (mut least, mut most) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (least + most);
            if self.is_possible(&self.tried(from.lerp(target, middle))) {
                least = middle;
            } else {
                most = middle;
            }
        }
        self.tried(from.lerp(target, least))
    }

    fn is_possible(&self, points: &[Vec2]) -> bool {
        self.pinned.iter().all(|limb| {
            let [from, to] = [limb[0], limb[limb.len() - 1]];
            points[from].distance(points[to]) <= self.longest(limb) * SLACK
        })
    }

    fn tried(&self, target: Vec2) -> Vec<Vec2> {
        let mut points = self.start.to_vec();
        let before = self.start[self.joint];
        let bounds = self.bounds();
        let mut target = within(&bounds, target);
        if let [anchor, _] = self.limb[..] {
            target = within(&bounds, sticky(self.start[anchor], before, target));
        }
        self.place(&self.limb, self.start[self.limb[0]], target, &mut points);
        let turn = match self.limb[..] {
            [.., last, _] => turned_bone(before - self.start[last], target - points[last]),
            _ => Vec2::X,
        };
        for &at in &self.along {
            points[at] = target + turn.rotate(self.start[at] - before);
        }
        for limb in &self.pinned {
            let end = self.start[limb[limb.len() - 1]];
            self.place(limb, points[limb[0]], end, &mut points);
        }
        points
    }

    /// Where the joint has to stay because of the limb it pulls at, and of the pins below it.
    fn bounds(&self) -> Vec<Bound> {
        let mut bounds = Vec::new();
        let is_root = self.limb.len() == 1;
        if !is_root {
            bounds.push(Bound {
                centre: self.start[self.limb[0]],
                radius: self.longest(&self.limb),
            });
        }
        for limb in &self.pinned {
            let beside = self.start[limb[0]] - self.start[self.joint];
            // The root takes all beginnings along by the same way; what turns is looked at later.
            if is_root || limb[0] == self.joint {
                bounds.push(Bound {
                    centre: self.start[limb[limb.len() - 1]] - beside,
                    radius: self.longest(limb),
                });
            }
        }
        bounds
    }

    /// Puts a limb between two places. Of several bones those before and after the one joint that stands out most are
    /// as stiff as one.
    fn place(&self, limb: &[usize], from: Vec2, to: Vec2, points: &mut [Vec2]) {
        let at = |index: usize| self.start[limb[index]];
        let last = limb.len() - 1;
        points[limb[0]] = from;
        points[limb[last]] = to;
        if last < 2 {
            return;
        }
        let middle = self.middle(limb);
        let parts = [&limb[..=middle], &limb[middle..]];
        let drawn = [at(0).distance(at(middle)), at(middle).distance(at(last))];
        let longest = [0, 1].map(|part| self.longest_part(parts[part], drawn[part]));
        let bend = Bend {
            drawn,
            longest,
            side: self.side(limb, middle),
        };
        let way = [at(last) - at(0), to - from];
        let place = from + bend.middle(at(middle) - at(0), way);
        points[limb[middle]] = place;
        for (part, ends) in parts.into_iter().zip([[from, place], [place, to]]) {
            self.place_stiff(part, ends, points);
        }
    }

    /// How long a stiff part of a limb may be.
    fn longest_part(&self, part: &[usize], drawn: f32) -> f32 {
        let bones = part
            .windows(2)
            .map(|two| self.start[two[0]].distance(self.start[two[1]]));
        let now: f32 = bones.sum();
        let longest = self.longest(part);
        if now > 0.0 {
            drawn * longest / now
        } else {
            longest
        }
    }

    /// The index in a limb of the joint that stands out most; in a straight one the joint nearest to half its length.
    fn middle(&self, limb: &[usize]) -> usize {
        let last = limb.len() - 1;
        let ends = [limb[0], limb[last]].map(|at| self.start[at]);
        let out = |index: &usize| {
            let beside = super::distance_to_line(self.start[limb[*index]], ends[0], ends[1]);
            let uneven = self.longest(&limb[..=*index]) - self.longest(&limb[*index..]);
            beside - 1.0e-3 * uneven.abs()
        };
        (1..last)
            .max_by(|a, b| out(a).total_cmp(&out(b)))
            .unwrap_or(1)
    }

    /// To which side of the way along a limb its middle stands out: 1 for the left, -1 for the right.
    fn side(&self, limb: &[usize], middle: usize) -> f32 {
        let out = |points: &[Vec2]| {
            let [from, at, to] = [limb[0], limb[middle], limb[limb.len() - 1]].map(|at| points[at]);
            (to - from).normalize_or_zero().perp_dot(at - from)
        };
        let drawn = out(self.start);
        if drawn.abs() > STRAIGHT * self.longest(limb) {
            drawn.signum()
        } else {
            (out(&self.figure.template) * self.facing).signum()
        }
    }

    /// The joints between the ends of a part of a limb that turns as a whole.
    fn place_stiff(&self, part: &[usize], [from, to]: [Vec2; 2], points: &mut [Vec2]) {
        let last = part.len() - 1;
        let [start, end] = [part[0], part[last]].map(|at| self.start[at]);
        let before = end - start;
        for (index, &at) in part.iter().enumerate().take(last).skip(1) {
            points[at] = if before.length_squared() > 0.0 {
                let ratio = Vec2::new(before.dot(to - from), before.perp_dot(to - from))
                    / before.length_squared();
                from + ratio.rotate(self.start[at] - start)
            } else {
                from.lerp(to, index as f32 / last as f32)
            };
        }
    }
}

/// Per joint the joint it hangs on with the longest its bone may be; and the joints from the root outwards.
pub(super) fn tree(
    figure: &Figure,
    longest: impl Fn(usize) -> f32,
) -> (Vec<Option<(usize, f32)>>, Vec<usize>) {
    let mut above = vec![None; figure.joint_count()];
    let mut order = vec![figure.root];
    let mut next = 0;
    while let Some(&at) = order.get(next) {
        next += 1;
        for (bone, &[a, b]) in figure.bones.iter().enumerate() {
            let below = match at {
                _ if a == at => b,
                _ if b == at => a,
                _ => continue,
            };
            if !order.contains(&below) {
                above[below] = Some((at, longest(bone)));
                order.push(below);
            }
        }
    }
    (above, order)
}

/// A place for the end of a single bone: near the bone's circle on it.
fn sticky(anchor: Vec2, before: Vec2, target: Vec2) -> Vec2 {
    let (length, bone) = (anchor.distance(before), target - anchor);
    let distance = bone.length();
    if distance >= length || distance <= 0.0 {
        return target;
    }
    anchor + bone * (length / distance).min(1.0 / (1.0 - STICKY))
}

/// How what hangs on a bone turns with it; a bone that is foreshortened to less than half takes it along.
fn turned_bone(before: Vec2, after: Vec2) -> Vec2 {
    if before.length_squared() <= 0.0 {
        return Vec2::X;
    }
    let ratio = Vec2::new(before.dot(after), before.perp_dot(after)) / before.length_squared();
    ratio * (1.0 / ratio.length().max(f32::MIN_POSITIVE)).min(2.0)
}

/// Two bones, or stiff parts, and how they bend.
struct Bend {
    /// Their lengths as drawn,
    drawn: [f32; 2],
    /// and the longest they may be.
    longest: [f32; 2],
    side: f32,
}

impl Bend {
    /// The middle of the limb from its beginning, when its end was on the way `before` and is on the way `now`.
    fn middle(&self, middle_before: Vec2, [before, now]: [Vec2; 2]) -> Vec2 {
        let reach = self.drawn[0] + self.drawn[1];
        let fade = START_FADES * reach.max(f32::MIN_POSITIVE);
        let left = (1.0 - now.distance(before) / fade).max(0.0);
        let shape = middle_before - self.ideal(before);
        let bounds = [(Vec2::ZERO, 0), (now, 1)].map(|(centre, part)| Bound {
            centre,
            radius: SLACK * self.longest[part],
        });
        within(&bounds, self.ideal(now) + shape * left)
    }

    fn ideal(&self, way: Vec2) -> Vec2 {
        let [first, second] = self.drawn;
        let reach = first + second;
        if reach <= f32::MIN_POSITIVE {
            let [first, second] = self.longest;
            return way * (first / (first + second).max(f32::MIN_POSITIVE));
        }
        let distance = way.length();
        let folded = (first - second).abs() + FOLDED * first.min(second);
        let width = distance.clamp(folded.min(reach), reach);
        let along = (first * first - second * second + width * width) / (2.0 * width);
        let out = (first * first - along * along).max(0.0).sqrt();
        let out = out.min(BEND_SPEED * (reach - width));
        let direction = way.normalize_or_zero();
        // Nearer than folded it is foreshortened, farther than its reach it is lengthened.
        (direction * along + direction.perp() * (self.side * out)) * (distance / width)
    }
}
