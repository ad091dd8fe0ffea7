//! Points found on our own bodies, held against the anchors that their rigs know.

use glam::{Quat, Vec3};

use super::*;
use crate::pose::{Controls, PoseLibrary};
use crate::rig::{Pose, Rig, regressor};

/// How far each joint is found from its anchor in a pose, by name, metres.
fn misses(
    preset: Preset,
    like: &Figure,
    rig: &Rig,
    pose: &Pose,
    stand: Quat,
) -> Vec<(String, f32)> {
    let mut mesh = rig.mesh.clone();
    rig.skin(pose, &mut mesh.positions);
    let anchors = regressor(like, rig).unwrap().joints(&mesh.positions);
    // Another heading and another unit: neither may matter.
    let unit = 39.4;
    mesh.positions
        .iter_mut()
        .for_each(|p| *p = unit * (stand * *p));
    let figure = preset.figure(&mesh).unwrap();
    assert_eq!(
        (figure.name.as_str(), &figure.path),
        (preset.name(), &like.path)
    );
    let found = crate::meshes::joint_regressor(&figure, mesh.positions.len()).unwrap();
    let found = found.joints(&mesh.positions);
    figure
        .joints
        .iter()
        .zip(found.iter().zip(anchors))
        .map(|(joint, (found, anchor))| {
            (
                joint.name.clone(),
                found.distance(unit * (stand * anchor)) / unit,
            )
        })
        .collect()
}

/// A shipped body with its pose library.
fn body(rig: &[u8], controls: &str, poses: &str) -> (Rig, Controls, PoseLibrary) {
    let rig = Rig::from_glb(rig).unwrap();
    let controls = Controls::from_ron(controls, &rig).unwrap();
    let library = PoseLibrary::from_ron(poses, &controls).unwrap();
    (rig, controls, library)
}

fn human() -> (Rig, Controls, PoseLibrary) {
    body(
        include_bytes!("../../../../assets/rigs/human.glb"),
        include_str!("../../../../assets/rigs/human.controls.ron"),
        include_str!("../../../../assets/poses/human.ron"),
    )
}

fn horse() -> (Rig, Controls, PoseLibrary) {
    body(
        include_bytes!("../../../../assets/rigs/horse.glb"),
        include_str!("../../../../assets/rigs/horse.controls.ron"),
        include_str!("../../../../assets/poses/horse.ron"),
    )
}

/// Holds a preset against a body: at rest every joint within `at_rest_m`, in other poses within `posed_m`.
fn check(
    preset: Preset,
    like: &Figure,
    (rig, controls, library): &(Rig, Controls, PoseLibrary),
    poses: &[&str],
    (at_rest_m, posed_m): (f32, f32),
) {
    let rest = Pose::rest(rig.skeleton.bones.len());
    let mut far = misses(preset, like, rig, &rest, Quat::IDENTITY);
    far.retain(|(_, miss)| *miss > at_rest_m);
    assert!(far.is_empty(), "at rest {far:?}");
    let turned = Quat::from_euler(glam::EulerRot::YXZ, 2.0, 0.7, -1.3);
    let mut far = vec![];
    for name in poses {
        let pose = library
            .poses
            .iter()
            .find(|pose| pose.name == *name)
            .unwrap();
        let pose = controls.pose(&pose.values);
        let misses = misses(preset, like, rig, &pose, turned);
        far.extend(
            misses
                .into_iter()
                .filter(|(_, miss)| *miss > posed_m)
                .map(|miss| (name, miss)),
        );
    }
    assert!(far.is_empty(), "{far:?}");
}

#[test]
fn joints_of_a_person_are_found_in_many_poses() {
    let poses = [
        "a_pose",
        "t_pose",
        "stand_at_ease",
        "walk_1_heel_strike_r",
        "hero",
        "march",
    ];
    check(
        Preset::Scape,
        Figure::human(),
        &human(),
        &poses,
        (0.035, 0.07),
    );
}

#[test]
fn joints_of_a_horse_are_found_in_many_poses() {
    let poses = [
        "stand",
        "stand_alert",
        "walk_1",
        "walk_4",
        "trot_1_support_lh_rf",
        "square_wide",
    ];
    check(
        Preset::ToscaHorse,
        Figure::horse(),
        &horse(),
        &poses,
        (0.09, 0.12),
    );
}

#[test]
fn a_horse_is_drawn_as_it_walks_to_the_right() {
    let (rig, ..) = horse();
    let turned = Quat::from_rotation_y(2.5);
    let mut mesh = rig.mesh.clone();
    mesh.positions.iter_mut().for_each(|p| *p = turned * *p);
    let figure = Preset::ToscaHorse.figure(&mesh).unwrap();
    assert_eq!(figure.views, Figure::horse().views);
    for (joint, (found, like)) in figure
        .joints
        .iter()
        .zip(figure.template.iter().zip(&Figure::horse().template))
    {
        // The drawn template steps; the body stands square.
        assert!(
            found.distance(*like) < 0.2,
            "{}: {found} {like}",
            joint.name
        );
    }
}

#[test]
fn the_template_is_the_pilot_seen_from_the_front() {
    let (rig, ..) = human();
    let turned = Quat::from_rotation_y(2.5);
    let mut mesh = rig.mesh.clone();
    mesh.positions.iter_mut().for_each(|p| *p = turned * *p);
    let figure = Preset::Scape.figure(&mesh).unwrap();
    let at = |name: &str| figure.template[figure.joint_index(name).unwrap()];
    assert!(at("forehead").y > 1.6 && at("foot_r").y < 0.1);
    assert!(at("hand_r").x < -0.3 && at("hand_l").x > 0.3);
    let sides = at("elbow_r").x + at("elbow_l").x;
    assert!(sides.abs() < 0.03, "{sides}");
}

#[test]
fn what_is_no_body_is_refused() {
    let sphere = |bumps: f32| {
        let (rings, round) = (20_u32, 40_u32);
        let mut mesh = TriangleMesh::default();
        for ring in 0..rings {
            for point in 0..round {
                let tilt = (0.1 + 0.9 * ring as f32 / rings as f32) * 3.0;
                let turn = point as f32 / round as f32 * std::f32::consts::TAU;
                let radius = 1.0 + bumps * (3.0 * turn).sin();
                mesh.positions.push(
                    radius
                        * Vec3::new(tilt.sin() * turn.cos(), tilt.cos(), tilt.sin() * turn.sin()),
                );
            }
        }
        for ring in 0..rings - 1 {
            for point in 0..round {
                let at = |ring: u32, point: u32| ring * round + point % round;
                let (a, b) = (at(ring, point), at(ring, point + 1));
                let (c, d) = (at(ring + 1, point + 1), at(ring + 1, point));
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        mesh
    };
    for preset in Preset::ALL {
        assert!(preset.figure(&TriangleMesh::default()).is_err());
        for bumps in [0.0, 0.2] {
            let refused = preset.figure(&sphere(bumps));
            assert!(refused.is_err(), "{:?}", refused.map(|f| f.template));
        }
    }
}
