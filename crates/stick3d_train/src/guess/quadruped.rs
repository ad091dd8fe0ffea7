//! The joints of a body on four legs.

use glam::Vec3;
use stick3d_figure::Side;

use super::limbs::LimbPair;
use super::name::End;
use super::plan::{Face, Finding, Named, Place, View, of_side};
use super::words::{BACK_LEG_STEMS, FRONT_LEG_STEMS, Role};

const SIDES: [Side; 2] = [Side::Right, Side::Left];

/// A bone of the trunk nearer to the front legs than this share of the trunk's length is the shoulder by itself.
const OVER_LEGS: f32 = 0.05;

/// A foot bone begins below this share of the leg's height.
const FOOT: f32 = 0.25;

/// A tail is at least this long, as a share of the body's extent.
const TAIL: f32 = 0.05;

/// How far the forehead is turned from the nose toward the ears, seen from where the head begins, radians.
const FOREHEAD_RAD: f32 = 0.96;

/// The legs in their order.
#[derive(Debug, Clone)]
pub(super) struct Legs {
    front: LimbPair,
    back: LimbPair,
    /// Whether anything told which are the front ones.
    pub(super) clear: bool,
}

impl Legs {
    /// Which of two pairs of legs are the front ones.
    pub(super) fn order(view: &View<'_>) -> Option<Self> {
        let [first, second] = &view.limbs.legs[..] else {
            return None;
        };
        let votes = votes_for_front(view, first, second);
        let (front, back) = if votes >= 0.0 {
            (first, second)
        } else {
            (second, first)
        };
        Some(Self {
            front: front.clone(),
            back: back.clone(),
            clear: votes != 0.0,
        })
    }

    /// Whether the front legs are where [`View::forward`] points: 1, or -1.
    pub(super) fn forward(&self, view: &View<'_>) -> f32 {
        let along = root_middle(view, &self.front) - root_middle(view, &self.back);
        view.forward().dot(along).signum()
    }
}

/// All joints. A body without tail has no joint for one.
pub(super) fn joints(view: &View<'_>, legs: &Legs) -> Vec<Finding> {
    let head = head(view, legs);
    let (shoulder, shoulder_at) = shoulder(view, legs, head);
    let hips = view.limb_begins(&legs.back);
    let hip_at = mean(view, &hips);
    let mut found = vec![forehead(view, head), shoulder];
    found.push(Finding::at("hip", Place::Heads(hips), false));
    found.extend(tail(view, legs, head));
    let ends = [("f", &legs.front, shoulder_at), ("b", &legs.back, hip_at)];
    for (end, pair, top) in ends {
        for side in SIDES {
            found.extend(leg(view, pair.of(side), top, |joint| {
                of_side(&format!("{joint}_{end}"), side)
            }));
        }
    }
    found
}

/// Positive if the first pair is at the front, by all that tells; names count more than shapes.
fn votes_for_front(view: &View<'_>, first: &LimbPair, second: &LimbPair) -> f32 {
    const NAMES: f32 = 4.0;
    let nearer = |point: Vec3| {
        let away = |pair| {
            (root_middle(view, pair) - point)
                .reject_from(Vec3::Y)
                .length()
        };
        let (a, b) = (away(first), away(second));
        // What lies between the pairs says nothing.
        if (a - b).abs() < 0.1 * view.body.extent_m {
            0.0
        } else {
            (b - a).signum()
        }
    };
    let mut votes = NAMES * (end_by_name(view, first) - end_by_name(view, second)).signum_or_zero();
    for head in view
        .body
        .named(Role::Head, Side::Center, &view.symmetry.sides)
    {
        votes += NAMES * nearer(view.body.bones[head].flesh.middle);
    }
    for tail in view
        .body
        .named(Role::Tail, Side::Center, &view.symmetry.sides)
    {
        votes -= NAMES * nearer(view.head(tail));
    }
    // Ears and eyes are the other pairs that a body has.
    for pair in &view.limbs.free {
        votes += nearer(root_middle(view, pair)).clamp(-1.0, 1.0);
    }
    let highest = view
        .middle()
        .max_by(|&a, &b| view.head(a).y.total_cmp(&view.head(b).y));
    votes += 2.0 * highest.map_or(0.0, |bone| nearer(view.head(bone)));
    // Most rigs begin at the pelvis.
    let root = view
        .middle()
        .min_by_key(|&bone| (view.body.upward(bone).count(), bone));
    votes - root.map_or(0.0, |bone| nearer(view.head(bone)))
}

