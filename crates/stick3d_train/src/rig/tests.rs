//! Tests of reading, writing and skinning on a small rig: a square tube of three bones.

use glam::{Quat, Vec3};
use proptest::prelude::*;
use stick3d_figure::TriangleMesh;

use super::{Bone, Pose, Rig, RigError, Skeleton, Skinning};

/// A closed tube along +X from 0 to 4, bones at 0, 1.5 and 2.5, weights fading from one to the next.
fn tube() -> Rig {
    let (rings, mut mesh) = (17_u32, TriangleMesh::default());
    for ring in 0..rings {
        let x = ring as f32 * 0.25;
        mesh.positions.extend(
            [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)].map(|(y, z)| Vec3::new(x, y, z)),
        );
    }
    for ring in 0..rings - 1 {
        for step in 0..4 {
            let at = |ring: u32, step: u32| ring * 4 + step % 4;
            let (a, b) = (at(ring, step), at(ring, step + 1));
            let (c, d) = (at(ring + 1, step + 1), at(ring + 1, step));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let last = (rings - 1) * 4;
    mesh.triangles.extend([
        [0, 2, 1],
        [0, 3, 2],
        [last, last + 1, last + 2],
        [last, last + 2, last + 3],
    ]);
    let bone = |name: &str, parent, x, turn| Bone {
        name: name.into(),
        parent,
        head: Vec3::new(x, 0.0, 0.0),
        rest_rotation: Quat::from_rotation_z(turn) * Quat::from_rotation_y(0.3),
    };
    let bones = vec![
        bone("a", None, 0.0, 0.2),
        bone("b", Some(0), 1.5, -1.0),
        bone("c", Some(1), 2.5, 0.7),
    ];
    let influences = mesh.positions.iter().map(|point| fading(point.x)).collect();
    let colors = (0..mesh.positions.len() as u8)
        .map(|shade| [shade, 255 - shade, 7, 255])
        .collect();
    let copyright = Some("nobody".to_owned());
    Rig::new(
        "tube".into(),
        copyright,
        Skeleton { bones },
        mesh,
        colors,
        influences,
    )
    .unwrap()
}

fn fading(x: f32) -> Vec<(u16, f32)> {
    let b = ((x - 1.0).clamp(0.0, 1.0) - (x - 2.0).clamp(0.0, 1.0)).clamp(0.0, 1.0);
    let c = (x - 2.0).clamp(0.0, 1.0);
    let mut list = vec![(0, 1.0 - b - c), (1, b), (2, c)];
    list.retain(|&(_, weight)| weight > 0.0);
    list.sort_by(|l, r| r.1.total_cmp(&l.1));
    list
}

#[test]
fn a_rig_survives_its_file() {
    let rig = tube();
    let report = rig.mesh.topology();
    assert!(report.closed && report.consistently_wound, "{report:?}");
    assert!(rig.mesh.volume() > 0.0, "{}", rig.mesh.volume());
    let bytes = rig.to_glb().unwrap();
    assert_eq!(
        bytes,
        rig.to_glb().unwrap(),
        "the same rig gives the same bytes"
    );
    let read = Rig::from_glb(&bytes).unwrap();
    assert_eq!((&read.name, &read.copyright), (&rig.name, &rig.copyright));
    assert_eq!(
        (&read.colors, &read.mesh.triangles),
        (&rig.colors, &rig.mesh.triangles)
    );
    for (read, written) in read.mesh.positions.iter().zip(&rig.mesh.positions) {
        assert!(read.abs_diff_eq(*written, 1e-5));
    }
    for (read, written) in read.skeleton.bones.iter().zip(&rig.skeleton.bones) {
        assert_eq!((&read.name, read.parent), (&written.name, written.parent));
        assert!(read.head.abs_diff_eq(written.head, 1e-5));
        assert!(read.rest_rotation.dot(written.rest_rotation).abs() > 1.0 - 1e-5);
    }
    for (read, written) in read.influences.iter().zip(&rig.influences) {
        assert_eq!(read.len(), written.len());
        assert!(
            read.iter()
                .zip(written)
                .all(|(r, w)| r.0 == w.0 && (r.1 - w.1).abs() < 1e-4)
        );
    }
}

#[test]
fn eight_influences_and_many_bones_survive_too() {
    let mut rig = tube();
    for extra in 3..300_u16 {
        let head = Vec3::X * f32::from(extra);
        let name = format!("bone {extra}");
        rig.skeleton.bones.push(Bone {
            name,
            parent: Some(2),
            head,
            rest_rotation: Quat::IDENTITY,
        });
    }
    let weights = [0.3, 0.2, 0.15, 0.1, 0.1, 0.05, 0.05, 0.05];
    rig.influences[5] = [7, 299, 1, 0, 280, 33, 2, 90]
        .into_iter()
        .zip(weights)
        .collect();
    let read = Rig::from_glb(&rig.to_glb().unwrap()).unwrap();
    assert_eq!(read.influences[5].len(), 8);
    for (bone, weight) in &rig.influences[5] {
        assert!(
            read.influences[5]
                .iter()
                .any(|(b, w)| b == bone && (w - weight).abs() < 1e-4)
        );
    }
}

#[test]
fn rest_and_rigid_motions_are_exact_with_every_method() {
    let rig = tube();
    let mut out = Vec::new();
    for method in [
        Skinning::Linear,
        Skinning::DualQuaternion,
        Skinning::CenterOfRotation,
    ] {
        rig.skin_with(method, &Pose::rest(3), &mut out);
        assert!(
            out.iter()
                .zip(&rig.mesh.positions)
                .all(|(a, b)| a.abs_diff_eq(*b, 1e-5))
        );
        let mut pose = Pose::rest(3);
        pose.rotations[0] = Quat::from_rotation_y(2.0);
        pose.root_translation = Vec3::new(1.0, 2.0, 3.0);
        rig.skin_with(method, &pose, &mut out);
        for (moved, rest) in out.iter().zip(&rig.mesh.positions) {
            let expected = pose.rotations[0] * *rest + pose.root_translation;
            assert!(
                moved.abs_diff_eq(expected, 1e-4),
                "{method:?}: {moved} {expected}"
            );
        }
    }
}

#[test]
fn a_twist_does_not_wring_the_tube() {
    let rig = tube();
    let mut pose = Pose::rest(3);
    pose.rotations[1] = Quat::from_rotation_x(170_f32.to_radians());
    let kept = |method| {
        let mut mesh = rig.mesh.clone();
        rig.skin_with(method, &pose, &mut mesh.positions);
        let ring = &mesh.positions[24..28];
        ring.iter()
            .map(|p| p.with_x(0.0).length())
            .fold(f32::INFINITY, f32::min)
            / 0.3_f32.hypot(0.3)
    };
    assert!(kept(Skinning::Linear) < 0.2);
    assert!(kept(Skinning::DualQuaternion) > 0.99);
    assert!(kept(Skinning::CenterOfRotation) > 0.95);
}

#[test]
fn the_sign_of_a_quaternion_does_not_matter() {
    let rig = tube();
    let mut pose = Pose::rest(3);
    pose.rotations[1] = Quat::from_rotation_z(1.0);
    let (mut one, mut other) = (Vec::new(), Vec::new());
    for method in [Skinning::DualQuaternion, Skinning::CenterOfRotation] {
        rig.skin_with(method, &pose, &mut one);
        pose.rotations[1] = -pose.rotations[1];
        rig.skin_with(method, &pose, &mut other);
        assert!(
            one.iter().zip(&other).all(|(a, b)| a.abs_diff_eq(*b, 1e-5)),
            "{method:?}"
        );
    }
}

#[test]
fn foreign_and_cut_files_are_refused_in_words() {
    let bytes = tube().to_glb().unwrap();
    for cut in [0, 3, 11, 12, 40, bytes.len() / 2, bytes.len() - 1] {
        let error = Rig::from_glb(&bytes[..cut]).unwrap_err();
        assert!(!error.to_string().is_empty());
    }
    let error = Rig::from_glb(b"PK\x03\x04 something else entirely").unwrap_err();
    assert!(
        error.to_string().contains("not a whole binary glTF"),
        "{error}"
    );
    let mut unskinned = tube();
    unskinned.influences[2].clear();
    assert!(matches!(
        unskinned.to_glb(),
        Err(RigError::Inconsistent { .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Flipped bytes give an error or another valid rig, never a panic.
    #[test]
    fn damaged_files_never_panic(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut bytes = tube().to_glb().unwrap();
        for (place, value) in flips {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        if let Ok(rig) = Rig::from_glb(&bytes) {
            prop_assert!(rig.validate().is_ok());
        }
    }
}
