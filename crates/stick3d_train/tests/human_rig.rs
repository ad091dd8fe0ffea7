//! The shipped man, `assets/rigs/human.glb`: every claim that the project makes about his rig.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::{Quat, Vec3};
use stick3d_figure::Figure;
use stick3d_train::rig::{Pose, Rig, Skinning, regressor};

fn rigs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/rigs")
}

fn file() -> Vec<u8> {
    std::fs::read(rigs().join("human.glb"))
        .expect("assets/rigs/human.glb is part of the repository")
}

fn rig() -> Rig {
    Rig::from_glb(&file()).expect("the shipped rig is valid")
}

fn head(rig: &Rig, bone: &str) -> Vec3 {
    rig.skeleton.bones[rig.skeleton.bone_index(bone).expect("a bone of the rig")].head
}

/// The share of a vertex that follows bones whose names start so.
fn share(rig: &Rig, vertex: usize, starts: &[&str]) -> f32 {
    let follows = |bone: u16| {
        let name = &rig.skeleton.bones[usize::from(bone)].name;
        starts.iter().any(|start| name.starts_with(start))
    };
    rig.influences[vertex]
        .iter()
        .filter(|(bone, _)| follows(*bone))
        .map(|&(_, w)| w)
        .sum()
}

/// A pose of single turns: (bone, axis, degrees).
fn bent(rig: &Rig, turns: &[(&str, Vec3, f32)]) -> Pose {
    let mut pose = Pose::rest(rig.skeleton.bones.len());
    for &(bone, axis, degrees) in turns {
        let bone = rig.skeleton.bone_index(bone).expect("a bone of the rig");
        pose.rotations[bone] = Quat::from_axis_angle(axis.normalize(), degrees.to_radians());
    }
    pose
}

#[test]
fn the_surface_is_one_closed_sphere_of_the_promised_size() {
    let rig = rig();
    assert_eq!(rig.mesh.positions.len(), 12_500);
    assert_eq!(rig.mesh.triangles.len(), 24_996);
    let report = rig.mesh.topology();
    assert!(report.closed && report.consistently_wound, "{report:?}");
    assert_eq!(report.euler_characteristic, 2);
    assert_eq!(report.genus, Some(0));
    assert_eq!(report.components, 1);
    assert_eq!(report.pinched_vertices, 0);
    assert_eq!(report.used_vertices, 12_500);
    // Outward winding means positive volume; a man of his size encloses some 70 litres.
    let litres = rig.mesh.volume() * 1000.0;
    assert!((60.0..85.0).contains(&litres), "{litres} l");
}

#[test]
fn no_inner_cavity_is_left() {
    // Of the base mesh, 46 vertices of the mouth bag lie in this ellipsoid within the skull, and 112
    // of each socket behind the eyeball's front.
    let rig = rig();
    let skull = (Vec3::new(0.0, 1.70, 0.05), Vec3::new(0.055, 0.075, 0.070));
    let balls = [0.030, -0.030].map(|x| (Vec3::new(x, 1.680, 0.1287), Vec3::splat(0.018)));
    for (place, (middle, reach)) in [(0, skull), (1, balls[0]), (2, balls[1])] {
        let inside = |point: &&Vec3| {
            ((**point - middle) / reach).length() < 1.0 && (place == 0 || point.z < 0.124)
        };
        assert_eq!(
            rig.mesh.positions.iter().filter(inside).count(),
            0,
            "cavity {place}"
        );
    }
}

#[test]
fn he_is_1_80_m_tall_stands_on_the_ground_and_faces_forward() {
    let rig = rig();
    let (low, high) = rig.mesh.bounds();
    assert!(
        low.y.abs() < 1e-5 && (high.y - 1.80).abs() < 1e-5,
        "{low} {high}"
    );
    assert!(
        (low.x + high.x).abs() < 0.01,
        "he is symmetric about x = 0: {low} {high}"
    );
    for side in ["l", "r"] {
        assert!(
            head(&rig, &format!("ball_{side}")).z > head(&rig, &format!("foot_{side}")).z + 0.05
        );
    }
    assert!(head(&rig, "upperarm_l").x > 0.1 && head(&rig, "upperarm_r").x < -0.1);
}

