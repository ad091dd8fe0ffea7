//! The joints of a body on two legs.

use glam::Vec3;
use stick3d_figure::Side;

use super::limbs::LimbPair;
use super::plan::{Face, Finding, Named, Place, View, of_side};
use super::words::Role;

const SIDES: [Side; 2] = [Side::Right, Side::Left];

/// Where the elbow is on the way from where an arm leaves the trunk to the wrist, as a share.
const ELBOW: f32 = 0.58;

/// A wrist is farther along the arm than this share.
const WRIST: f32 = 0.6;

/// The surface of a hand is nearer to its bone's head than this share of the forearm; that of a forearm is not.
const HAND: f32 = 0.4;

/// The ankle is lower than this share of the hip's height.
const ANKLE: f32 = 0.18;

/// A second pair of limbs above the legs that is at least this long, as a share of the longest, may be the arms, too.
const ARMS: f32 = 0.7;

/// A pelvis is at most this far from the hips, as a share of the body's height.
const PELVIS: f32 = 0.12;

/// How far toes stick out, as a share of the body's height, for the heading to be clear.
const TOES: f32 = 0.01;

/// The neck may begin this far below the arms, as a share of the body's height.
const NECK: f32 = 0.02;

/// The forehead is this much above straight ahead from the middle of the head, radians.
const FOREHEAD_RAD: f32 = 0.5;

/// Whether names say that the body has arms and legs like a man's.
pub(super) fn is_named(view: &View<'_>) -> bool {
    let pair = |role: Role| SIDES.iter().all(|&side| view.sure(role, side).is_some());
    let leg = pair(Role::Calf) || pair(Role::Thigh) || pair(Role::Foot);
    leg && (pair(Role::Forearm) || pair(Role::Hand))
}

/// Which way the toes point against [`View::forward`]; 0 where that is not clear.
pub(super) fn toes_forward(view: &View<'_>) -> f32 {
    let mut toes = Vec3::ZERO;
    for side in SIDES {
        let Some(ankle) = ankle(view, side) else {
            continue;
        };
        for bone in view.body.below(ankle) {
            let farthest = [view.body.bones[bone].flesh.middle, view.head(bone)];
            for point in farthest {
                let out = (point - view.head(ankle)).reject_from(Vec3::Y);
                if out.length() > toes.length() {
                    toes = out;
                }
            }
        }
    }
    let ahead_m = toes.dot(view.forward());
    if ahead_m.abs() < TOES * view.body.height_m {
        0.0
    } else {
        ahead_m.signum()
    }
}

/// All joints.
pub(super) fn joints(view: &View<'_>) -> Vec<Finding> {
    let mut found = vec![forehead(view), neck(view), abdomen(view)];
    for side in SIDES {
        found.push(elbow(view, side));
        found.push(hand(view, side));
        found.push(knee(view, side));
        found.push(foot(view, side));
    }
    found
}

fn forehead(view: &View<'_>) -> Finding {
    const JOINT: &str = "forehead";
    let at = |head, named| {
        Finding::at(
            JOINT,
            Place::Forehead(head, Face::Flat(FOREHEAD_RAD)),
            named,
        )
    };
    match view.named(Role::Head, Side::Center) {
        Named::One(head) => at(head, true),
        Named::Several(first, second) => view.doubtful(JOINT, first, second),
        Named::None => match head_by_place(view) {
            Some(head) => at(head, false),
            None => view.missing(
                JOINT,
                Role::Head,
                "no bone of the middle is above the arms",
                &[],
            ),
        },
    }
}

fn neck(view: &View<'_>) -> Finding {
    const JOINT: &str = "neck";
    match view.named(Role::Neck, Side::Center) {
        Named::One(neck) => return Finding::at(JOINT, Place::Heads(vec![neck]), true),
        Named::Several(first, second) => return view.doubtful(JOINT, first, second),
        Named::None => {}
    }
    let head = view.sure(Role::Head, Side::Center);
    let head = head.or_else(|| head_by_place(view));
    if let Some((head, shoulders_m)) = head.zip(shoulders_m(view)) {
        let lowest_m = shoulders_m - NECK * view.body.height_m;
        let above = |&bone: &usize| view.head(bone).y >= lowest_m;
        let neck = view.body.upward(head).take_while(above).last();
        return Finding::at(JOINT, Place::Heads(vec![neck.unwrap_or(head)]), false);
    }
    let near: Vec<usize> = head.into_iter().collect();
    view.missing(JOINT, Role::Neck, "no bone is called so", &near)
}