/// How many names of a pair's bones say that it is at the front, less those that say back.
fn end_by_name(view: &View<'_>, pair: &LimbPair) -> f32 {
    let says = |bone: usize| {
        let says = &view.body.bones[bone].says;
        let stem = says.stem.as_str();
        match says.end {
            Some(End::Front) => 2.0,
            Some(End::Back) => -2.0,
            None if FRONT_LEG_STEMS.contains(&stem) => 1.0,
            None if BACK_LEG_STEMS.contains(&stem) => -1.0,
            None => 0.0,
        }
    };
    pair.bones().map(says).sum()
}

trait SignumOrZero {
    fn signum_or_zero(self) -> Self;
}

impl SignumOrZero for f32 {
    fn signum_or_zero(self) -> Self {
        if self == 0.0 { 0.0 } else { self.signum() }
    }
}

/// The head, or two bones that are called so; by its place it is the heaviest bone of the middle ahead of the legs.
fn head(view: &View<'_>, legs: &Legs) -> Named {
    match view.named(Role::Head, Side::Center) {
        Named::None => {}
        named => return named,
    }
    let forward = view.forward();
    let front = forward.dot(root_middle(view, &legs.front));
    let carries_legs = |bone: usize| {
        let roots = legs.front.roots().into_iter().chain(legs.back.roots());
        roots.into_iter().any(|leg| view.body.is_below(leg, bone))
    };
    let ahead = view
        .middle()
        .filter(|&bone| forward.dot(view.head(bone)) > front && !carries_legs(bone));
    view.heaviest(ahead).map_or(Named::None, Named::One)
}

fn forehead(view: &View<'_>, head: Named) -> Finding {
    const JOINT: &str = "forehead";
    match head {
        Named::One(head) => Finding::at(
            JOINT,
            Place::Forehead(head, Face::Muzzle(FOREHEAD_RAD)),
            view.sure(Role::Head, Side::Center).is_some(),
        ),
        Named::Several(first, second) => view.doubtful(JOINT, first, second),
        Named::None => view.missing(
            JOINT,
            Role::Head,
            "no bone of the middle is ahead of the front legs",
            &[],
        ),
    }
}

/// The trunk above the front legs: one bone, or the two before and behind; and where that is.
fn shoulder(view: &View<'_>, legs: &Legs, head: Named) -> (Finding, Vec3) {
    const JOINT: &str = "shoulder";
    let forward = view.forward();
    let ahead = |bone: usize| forward.dot(view.head(bone));
    let legs_m = legs.front.bones().map(ahead).sum::<f32>() / legs.front.bones().count() as f32;
    let hips_m = forward.dot(root_middle(view, &legs.back));
    let mut line: Vec<usize> = match head {
        Named::One(head) => view
            .body
            .upward(head)
            .filter(|&bone| view.weight(bone) > 0.0)
            .collect(),
        Named::None | Named::Several(..) => Vec::new(),
    };
    line.sort_by(|&a, &b| ahead(a).total_cmp(&ahead(b)));
    let nearest = line.iter().copied().min_by(|&a, &b| {
        (ahead(a) - legs_m)
            .abs()
            .total_cmp(&(ahead(b) - legs_m).abs())
    });
    let Some(nearest) = nearest else {
        let roots = legs.front.roots();
        let missing = view.missing(
            JOINT,
            Role::Neck,
            "no bone of the trunk is above the front legs",
            &roots,
        );
        return (missing, mean(view, &roots));
    };
    let after = line.partition_point(|&bone| ahead(bone) < legs_m);
    let bones = match (after.checked_sub(1).map(|at| line[at]), line.get(after)) {
        (Some(behind), Some(&before))
            if (ahead(nearest) - legs_m).abs() > OVER_LEGS * (legs_m - hips_m).abs() =>
        {
            vec![behind, before]
        }
        _ => vec![nearest],
    };
    let at = mean(view, &bones);
    (Finding::at(JOINT, Place::Heads(bones), false), at)
}