#[test]
fn the_skeleton_is_the_game_engine_one() {
    let rig = rig();
    assert_eq!(rig.skeleton.bones.len(), 53);
    let parent = |name: &str| {
        let bone = &rig.skeleton.bones[rig.skeleton.bone_index(name).unwrap()];
        bone.parent
            .map(|parent| rig.skeleton.bones[parent].name.as_str())
    };
    for (bone, expected) in [
        ("Root", None),
        ("pelvis", Some("Root")),
        ("spine_03", Some("spine_02")),
        ("head", Some("neck_01")),
        ("upperarm_r", Some("clavicle_r")),
        ("middle_01_l", Some("hand_l")),
        ("thigh_l", Some("pelvis")),
        ("ball_r", Some("foot_r")),
    ] {
        assert_eq!(parent(bone), expected, "{bone}");
    }
}

#[test]
fn at_most_four_bones_move_a_vertex() {
    for (vertex, list) in rig().influences.iter().enumerate() {
        let sum: f32 = list.iter().map(|&(_, weight)| weight).sum();
        assert!(
            (1..=4).contains(&list.len()) && (sum - 1.0).abs() < 1e-5,
            "{vertex}: {list:?}"
        );
        assert!(
            list.is_sorted_by(|a, b| a.1 >= b.1),
            "strongest first: {list:?}"
        );
    }
}

#[test]
fn the_suit_covers_trunk_and_limbs_and_leaves_hands_feet_and_face_bare() {
    let rig = rig();
    let skin = rig.colors[rig.mesh.positions.iter().position(|p| p.y < 0.01).unwrap()];
    let colors: BTreeSet<[u8; 4]> = rig.colors.iter().copied().collect();
    assert!(
        colors.len() >= 8 && colors.iter().all(|color| color[3] == 255),
        "{colors:?}"
    );
    let is_skin = |vertex: usize| rig.colors[vertex] == skin;
    let (mut bare_fingers, mut dressed) = (0, 0);
    for vertex in 0..rig.mesh.positions.len() {
        if share(
            &rig,
            vertex,
            &["index", "middle", "ring", "pinky", "thumb", "ball"],
        ) > 0.9
        {
            assert!(is_skin(vertex), "finger or toe vertex {vertex} is not bare");
            bare_fingers += 1;
        }
        if share(
            &rig,
            vertex,
            &["pelvis", "spine_01", "spine_02", "thigh", "upperarm"],
        ) > 0.5
        {
            assert!(
                !is_skin(vertex),
                "vertex {vertex} of trunk, thigh or upper arm is not dressed"
            );
            dressed += 1;
        }
    }
    assert!(
        bare_fingers > 500 && dressed > 1500,
        "{bare_fingers} {dressed}"
    );
    let top =
        (0..12_500).max_by(|&a, &b| rig.mesh.positions[a].y.total_cmp(&rig.mesh.positions[b].y));
    assert!(!is_skin(top.unwrap()), "he has hair");
}

