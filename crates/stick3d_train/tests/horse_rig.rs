//! The shipped horse, `assets/rigs/horse.glb`: every claim that the project makes about its rig.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{Quat, Vec3};
use stick3d_figure::Figure;
use stick3d_train::rig::{Pose, Rig, regressor};

fn rigs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/rigs")
}

fn file() -> Vec<u8> {
    std::fs::read(rigs().join("horse.glb")).unwrap()
}

fn rig() -> Rig {
    Rig::from_glb(&file()).unwrap()
}

fn head(rig: &Rig, bone: &str) -> Vec3 {
    rig.skeleton.bones[rig.skeleton.bone_index(bone).unwrap()].head
}

fn bent(rig: &Rig, bone: &str, axis: Vec3, degrees: f32) -> Pose {
    let mut pose = Pose::rest(rig.skeleton.bones.len());
    let bone = rig.skeleton.bone_index(bone).unwrap();
    pose.rotations[bone] = Quat::from_axis_angle(axis, degrees.to_radians());
    pose
}

#[test]
fn the_surface_is_one_closed_sphere_of_the_promised_size() {
    let rig = rig();
    assert_eq!(rig.mesh.positions.len(), 19_248);
    assert_eq!(rig.mesh.triangles.len(), 38_492);
    let report = rig.mesh.topology();
    assert!(report.closed && report.consistently_wound, "{report:?}");
    assert_eq!(report.euler_characteristic, 2);
    assert_eq!(report.genus, Some(0));
    assert_eq!(report.components, 1);
    assert_eq!(report.pinched_vertices, 0);
    assert_eq!(report.used_vertices, 19_248);
    // A horse weighs as many kilograms as it displaces litres.
    let litres = rig.mesh.volume() * 1000.0;
    assert!((430.0..560.0).contains(&litres), "{litres} l");
    assert!(file().len() < 3_000_000, "{} bytes", file().len());
}

#[test]
fn it_stands_on_the_ground_walks_along_x_and_shows_its_right_to_plus_z() {
    let rig = rig();
    let (low, high) = rig.mesh.bounds();
    assert!(
        low.y.abs() < 1e-5 && (high.y - 2.06).abs() < 0.03,
        "{low} {high}"
    );
    assert!((low.z + high.z).abs() < 0.02, "{low} {high}");
    assert!(head(&rig, "head").x > 1.0 && head(&rig, "tail_07").x < -0.8);
    for bone in [
        "scapula",
        "forearm",
        "fore_hoof",
        "thigh",
        "hind_hoof",
        "ear",
    ] {
        assert!(head(&rig, &format!("{bone}_r")).z > 0.02, "{bone}");
        assert!(head(&rig, &format!("{bone}_l")).z < -0.02, "{bone}");
    }
    let withers = rig
        .mesh
        .positions
        .iter()
        .filter(|p| (0.30..0.40).contains(&p.x))
        .map(|p| p.y)
        .fold(0.0, f32::max);
    assert!((1.48..1.62).contains(&withers), "{withers}");
}

#[test]
fn few_bones_move_a_vertex_and_every_bone_moves_some() {
    let rig = rig();
    let mut followed = vec![0.0; rig.skeleton.bones.len()];
    for list in &rig.influences {
        assert!((1..=8).contains(&list.len()));
        let sum: f32 = list.iter().map(|&(_, weight)| weight).sum();
        assert!((sum - 1.0).abs() < 1e-4);
        for &(bone, weight) in list {
            followed[usize::from(bone)] += weight;
        }
    }
    for (bone, weight) in rig.skeleton.bones.iter().zip(followed) {
        assert!(weight > 20.0, "`{}` moves {weight} vertices", bone.name);
    }
}

#[test]
fn hooves_are_carried_by_the_legs() {
    let rig = rig();
    let mut posed = Vec::new();
    for (leg, hoof) in [
        ("forearm", "fore_hoof"),
        ("metacarpus", "fore_hoof"),
        ("thigh", "hind_hoof"),
        ("metatarsus", "hind_hoof"),
    ] {
        for side in ["l", "r"] {
            let (leg, hoof) = (format!("{leg}_{side}"), format!("{hoof}_{side}"));
            rig.skin(&bent(&rig, &leg, Vec3::Z, 40.0), &mut posed);
            let bone = rig.skeleton.bone_index(&hoof).unwrap();
            let knee = head(&rig, &leg);
            let turn = Quat::from_rotation_z(40.0_f32.to_radians());
            let mut of_hoof = 0;
            for (vertex, list) in rig.influences.iter().enumerate() {
                let whole = list
                    .iter()
                    .any(|&(b, w)| usize::from(b) == bone && w > 0.99);
                if whole {
                    let expected = knee + turn * (rig.mesh.positions[vertex] - knee);
                    assert!(posed[vertex].distance(expected) < 2e-3, "{hoof} {vertex}");
                    of_hoof += 1;
                }
            }
            assert!(of_hoof > 50, "{hoof} has {of_hoof} vertices of its own");
        }
    }
}

