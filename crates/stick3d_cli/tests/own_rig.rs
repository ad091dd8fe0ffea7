//! `stick3d train` and `eval` on a rig of one's own: what is said of it, what is refused, and that it works.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

const RING: usize = 8;
const RINGS: usize = 9;
const FIGURE: &str = r#"Figure(name: "rod", root: "foot", joints: [
    (name: "foot", side: Center, template: (0.0, 0.0), anchor: Bones(["lower"])),
    (name: "knee", side: Center, template: (0.0, 0.8), anchor: Bones(["middle"])),
    (name: "tip", side: Center, template: (0.0, 1.6), anchor: Bones(["upper"])),
], path: ["foot", "knee", "tip"], bones: [("foot", "knee"), ("knee", "tip")])"#;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn stick3d(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stick3d"))
        .args(arguments)
        .current_dir(workspace())
        .output()
        .unwrap()
}

/// A rod of three bones, two metres high, as a `.gltf` with its data beside it.
struct Rod {
    folder: tempfile::TempDir,
    json: Value,
    data: Vec<u8>,
}

impl Rod {
    fn new() -> Self {
        let mut rod = Self {
            folder: tempfile::tempdir().unwrap(),
            json: json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 3]}],
                "accessors": [], "bufferViews": [],
                "nodes": [
                    {"name": "lower", "children": [1]},
                    {"name": "middle", "children": [2], "translation": [0.0, 0.8, 0.0]},
                    {"name": "upper", "translation": [0.0, 0.8, 0.0]},
                    {"name": "Rod", "mesh": 0, "skin": 0},
                ],
                "skins": [{"joints": [0, 1, 2]}]}),
            data: Vec::new(),
        };
        let height = |ring: usize| 2.0 * ring as f32 / (RINGS - 1) as f32;
        let mut points: Vec<[f32; 3]> = Vec::new();
        let mut weights: Vec<[f32; 4]> = Vec::new();
        for ring in 0..RINGS {
            for step in 0..RING {
                let angle = std::f32::consts::TAU * step as f32 / RING as f32;
                points.push([0.1 * angle.cos(), height(ring), 0.1 * angle.sin()]);
                let upper = (2.0 * (height(ring) - 1.35)).clamp(0.0, 1.0);
                let lower = (2.0 * (1.05 - height(ring))).clamp(0.0, 1.0);
                weights.push([lower, 1.0 - lower - upper, upper, 0.0]);
            }
        }
        let mut corners: Vec<u16> = Vec::new();
        for ring in 0..RINGS - 1 {
            for step in 0..RING {
                let at = |ring: usize, step: usize| (ring * RING + step % RING) as u16;
                let [a, b] = [at(ring, step), at(ring, step + 1)];
                let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
                corners.extend([a, c, b, b, c, d]);
            }
        }
        let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let positions = rod.accessor(floats(points.as_flattened()), 5126, "VEC3", points.len());
        let weights = rod.accessor(floats(weights.as_flattened()), 5126, "VEC4", points.len());
        let joints = [0_u8, 1, 2, 0].repeat(points.len());
        let joints = rod.accessor(joints, 5121, "VEC4", points.len());
        let bytes = corners.iter().flat_map(|c| c.to_le_bytes()).collect();
        let indices = rod.accessor(bytes, 5123, "SCALAR", corners.len());
        rod.json["meshes"] = json!([{"name": "Tube", "primitives": [{
            "attributes": {"POSITION": positions, "WEIGHTS_0": weights, "JOINTS_0": joints}, "indices": indices}]}]);
        rod
    }

    fn accessor(&mut self, bytes: Vec<u8>, component: u32, shape: &str, count: usize) -> usize {
        let list = |json: &mut Value, list: &str, entry: Value| {
            let list = json[list].as_array_mut().unwrap();
            list.push(entry);
            list.len() - 1
        };
        let view = json!({"buffer": 0, "byteOffset": self.data.len(), "byteLength": bytes.len()});
        self.data.extend(bytes);
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let view = list(&mut self.json, "bufferViews", view);
        let mut accessor =
            json!({"bufferView": view, "componentType": component, "type": shape, "count": count});
        if shape == "VEC3" {
            accessor["min"] = json!([-0.1, 0.0, -0.1]);
            accessor["max"] = json!([0.1, 2.0, 0.1]);
        }
        list(&mut self.json, "accessors", accessor)
    }

    /// Overwrites floats of the data, from float `first` of an accessor on.
    fn write_floats(&mut self, accessor: usize, first: usize, values: &[f32]) {
        let view = &self.json["bufferViews"][accessor]["byteOffset"];
        let start = usize::try_from(view.as_u64().unwrap()).unwrap() + 4 * first;
        for (number, value) in values.iter().enumerate() {
            self.data[start + 4 * number..][..4].copy_from_slice(&value.to_le_bytes());
        }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    fn write(&self, name: &str, text: &str) -> String {
        let path = self.path(name);
        stick3d_model::files::write_atomically(Path::new(&path), text.as_bytes()).unwrap();
        path
    }

    /// Writes the rig, and its figure, and gives their paths.
    fn files(&self) -> (String, String) {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"uri": "rod.bin", "byteLength": self.data.len()}]);
        let bin = self.path("rod.bin");
        stick3d_model::files::write_atomically(Path::new(&bin), &self.data).unwrap();
        (
            self.write("rod.gltf", &json.to_string()),
            self.write("rod.ron", FIGURE),
        )
    }

    fn train(&self, more: &[&str]) -> Output {
        let (rig, figure) = self.files();
        let (out, work) = (self.path("rod.stick3d"), self.path("work"));
        let own = ["train", "--rig", &rig, "--figure", &figure, "--out", &out];
        stick3d(&[&own[..], &["--work-dir", &work], more].concat())
    }

    /// Training that must end with code 3 and name some things.
    fn refused(&self, more: &[&str], named: &[&str]) {
        let output = self.train(more);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{error}");
        for part in named {
            assert!(error.contains(part), "no {part:?} in: {error}");
        }
        assert!(!Path::new(&self.path("rod.stick3d")).exists());
    }
}

