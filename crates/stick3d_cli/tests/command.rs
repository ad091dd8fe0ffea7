//! The `stick3d` command as a person runs it: what it prints, what it writes, how it ends.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

const HUMAN_VERTICES: usize = 12_500;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn sketch(name: &str) -> PathBuf {
    workspace().join("assets/sketches").join(name)
}

fn stick3d() -> Command {
    Command::new(env!("CARGO_BIN_EXE_stick3d"))
}

fn pose(sketch: &Path, more: &[&str]) -> Output {
    stick3d()
        .arg("pose")
        .arg("--sketch")
        .arg(sketch)
        .args(more)
        .output()
        .unwrap()
}

fn pose_standard_input(text: &str) -> Output {
    let mut child = stick3d()
        .args(["pose", "--json", "--sketch", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(text.as_bytes())
        .unwrap();
    child.wait_with_output().unwrap()
}

fn error_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn joint(json: &Value, name: &str) -> [f64; 3] {
    let numbers = json["joints"][name]
        .as_array()
        .unwrap_or_else(|| panic!("no joint {name}"));
    [0, 1, 2].map(|axis| numbers[axis].as_f64().unwrap())
}

#[test]
fn json_tells_joints_latent_and_times() {
    let output = pose(&sketch("arms_up.json"), &["--json"]);
    assert!(output.status.success(), "{}", error_of(&output));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["joints"].as_object().unwrap().len(), 11);
    assert_eq!(json["latent"].as_array().unwrap().len(), 256);
    for step in ["encode", "infer", "decode"] {
        assert!(json["seconds"][step].as_f64().unwrap() > 0.0, "{step}");
    }
    let [neck, abdomen] = ["neck", "abdomen"].map(|name| joint(&json, name));
    assert!(neck[1] > abdomen[1] + 0.3, "he stands upright");
    for hand in ["hand_r", "hand_l"] {
        assert!(
            joint(&json, hand)[1] > neck[1] + 0.2,
            "{hand} is above the head"
        );
    }
    assert!(
        joint(&json, "hand_r")[0] < joint(&json, "hand_l")[0],
        "his right is at the viewer's left"
    );
    for foot in ["foot_r", "foot_l"] {
        assert!(
            (-0.01..0.25).contains(&joint(&json, foot)[1]),
            "{foot} is near the ground"
        );
    }
}

#[test]
fn json_tells_all_alternatives_the_answer_first() {
    for (name, limbs) in [("wave.json", 5), ("horse_walk.json", 6)] {
        let output = pose(&sketch(name), &["--json"]);
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        let alternatives = json["alternatives"].as_array().unwrap();
        assert!((1..=8).contains(&alternatives.len()));
        for key in ["joints", "limbs", "latent"] {
            assert_eq!(json[key], alternatives[0][key], "{key}");
        }
        let probability = |of: &Value| of["probability"].as_f64().unwrap();
        let sum: f64 = alternatives.iter().map(probability).sum();
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
        assert!(alternatives.is_sorted_by(|a, b| probability(a) >= probability(b)));
        for alternative in alternatives {
            assert_eq!(alternative["limbs"].as_object().unwrap().len(), limbs);
            let height = |name: &String| joint(alternative, name)[1];
            let names = alternative["joints"].as_object().unwrap().keys();
            let lowest = names.map(height).fold(f64::INFINITY, f64::min);
            assert!((0.0..0.3).contains(&lowest), "it stands on the ground");
        }
    }
    let output = pose(&sketch("horse_walk.json"), &["--json"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    // Its front legs hang on the shoulder.
    let deep = |name: &str| joint(&json, name)[2] - joint(&json, "shoulder")[2];
    for foot in ["foot_fr", "foot_fl"] {
        let toward = if deep(foot) >= 0.0 { "toward" } else { "away" };
        assert_eq!(json["limbs"][foot], toward, "{foot}");
    }
}

#[test]
fn an_alternative_is_chosen_by_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.obj");
    let write = |number: &str| {
        let out = ["--out", path.to_str().unwrap(), "--alternative", number];
        pose(&sketch("walk.json"), &out)
    };
    let first = write("1");
    assert!(first.status.success(), "{}", error_of(&first));
    let count = {
        let output = pose(&sketch("walk.json"), &["--json"]);
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        json["alternatives"].as_array().unwrap().len()
    };
    let last = write(&count.to_string());
    assert!(last.status.success(), "{}", error_of(&last));
    std::fs::remove_file(&path).unwrap();
    let beyond = write(&(count + 1).to_string());
    assert_eq!(beyond.status.code(), Some(2), "{}", error_of(&beyond));
    let said = error_of(&beyond);
    assert!(said.contains(&format!("from 1 to {count}")), "{said}");
    assert_eq!(write("0").status.code(), Some(2));
    assert!(!path.exists());
    let unused = pose(&sketch("walk.json"), &["--json", "--alternative", "1"]);
    assert_eq!(
        unused.status.code(),
        Some(2),
        "it chooses what --out writes"
    );
}

#[test]
fn a_sheet_is_drawn_of_the_sketches_of_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let copy = |name: &str| std::fs::copy(sketch(name), folder.path().join(name)).unwrap();
    let sheet = |sketches: &str| {
        let out = path("sheet.png");
        let arguments = ["eval", "--sheet", &out, "--sketches", sketches];
        stick3d().args(arguments).output().unwrap()
    };
    copy("horse_walk.json");
    let none = sheet(&path(""));
    assert_eq!(none.status.code(), Some(3));
    assert!(error_of(&none).contains("1 are of other figures"));
    copy("walk.json");
    let output = sheet(&path(""));
    assert!(output.status.success(), "{}", error_of(&output));
    let one = image::open(path("sheet.png")).unwrap().to_rgb8();
    copy("wave.json");
    copy("walk_strokes.json");
    assert!(sheet(&path("")).status.success());
    let three = image::open(path("sheet.png")).unwrap().to_rgb8();
    assert!(three.width() > 2 * one.width() && three.height() == one.height());
    assert_eq!(sheet(&path("nowhere")).status.code(), Some(3));
}

#[test]
fn the_figure_of_the_sketch_chooses_the_model() {
    let posed = |name: &str| -> Value {
        let output = pose(&sketch(name), &["--json"]);
        assert!(output.status.success(), "{name}: {}", error_of(&output));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    assert_eq!(posed("walk.json")["figure"], "human");
    for name in [
        "horse_walk.json",
        "horse_rear.json",
        "horse_graze_left.json",
    ] {
        let json = posed(name);
        assert_eq!(json["figure"], "horse");
        assert_eq!(json["joints"].as_object().unwrap().len(), 12);
        assert!(joint(&json, "hip")[1] > 0.6, "{name}: it stands");
    }
    let [walk, rear, graze] = [
        "horse_walk.json",
        "horse_rear.json",
        "horse_graze_left.json",
    ]
    .map(posed);
    // Which way it looks is where the head is.
    let ahead = |json: &Value| joint(json, "forehead")[0] - joint(json, "hip")[0];
    assert!(ahead(&walk) > 0.8, "walks to the right");
    assert!(ahead(&graze) < -0.8, "grazes to the left");
    let height = |json: &Value, name: &str| joint(json, name)[1];
    assert!(height(&rear, "foot_fr") > height(&walk, "foot_fr") + 0.4);
    assert!(height(&graze, "forehead") < height(&walk, "shoulder") - 0.2);
}

#[test]
fn a_named_model_is_for_sketches_of_its_figure_alone() {
    let human = workspace().join("assets/models/human.stick3d");
    let model = ["--json", "--model", human.to_str().unwrap()];
    let output = pose(&sketch("walk.json"), &model);
    assert!(output.status.success(), "{}", error_of(&output));
    let output = pose(&sketch("horse_walk.json"), &model);
    assert_eq!(output.status.code(), Some(3));
    let said = error_of(&output);
    assert!(said.contains("horse") && said.contains("human"), "{said}");
}

#[test]
fn every_format_is_written_whole() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["out.glb", "out.obj", "out.ply", "out.off", "out.png"] {
        let path = folder.path().join(name);
        let output = pose(&sketch("walk.json"), &["--out", path.to_str().unwrap()]);
        assert!(output.status.success(), "{name}: {}", error_of(&output));
        assert!(output.stdout.is_empty(), "only --json prints");
    }
    let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let starting =
        |text: &str, with: &str| text.lines().filter(|line| line.starts_with(with)).count();
    assert_eq!(starting(&text("out.obj"), "v "), HUMAN_VERTICES);
    assert!(text("out.ply").contains(&format!("element vertex {HUMAN_VERTICES}\n")));
    assert!(
        text("out.off")
            .lines()
            .any(|line| line.starts_with(&format!("{HUMAN_VERTICES} 24996")))
    );
    assert!(
        std::fs::read(folder.path().join("out.glb"))
            .unwrap()
            .starts_with(b"glTF")
    );
    let picture = image::open(folder.path().join("out.png"))
        .unwrap()
        .to_rgb8();
    let corner = *picture.get_pixel(0, 0);
    let covered = picture.pixels().filter(|pixel| {
        pixel
            .0
            .iter()
            .zip(corner.0)
            .any(|(a, b)| a.abs_diff(b) > 60)
    });
    assert!(covered.count() > 10_000, "the body is in the picture");
}

#[test]
fn every_form_of_sketch_gives_the_same_kind_of_answer() {
    for name in ["walk.json", "walk_strokes.json"] {
        let output = pose(&sketch(name), &["--json"]);
        assert!(output.status.success(), "{name}: {}", error_of(&output));
    }
    let text = std::fs::read_to_string(sketch("standing.json")).unwrap();
    let output = pose_standard_input(&text);
    assert!(output.status.success(), "{}", error_of(&output));
}

#[test]
fn wrong_sketches_end_with_3_and_say_why() {
    let points: Vec<String> = (0..17).map(|i| format!("[{i},{}]", i * i)).collect();
    let huge = format!(r#"{{"figure":"human","path":[{}]}}"#, points.join(","))
        .replace("[3,9]", "[3,1e30]");
    let cases = [
        ("{", "line 1"),
        (r#"{"figure":"dragon","joints":{"neck":[0,1]}}"#, "dragon"),
        (
            r#"{"figure":"hrose","joints":{"hip":[0,1]}}"#,
            "did you mean \"horse\"?",
        ),
        (r#"{"figure":"dragon","joints":{}}"#, "--model"),
        (r#"{"joints":{}}"#, "figure"),
        (r#"{"figure":"human","joints":{"nek":[0,1]}}"#, "neck"),
        (r#"{"figure":"human","joints":{"neck":[0,1]}}"#, "forehead"),
        (&huge, "path point 3"),
        (r#"{"figure":"human","path":[[0,0],[0,1]]}"#, "17"),
    ];
    for (text, expected) in cases {
        let output = pose_standard_input(text);
        assert_eq!(
            output.status.code(),
            Some(3),
            "{text}: {}",
            error_of(&output)
        );
        assert!(output.stdout.is_empty());
        assert!(
            error_of(&output).contains(expected),
            "{text}: {}",
            error_of(&output)
        );
    }
    let missing = pose(Path::new("no-such-file.json"), &["--json"]);
    assert_eq!(missing.status.code(), Some(3));
    assert!(error_of(&missing).contains("no-such-file.json"));
}

#[test]
fn wrong_models_end_with_4() {
    let folder = tempfile::tempdir().unwrap();
    let good = std::fs::read(workspace().join("assets/models/human.stick3d")).unwrap();
    let mut flipped = good.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 0x10;
    let cases: [(&str, &[u8]); 4] = [
        ("empty", b""),
        ("truncated", &good[..good.len() / 3]),
        ("bit-flipped", &flipped),
        ("foreign", b"{\"not\":\"a model\"}"),
    ];
    for (name, bytes) in cases {
        let path = folder.path().join(name);
        std::fs::File::create(&path)
            .unwrap()
            .write_all(bytes)
            .unwrap();
        let output = pose(
            &sketch("walk.json"),
            &["--json", "--model", path.to_str().unwrap()],
        );
        assert_eq!(
            output.status.code(),
            Some(4),
            "{name}: {}",
            error_of(&output)
        );
        assert!(
            error_of(&output).contains(name),
            "{name}: {}",
            error_of(&output)
        );
    }
}

#[test]
fn unwritable_outputs_end_with_5_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let nowhere = folder.path().join("no-such-folder/out.glb");
    for path in [nowhere.to_str().unwrap(), "out.step"] {
        let output = pose(&sketch("walk.json"), &["--out", path]);
        assert_eq!(
            output.status.code(),
            Some(5),
            "{path}: {}",
            error_of(&output)
        );
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn usage_errors_end_with_2_and_help_shows_an_example() {
    let output = stick3d().args(["pose"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    for command in ["pose", "train", "eval", "figure", "bake"] {
        let output = stick3d().args([command, "--help"]).output().unwrap();
        let help = String::from_utf8(output.stdout).unwrap();
        assert!(
            help.contains("Example") && help.contains("stick3d"),
            "{command}: {help}"
        );
    }
}

/// The error of a command line that must fail with a code and name some things.
fn refused(code: i32, arguments: &[&str], named: &[&str]) {
    let output = stick3d().args(arguments).output().unwrap();
    let error = error_of(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
    for part in named {
        assert!(
            error.contains(part),
            "{arguments:?} lacks {part:?}: {error}"
        );
    }
}

#[test]
fn meshes_and_rigs_do_not_mix() {
    let meshes = ["train", "--out", "x.stick3d", "--meshes", "."];
    let with = |more: &[&'static str]| [&meshes[..], more].concat();
    refused(2, &with(&[]), &["--figure"]);
    refused(2, &with(&["--figure", "f", "--rig", "r"]), &["--rig"]);
    refused(
        2,
        &with(&["--figure", "f", "--controls", "c"]),
        &["--controls"],
    );
    refused(2, &with(&["--figure", "f", "--poses", "p"]), &["--poses"]);
    refused(
        2,
        &["train", "--out", "x.stick3d", "--skip-mismatched"],
        &["--meshes"],
    );
    refused(
        2,
        &["train", "--out", "x.stick3d", "--scale", "2"],
        &["--meshes"],
    );
    refused(2, &["eval", "--meshes", "."], &["--model"]);
    let init = [
        "figure", "init", "--mesh", "m.off", "--out", "f.ron", "--preset",
    ];
    refused(
        2,
        &[&init[..], &["dragon"]].concat(),
        &["dragon", "scape", "tosca-horse"],
    );
}

#[test]
fn wrong_mesh_sets_end_with_3_and_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let write = |name: &str, text: &str| {
        std::fs::File::create(path(name))
            .unwrap()
            .write_all(text.as_bytes())
            .unwrap();
    };
    let joint = |name: &str, x: f32, vertex: u32| {
        format!(
            "(name: {name:?}, side: Center, template: ({x:?}, 0.0), anchor: Vertices([{vertex}])),"
        )
    };
    let figure = format!(
        "Figure(name: \"rod\", root: \"a\", joints: [{}{}], path: [\"a\", \"b\"], bones: [(\"a\", \"b\")])",
        joint("a", 0.0, 0),
        joint("b", 1.0, 1)
    );
    write("rod.ron", &figure);
    let (meshes, rod) = (folder.path().to_str().unwrap(), path("rod.ron"));
    let (rod, work, out) = (rod.to_str().unwrap(), path("work"), path("rod.stick3d"));
    let (work, out) = (work.to_str().unwrap(), out.to_str().unwrap());
    let train = [
        "train",
        "--meshes",
        meshes,
        "--figure",
        rod,
        "--out",
        out,
        "--work-dir",
        work,
    ];
    refused(3, &train, &["holds no mesh"]);
    let tetrahedron =
        "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    write("mesh1.off", tetrahedron);
    write("mesh2.off", tetrahedron);
    write("mesh3.off", &tetrahedron.replace("0 0 1\n", "0 0 nan\n"));
    refused(3, &train, &["mesh3.off, line 6", "vertex 3"]);
    let larger = tetrahedron.replace("4 4 0\n", "5 4 0\n9 9 9\n");
    write("mesh3.off", &larger);
    refused(
        3,
        &train,
        &["mesh3.off", "5 vertices", "4", "--skip-mismatched"],
    );
    let skip = [&train[..], &["--skip-mismatched"]].concat();
    let pilot = [&skip[..], &["--pilot", "mesh9.off"]].concat();
    refused(3, &pilot, &["mesh9.off", "did you mean"]);
    let negative = [&skip[..], &["--scale=-1"]].concat();
    refused(3, &negative, &["the scale is -1"]);
    write("rod.ron", &figure.replace("[1]", "[4]"));
    refused(3, &skip, &["joint `b`", "vertex 4"]);
    let init = [
        "figure", "init", "--preset", "scape", "--out", out, "--mesh",
    ];
    let mesh = path("mesh1.off");
    refused(
        3,
        &[&init[..], &[mesh.to_str().unwrap()]].concat(),
        &["mesh1.off"],
    );
    assert!(!path("rod.stick3d").exists());
}