#[test]
fn coat_hair_hooves_muzzle_and_eyes_keep_their_colours() {
    let rig = rig();
    let mut counts: BTreeMap<[u8; 4], usize> = BTreeMap::new();
    for color in &rig.colors {
        *counts.entry(*color).or_default() += 1;
    }
    for (what, color, least) in [
        ("coat", [50, 23, 8, 255], 4000),
        ("hooves", [38, 34, 28, 255], 400),
        ("muzzle", [12, 9, 5, 255], 200),
        ("white of the eyes", [124, 124, 124, 255], 8),
        ("black of the eyes", [2, 2, 2, 255], 100),
    ] {
        let count = counts.get(&color).copied().unwrap_or(0);
        assert!(count >= least, "{what}: {count} vertices");
    }
    let of = |wanted: &dyn Fn(Vec3) -> bool, vertex_is: &dyn Fn([u8; 4]) -> bool| {
        let (mut all, mut yes) = (0, 0);
        for (point, color) in rig.mesh.positions.iter().zip(&rig.colors) {
            if wanted(*point) {
                all += 1;
                yes += usize::from(vertex_is(*color));
            }
        }
        yes as f32 / all as f32
    };
    let dark = |color: [u8; 4]| color[0] < 26;
    // The tail hangs free behind; the soles are horn all over; the barrel is coat.
    assert!(
        of(
            &|p| p.x < -0.80 && p.y > 0.4 && p.y < 1.2 && p.z.abs() < 0.1,
            &dark
        ) > 0.9
    );
    assert_eq!(of(&|p| p.y < 0.02, &|c| c == [38, 34, 28, 255]), 1.0);
    assert_eq!(
        of(&|p| p.x.abs() < 0.2 && p.y > 1.0, &|c| c
            == [50, 23, 8, 255]),
        1.0
    );
}

#[test]
fn joints_lie_where_one_draws_them() {
    let (rig, figure) = (rig(), Figure::horse());
    let regressor = regressor(figure, &rig).unwrap();
    regressor.validate(rig.mesh.positions.len()).unwrap();
    let joints = regressor.joints(&rig.mesh.positions);
    for (joint, expected) in [
        ("forehead", Vec3::new(1.27, 1.85, 0.0)),
        ("shoulder", Vec3::new(0.54, 1.20, 0.0)),
        ("hip", Vec3::new(-0.54, 1.27, 0.0)),
        ("knee_fr", Vec3::new(0.60, 0.51, 0.18)),
        ("knee_bl", Vec3::new(-0.79, 0.57, -0.18)),
        ("foot_fl", Vec3::new(0.60, 0.06, -0.18)),
        ("foot_br", Vec3::new(-0.74, 0.06, 0.18)),
        ("tail", Vec3::new(-0.91, 0.54, 0.0)),
    ] {
        let found = joints[figure.joint_index(joint).unwrap()];
        assert!(found.distance(expected) < 0.06, "{joint}: {found}");
    }
}

#[test]
fn joints_stay_on_their_anchors_when_bent() {
    let (rig, figure) = (rig(), Figure::horse());
    let regressor = regressor(figure, &rig).unwrap();
    let mut posed = Vec::new();
    for (joint, bone, nearby) in [
        ("knee_fr", "metacarpus_r", "forearm_r"),
        ("knee_bl", "metatarsus_l", "gaskin_l"),
        ("foot_fl", "fore_hoof_l", "fore_pastern_l"),
        ("foot_br", "hind_hoof_r", "hind_pastern_r"),
        ("tail", "tail_07", "tail_05"),
    ] {
        let joint_index = figure.joint_index(joint).unwrap();
        let bone_index = rig.skeleton.bone_index(bone).unwrap();
        for turned in [bone, nearby] {
            for degrees in [-50.0, 50.0] {
                let pose = bent(&rig, turned, Vec3::Z, degrees);
                rig.skin(&pose, &mut posed);
                let anchor = rig.bone_transforms(&pose)[bone_index].1;
                let miss = regressor.joints(&posed)[joint_index].distance(anchor);
                assert!(
                    miss < 0.02,
                    "{joint}: {miss} m with `{turned}` at {degrees}"
                );
            }
        }
    }
}

#[test]
fn the_clips_came_along() {
    let rig = rig();
    let durations_s = [
        ("Walk", 1.167),
        ("Gallop", 0.6),
        ("Gallop_Jump", 1.467),
        ("Eating", 6.0),
        ("Attack_Kick", 1.0),
        ("Death", 1.0),
    ];
    for (name, seconds) in durations_s {
        let clip = rig.clips.iter().find(|clip| clip.name == name).unwrap();
        assert!((clip.duration_s() - seconds).abs() < 0.05, "{name}");
    }
    // Half a gallop's stride apart, the neck and the legs are elsewhere, and the feet never far below.
    let gallop = rig.clips.iter().find(|clip| clip.name == "Gallop").unwrap();
    let at = |time_s| rig.bone_transforms(&gallop.sample(time_s).unwrap());
    let hoof = rig.skeleton.bone_index("fore_hoof_r").unwrap();
    assert!(at(0.0)[hoof].1.distance(at(0.3)[hoof].1) > 0.2);
    for pose in &gallop.poses {
        for (bone, (_, head)) in rig.skeleton.bones.iter().zip(rig.bone_transforms(pose)) {
            assert!(head.y > -0.05 && head.y < 2.3, "{}: {head}", bone.name);
        }
    }
}
