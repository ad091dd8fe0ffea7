//! Tests of reading files as other software writes them: parts, seams, scales, axes, clips, and faults.

use std::f32::consts::FRAC_PI_2;

use base64::Engine as _;
use glam::{Mat4, Quat, Vec3};
use serde_json::{Value, json};

use super::{Pose, Rig, RigError, RigFile, Weld};
use stick3d_model::files::write_atomically;

/// A glTF under construction.
struct Foreign {
    json: Value,
    bytes: Vec<u8>,
}

const FLOATS: u32 = 5126;
const WORDS: u32 = 5123;
const BYTES: u32 = 5121;

impl Foreign {
    fn accessor(&mut self, bytes: &[u8], component: u32, shape: &str, count: usize) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        let view = views.len() - 1;
        self.bytes.extend_from_slice(bytes);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(
            json!({"bufferView": view, "componentType": component, "type": shape,
            "count": count, "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0]}),
        );
        if shape != "VEC3" {
            let accessor = accessors.last_mut().unwrap().as_object_mut().unwrap();
            accessor.remove("min");
            accessor.remove("max");
        }
        accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let shape = ["SCALAR", "VEC2", "VEC3", "VEC4"]
            .get(N - 1)
            .copied()
            .unwrap_or("MAT4");
        let bytes: Vec<u8> = values
            .iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        self.accessor(&bytes, FLOATS, shape, values.len())
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    fn finished(&self, uri: Option<String>) -> Value {
        let mut json = self.json.clone();
        let mut buffer = json!({"byteLength": self.bytes.len()});
        if let Some(uri) = uri {
            buffer["uri"] = uri.into();
        }
        json["buffers"] = json!([buffer]);
        for list in ["animations", "skins", "materials"] {
            if json[list].as_array().unwrap().is_empty() {
                json.as_object_mut().unwrap().remove(list);
            }
        }
        json
    }

    fn glb(&self) -> Vec<u8> {
        let mut text = serde_json::to_vec(&self.finished(None)).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bytes.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let total = 12 + 8 + text.len() + 8 + bin.len();
        let mut glb = b"glTF".to_vec();
        for (length, kind, chunk) in [(text.len(), b"JSON", &text), (bin.len(), b"BIN\0", &bin)] {
            if glb.len() == 4 {
                glb.extend(2_u32.to_le_bytes());
                glb.extend((total as u32).to_le_bytes());
            }
            glb.extend((length as u32).to_le_bytes());
            glb.extend(kind);
            glb.extend_from_slice(chunk);
        }
        glb
    }

    fn read(&self) -> RigFile {
        RigFile::from_bytes(&self.glb(), Weld::default()).unwrap()
    }

    fn error(&self) -> RigError {
        RigFile::from_bytes(&self.glb(), Weld::default()).unwrap_err()
    }

    /// One face of four corners with its own vertices, as flat shading makes them.
    fn quads(&mut self, quads: &[[(f32, f32, f32); 4]], material: usize, weights_0: f32) -> Value {
        let points: Vec<[f32; 3]> = quads.iter().flatten().map(|&(x, y, z)| [x, y, z]).collect();
        let joints: Vec<u8> = points.iter().flat_map(|_| [0, 1, 0, 0]).collect();
        let weight = |p: &[f32; 3]| match p[2] {
            z if z < 50.0 => [weights_0, 0.0, 0.0, 0.0],
            z if z < 150.0 => [0.5, 0.5, 0.0, 0.0],
            _ => [0.0, 1.0, 0.0, 0.0],
        };
        let weights: Vec<[f32; 4]> = points.iter().map(weight).collect();
        let corners = (0..quads.len() as u16).flat_map(|q| [0, 1, 2, 0, 2, 3].map(|c| 4 * q + c));
        let indices: Vec<u8> = corners.flat_map(u16::to_le_bytes).collect();
        let (positions, weights) = (self.floats(&points), self.floats(&weights));
        let joints = self.accessor(&joints, BYTES, "VEC4", points.len());
        let indices = self.accessor(&indices, WORDS, "SCALAR", 6 * quads.len());
        json!({"attributes": {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights},
            "indices": indices, "material": material})
    }
}

const RING: [(f32, f32); 4] = [(-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0)];

fn side(step: usize, low: f32) -> [(f32, f32, f32); 4] {
    let ((ax, ay), (bx, by)) = (RING[step], RING[(step + 1) % 4]);
    [
        (ax, ay, low),
        (bx, by, low),
        (bx, by, low + 100.0),
        (ax, ay, low + 100.0),
    ]
}

/// A column of two bones, centimetres and z up as modelled, metres and y up by its armature: red below,
/// green above, every face with vertices of its own.
fn column() -> Foreign {
    column_with_weight(1.0)
}

fn column_with_weight(weight: f32) -> Foreign {
    let mut file = Foreign {
        json: json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "accessors": [], "bufferViews": [], "animations": [], "skins": [], "meshes": [],
        "nodes": [
            {"name": "Armature", "children": [1, 3], "scale": [0.01, 0.01, 0.01],
                "rotation": Quat::from_rotation_x(-FRAC_PI_2).to_array()},
            {"name": "lower", "children": [2]},
            {"name": "upper", "translation": [0.0, 0.0, 100.0]},
            {"name": "Column", "mesh": 0, "skin": 0, "translation": [7.0, 7.0, 7.0]},
        ],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorFactor": [1.0, 0.0, 0.0, 1.0]}},
            {"pbrMetallicRoughness": {"baseColorFactor": [0.0, 0.5, 0.0, 1.0]}},
        ]}),
        bytes: Vec::new(),
    };
    let cap = |z: f32, order: [usize; 4]| order.map(|i| (RING[i].0, RING[i].1, z));
    let below = [0, 1, 2, 3].map(|step| side(step, 0.0));
    let above = [0, 1, 2, 3].map(|step| side(step, 100.0));
    let red: Vec<_> = below.into_iter().chain([cap(0.0, [3, 2, 1, 0])]).collect();
    let green: Vec<_> = above
        .into_iter()
        .chain([cap(200.0, [0, 1, 2, 3])])
        .collect();
    let parts = [file.quads(&red, 0, weight), file.quads(&green, 1, weight)];
    file.push("meshes", json!({"name": "Cube", "primitives": parts}));
    let bind = [0.0, -100.0].map(|z| Mat4::from_translation(Vec3::Z * z).to_cols_array());
    let bind = file.floats(&bind);
    file.push(
        "skins",
        json!({"joints": [1, 2], "inverseBindMatrices": bind}),
    );
    file
}