fn abdomen(view: &View<'_>) -> Finding {
    const JOINT: &str = "abdomen";
    let thighs = thighs(view);
    match view.named(Role::Pelvis, Side::Center) {
        Named::One(pelvis) => {
            let near_hips = |(hips, _): &(Vec<usize>, bool)| {
                let hips_m = mean_y(view, hips);
                (view.head(pelvis).y - hips_m).abs() <= PELVIS * view.body.height_m
            };
            if view.weight(pelvis) > 0.0 && thighs.as_ref().is_none_or(near_hips) {
                return Finding::at(JOINT, Place::Heads(vec![pelvis]), true);
            }
        }
        Named::Several(first, second) => return view.doubtful(JOINT, first, second),
        Named::None => {}
    }
    match thighs {
        Some((hips, named)) => Finding::at(JOINT, Place::Heads(hips), named),
        None => view.missing(JOINT, Role::Pelvis, "neither hips nor legs are found", &[]),
    }
}

fn elbow(view: &View<'_>, side: Side) -> Finding {
    let joint = of_side("elbow_", side);
    match view.named(Role::Forearm, side) {
        Named::One(forearm) => return Finding::at(&joint, Place::Heads(vec![forearm]), true),
        Named::Several(first, second) => return view.doubtful(&joint, first, second),
        Named::None => {}
    }
    let mut elbows = arms(view).map(|pair| elbow_of(view, pair.of(side)));
    match (elbows.next(), elbows.next()) {
        (Some(Some(first)), Some(Some(second))) => view.doubtful(&joint, first, second),
        (Some(Some(elbow)), _) => Finding::at(&joint, Place::Heads(vec![elbow]), false),
        (Some(None), _) => {
            let near: Vec<usize> = arms(view).flat_map(|pair| pair.of(side).to_vec()).collect();
            view.missing(
                &joint,
                Role::Forearm,
                "the arm is one bone and does not bend",
                &near,
            )
        }
        (None, _) => view.missing(&joint, Role::Forearm, "no arm is found on this side", &[]),
    }
}

fn hand(view: &View<'_>, side: Side) -> Finding {
    let joint = of_side("hand_", side);
    if let Some(finger) = view.sure(Role::MiddleFinger, side) {
        return Finding::at(&joint, Place::Heads(vec![finger]), true);
    }
    let whole = |hand: usize, named| {
        let below = view.body.below(hand).into_iter();
        let solid = below.filter(|&bone| view.weight(bone) > 0.0).collect();
        Finding::at(&joint, Place::Middle(solid), named)
    };
    match view.named(Role::Hand, side) {
        Named::One(hand) => return whole(hand, true),
        Named::Several(first, second) => return view.doubtful(&joint, first, second),
        Named::None => {}
    }
    let mut hands = arms(view).map(|pair| {
        let chain = pair.of(side);
        let hand = chain[wrist(view, chain)];
        (
            hand,
            elbow_of(view, chain).is_none_or(|elbow| elbow == hand),
        )
    });
    match (hands.next(), hands.next()) {
        (Some((first, _)), Some((second, _))) => view.doubtful(&joint, first, second),
        (Some((forearm, true)), None) => Finding::at(&joint, Place::End(forearm), false),
        (Some((hand, false)), None) => whole(hand, false),
        (None, _) => view.missing(&joint, Role::Hand, "no arm is found on this side", &[]),
    }
}

fn knee(view: &View<'_>, side: Side) -> Finding {
    let joint = of_side("knee_", side);
    match view.named(Role::Calf, side) {
        // `Leg` alone may be the whole of it.
        Named::One(calf) if view.sure(Role::Thigh, side) != Some(calf) => {
            return Finding::at(&joint, Place::Heads(vec![calf]), true);
        }
        Named::Several(first, second) => return view.doubtful(&joint, first, second),
        Named::None | Named::One(_) => {}
    }
    let Some(leg) = view.limbs.legs.first() else {
        return view.missing(&joint, Role::Calf, "no leg is found on this side", &[]);
    };
    let chain = leg.of(side);
    let top = view.head(view.limb_begin(chain));
    let end = ankle_of(view, chain);
    let (upper, end) = match end {
        Some(ankle) => (&chain[1..ankle.max(1)], view.head(chain[ankle])),
        None => (&chain[1..], top.with_y(view.body.ground_m)),
    };
    match view.bend(top, upper, end) {
        Some(knee) => Finding::at(&joint, Place::Heads(vec![knee]), false),
        None => view.missing(
            &joint,
            Role::Calf,
            "the leg has no bone between hip and foot",
            chain,
        ),
    }
}

fn foot(view: &View<'_>, side: Side) -> Finding {
    let joint = of_side("foot_", side);
    let whole = |foot: usize| {
        let below = view.body.below(foot).into_iter();
        Place::Middle(below.filter(|&bone| view.weight(bone) > 0.0).collect())
    };
    match view.named(Role::Foot, side) {
        Named::One(foot) => {
            let toe = view.sure(Role::Toe, side);
            let place = match toe.filter(|&toe| view.weight(toe) > 0.0) {
                Some(toe) => Place::Heads(vec![foot, toe]),
                None => whole(foot),
            };
            return Finding::at(&joint, place, true);
        }
        Named::Several(first, second) => return view.doubtful(&joint, first, second),
        Named::None => {}
    }
    let Some(leg) = view.limbs.legs.first() else {
        return view.missing(&joint, Role::Foot, "no leg is found on this side", &[]);
    };
    let chain = leg.of(side);
    let place = match ankle_of(view, chain) {
        Some(ankle) => match chain.get(ankle + 1).filter(|&&b| view.weight(b) > 0.0) {
            Some(&toe) => Place::Heads(vec![chain[ankle], toe]),
            None => whole(chain[ankle]),
        },
        None => Place::End(chain[chain.len() - 1]),
    };
    Finding::at(&joint, place, false)
}