#[test]
fn what_is_wrong_with_a_rig_is_named() {
    let rod = Rod::new();
    let refused = stick3d(&["train", "--rig", "x.glb", "--out", "x.stick3d"]);
    assert_eq!(refused.status.code(), Some(2), "a rig needs a figure");
    let missing = stick3d(&[
        "train",
        "--rig",
        "no-such.glb",
        "--figure",
        &rod.files().1,
        "--out",
        "x.stick3d",
    ]);
    assert_eq!(missing.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("no-such.glb"));

    let mut bare = Rod::new();
    bare.json["nodes"][3]
        .as_object_mut()
        .unwrap()
        .remove("skin");
    bare.refused(&[], &["rod.gltf", "skin", "`Rod`"]);

    let mut broken = Rod::new();
    broken.write_floats(0, 3 * 17 + 1, &[f32::NAN]);
    broken.refused(&[], &["rod.gltf", "`Tube`, part 0", "vertex 17"]);

    let mut weightless = Rod::new();
    weightless.write_floats(1, 4 * 5, &[f32::NAN]);
    weightless.refused(&[], &["`Tube`, part 0", "vertex 5"]);
}

#[test]
fn what_is_wrong_with_a_figure_is_named() {
    let rod = Rod::new();
    let train = |figure: &str| {
        let (rig, out) = (rod.files().0, rod.path("rod.stick3d"));
        let figure = rod.write("other.ron", figure);
        let output = stick3d(&["train", "--rig", &rig, "--figure", &figure, "--out", &out]);
        assert_eq!(output.status.code(), Some(3));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let said = train(&FIGURE.replace("[\"middle\"]", "[\"midle\"]"));
    assert!(
        said.contains("`midle`") && said.contains("`middle`"),
        "{said}"
    );
    let said = train(&FIGURE.replace("path: [\"foot\", \"knee\"", "path: [\"foot\", \"nee\""));
    assert!(
        said.contains("other.ron") && said.contains("did you mean \"knee\""),
        "{said}"
    );
    let said = train(&FIGURE.replace("\"knee\", \"tip\"],", "\"knee\"],"));
    assert!(said.contains("\"tip\" is never visited"), "{said}");
    let said = train(&FIGURE.replace("(0.0, 0.8)", "(0.0, NaN)"));
    assert!(said.contains("knee") && said.contains("NaN"), "{said}");
    let said = train("Figure(\n name: \"rod\",\n root: foot)");
    assert!(said.contains("line 3"), "{said}");
}

#[test]
fn controls_and_poses_of_another_skeleton_are_refused() {
    let rod = Rod::new();
    let horse = ["assets/rigs/horse.controls.ron", "assets/poses/horse.ron"];
    rod.refused(&["--controls", horse[0]], &["horse.controls.ron", "bone `"]);
    rod.refused(&["--poses", horse[1]], &["horse.ron", "`horse`", "`Rod`"]);
    let poses = |text: &str| rod.write("poses.ron", text);
    let path = poses("(rig: \"Rod\", poses: [(name: \"bent\", values: {\"uper.bend\": 20})])");
    rod.refused(
        &["--poses", &path],
        &["pose `bent`", "`uper.bend`", "`upper.bend`"],
    );
    let path = poses("(rig: \"Rod\", poses: [(name: \"bent\", values: {\"upper.bend\": NaN})])");
    rod.refused(&["--poses", &path], &["pose `bent`", "`upper.bend`", "NaN"]);
    let path = poses("(rig: \"Rod\", poses: [(name: \"up\", lift_m: NaN)])");
    rod.refused(&["--poses", &path], &["pose `up`", "lift_m"]);
    let path = poses("(rig: \"Rod\", poses: [(name: \"walk\", clip: Some((\"Walk\", 0.1)))])");
    rod.refused(&["--poses", &path], &["pose `walk`", "no clip `Walk`"]);
}

/// Without clips and a library: poses from the limits; what was put right is said; the model knows its rig again.
#[test]
fn a_rig_alone_is_trained_and_measured() {
    let mut rod = Rod::new();
    rod.write_floats(1, 0, &[0.5, 0.0, 0.0, 0.0]);
    let triangle = rod.json["bufferViews"][3]["byteOffset"].as_u64().unwrap();
    let triangle = usize::try_from(triangle).unwrap();
    rod.data.copy_within(triangle..triangle + 2, triangle + 2);
    let output = rod.train(&["--quick"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    for part in [
        "3 bones, 72 vertices, 128 triangles, 0 clips",
        "80 poses: 0 of a library, 0 of the clips, 80 inside the joints' limits",
        "1 vertices had weights that did not sum to one; they were scaled",
        "1 triangles have no area; they were kept",
    ] {
        assert!(said.contains(part), "no {part:?} in: {said}");
    }
    let (rig, _) = rod.files();
    let model = rod.path("rod.stick3d");
    let output = stick3d(&["eval", "--model", &model, "--rig", &rig, "--json"]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let parts = report["parts"].as_array().unwrap();
    let names = parts.iter().map(|part| part["name"].as_str().unwrap());
    assert_eq!(names.collect::<Vec<_>>(), ["natural", "broad"]);
    for part in parts {
        assert_eq!(part["cases"], 400);
        let mean = |answer: &str| {
            let rows = part["rows"].as_array().unwrap().iter();
            let mut clean = rows.filter(|row| row["answer"] == answer && row["drawn"] == "clean");
            let metrics = &clean.next().unwrap()["metrics"];
            metrics["vertex_mean_cm"].as_f64().unwrap()
        };
        assert!(mean("best alternative") > 0.0 && mean("nearest neighbour") > 0.0);
        assert!(mean("best alternative") <= mean("first answer"));
    }
    assert!(report["latency"]["p99_ms"].as_f64() >= report["latency"]["p50_ms"].as_f64());
    // Poses that the model kept apart are not known without the rig's own ones.
    let output = stick3d(&[
        "eval",
        "--model",
        &model,
        "--rig",
        &rig,
        "--poses",
        &rod.write("none.ron", "(rig: \"Rod\", poses: [])"),
    ]);
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("free_"));
}