#[test]
fn a_scaled_and_turned_armature_becomes_metres_with_y_up() {
    let RigFile { rig, report, .. } = column().read();
    let (low, high) = rig.mesh.bounds();
    assert!(low.abs_diff_eq(Vec3::new(-0.1, 0.0, -0.1), 1e-5), "{low}");
    assert!(high.abs_diff_eq(Vec3::new(0.1, 2.0, 0.1), 1e-5), "{high}");
    assert_eq!(rig.name, "Column");
    assert_eq!(rig.skeleton.bones[1].name, "upper");
    assert_eq!(rig.skeleton.bones[1].parent, Some(0));
    assert!(rig.skeleton.bones[1].head.abs_diff_eq(Vec3::Y, 1e-6));
    assert!(rig.mesh.volume() > 0.0, "triangles face outward");
    assert_eq!((report.normalized, report.degenerate), (0, 0));
}

#[test]
fn seams_are_welded_and_colour_borders_stay_sharp() {
    let file = column();
    let RigFile { rig, report, .. } = file.read();
    assert_eq!(report.file_vertices, 40);
    // Three rings of four, the middle one once in each colour.
    assert_eq!((rig.mesh.positions.len(), report.welded), (16, 24));
    for triangle in &rig.mesh.triangles {
        let colors = triangle.map(|vertex| rig.colors[vertex as usize]);
        assert!(colors.iter().all(|color| *color == colors[0]), "{colors:?}");
    }
    let closed = RigFile::from_bytes(&file.glb(), Weld::ByPosition).unwrap();
    let topology = closed.rig.mesh.topology();
    assert_eq!(closed.rig.mesh.positions.len(), 12);
    assert!(topology.closed && topology.consistently_wound && topology.genus == Some(0));
    let red = closed
        .triangle_colors
        .iter()
        .filter(|color| **color == [255, 0, 0, 255]);
    let green = closed
        .triangle_colors
        .iter()
        .filter(|color| **color == [0, 128, 0, 255]);
    assert_eq!((red.count(), green.count()), (10, 10));
}

