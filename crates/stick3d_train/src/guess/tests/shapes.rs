//! Bodies whose names say little or nothing, bodies with more or less than usual, and none at all.

use std::sync::LazyLock;

use glam::Vec3;
use proptest::prelude::*;

use super::bodies::Sample;
use super::{GuessError, HORSE, MAN, expected, find_in, found, in_words};

/// A man whose limbs are as many bones as joints.
static PLAIN_MAN: LazyLock<Sample> = LazyLock::new(|| {
    let lines = "
Hips | pelvis
  Spine | spine1
    Chest | spine2
      UpperChest | spine3
        Neck | neck
          Head | head
            Jaw | jaw
            Eye.L | eye_l
        Shoulder.L | clavicle_l
          UpperArm.L | upperarm_l
            LowerArm.L | forearm_l
              Hand.L | hand_l
                Thumb1.L | thumb1_l
                  Thumb2.L | thumb2_l
                Index1.L | index1_l
                  Index2.L | index2_l
                Middle1.L | middle1_l
                  Middle2.L | middle2_l
                Pinky1.L | pinky1_l
                  Pinky2.L | pinky2_l
  UpperLeg.L | thigh_l
    LowerLeg.L | calf_l
      Foot.L | foot_l
        Toe.L | toe_l
";
    Sample::man(lines, (".L", ".R"))
});

static PLAIN_HORSE: LazyLock<Sample> = LazyLock::new(|| {
    let lines = "
Hips | hips
  Spine1 | spine1
    Spine2 | spine2
      Chest | chest
        Neck1 | neck1
          Neck2 | neck2
            Head | head
              Jaw | jaw
              Ear1.L | ear_l
                Ear2.L | ear2_l
        FrontLeg1.L | scapula_l
          FrontLeg2.L | humerus_l
            FrontLeg3.L | forearm_l
              FrontLeg4.L | carpus_l
                FrontLeg5.L | fpastern_l
                  FrontLeg6.L | fhoof_l
  HindLeg1.L | thigh_l
    HindLeg2.L | stifle_l
      HindLeg3.L | hock_l
        HindLeg4.L | bpastern_l
          HindLeg5.L | bhoof_l
  Tail1 | tail1
    Tail2 | tail2
      Tail3 | tail3
        Tail4 | tail4
";
    Sample::horse(lines, (".L", ".R"))
});

/// What is found of a man by his shape alone: hands as a whole, hips instead of a pelvis.
const SHAPE_OF_A_MAN: &str = "
    hand_*: middle of hand_*
    abdomen: thigh_l+thigh_r
";

#[test]
fn a_man_without_names_is_found_by_his_shape_whichever_way_he_faces() {
    let mut wanted = expected(MAN);
    wanted.extend(expected(SHAPE_OF_A_MAN));
    for degrees in [0.0, 90.0, 180.0, -90.0] {
        let sample = PLAIN_MAN.clone().nameless().turned(degrees);
        assert_eq!(found(&sample), wanted, "{degrees}");
        let (sin, cos) = f32::to_radians(degrees).sin_cos();
        let faces = find_in(&sample).unwrap().forward;
        assert!(faces.abs_diff_eq(Vec3::new(sin, 0.0, cos), 1e-5), "{faces}");
    }
}

#[test]
fn a_horse_without_names_is_found_by_its_shape_whichever_way_it_walks() {
    for degrees in [0.0, 90.0, 180.0, -90.0] {
        let sample = PLAIN_HORSE.clone().nameless().turned(degrees);
        assert_eq!(found(&sample), expected(HORSE), "{degrees}");
        let (sin, cos) = f32::to_radians(degrees).sin_cos();
        let found = find_in(&sample).unwrap();
        assert!(found.right.abs_diff_eq(Vec3::new(sin, 0.0, cos), 1e-5));
        assert_eq!(found.like.name, "horse");
    }
}

#[test]
fn a_body_may_face_between_the_axes_if_its_names_have_sides() {
    for (sample, wanted) in [(&PLAIN_MAN, MAN), (&PLAIN_HORSE, HORSE)] {
        let sample = (*sample).clone().turned(37.0);
        assert_eq!(found(&sample), expected(wanted));
    }
}

#[test]
fn sides_are_told_by_place_where_names_do_not_say() {
    // As Blender numbers what has one name already.
    let mut sample = PLAIN_MAN.clone();
    for bone in &mut sample.skeleton.bones {
        bone.name = bone.name.replace(".L", "").replace(".R", ".001");
    }
    assert_eq!(found(&sample), expected(MAN));
    let mut twice = PLAIN_HORSE.clone();
    for bone in &mut twice.skeleton.bones {
        bone.name = bone.name.replace(".L", "").replace(".R", ".001");
    }
    assert_eq!(found(&twice), expected(HORSE));
}

