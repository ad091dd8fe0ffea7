//! Tests of guessing: skeletons as other programs name them, bodies without names, and what cannot be guessed.

mod bodies;
mod names;
mod shapes;
mod shipped;

use std::collections::BTreeMap;

use super::body::{Body, Flesh};
use super::plan::Place;
use super::{Found, GuessError, JointFault, find};
use bodies::Sample;

/// What was found of a sample: joint -> the keys of its bones, in words.
fn found(sample: &Sample) -> BTreeMap<String, String> {
    in_words(sample, &find_in(sample).unwrap())
}

fn find_in(sample: &Sample) -> Result<Found, GuessError> {
    find(&Body::new(&sample.skeleton, &sample.flesh))
}

fn in_words(sample: &Sample, found: &Found) -> BTreeMap<String, String> {
    let keys = |bones: &[usize]| -> String {
        let mut keys: Vec<&str> = bones.iter().map(|&b| sample.keys[b].as_str()).collect();
        keys.sort_unstable();
        keys.join("+")
    };
    let place = |place: &Result<Place, JointFault>| match place {
        Ok(Place::Heads(bones)) => keys(bones),
        Ok(Place::Middle(bones)) => format!("middle of {}", keys(&bones[..1])),
        Ok(Place::End(bone)) => format!("end of {}", keys(&[*bone])),
        Ok(Place::Forehead(bone, _)) => format!("front of {}", keys(&[*bone])),
        Err(fault) => fault.to_string(),
    };
    found
        .findings
        .iter()
        .map(|finding| (finding.joint.clone(), place(&finding.place)))
        .collect()
}

/// `joint: bones` line by line, `*` standing for either side.
fn expected(lines: &str) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    for line in lines.lines().filter(|line| !line.trim().is_empty()) {
        let (joint, bones) = line.trim().split_once(": ").unwrap();
        let sides: &[&str] = if joint.contains('*') {
            &["l", "r"]
        } else {
            &["l"]
        };
        for side in sides {
            all.insert(joint.replace('*', side), bones.replace('*', side));
        }
    }
    all
}

/// The joints of a man whose bones are all found.
const MAN: &str = "
    forehead: front of head
    neck: neck
    abdomen: pelvis
    elbow_*: forearm_*
    hand_*: middle1_*
    knee_*: calf_*
    foot_*: foot_*+toe_*
";

/// The joints of a horse whose bones are all found.
const HORSE: &str = "
    forehead: front of head
    shoulder: chest+neck1
    hip: thigh_l+thigh_r
    tail: tail4
    knee_f*: carpus_*
    foot_f*: fhoof_*
    knee_b*: hock_*
    foot_b*: bhoof_*
";

fn flesh(weight: f32, middle: glam::Vec3, low_m: f32) -> Flesh {
    Flesh {
        weight,
        middle,
        low_m,
    }
}
