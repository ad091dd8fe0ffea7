//! `stick3d animate` as a person runs it: what it writes, and how it ends when something is wrong.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use gltf::animation::util::ReadOutputs;

fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets")
}

fn sketch(name: &str) -> String {
    let path = assets().join("sketches").join(name);
    path.to_str().unwrap().to_owned()
}

fn animate(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stick3d"));
    command.arg("animate").args(arguments).output().unwrap()
}

/// Runs with sketches before the other arguments.
fn of_sketches(names: &[&str], more: &[&str]) -> Output {
    let files: Vec<String> = names.iter().map(|name| sketch(name)).collect();
    let mut arguments: Vec<&str> = files.iter().flat_map(|file| ["--sketch", file]).collect();
    arguments.extend(more);
    animate(&arguments)
}

fn error_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What a command that must succeed prints.
fn said(output: &Output) -> String {
    assert!(output.status.success(), "{}", error_of(output));
    assert!(output.stderr.is_empty(), "{}", error_of(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Asserts how a command failed.
fn refused(output: &Output, code: i32, named: &[&str]) {
    let error = error_of(output);
    assert_eq!(output.status.code(), Some(code), "{error}");
    assert!(output.stdout.is_empty());
    for part in named {
        assert!(error.contains(part), "lacks {part:?}: {error}");
    }
}

/// A folder for one test, and paths in it.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    fn write(&self, name: &str, text: &str) -> String {
        let path = self.path(name);
        let mut file = std::fs::File::create(&path).unwrap();
        file.write_all(text.as_bytes()).unwrap();
        path
    }

    fn count(&self) -> usize {
        std::fs::read_dir(self.0.path()).unwrap().count()
    }
}

/// The times of a file's animation, the number of its morph targets, and where its node is.
fn animation(path: &str) -> (Vec<f32>, usize, Vec<[f32; 3]>) {
    let file = gltf::Gltf::open(path).unwrap();
    let blob = file.blob.as_deref().unwrap();
    let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
    let targets = primitive.morph_targets().count();
    let (mut times_s, mut places) = (vec![], vec![]);
    for channel in file.animations().next().unwrap().channels() {
        let reader = channel.reader(|_| Some(blob));
        times_s = reader.read_inputs().unwrap().collect();
        match reader.read_outputs().unwrap() {
            ReadOutputs::MorphTargetWeights(weights) => {
                assert_eq!(weights.into_f32().count(), times_s.len() * targets);
            }
            ReadOutputs::Translations(values) => places = values.collect(),
            _ => panic!("nothing else moves"),
        }
    }
    (times_s, targets, places)
}

#[test]
fn sketches_become_one_file_that_plays() {
    let place = Place::new();
    let out = place.path("wave.glb");
    let arguments = ["--seconds", "1", "--past", "0.5", "--out", &out];
    let output = of_sketches(&["standing.json", "walk.json", "wave.json"], &arguments);
    let said = said(&output);
    for part in [
        "wave.glb",
        "1.50 s",
        "46 frames",
        "morph targets",
        "mm",
        "MB",
    ] {
        assert!(said.contains(part), "lacks {part:?}: {said}");
    }
    let (times_s, targets, places) = animation(&out);
    assert_eq!((times_s.len(), places.len()), (46, 46));
    assert_eq!((times_s[0], times_s[45]), (0.0, 1.5));
    assert!((3..40).contains(&targets), "{targets}");
    assert!(
        places.iter().all(|place| place[1] > 0.5),
        "the root is above the ground"
    );
    assert!(std::fs::metadata(&out).unwrap().len() < 12_000_000);
}

#[test]
fn options_change_the_motion() {
    let place = Place::new();
    let made = |name: &str, more: &[&str]| {
        let out = place.path(name);
        let arguments = [&["--seconds", "0.4", "--fps", "20", "--out", &out], more].concat();
        said(&of_sketches(
            &["standing.json", "walk.json", "run.json"],
            &arguments,
        ));
        animation(&out)
    };
    let (once, _, places) = made("once.glb", &[]);
    assert_eq!((once.len(), places.len()), (9, 9));
    let (_, _, places) = made("floating.glb", &["--grounded", "off"]);
    assert!(places.is_empty());
    let (times_s, _, _) = made("loop.glb", &["--repeat", "loop"]);
    assert_eq!((times_s.len(), times_s[12]), (13, 0.6));
    let (times_s, _, _) = made("ping_pong.glb", &["--repeat", "ping-pong"]);
    assert_eq!((times_s.len(), times_s[16]), (17, 0.8));
    let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
    made("cubic.glb", &["--interpolation", "cubic"]);
    assert_ne!(bytes("once.glb"), bytes("cubic.glb"));
    for (name, beyond) in [
        ("b.glb", "bounded"),
        ("u.glb", "unbounded"),
        ("h.glb", "hold"),
    ] {
        made(name, &["--past", "0.4", "--extrapolation", beyond]);
    }
    assert!(bytes("b.glb") != bytes("u.glb") && bytes("b.glb") != bytes("h.glb"));
}

#[test]
fn a_clip_file_says_everything_and_the_command_line_more() {
    let place = Place::new();
    std::fs::copy(sketch("horse_walk.json"), place.path("walk.json")).unwrap();
    std::fs::copy(sketch("horse_rear.json"), place.path("rear.json")).unwrap();
    let clip = place.write(
        "rear.clip.ron",
        "Clip(figure: \"horse\", interpolation: Cubic, repeat: Loop(closing_s: 0.5), keys: [\
            (time_s: 2.0, pose: Sketch(\"walk.json\")),\
            (time_s: 2.5, easing: InOut, pose: Sketch(\"rear.json\")),\
            (time_s: 3.0, pose: Sketch(\"walk.json\")),\
        ])",
    );
    let out = place.path("rear.glb");
    said(&animate(&["--clip", &clip, "--out", &out]));
    let (times_s, _, places) = animation(&out);
    // The last pose is the first, so the loop closes itself.
    assert_eq!((times_s.len(), times_s[30]), (31, 1.0));
    assert!(!places.is_empty());
    said(&animate(&[
        "--clip",
        &clip,
        "--grounded",
        "off",
        "--repeat",
        "ping-pong",
        "--out",
        &out,
    ]));
    let (times_s, _, places) = animation(&out);
    assert_eq!((times_s.len(), places.len()), (61, 0));
    let model = assets().join("models/horse.stick3d");
    said(&animate(&[
        "--clip",
        &clip,
        "--model",
        model.to_str().unwrap(),
        "--out",
        &out,
    ]));
}

#[test]
fn frames_become_numbered_files_in_a_new_folder() {
    let place = Place::new();
    for (format, ending) in [("obj-sequence", "obj"), ("png-sequence", "png")] {
        let out = place.path(ending);
        let arguments = [
            "--seconds",
            "0.2",
            "--fps",
            "10",
            "--format",
            format,
            "--out",
            &out,
        ];
        let said = said(&of_sketches(&["standing.json", "wave.json"], &arguments));
        assert!(said.contains('3'), "{said}");
        let mut names: Vec<_> = std::fs::read_dir(&out)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(names, [1, 2, 3].map(|i| format!("frame_000{i}.{ending}")));
        let again = of_sketches(&["standing.json", "wave.json"], &arguments);
        refused(&again, 5, &[&out, "there already"]);
    }
    let text = std::fs::read_to_string(place.path("obj/frame_0002.obj")).unwrap();
    let heights = text.lines().filter_map(|line| line.strip_prefix("v "));
    let heights = heights.map(|line| line.split(' ').nth(1).unwrap().parse::<f32>().unwrap());
    let lowest = heights.fold(f32::INFINITY, f32::min);
    assert!(
        lowest.abs() < 0.03,
        "he stands on the ground, not at {lowest}"
    );
    let picture = |i: usize| image::open(place.path(&format!("png/frame_000{i}.png"))).unwrap();
    assert_ne!(picture(1), picture(3));
    assert_eq!(place.count(), 2);
}

#[test]
fn wrong_command_lines_end_with_2() {
    let place = Place::new();
    let out = place.path("out.glb");
    let two = ["standing.json", "wave.json"];
    let with =
        |names: &[&str], more: &[&str]| of_sketches(names, &[more, &["--out", &out]].concat());
    refused(
        &with(&["wave.json"], &["--seconds", "1"]),
        2,
        &["at least two keys"],
    );
    refused(&with(&two, &[]), 2, &["--seconds"]);
    for seconds in ["0", "-1", "nan", "inf", "soon"] {
        refused(&with(&two, &["--seconds", seconds]), 2, &["seconds"]);
    }
    for fps in ["0", "-30", "nan", "inf"] {
        let output = with(&two, &["--seconds", "1", "--fps", fps]);
        refused(&output, 2, &["frames a second"]);
    }
    for past in ["-0.5", "nan"] {
        refused(
            &with(&two, &["--seconds", "1", "--past", past]),
            2,
            &["after its last key"],
        );
    }
    refused(&with(&two, &["--seconds", "1e6"]), 2, &["1800 frames"]);
    refused(
        &with(&two, &["--seconds", "1", "--clip", "c"]),
        2,
        &["--clip"],
    );
    refused(&with(&[], &[]), 2, &["--sketch", "--clip"]);
    refused(
        &with(&two, &["--seconds", "1", "--repeat", "often"]),
        2,
        &["ping-pong"],
    );
    assert_eq!(place.count(), 0);
}

#[test]
fn wrong_sketches_end_with_3_and_leave_nothing() {
    let place = Place::new();
    let out = place.path("out.glb");
    let more = ["--seconds", "1", "--out", &out];
    let mixed = of_sketches(&["walk.json", "horse_walk.json"], &more);
    refused(&mixed, 3, &["horse_walk.json", "human", "horse"]);
    refused(
        &of_sketches(&["walk.json", "none.json"], &more),
        3,
        &["none.json"],
    );
    let point = place.write(
        "point.json",
        r#"{"figure":"human","path":[[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1],[1,1]]}"#,
    );
    let walk = sketch("walk.json");
    let arguments = [&["--sketch", &walk, "--sketch", &point][..], &more].concat();
    refused(&animate(&arguments), 3, &[]);
    assert_eq!(place.count(), 1);
}

#[test]
fn wrong_clip_files_end_with_3_and_say_where() {
    let place = Place::new();
    let out = place.path("out.glb");
    let latent = |x: &str, len: usize| format!("Latent([{}])", vec![x; len].join(", "));
    let clip = |figure: &str, keys: &[(f32, String)]| {
        let key = |(time_s, pose): &(f32, String)| format!("(time_s: {time_s:?}, pose: {pose})");
        let keys: Vec<String> = keys.iter().map(key).collect();
        format!("Clip(figure: {figure:?}, keys: [{}])", keys.join(", "))
    };
    let good = latent("0.0", 256);
    let key = |time_s: f32| (time_s, good.clone());
    let cases = [
        (clip("human", &[key(0.0)]), "at least two keys"),
        (
            clip("human", &[key(1.0), key(1.0)]),
            "keys 1 and 2 are both at 1 s",
        ),
        (
            clip("human", &[key(1.0), key(0.5)]),
            "key 2 is at 0.5 s, before key 1",
        ),
        (
            clip("human", &[key(0.0), (1.0, latent("0.0", 255))]),
            "key 2 has 255 numbers",
        ),
        (
            clip("human", &[(0.0, latent("0.0", 9)), (1.0, latent("0.0", 9))]),
            "9 numbers",
        ),
        (
            clip("human", &[key(0.0), (1.0, latent("NaN", 256))]),
            "key 2 has a number that is not",
        ),
        (
            clip("human", &[key(0.0), (f32::NAN, good.clone())]),
            "time of key 2 is NaN",
        ),
        (
            clip("human", &[key(0.0), (1.0, "Sketch(\"none.json\")".into())]),
            "none.json",
        ),
        (
            clip("dragon", &[key(0.0), key(1.0)]),
            "no model of figure \"dragon\"",
        ),
        (
            clip("hrose", &[key(0.0), key(1.0)]),
            "did you mean \"horse\"?",
        ),
        ("Clip(figure: \"human\", keys: [".to_owned(), "line 1"),
        (
            "Clip(figure: \"human\", keys: [], speed: 2)".to_owned(),
            "speed",
        ),
    ];
    for (text, expected) in &cases {
        let path = place.write("wrong.clip.ron", text);
        let output = animate(&["--clip", &path, "--out", &out]);
        refused(&output, 3, &["wrong.clip.ron", expected]);
    }
    refused(
        &animate(&["--clip", "none.clip.ron", "--out", &out]),
        3,
        &["none.clip.ron"],
    );
    assert_eq!(place.count(), 1);
}

#[test]
fn missing_models_and_models_of_other_figures_are_refused() {
    let place = Place::new();
    let out = place.path("out.glb");
    let more = ["--seconds", "1", "--out", &out, "--model", "none.stick3d"];
    let output = of_sketches(&["walk.json", "wave.json"], &more);
    refused(&output, 4, &["none.stick3d"]);
    let clip = place.write(
        "horse.clip.ron",
        "Clip(figure: \"horse\", keys: [(time_s: 0.0, pose: Latent([0.0])), (time_s: 1.0, pose: Latent([1.0]))])",
    );
    let human = assets().join("models/human.stick3d");
    let human = human.to_str().unwrap();
    let output = animate(&["--clip", &clip, "--model", human, "--out", &out]);
    refused(&output, 3, &["horse.clip.ron", "\"horse\"", "\"human\""]);
    let output = animate(&["--clip", &clip, "--model", "none.stick3d", "--out", &out]);
    refused(&output, 4, &["none.stick3d"]);
    assert_eq!(place.count(), 1);
}

#[test]
fn unwritable_outputs_end_with_5_and_leave_nothing() {
    let place = Place::new();
    let with = |more: &[&str]| {
        let arguments = [&["--seconds", "0.1"], more].concat();
        of_sketches(&["standing.json", "wave.json"], &arguments)
    };
    for name in ["none/out.glb", "out.obj", "out"] {
        let out = place.path(name);
        refused(&with(&["--out", &out]), 5, &[&out]);
    }
    for format in ["obj-sequence", "png-sequence"] {
        let out = place.path("none/frames");
        refused(&with(&["--format", format, "--out", &out]), 5, &[&out]);
        let file = place.write("file", "mine");
        refused(&with(&["--format", format, "--out", &file]), 5, &[&file]);
    }
    assert_eq!(std::fs::read_to_string(place.path("file")).unwrap(), "mine");
    assert_eq!(place.count(), 1);
}