/// The arms: the longest limbs above the legs; a second pair where it is about as long.
fn arms<'v>(view: &'v View<'_>) -> impl Iterator<Item = &'v LimbPair> {
    let hips_m = view
        .limbs
        .legs
        .first()
        .map(|leg| mean_y(view, &leg.roots()));
    let above =
        move |pair: &&LimbPair| hips_m.is_none_or(|hips_m| mean_y(view, &pair.roots()) > hips_m);
    let longest_m = view.limbs.free.iter().find(above).map(|arm| arm.length_m);
    view.limbs
        .free
        .iter()
        .filter(above)
        .filter(move |arm| longest_m.is_some_and(|longest| arm.length_m >= ARMS * longest))
}

fn elbow_of(view: &View<'_>, chain: &[usize]) -> Option<usize> {
    let wrist = wrist(view, chain);
    if wrist == 1 || (wrist == 2 && wrist + 1 == chain.len() && is_forearm(view, chain, wrist)) {
        return Some(chain[wrist]);
    }
    let along = view.along(chain);
    let off = |at: usize| (along[at] - ELBOW * along[wrist]).abs();
    let elbow = (1..wrist).min_by(|&a, &b| off(a).total_cmp(&off(b)))?;
    Some(chain[elbow])
}

/// Whether the last bone of an arm is as long as a forearm: rigs without hands end there.
fn is_forearm(view: &View<'_>, chain: &[usize], last: usize) -> bool {
    let before_m = view.head(chain[last]).distance(view.head(chain[last - 1]));
    let bone = &view.body.bones[chain[last]];
    bone.flesh.middle.distance(bone.head) > HAND * before_m
}

/// Where in the chain of an arm the hand begins: where it branches into fingers, else its last bone.
fn wrist(view: &View<'_>, chain: &[usize]) -> usize {
    let along = view.along(chain);
    let whole_m = along.last().copied().unwrap_or(0.0);
    let branches = |bone: usize| {
        let children = view.body.children(bone);
        let fingers = children
            .iter()
            .filter(|&&c| !view.body.children(c).is_empty());
        children.len() >= 3 || fingers.count() >= 2
    };
    let found = (1..chain.len()).find(|&at| along[at] >= WRIST * whole_m && branches(chain[at]));
    found.unwrap_or(chain.len() - 1)
}

fn ankle(view: &View<'_>, side: Side) -> Option<usize> {
    view.sure(Role::Foot, side).or_else(|| {
        let chain = view.limbs.legs.first()?.of(side);
        ankle_of(view, chain).map(|at| chain[at])
    })
}

/// Where in the chain of a leg the foot begins.
fn ankle_of(view: &View<'_>, chain: &[usize]) -> Option<usize> {
    let above_m = |at: usize| view.head(chain[at]).y - view.body.ground_m;
    (1..chain.len()).find(|&at| above_m(at) < ANKLE * above_m(0))
}

/// Where both legs begin, and whether names told.
fn thighs(view: &View<'_>) -> Option<(Vec<usize>, bool)> {
    let named: Vec<usize> = SIDES
        .iter()
        .filter_map(|&side| view.sure(Role::Thigh, side))
        .collect();
    if named.len() == SIDES.len() {
        return Some((named, true));
    }
    let legs = view.limbs.legs.first()?;
    Some((view.limb_begins(legs), false))
}

/// How high the arms leave the trunk, metres.
fn shoulders_m(view: &View<'_>) -> Option<f32> {
    let named: Vec<usize> = SIDES
        .iter()
        .filter_map(|&side| view.sure(Role::UpperArm, side))
        .collect();
    if named.len() == SIDES.len() {
        return Some(mean_y(view, &named));
    }
    arms(view).next().map(|pair| mean_y(view, &pair.roots()))
}

/// The heaviest bone of the middle above the arms.
fn head_by_place(view: &View<'_>) -> Option<usize> {
    let lowest_m = shoulders_m(view)? - NECK * view.body.height_m;
    let carries_arms = |bone: usize| {
        arms(view)
            .flat_map(LimbPair::roots)
            .any(|arm| view.body.is_below(arm, bone))
    };
    let above = view
        .middle()
        .filter(|&bone| view.head(bone).y >= lowest_m && !carries_arms(bone));
    view.heaviest(above)
}

fn mean_y(view: &View<'_>, bones: &[usize]) -> f32 {
    bones.iter().map(|&bone| view.head(bone).y).sum::<f32>() / bones.len().max(1) as f32
}