#[test]
fn names_tell_pairs_in_a_pose_that_is_not_symmetric() {
    let mut sample = PLAIN_HORSE.clone();
    for (key, step) in [("carpus", 0.2), ("fpastern", 0.25), ("fhoof", 0.3)] {
        for (side, way) in [("l", 1.0), ("r", -1.0)] {
            let at = sample.at(&format!("{key}_{side}"));
            sample.skeleton.bones[at].head.z += way * step;
            sample.flesh[at].middle.z += way * step;
        }
    }
    assert_eq!(found(&sample), expected(HORSE));
}

#[test]
fn feet_that_point_backward_and_heads_behind_are_said() {
    // Left and right of the names exchanged.
    let swapped = |sample: &Sample| {
        let mut sample = sample.clone();
        for bone in &mut sample.skeleton.bones {
            bone.name = match bone.name.strip_suffix(".L") {
                Some(stem) => format!("{stem}.R"),
                None => bone.name.replace(".R", ".L"),
            };
        }
        find_in(&sample).unwrap()
    };
    let man = swapped(&PLAIN_MAN);
    assert!(man.notes[0].contains("backward"), "{:?}", man.notes);
    let horse = swapped(&PLAIN_HORSE);
    assert!(
        horse.notes[0].contains("count as right"),
        "{:?}",
        horse.notes
    );
    // An animal's head leaves no doubt: its own left is left.
    assert_eq!(in_words(&PLAIN_HORSE, &horse), expected(HORSE));
}

#[test]
fn two_candidates_are_both_named() {
    let mut sample = PLAIN_MAN.clone();
    for (side, x) in [("L", 1.0), ("R", -1.0)] {
        let below = format!("UpperArm2.{side}");
        sample.add(&below, Some("spine2"), Vec3::new(0.2 * x, 1.2, 0.0), 1.0);
        let arm = Vec3::new(0.45 * x, 1.2, 0.0);
        let (elbow, hand) = (format!("LowerArm2.{side}"), format!("Fingers2.{side}"));
        sample.add(&elbow, Some(&below), arm, 1.0);
        let end = Vec3::new(0.85 * x, 1.2, 0.0);
        sample.add(&hand, Some(&elbow), end, 1.0);
    }
    let elbow = &found(&sample)["elbow_l"];
    for name in ["elbow_l", "`LowerArm.L`", "`LowerArm2.L`"] {
        assert!(elbow.contains(name), "{elbow}");
    }
    // Without names four arms are as doubtful.
    let nameless = found(&sample.nameless());
    assert!(nameless["elbow_l"].contains("both bone"), "{nameless:?}");
    assert_eq!(nameless["knee_l"], "calf_l");
}

#[test]
fn what_is_not_there_is_said_with_what_is_near() {
    let lines = "
Hips | pelvis
  Torso | spine2
    Head | head
    Arm.L | upperarm_l
  Thigh.L | thigh_l
    Foot.L | foot_l
";
    let found = found(&Sample::man(lines, (".L", ".R")));
    let elbow = &found["elbow_r"];
    assert!(
        elbow.contains("\"elbow_r\": the arm is one bone"),
        "{elbow}"
    );
    assert!(elbow.contains("perhaps `Arm.R`"), "{elbow}");
    assert_eq!(found["hand_r"], "end of upperarm_r");
    let knee = &found["knee_l"];
    assert!(knee.contains("`Thigh.L` or `Foot.L`"), "{knee}");
    assert_eq!(found["neck"], "head", "the head's bone begins at the neck");
    assert_eq!(found["abdomen"], "pelvis");
}

#[test]
fn an_animal_without_tail_has_no_joint_for_one() {
    let mut wanted = expected(HORSE);
    wanted.remove("tail");
    for nameless in [false, true] {
        let mut sample = PLAIN_HORSE.clone();
        for key in ["tail1", "tail2", "tail3", "tail4"] {
            let at = sample.at(key);
            sample.flesh[at].weight = 0.0;
        }
        let sample = if nameless { sample.nameless() } else { sample };
        assert_eq!(found(&sample), wanted);
    }
}

