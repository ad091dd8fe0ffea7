//! The default controls on the shipped rigs, which come with controls of their own to compare with.

use std::sync::LazyLock;

use glam::{Quat, Vec3};
use stick3d_figure::figure::Figure;

use super::default_controls;
use crate::pose::{Controls, PoseLibrary, PoseSampler, PoseValues, SampleKind};
use crate::rig::{Pose, Rig};

struct Body {
    rig: Rig,
    controls: Controls,
}

impl Body {
    fn of(figure: &Figure, bytes: &[u8]) -> Self {
        let rig = Rig::from_glb(bytes).unwrap();
        let spec = default_controls(&rig, figure).unwrap();
        let controls = Controls::bind(&spec, &rig).unwrap();
        Self { rig, controls }
    }

    fn set(&self, name: &str, degrees: f32) -> PoseValues {
        let mut values = self.controls.ease();
        values.degrees[self.controls.index(name, "test").unwrap()] = degrees;
        values
    }

    /// How far apart the heads of two bones are.
    fn span(&self, values: &PoseValues, from: &str, to: &str) -> f32 {
        let at = self.rig.bone_transforms(&self.controls.pose(values));
        let head = |name| at[self.rig.skeleton.bone_index(name).unwrap()].1;
        head(from).distance(head(to))
    }
}

static HORSE: LazyLock<Body> = LazyLock::new(|| {
    let bytes = include_bytes!("../../../../../assets/rigs/horse.glb");
    Body::of(Figure::horse(), bytes)
});
static HUMAN: LazyLock<Body> = LazyLock::new(|| {
    let bytes = include_bytes!("../../../../../assets/rigs/human.glb");
    Body::of(Figure::human(), bytes)
});

fn turn_deg(a: Quat, b: Quat) -> f32 {
    2.0 * (a.inverse() * b)
        .xyz()
        .length()
        .min(1.0)
        .asin()
        .to_degrees()
}

/// The largest difference between the rotations of two poses, degrees.
fn apart_deg(a: &Pose, b: &Pose) -> f32 {
    let pairs = a.rotations.iter().zip(&b.rotations);
    pairs.map(|(a, b)| turn_deg(*a, *b)).fold(0.0, f32::max)
}

#[test]
fn every_moment_of_the_clips_is_made_exactly_inside_the_limits() {
    let Body { rig, controls } = &*HORSE;
    assert!(rig.clips.len() > 5);
    for pose in rig.clips.iter().flat_map(|clip| clip.spread(7)) {
        let values = controls.unfold(&pose).expect("three axes for every bone");
        controls.check(&values, "unfolded").unwrap();
        // Bones that turn by half a degree in no clip have no controls.
        let apart = apart_deg(&controls.pose(&values), &pose);
        assert!(apart < 0.6, "{apart}");
    }
}

#[test]
fn knees_and_elbows_fold_the_short_way() {
    for (body, hinge, from, to) in [
        (&HUMAN, "lowerarm_l", "upperarm_l", "hand_l"),
        (&HUMAN, "calf_r", "thigh_r", "foot_r"),
        (&HORSE, "metacarpus_l", "forearm_l", "fore_hoof_l"),
        (&HORSE, "gaskin_r", "thigh_r", "metatarsus_r"),
        (&HORSE, "metatarsus_r", "gaskin_r", "hind_pastern_r"),
    ] {
        let name = format!("{hinge}.bend");
        let rest = body.span(&body.controls.ease(), from, to);
        let folded = body.span(&body.set(&name, 60.0), from, to);
        assert!(folded < 0.95 * rest, "{name}: {rest} becomes {folded}");
        let index = body.controls.index(&name, "test").unwrap();
        let control = &body.controls.list()[index];
        assert!(
            control.max_deg > 60.0 && control.min_deg > -80.0,
            "{control:?}"
        );
    }
}