#[test]
fn what_only_touches_is_not_sewn_together() {
    let mut file = column();
    // The same cap once more, on the upper bone only: another thing that lies on the first.
    let mut lid = file.quads(&[[0, 1, 2, 3].map(|i| (RING[i].0, RING[i].1, 0.0))], 0, 1.0);
    let joints = file.accessor(&[1; 16], BYTES, "VEC4", 4);
    lid["attributes"]["JOINTS_0"] = joints.into();
    file.json["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .push(lid);
    assert_eq!(file.read().rig.mesh.positions.len(), 20);
}

#[test]
fn vertex_colours_tint_the_material() {
    let mut file = column();
    let halves: Vec<[f32; 4]> = vec![[0.5, 1.0, 1.0, 1.0]; 20];
    let colors = file.floats(&halves);
    file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors.into();
    assert!(file.read().rig.colors.contains(&[128, 0, 0, 255]));
}

#[test]
fn weights_are_scaled_and_flat_triangles_kept_and_both_are_counted() {
    let mut file = column_with_weight(0.6);
    let flat: Vec<u8> = [0_u16, 1, 2, 0, 1, 1]
        .into_iter()
        .flat_map(u16::to_le_bytes)
        .collect();
    let indices = file.accessor(&flat, WORDS, "SCALAR", 6);
    file.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
    let RigFile { rig, report, .. } = file.read();
    // Eight corners of the sides and four of the cap stand on the ground.
    assert_eq!((report.normalized, report.degenerate), (12, 1));
    assert_eq!(rig.mesh.triangles.len(), 2 + 10);
    assert_eq!(report.lines().len(), 3, "{:?}", report.lines());
    assert!(
        rig.influences
            .iter()
            .all(|list| (list.iter().map(|i| i.1).sum::<f32>() - 1.0).abs() < 1e-6)
    );
}

#[test]
fn eight_bones_may_hold_a_vertex_and_of_twelve_the_strongest_do() {
    let mut file = column();
    for number in 0..10 {
        let node = file.push("nodes", json!({"name": format!("extra {number}")}));
        file.json["nodes"][1]["children"]
            .as_array_mut()
            .unwrap()
            .push(node.into());
        file.json["skins"][0]["joints"]
            .as_array_mut()
            .unwrap()
            .push(node.into());
    }
    let bind = [Mat4::IDENTITY.to_cols_array(); 12];
    let bind = file.floats(&bind);
    file.json["skins"][0]["inverseBindMatrices"] = bind.into();
    file.json["nodes"][2]["translation"] = json!([0.0, 0.0, 0.0]);
    let part = &mut file.json["meshes"][0]["primitives"];
    part.as_array_mut().unwrap().truncate(1);
    for (set, [first, share]) in [[0, 10], [4, 8], [8, 1]].into_iter().enumerate() {
        let joints: Vec<u8> = (0..20)
            .flat_map(|_| [0, 1, 2, 3].map(|j| j + first))
            .collect();
        let joints = file.accessor(&joints, BYTES, "VEC4", 20);
        let weights = file.floats(&[[f32::from(share) / 76.0; 4]; 20]);
        let attributes = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
        attributes[format!("JOINTS_{set}")] = joints.into();
        attributes[format!("WEIGHTS_{set}")] = weights.into();
    }
    let RigFile { rig, report, .. } = file.read();
    assert_eq!(report.truncated, 20);
    for list in &rig.influences {
        assert_eq!(list.len(), 8);
        assert!((list[0].1 - 10.0 / 72.0).abs() < 1e-5, "{list:?}");
        assert!(list.iter().all(|(bone, _)| *bone < 12));
    }
}

#[test]
fn a_mesh_that_hangs_on_a_bone_follows_it_whole() {
    let mut file = column();
    let mut hat = file.quads(
        &[[0, 1, 2, 3].map(|i| (RING[i].0, RING[i].1, 110.0))],
        1,
        1.0,
    );
    let attributes = hat["attributes"].as_object_mut().unwrap();
    attributes.remove("JOINTS_0");
    attributes.remove("WEIGHTS_0");
    let mesh = file.push("meshes", json!({"primitives": [hat]}));
    let node = file.push("nodes", json!({"name": "hat", "mesh": mesh}));
    file.json["nodes"][2]["children"] = json!([node]);
    let rig = file.read().rig;
    let worn: Vec<usize> = (0..rig.mesh.positions.len())
        .filter(|&v| (rig.mesh.positions[v].y - 2.1).abs() < 1e-4)
        .collect();
    assert_eq!(worn.len(), 4);
    assert!(worn.iter().all(|&v| rig.influences[v] == [(1, 1.0)]));
}

#[test]
fn the_rest_is_the_pose_that_was_bound_even_where_the_file_shows_another() {
    let mut file = column();
    file.json["nodes"][2]["rotation"] = json!(Quat::from_rotation_x(0.6).to_array());
    let RigFile { rig, report, .. } = file.read();
    assert!(
        (rig.mesh.bounds().1.y - 2.0).abs() < 1e-4,
        "it stands straight"
    );
    assert!(
        report
            .notes
            .iter()
            .any(|note| note.contains("1 of 2 bones")),
        "{report:?}"
    );
}

fn animate(file: &mut Foreign, node: usize, path: &str, mode: &str, times: &[f32], output: usize) {
    let times: Vec<[f32; 1]> = times.iter().map(|&t| [t]).collect();
    let input = file.floats(&times);
    if file.json["animations"].as_array().unwrap().is_empty() {
        file.push(
            "animations",
            json!({"name": "Bend", "channels": [], "samplers": []}),
        );
    }
    let animation = &mut file.json["animations"][0];
    let samplers = animation["samplers"].as_array_mut().unwrap();
    samplers.push(json!({"input": input, "output": output, "interpolation": mode}));
    let sampler = samplers.len() - 1;
    animation["channels"]
        .as_array_mut()
        .unwrap()
        .push(json!({"sampler": sampler, "target": {"node": node, "path": path}}));
}

fn turned(angle: f32) -> [f32; 4] {
    Quat::from_rotation_y(angle).to_array()
}

#[test]
fn clips_turn_bones_about_model_axes_and_move_the_root() {
    let mut file = column();
    let turns = file.floats(&[turned(0.0), turned(1.0)]);
    animate(&mut file, 2, "rotation", "LINEAR", &[2.0, 3.0], turns);
    let places = file.floats(&[[0.0, 0.0, 0.0], [0.0, 0.0, 50.0]]);
    animate(&mut file, 1, "translation", "LINEAR", &[2.0, 3.0], places);
    let rig = file.read().rig;
    let clip = &rig.clips[0];
    assert_eq!((clip.name.as_str(), clip.duration_s()), ("Bend", 1.0));
    for (time, angle) in [(-1.0, 0.0), (0.0, 0.0), (0.3, 0.3), (1.0, 1.0), (9.0, 1.0)] {
        let pose = clip.sample(time).unwrap();
        // The armature lays the file's y along the model's -z.
        let expected = Quat::from_axis_angle(-Vec3::Z, angle);
        assert!(
            pose.rotations[1].dot(expected).abs() > 1.0 - 1e-6,
            "{time}: {pose:?}"
        );
        assert!(
            pose.root_translation
                .abs_diff_eq(Vec3::Y * 0.5 * angle, 1e-4)
        );
    }
    let read = Rig::from_glb(&rig.to_glb().unwrap()).unwrap();
    assert_eq!(read.clips[0].times_s, clip.times_s);
    for (read, written) in read.clips[0].poses.iter().zip(&clip.poses) {
        assert!(
            read.root_translation
                .abs_diff_eq(written.root_translation, 1e-5)
        );
        assert!(read.rotations[1].dot(written.rotations[1]).abs() > 1.0 - 1e-6);
    }
}

#[test]
fn steps_hold_and_cubic_splines_follow_their_tangents() {
    let mut file = column();
    let turns = file.floats(&[turned(0.0), turned(1.0)]);
    animate(&mut file, 2, "rotation", "STEP", &[0.0, 1.0], turns);
    let clip = &file.read().rig.clips[0];
    let angle = |pose: Pose| pose.rotations[1].to_axis_angle().1;
    assert!(angle(clip.sample(0.99).unwrap()) < 1e-3);
    assert!((angle(clip.sample(1.0).unwrap()) - 1.0).abs() < 1e-3);

    let mut file = column();
    let zero = [0.0; 3];
    // In-tangent, value, out-tangent: the slope of 100 cm/s at the start carries it past the line.
    let places = file.floats(&[zero, zero, [0.0, 0.0, 100.0], zero, zero, zero]);
    animate(
        &mut file,
        1,
        "translation",
        "CUBICSPLINE",
        &[0.0, 2.0],
        places,
    );
    let clip = &file.read().rig.clips[0];
    // t³ - 2t² + t at t = 1/4, times span and slope: 0.140625 * 2 * 100 cm.
    let height = clip.sample(0.5).unwrap().root_translation.y;
    assert!((height - 0.28125).abs() < 2e-3, "{height}");
}

#[test]
fn a_foot_that_slides_with_its_leg_is_hung_on_it() {
    let mut file = column();
    // A bone outside the leg, at its end, that clips keep there.
    let node = file.push(
        "nodes",
        json!({"name": "foot", "translation": [0.0, 0.0, 200.0]}),
    );
    file.json["nodes"][0]["children"]
        .as_array_mut()
        .unwrap()
        .push(node.into());
    file.json["skins"][0]["joints"] = json!([1, 2, node]);
    let bind = [0.0, -100.0, -200.0].map(|z| Mat4::from_translation(Vec3::Z * z).to_cols_array());
    let bind = file.floats(&bind);
    file.json["skins"][0]["inverseBindMatrices"] = bind.into();
    let mut toe = file.quads(
        &[[0, 1, 2, 3].map(|i| (RING[i].0, RING[i].1, 210.0))],
        1,
        1.0,
    );
    let joints = file.accessor(&[2; 16], BYTES, "VEC4", 4);
    toe["attributes"]["JOINTS_0"] = joints.into();
    file.json["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .push(toe);
    let angles = [0.0_f32, 0.25, 0.5, 0.75, 1.0];
    let turns = file.floats(&angles.map(turned));
    animate(&mut file, 2, "rotation", "LINEAR", &angles, turns);
    let places =
        angles.map(|a| (Vec3::Z * 100.0 + Quat::from_rotation_y(a) * Vec3::Z * 100.0).to_array());
    let places = file.floats(&places);
    animate(&mut file, node, "translation", "LINEAR", &angles, places);
    let RigFile { rig, report, .. } = file.read();
    let foot = rig.skeleton.bone_index("foot").unwrap();
    let carrier = rig.skeleton.bones[foot].parent.unwrap();
    assert_eq!(rig.skeleton.bones[carrier].name, "upper");
    assert!(
        report
            .notes
            .iter()
            .any(|note| note.contains("`foot` on `upper`")),
        "{report:?}"
    );
    // The foot itself did not turn: its own rotation takes the leg's back.
    let transforms = rig.bone_transforms(&rig.clips[0].sample(1.0).unwrap());
    assert!(transforms[foot].0.abs_diff_eq(Quat::IDENTITY, 1e-3));
    assert!(
        transforms[foot]
            .1
            .abs_diff_eq(Vec3::new(1.0_f32.sin(), 1.0 + 1.0_f32.cos(), 0.0), 1e-3)
    );
}

#[test]
fn hips_that_move_under_a_resting_root_become_the_root() {
    let mut file = column();
    file.json["nodes"][0]["children"] = json!([4, 3]);
    let root = file.push("nodes", json!({"name": "Root", "children": [1]}));
    file.json["skins"][0]["joints"] = json!([1, 2, root]);
    let bind = [0.0, -100.0, 0.0].map(|z| Mat4::from_translation(Vec3::Z * z).to_cols_array());
    let bind = file.floats(&bind);
    file.json["skins"][0]["inverseBindMatrices"] = bind.into();
    let places = file.floats(&[[0.0, 0.0, 0.0], [0.0, 0.0, -40.0]]);
    animate(&mut file, 1, "translation", "LINEAR", &[0.0, 1.0], places);
    let rig = file.read().rig;
    let hips = rig.skeleton.bone_index("lower").unwrap();
    assert_eq!(rig.skeleton.bones[hips].parent, None);
    assert!((rig.clips[0].sample(1.0).unwrap().root_translation.y + 0.4).abs() < 1e-4);
}

#[test]
fn text_with_embedded_and_with_separate_buffers_is_the_same_rig() {
    let file = column();
    let expected = file.read();
    let coded = base64::engine::general_purpose::STANDARD.encode(&file.bytes);
    let embedded = file.finished(Some(format!(
        "data:application/octet-stream;base64,{coded}"
    )));
    let embedded = serde_json::to_vec(&embedded).unwrap();
    assert_eq!(
        RigFile::from_bytes(&embedded, Weld::default()).unwrap(),
        expected
    );

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("column.gltf");
    write_atomically(&folder.path().join("column data.bin"), &file.bytes).unwrap();
    let separate = file.finished(Some("column%20data.bin".into()));
    write_atomically(&path, &serde_json::to_vec(&separate).unwrap()).unwrap();
    assert_eq!(RigFile::read(&path, Weld::default()).unwrap(), expected);

    let outside = file.finished(Some("../column data.bin".into()));
    write_atomically(&path, &serde_json::to_vec(&outside).unwrap()).unwrap();
    let error = RigFile::read(&path, Weld::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("../column data.bin"), "{error}");
    let absent = file.finished(Some("absent.bin".into()));
    write_atomically(&path, &serde_json::to_vec(&absent).unwrap()).unwrap();
    let error = RigFile::read(&path, Weld::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("absent.bin"), "{error}");
}

#[test]
fn faults_name_what_is_wrong_and_where() {
    let mut file = column();
    file.json["nodes"][3]
        .as_object_mut()
        .unwrap()
        .remove("skin");
    let error = file.error();
    assert!(
        matches!(&error, RigError::NoSkin { meshes } if meshes == &["`Column`"]),
        "{error}"
    );

    let mut file = column();
    let bone = file.push("nodes", json!({"name": "stranger"}));
    let skin = file.push("skins", json!({"joints": [bone]}));
    file.push("nodes", json!({"name": "Other", "mesh": 0, "skin": skin}));
    let error = file.error();
    assert!(matches!(error, RigError::TwoSkins { .. }), "{error}");
    let text = error.to_string();
    assert!(
        ["`Column`", "`Other`", "`stranger`"]
            .iter()
            .all(|name| text.contains(name)),
        "{text}"
    );

    let mut file = column();
    file.json["accessors"][0]["sparse"] = json!({"count": 1,
        "indices": {"bufferView": 0, "componentType": WORDS}, "values": {"bufferView": 0}});
    let text = file.error().to_string();
    assert!(
        text.contains("accessor 0") && text.contains("`Cube`") && text.contains("sparse"),
        "{text}"
    );

    let mut file = column();
    file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(
        file.error()
            .to_string()
            .contains("KHR_draco_mesh_compression")
    );

    let mut file = column();
    let joints = file.accessor(&[9; 80], BYTES, "VEC4", 20);
    file.json["meshes"][0]["primitives"][1]["attributes"]["JOINTS_0"] = joints.into();
    let text = file.error().to_string();
    assert!(
        text.contains("`Cube`, part 1") && text.contains("vertex 0"),
        "{text}"
    );

    let mut file = column();
    let turns = file.floats(&[turned(0.0)]);
    animate(&mut file, 2, "rotation", "LINEAR", &[0.0, 1.0], turns);
    let text = file.error().to_string();
    assert!(
        text.contains("`Bend`, channel 0") && text.contains("2 keys but 1 values"),
        "{text}"
    );

    let mut file = column();
    let turns = file.floats(&[turned(0.0), turned(1.0)]);
    animate(&mut file, 77, "rotation", "LINEAR", &[0.0, 1.0], turns);
    assert!(file.error().to_string().contains("node 77"));
}