#[test]
fn rigs_without_hands_and_feet_end_where_their_limbs_do() {
    let lines = "
a | pelvis
  b | spine2
    c | neck
      d | head
    e.L | upperarm_l
      f.L | forearm_l
  g.L | thigh_l
    h.L | calf_l
";
    let mut sample = Sample::man(lines, (".L", ".R"));
    for side in ["l", "r"] {
        // A shin's surface reaches to the sole.
        let at = sample.at(&format!("calf_{side}"));
        sample.flesh[at].low_m = 0.0;
    }
    let found = found(&sample);
    assert_eq!(found["hand_l"], "end of forearm_l");
    assert_eq!(found["elbow_r"], "forearm_r");
    assert_eq!(found["knee_l"], "calf_l");
    assert_eq!(found["foot_r"], "end of calf_r");
}

#[test]
fn a_snake_and_a_beetle_are_refused_with_reasons() {
    let mut snake = PLAIN_HORSE.clone();
    for bone in 0..snake.keys.len() {
        if snake.keys[bone].contains('_') {
            snake.flesh[bone].weight = 0.0;
        }
    }
    let error = find_in(&snake.nameless()).unwrap_err();
    assert!(matches!(error, GuessError::NoPairs { .. }), "{error}");
    assert!(error.to_string().contains("bone_000"), "{error}");

    let mut beetle = PLAIN_HORSE.clone();
    for (side, x) in [("L", 0.2), ("R", -0.2)] {
        let (top, foot) = (format!("MidLeg1.{side}"), format!("MidLeg2.{side}"));
        beetle.add(&top, Some("spine2"), Vec3::new(x, 1.1, 0.0), 1.0);
        beetle.add(&foot, Some(&top), Vec3::new(x, 0.05, 0.0), 1.0);
    }
    let error = find_in(&beetle).unwrap_err();
    assert!(matches!(&error, GuessError::ManyLegs { legs } if legs.len() == 6));
    assert!(error.to_string().contains("MidLeg1.L"), "{error}");

    let mut fish = PLAIN_MAN.clone().nameless();
    for key in ["thigh", "calf", "foot", "toe"] {
        for side in ["l", "r"] {
            let at = fish.at(&format!("{key}_{side}"));
            fish.flesh[at].weight = 0.0;
        }
    }
    for bone in 0..4 {
        let y = 0.7 - 0.2 * bone as f32;
        fish.add(
            &format!("tail{bone}"),
            Some("pelvis"),
            Vec3::new(0.0, y, 0.0),
            1.0,
        );
    }
    let error = find_in(&fish).unwrap_err();
    assert!(matches!(error, GuessError::NoLegs { .. }), "{error}");
}

/// Twists, targets and odds and ends beside a body's own bones.
fn with_helpers(mut sample: Sample, limbs: &[&str], shares: &[f32]) -> Sample {
    for (nth, (limb, share)) in limbs.iter().zip(shares.iter().cycle()).enumerate() {
        for side in ["l", "r"] {
            let key = format!("{limb}_{side}");
            let (from, below) = (sample.head(&key), sample.at(&key));
            let next = sample
                .skeleton
                .bones
                .iter()
                .find(|bone| bone.parent == Some(below))
                .map_or(from, |bone| bone.head);
            let mark = side.to_uppercase();
            let at = from.lerp(next, 0.9 * *share);
            sample.add(&format!("{limb}_twist{nth}.{mark}"), Some(&key), at, 0.6);
            let target = from + Vec3::new(0.0, -0.02, 0.4);
            sample.add(&format!("{limb}_ik_target{nth}.{mark}"), None, target, 0.0);
        }
    }
    sample.add("sword", Some("hand_r"), sample.head("hand_r"), 0.3);
    sample
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn neither_order_nor_helpers_change_what_is_found(
        numbers in prop::collection::vec(any::<u32>(), 97),
        shares in prop::collection::vec(0.05_f32..0.95, 1..7),
        nameless in any::<bool>(),
    ) {
        let limbs = ["upperarm", "forearm", "thigh", "calf"];
        let sample = with_helpers(PLAIN_MAN.clone(), &limbs, &shares).reordered(&numbers);
        let mut wanted = expected(MAN);
        let sample = if nameless {
            wanted.extend(expected(SHAPE_OF_A_MAN));
            sample.nameless()
        } else {
            sample
        };
        prop_assert_eq!(found(&sample), wanted);
    }

    #[test]
    fn neither_does_the_order_of_an_animals_bones(
        numbers in prop::collection::vec(any::<u32>(), 97),
        nameless in any::<bool>(),
    ) {
        let sample = PLAIN_HORSE.reordered(&numbers);
        let sample = if nameless { sample.nameless() } else { sample };
        prop_assert_eq!(found(&sample), expected(HORSE));
    }
}