#[test]
fn the_file_keeps_the_rules_of_gltf() {
    use gltf::json::validation::Validate as _;
    let bytes = file();
    assert!(bytes.len() < 1_500_000, "{} bytes", bytes.len());
    let glb = gltf::binary::Glb::from_slice(&bytes).unwrap();
    let root: gltf::json::Root = gltf::json::deserialize::from_slice(&glb.json).unwrap();
    let mut faults = Vec::new();
    root.validate(&root, gltf::json::Path::new, &mut |path, fault| {
        faults.push(format!("{}: {fault:?}", path()));
    });
    assert_eq!(faults, Vec::<String>::new());
    for view in &root.buffer_views {
        assert_eq!(view.byte_offset.unwrap_or_default().0 % 4, 0);
    }
    let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
    let mesh = gltf.meshes().next().unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let material = primitive.material();
    assert!(!material.double_sided());
    assert!((material.pbr_metallic_roughness().roughness_factor() - 0.8).abs() < 1e-6);
    let bounds = primitive.bounding_box();
    assert!((bounds.max[1] - bounds.min[1] - 1.80).abs() < 1e-5);
    let reader = primitive.reader(|_| glb.bin.as_deref());
    let colors: Vec<[u8; 4]> = reader.read_colors(0).unwrap().into_rgba_u8().collect();
    assert_eq!(colors, rig().colors);
    let Some(gltf::mesh::util::ReadWeights::U16(weights)) = reader.read_weights(0) else {
        panic!("weights are normalised 16-bit numbers");
    };
    assert!(
        weights
            .into_iter()
            .all(|four| four.iter().map(|&w| u32::from(w)).sum::<u32>() == 65_535)
    );
    assert!(
        reader
            .read_normals()
            .unwrap()
            .all(|n| (Vec3::from(n).length() - 1.0).abs() < 1e-3)
    );
    assert_eq!(gltf.skins().next().unwrap().joints().count(), 53);
}

#[test]
fn joints_lie_on_their_anchors_at_rest_and_stay_when_bent() {
    let (rig, figure) = (rig(), Figure::human());
    let regressor = regressor(figure, &rig).unwrap();
    regressor.validate(rig.mesh.positions.len()).unwrap();
    let anchors: [(&str, &[&str]); 10] = [
        ("neck", &["neck_01"]),
        ("abdomen", &["pelvis"]),
        ("elbow_r", &["lowerarm_r"]),
        ("elbow_l", &["lowerarm_l"]),
        ("hand_r", &["middle_01_r"]),
        ("hand_l", &["middle_01_l"]),
        ("knee_r", &["calf_r"]),
        ("knee_l", &["calf_l"]),
        ("foot_r", &["foot_r", "ball_r"]),
        ("foot_l", &["foot_l", "ball_l"]),
    ];
    let error_m = |pose: &Pose, joint: &str, bones: &[&str]| {
        let mut posed = Vec::new();
        rig.skin(pose, &mut posed);
        let transforms = rig.bone_transforms(pose);
        let at = |bone: &&str| transforms[rig.skeleton.bone_index(bone).unwrap()].1;
        let anchor = bones.iter().map(at).sum::<Vec3>() / bones.len() as f32;
        regressor.joints(&posed)[figure.joint_index(joint).unwrap()].distance(anchor)
    };
    let near: [(&str, &[&str]); 5] = [
        ("abdomen", &["thigh_l", "thigh_r", "spine_01"]),
        ("neck", &["head", "clavicle_r", "spine_03"]),
        ("elbow_l", &["upperarm_l", "hand_l"]),
        ("knee_l", &["thigh_l", "foot_l"]),
        ("hand_r", &["index_01_r", "thumb_01_r", "middle_02_r"]),
    ];
    for (joint, others) in near {
        let bones = anchors.iter().find(|(name, _)| *name == joint).unwrap().1;
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for degrees in [-60.0, 60.0] {
                let turns: Vec<_> = others.iter().map(|&bone| (bone, axis, degrees)).collect();
                let error = error_m(&bent(&rig, &turns), joint, bones);
                println!("{joint} beside a turn of {degrees} about {axis}: {error:.4} m");
                assert!(
                    error < 0.02,
                    "{joint}: {error} m with its neighbours turned about {axis}"
                );
            }
        }
    }
    let rest = bent(&rig, &[]);
    for (joint, bones) in anchors {
        assert!(error_m(&rest, joint, bones) < 1e-4, "{joint} at rest");
        let mut worst = 0.0_f32;
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.7, -0.5, 0.5)] {
            for degrees in [-90.0, -60.0, 60.0, 90.0] {
                let turns: Vec<_> = bones.iter().map(|&bone| (bone, axis, degrees)).collect();
                let error = error_m(&bent(&rig, &turns), joint, bones);
                assert!(
                    error < 0.02,
                    "{joint} is off by {error} m, turned {degrees} about {axis}"
                );
                worst = worst.max(error);
            }
        }
        let row = &regressor.rows[figure.joint_index(joint).unwrap()];
        let gain = row
            .iter()
            .map(|&(_, weight)| weight * weight)
            .sum::<f32>()
            .sqrt();
        println!(
            "{joint}: {} vertices, off by {worst:.4} m at most, gain {gain:.2}",
            row.len()
        );
        assert!(
            gain < 0.5,
            "{joint}: noise of the vertices comes through by a factor of {gain}"
        );
    }
}

