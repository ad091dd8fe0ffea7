//! Guesses of the shipped rigs, held against the figures that were made for them by hand.

use std::path::Path;
use std::sync::LazyLock;

use glam::{Quat, Vec3};
use stick3d_figure::{Anchor, Figure};

use crate::guess::template::unit_m;
use crate::guess::{Guess, direction, guess};
use crate::rig::{Rig, regressor};

fn read(file: &str) -> Rig {
    let rigs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/rigs");
    Rig::from_glb(&std::fs::read(rigs.join(file)).unwrap()).unwrap()
}

static HUMAN: LazyLock<Rig> = LazyLock::new(|| read("human.glb"));
static HORSE: LazyLock<Rig> = LazyLock::new(|| read("horse.glb"));
static MAN: LazyLock<Guess> = LazyLock::new(|| guess(&HUMAN, "man").unwrap());
static MARE: LazyLock<Guess> = LazyLock::new(|| guess(&HORSE, "mare").unwrap());

/// Where an anchor is at rest; regressors are exact there.
fn place(anchor: &Anchor, rig: &Rig) -> Vec3 {
    let points: Vec<Vec3> = match anchor {
        Anchor::Bones(names) => {
            let head = |name| rig.skeleton.bones[rig.skeleton.bone_index(name).unwrap()].head;
            names.iter().map(|name| head(name)).collect()
        }
        Anchor::Vertices(vertices) => {
            let at = |&vertex: &u32| rig.mesh.positions[vertex as usize];
            vertices.iter().map(at).collect()
        }
    };
    points.iter().sum::<Vec3>() / points.len() as f32
}

fn assert_near(guess: &Guess, figure: &Figure, rig: &Rig, bar_m: f32) {
    assert_eq!(guess.faults, [], "{:?}", guess.notes);
    assert_eq!(guess.figure.path, figure.path);
    let at = |figure: &Figure| -> Vec<Vec3> {
        let anchors = figure.joints.iter().map(|joint| &joint.anchor);
        anchors.map(|anchor| place(anchor, rig)).collect()
    };
    let (guessed, made) = (at(&guess.figure), at(figure));
    for (joint, (guessed, made)) in figure.joints.iter().zip(guessed.iter().zip(&made)) {
        let miss_m = guessed.distance(*made);
        let name = &joint.name;
        assert!(
            miss_m <= bar_m,
            "{name} is at {guessed}, {miss_m} m from {made}"
        );
    }
}

/// The same body with numbers instead of names.
fn nameless(rig: &Rig) -> Rig {
    let mut rig = rig.clone();
    for (number, bone) in rig.skeleton.bones.iter_mut().enumerate() {
        bone.name = format!("bone_{number:03}");
    }
    rig
}

fn turned(rig: &Rig, degrees: f32) -> Rig {
    let turn = Quat::from_rotation_y(degrees.to_radians());
    let mut rig = rig.clone();
    for bone in &mut rig.skeleton.bones {
        bone.head = turn * bone.head;
    }
    for position in &mut rig.mesh.positions {
        *position = turn * *position;
    }
    rig
}

#[test]
fn the_shipped_man_is_guessed_within_three_centimetres() {
    let guess = &*MAN;
    assert_near(guess, Figure::human(), &HUMAN, 0.03);
    assert_eq!(direction(guess.forward), "+Z");
    assert_eq!(guess.figure.name, "man");
    let neck = guess.figure.joint_index("neck").unwrap();
    assert_eq!(
        guess.figure.joints[neck].anchor,
        Anchor::Bones(vec!["neck_01".to_owned()])
    );
}

#[test]
fn the_shipped_horse_is_guessed_within_five_centimetres() {
    let guess = &*MARE;
    assert_near(guess, Figure::horse(), &HORSE, 0.05);
    assert_eq!(direction(guess.forward), "+X");
    assert_eq!(guess.figure.views, Figure::horse().views);
}

#[test]
fn without_names_both_are_guessed_by_shape_within_six_centimetres() {
    let man = nameless(&HUMAN);
    assert_near(
        &guess(&man, "man").unwrap(),
        &renamed(Figure::human(), &HUMAN),
        &man,
        0.06,
    );
    let mare = nameless(&HORSE);
    assert_near(
        &guess(&mare, "mare").unwrap(),
        &renamed(Figure::horse(), &HORSE),
        &mare,
        0.06,
    );
}