#[test]
fn mirrored_values_are_the_mirrored_body() {
    for body in [&HORSE, &HUMAN] {
        let library = PoseLibrary::default();
        let mut sampler = PoseSampler::new(&body.rig, &body.controls, &library, 5);
        for _ in 0..20 {
            let values = sampler.sample_values(SampleKind::Free);
            let mirrored = body.controls.pose(&body.controls.mirror(&values));
            let direct = body.controls.mirror_pose(&body.controls.pose(&values));
            for (bone, (a, b)) in mirrored.rotations.iter().zip(&direct.rotations).enumerate() {
                let apart = turn_deg(*a, *b);
                assert!(
                    apart < 0.1,
                    "{}: {apart}",
                    body.rig.skeleton.bones[bone].name
                );
            }
        }
    }
}

#[test]
fn trunk_neck_and_tail_curve_and_limbs_may_be_exchanged() {
    let names: Vec<&str> = HORSE
        .controls
        .list()
        .iter()
        .map(|c| c.name.as_str())
        .collect();
    for name in [
        "trunk_curve.bend",
        "forehead_curve.side",
        "tail_curve.twist",
        "pelvis.yaw",
    ] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    // Four legs, neck and tail.
    assert_eq!(HORSE.controls.limb_count(), 6);
    // Two arms, two legs, the head.
    assert_eq!(HUMAN.controls.limb_count(), 5);
    let limb = |name: &str| {
        let index = HORSE.controls.index(name, "test").unwrap();
        HORSE.controls.limb_of(index)
    };
    assert_eq!(limb("metacarpus_l.bend"), limb("forearm_l.twist"));
    assert_ne!(limb("metacarpus_l.bend"), limb("metacarpus_r.bend"));
    assert_eq!(limb("trunk_curve.bend"), None);
    // An arm that is held out at rest can be lowered to the body.
    let lowered = HUMAN.controls.index("upperarm_l.side", "test").unwrap();
    assert!(HUMAN.controls.list()[lowered].min_deg < -25.0);
}

#[test]
fn a_library_is_made_of_clips_in_stretches_or_of_limits() {
    let Body { rig, controls } = &*HORSE;
    let library = PoseLibrary::from_clips(controls, 100);
    assert!(
        (70..150).contains(&library.poses.len()),
        "{}",
        library.poses.len()
    );
    let of = |clip: &str| {
        let moments = library
            .poses
            .iter()
            .filter(|pose| pose.name.starts_with(clip));
        moments.count() as f32
    };
    assert!(
        of("Gallop@") > of("Idle@"),
        "what moves more has more moments"
    );
    assert!(library.poses.iter().all(|pose| pose.clip_miss_rad == 0.0));
    let (trained, held_out) = library.split(1, 0.1);
    assert!(held_out.poses.len() >= 5);
    for pose in &held_out.poses {
        assert!(
            trained
                .poses
                .iter()
                .all(|other| other.family != pose.family)
        );
    }
    let mut few = PoseLibrary::default();
    few.fill(rig, controls, 12);
    assert_eq!(few.poses.len(), 12);
    let again = {
        let mut again = PoseLibrary::default();
        again.fill(rig, controls, 12);
        again
    };
    assert_eq!(few, again);
}

#[test]
fn a_joint_on_a_bone_that_is_not_there_is_answered_with_the_nearest() {
    let text = Figure::horse()
        .to_ron()
        .unwrap()
        .replace("metacarpus_r", "metacarpals_r");
    let figure = Figure::from_ron(&text).unwrap();
    let error = default_controls(&HORSE.rig, &figure)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("metacarpals_r") && error.contains("`metacarpus_r`"),
        "{error}"
    );
}

#[test]
fn an_asymmetric_skeleton_has_controls_without_mirrors() {
    let mut rig = HORSE.rig.clone();
    for bone in rig
        .skeleton
        .bones
        .iter_mut()
        .filter(|bone| bone.name.ends_with("_l"))
    {
        bone.head += Vec3::new(0.2, 0.1, 0.0);
    }
    let controls = Controls::bind(&default_controls(&rig, Figure::horse()).unwrap(), &rig).unwrap();
    let knee = controls.index("metacarpus_l_.bend", "test").unwrap();
    assert_eq!(controls.list()[knee].mirror, knee);
}