/// The last bone of the tail, if there is one.
fn tail(view: &View<'_>, legs: &Legs, head: Named) -> Option<Finding> {
    const JOINT: &str = "tail";
    let depth = |bone: usize| view.body.upward(bone).count();
    let last = |root: usize| {
        let below = view.body.below(root).into_iter();
        let solid = below
            .filter(|&bone| view.weight(bone) > 0.0 && view.symmetry.sides[bone] == Side::Center);
        solid.max_by_key(|&bone| (depth(bone), bone))
    };
    match view.named(Role::Tail, Side::Center) {
        Named::One(tail) => {
            return last(tail).map(|tail| Finding::at(JOINT, Place::Heads(vec![tail]), true));
        }
        Named::Several(first, second) => return Some(view.doubtful(JOINT, first, second)),
        Named::None => {}
    }
    let Named::One(head) = head else { return None };
    let forward = view.forward();
    let hips = root_middle(view, &legs.back);
    let carries_head_or_legs = |bone: usize| {
        let roots = legs.front.roots().into_iter().chain(legs.back.roots());
        roots
            .chain([head])
            .any(|other| view.body.is_below(other, bone))
    };
    let behind = |&bone: &usize| {
        let reach = view.head(bone).distance(hips);
        forward.dot(view.head(bone) - hips) < 0.0
            && reach > TAIL * view.body.extent_m
            && !carries_head_or_legs(bone)
            && !view.body.is_below(bone, head)
    };
    let tip = view.middle().filter(behind).max_by(|&a, &b| {
        depth(a)
            .cmp(&depth(b))
            .then(view.head(b).y.total_cmp(&view.head(a).y))
    })?;
    Some(Finding::at(JOINT, Place::Heads(vec![tip]), false))
}

/// Knee and foot of one leg whose upper end is at `top`.
fn leg(
    view: &View<'_>,
    chain: &[usize],
    top: Vec3,
    called: impl Fn(&str) -> String,
) -> [Finding; 2] {
    let above_m = |point: Vec3| point.y - view.body.ground_m;
    let last = chain
        .iter()
        .rposition(|&bone| view.weight(bone) > 0.0)
        .unwrap_or(chain.len() - 1);
    let low = above_m(view.head(chain[last])) < FOOT * above_m(top);
    let (upper, end, foot) = if low && last > 0 {
        let foot = chain[last];
        (&chain[..last], view.head(foot), Place::Heads(vec![foot]))
    } else {
        let end = view.head(chain[last]).with_y(view.body.ground_m);
        (&chain[..=last], end, Place::End(chain[last]))
    };
    let knee = match view.bend(top, upper, end) {
        Some(knee) => Finding::at(&called("knee"), Place::Heads(vec![knee]), false),
        None => view.missing(
            &called("knee"),
            Role::Calf,
            "the leg has no bone between trunk and foot",
            chain,
        ),
    };
    [knee, Finding::at(&called("foot"), foot, false)]
}

fn root_middle(view: &View<'_>, pair: &LimbPair) -> Vec3 {
    mean(view, &pair.roots())
}

fn mean(view: &View<'_>, bones: &[usize]) -> Vec3 {
    bones.iter().map(|&bone| view.head(bone)).sum::<Vec3>() / bones.len().max(1) as f32
}