/// A figure whose anchors are those of a rig, for the same rig with numbers for names.
fn renamed(figure: &Figure, rig: &Rig) -> Figure {
    let mut figure = figure.clone();
    for joint in &mut figure.joints {
        if let Anchor::Bones(names) = &mut joint.anchor {
            for name in names {
                *name = format!("bone_{:03}", rig.skeleton.bone_index(name).unwrap());
            }
        }
    }
    figure
}

#[test]
fn the_template_is_the_same_whichever_way_the_rig_faces() {
    for (rig, straight) in [(&HUMAN, &MAN), (&HORSE, &MARE)] {
        let about = guess(&turned(rig, 90.0), "body").unwrap();
        let template = &straight.figure.template;
        for (one, other) in template.iter().zip(&about.figure.template) {
            assert!(one.distance(*other) < 2e-3, "{one} {other}");
        }
        let forward = Quat::from_rotation_y(90_f32.to_radians()) * straight.forward;
        assert!(about.forward.abs_diff_eq(forward, 1e-4));
    }
}

#[test]
fn a_file_in_centimetres_gives_a_template_in_metres() {
    let mut rig = HUMAN.clone();
    assert_eq!(unit_m(&rig), 1.0);
    for position in &mut rig.mesh.positions {
        *position *= 100.0;
    }
    assert_eq!(unit_m(&rig), 0.01);
}

#[test]
fn the_template_is_the_body_as_it_is_usually_drawn() {
    let man = &MAN.figure;
    let at = |figure: &Figure, name: &str| figure.template[figure.joint_index(name).unwrap()];
    assert!(
        at(man, "hand_r").x < -0.4 && at(man, "hand_l").x > 0.4,
        "his right is on the left"
    );
    assert!((1.6..1.8).contains(&at(man, "forehead").y));
    let mare = &MARE.figure;
    assert!(
        at(mare, "forehead").x > at(mare, "shoulder").x,
        "she walks to the right"
    );
    assert!(
        at(mare, "foot_fl").x > at(mare, "foot_fr").x + 0.1,
        "far legs are a step ahead"
    );
    for joint in 0..mare.joint_count() {
        let likely = Figure::horse().template[joint];
        assert!(
            mare.template[joint].distance(likely) < 0.1,
            "{}",
            mare.joints[joint].name
        );
    }
}

/// Gives what follows the bones below one, itself included, to another; of `spared` vertices each keeps its own.
fn hand_over(rig: &mut Rig, from: &str, to: &str, mut spared: usize) {
    let [from, to] = [from, to].map(|name| rig.skeleton.bone_index(name).unwrap());
    for list in &mut rig.influences {
        let follows = |bone: u16| rig.skeleton.is_below(usize::from(bone), from);
        if spared > 0 && follows(list[0].0) {
            spared -= 1;
            continue;
        }
        for (bone, _) in list.iter_mut().filter(|(bone, _)| follows(*bone)) {
            *bone = to as u16;
        }
        list.sort_by_key(|&(bone, _)| bone);
        list.dedup_by(|next, first| {
            let same = next.0 == first.0;
            first.1 += if same { next.1 } else { 0.0 };
            same
        });
        list.sort_by(|a, b| b.1.total_cmp(&a.1));
    }
}

/// How far the hand of a guess, where training finds it on the surface, is from a bone's head.
fn hand_from(rig: &Rig, bone: &str) -> f32 {
    let guess = guess(rig, "man").unwrap();
    assert_eq!(guess.faults, []);
    let hand = guess.figure.joint_index("hand_l").unwrap();
    let regressor = regressor(&guess.figure, rig).unwrap();
    let found = regressor.joints(&rig.mesh.positions)[hand];
    found.distance(rig.skeleton.bones[rig.skeleton.bone_index(bone).unwrap()].head)
}

#[test]
fn a_hand_without_bones_of_its_own_is_at_the_end_of_the_arm() {
    let mut rig = HUMAN.clone();
    hand_over(&mut rig, "hand_l", "lowerarm_l", 0);
    let from_knuckles = hand_from(&rig, "middle_01_l");
    assert!(from_knuckles < 0.12, "{from_knuckles}");
}

#[test]
fn a_hand_that_hardly_any_surface_surrounds_stays_at_the_knuckles() {
    let mut rig = HUMAN.clone();
    hand_over(&mut rig, "middle_01_l", "hand_l", 2);
    let from_knuckles = hand_from(&rig, "middle_01_l");
    assert!(from_knuckles < 0.02, "{from_knuckles}");
}
