//! A small measurement on the real rig and model.

use std::sync::LazyLock;

use super::*;
use crate::pose::{Controls, PoseLibrary, ShippedBody};
use crate::rig::Clip;
use crate::training::Quiet;

static RIG: LazyLock<Rig> = LazyLock::new(|| {
    Rig::from_glb(include_bytes!("../../../../../assets/rigs/human.glb")).unwrap()
});

fn named(names: &[&str]) -> Vec<(String, Pose)> {
    let human = ShippedBody::named("human").unwrap();
    let controls = Controls::from_ron(human.controls, &RIG).unwrap();
    let library = PoseLibrary::from_ron(human.poses, &controls).unwrap();
    let pose = |name: &&str| {
        let values = &library.get(name).unwrap().values;
        ((*name).to_owned(), controls.pose(values))
    };
    names.iter().map(pose).collect()
}

fn poses(names: &[&str]) -> Vec<Pose> {
    named(names).into_iter().map(|(_, pose)| pose).collect()
}

fn report(motions: &[TrueMotion], gaits: &[TrueMotion]) -> MotionReport {
    let bytes = include_bytes!("../../../../../assets/models/human.stick3d");
    let model = Model::from_bytes(bytes).unwrap();
    let library = poses(&[
        "stand_at_ease",
        "wave",
        "reach_up",
        "squat_deep",
        "kick_front",
    ]);
    let input = MotionEvalInput {
        rig: &RIG,
        motions,
        gaits,
        library: &library,
        stream: Box::new(std::iter::empty()),
    };
    evaluate_motion(&model, input, &MotionEvalConfig::default(), &Quiet).unwrap()
}

#[test]
fn methods_are_compared_with_the_true_motion() {
    let arm = TrueMotion::between(
        "raises an arm".to_owned(),
        poses(&["stand_at_ease", "wave"]),
        0.5,
        false,
    );
    let report = report(&[arm], &[]);
    let row = |name: &str| {
        let found = report.between.iter().find(|row| row.name == name);
        found.unwrap_or_else(|| panic!("no row {name}"))
    };
    let truth = row("the true motion");
    assert!(truth.motions == 3 && truth.vertex_cm < 1e-3, "{truth:?}");
    assert!(truth.bone_length_percent < 1e-3, "{truth:?}");
    for name in [
        "latent, straight",
        "latent, cubic",
        "vertex-linear",
        "sketch-level",
    ] {
        let row = row(name);
        assert!(row.vertex_cm > 0.5 && row.vertex_cm < 30.0, "{row:?}");
        assert!(
            row.jerk_m_s3 > 0.0 && row.edge_stretch_percent >= 0.0,
            "{row:?}"
        );
    }
    // Two keys are joined by a straight line either way.
    let (straight, cubic) = (row("latent, straight"), row("latent, cubic"));
    assert!((straight.vertex_cm - cubic.vertex_cm).abs() < 0.05);
    let beyond = &report.beyond;
    assert_eq!(beyond.motions, 3);
    assert!(beyond.bounded_worst_percent < beyond.unbounded_worst_percent);
}

#[test]
fn a_walk_of_keys_goes_on_and_skates_less_than_on_the_spot() {
    let names = [
        "walk_1_heel_strike_r",
        "walk_3_passing_r",
        "walk_5_heel_strike_l",
        "walk_7_passing_l",
    ];
    let walk = TrueMotion::between("walk".to_owned(), poses(&names), 0.25, true);
    let gaits = report(&[], &[walk]).gaits;
    assert_eq!(gaits.gaits, 3);
    assert!(
        gaits.grounded_percent < 0.5 * gaits.still_percent,
        "{gaits:?}"
    );
    assert!((0.4..2.5).contains(&gaits.speed_m_per_s), "{gaits:?}");
    // A foot that is held does not skate, and the other one is seldom down.
    assert!(
        gaits.true_percent < 25.0 && gaits.true_percent <= gaits.true_below_5_cm_percent,
        "{gaits:?}"
    );
}

#[test]
fn clips_of_a_rig_are_motions_and_those_that_go_round_are_gaits() {
    let mut rig = RIG.clone();
    let [a, b] = <[Pose; 2]>::try_from(poses(&["stand_at_ease", "wave"])).unwrap();
    let clip = |name: &str, poses: Vec<Pose>| Clip {
        name: name.to_owned(),
        times_s: (0..poses.len()).map(|i| 0.1 * i as f32).collect(),
        poses,
    };
    let there = vec![
        a.clone(),
        a.clone(),
        b.clone(),
        b.clone(),
        b.clone(),
        b.clone(),
    ];
    let round = vec![a.clone(), b.clone(), a.clone()];
    rig.clips = vec![
        clip("there", there),
        clip("round", round),
        clip("still", vec![a]),
    ];
    let motions = clip_motions(&rig);
    let keys: Vec<&[usize]> = motions
        .iter()
        .map(|motion| motion.keys.as_slice())
        .collect();
    assert_eq!(keys, [&[0, 1, 2, 3, 5][..], &[0, 1, 2]]);
    let gaits = clip_gaits(&rig);
    assert_eq!(
        (gaits.len(), gaits[0].name.as_str(), gaits[0].poses.len()),
        (1, "round", 8)
    );
    assert!(gaits[0].is_loop && (gaits[0].poses[1].0 - 0.025).abs() < 1e-6);
    assert_eq!(report(&motions, &[]).between[0].motions, 6);
}

#[test]
fn motions_lead_to_the_nearest_poses() {
    let motions = held_out_motions(&named(&["stand_at_ease", "squat_deep", "contrapposto"]));
    assert_eq!(motions.len(), 6);
    assert_eq!(motions[0].name, "stand_at_ease - contrapposto");
    assert_eq!(motions[3].keys, [0, 1, 2]);
    assert!(held_out_motions(&named(&["wave", "hop"])).is_empty());
}