#[test]
fn skinning_keeps_volume_where_linear_blending_loses_it() {
    let rig = rig();
    let both = |bone: &str, axis: Vec3, degrees: f32| {
        let mirrored = Vec3::new(axis.x, -axis.y, -axis.z);
        [
            (format!("{bone}_l"), axis, degrees),
            (format!("{bone}_r"), mirrored, degrees),
        ]
    };
    let sit = [both("thigh", Vec3::X, -90.0), both("calf", Vec3::X, 90.0)].concat();
    let squat = [both("thigh", Vec3::X, -115.0), both("calf", Vec3::X, 135.0)].concat();
    let raise = [
        both("clavicle", Vec3::Z, 25.0),
        both("upperarm", Vec3::Z, 80.0),
    ]
    .concat();
    let twist = both("upperarm", Vec3::new(0.66, -0.75, 0.0), 90.0).to_vec();
    for (name, turns) in [
        ("sit", sit),
        ("squat", squat),
        ("raise", raise),
        ("twist", twist),
    ] {
        let turns: Vec<_> = turns
            .iter()
            .map(|(bone, axis, d)| (bone.as_str(), *axis, *d))
            .collect();
        let pose = bent(&rig, &turns);
        let [linear, dual, ours] = [
            Skinning::Linear,
            Skinning::DualQuaternion,
            Skinning::CenterOfRotation,
        ]
        .map(|method| measured(&rig, &pose, method));
        println!("{name}: volume kept, stretch p99.9: {linear:.3?} {dual:.3?} {ours:.3?}");
        let lost = |volume: f64| (volume - 1.0).abs();
        assert!(
            lost(ours.0) < 0.065,
            "{name} changes the volume to {}",
            ours.0
        );
        if linear.0 < 0.99 {
            assert!(
                lost(ours.0) < 0.6 * lost(linear.0),
                "{name}: {ours:?} against linear {linear:?}"
            );
        }
        assert!(
            lost(ours.0) < lost(dual.0) + 0.003,
            "{name}: {ours:?} against dual {dual:?}"
        );
        assert!(
            ours.1 < 3.5 && ours.1 < 1.02 * dual.1,
            "{name}: {ours:?} against dual {dual:?}"
        );
    }
}

/// (posed volume / rest volume, the stretch that one edge in a thousand exceeds).
fn measured(rig: &Rig, pose: &Pose, method: Skinning) -> (f64, f32) {
    let mut mesh = rig.mesh.clone();
    rig.skin_with(method, pose, &mut mesh.positions);
    let edges = rig
        .mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let length = |at: &[Vec3], (a, b): (u32, u32)| at[a as usize].distance(at[b as usize]);
    let mut stretch: Vec<f32> = edges
        .filter(|edge| edge.0 < edge.1 && length(&rig.mesh.positions, *edge) > 0.004)
        .map(|edge| length(&mesh.positions, edge) / length(&rig.mesh.positions, edge))
        .collect();
    stretch.sort_by(f32::total_cmp);
    (
        mesh.volume() / rig.mesh.volume(),
        stretch[stretch.len() * 999 / 1000],
    )
}
