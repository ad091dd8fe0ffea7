//! The sketch files of `tests/corpus` and `assets/sketches`, and files broken at random.

#![allow(
    clippy::unwrap_used,
    reason = "the helpers of tests may panic as tests do"
)]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::Vec2;
use proptest::prelude::*;
use stick3d_figure::interchange::figure_name;
use stick3d_figure::{Drawing, Figure, Sketch, Stroke};

/// What the error about each file of `corpus/bad` must say.
const BAD: &[(&str, &str)] = &[
    ("all_at_one_place", "all joints coincide at (3, 4)"),
    ("array", "invalid type"),
    ("beyond_f32", r#"joint "hand_l" is at (0, -inf)"#),
    ("bit_flipped", "control character"),
    ("deeply_nested", "invalid type"),
    ("deeply_nested_strokes", "invalid"),
    ("dots", "nothing is drawn: 3 strokes"),
    ("empty", "line 1, column 0: EOF"),
    ("figure_is_number", "invalid type"),
    ("foreign_joint", r#"no joint "wing"; known are: forehead"#),
    ("huge", r#"joint "hand_l" is at (10000000, 0)"#),
    ("infinite", "out of range"),
    ("invalid_utf8", "line 1"),
    ("joint_twice", r#"joint "abdomen" is given twice"#),
    ("missing_joint", r#"joint "foot_l" is missing"#),
    ("nan", "expected value"),
    ("no_figure", "missing field `figure`"),
    ("no_form", "has 0 of"),
    ("no_joints", r#"joint "forehead" is missing"#),
    ("no_strokes", "nothing is drawn: 0 strokes"),
    ("not_json", "line 1, column 2: expected"),
    ("null_coordinate", "invalid type: null"),
    ("one_number", "expected a point [x, y]"),
    ("only_a_head", r#"the next joint to draw is "elbow_r""#),
    ("path_huge", "path point 16 is at (0, 2000000)"),
    ("path_too_long", "18 points given for 17 path points"),
    ("path_too_short", "16 points given for 17 path points"),
    (
        "stroke_huge",
        "stroke 1: point 1 of the stroke is at (0, 3000000)",
    ),
    ("text_coordinate", "invalid type: string"),
    ("three_numbers", "expected a point [x, y]"),
    ("trailing_text", "trailing characters"),
    ("truncated", "EOF"),
    ("two_forms", "has 2 of"),
    ("unknown_field", "unknown field `joint`"),
    (
        "unknown_joint",
        r#"no joint "elbow_rigth"; did you mean "elbow_r"?"#,
    ),
    (
        "wrong_figure",
        r#"of figure "horse", but "human" is needed"#,
    ),
    ("y_sideways", "unknown variant `left`"),
];

fn here() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus")
}

fn json_files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    assert!(!files.is_empty(), "no files in {}", folder.display());
    files
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap().to_string_lossy().into_owned()
}

#[test]
fn good_files_all_show_the_same_man() {
    let human = Figure::human();
    let read = |path: &Path| Sketch::from_json(human, &std::fs::read(path).unwrap()).unwrap();
    let expected = read(&here().join("good/joints.json"))
        .input_vector(human)
        .unwrap();
    for path in json_files(&here().join("good")) {
        let input = read(&path).input_vector(human).unwrap();
        for (got, want) in input.iter().zip(&expected) {
            assert!(
                (got - want).abs() < 0.25,
                "{}: {got} {want}",
                path.display()
            );
        }
    }
}

#[test]
fn bad_files_are_refused_with_what_and_where() {
    let human = Figure::human();
    let listed: BTreeSet<String> = BAD.iter().map(|(name, _)| (*name).to_owned()).collect();
    let there: BTreeSet<String> = json_files(&here().join("bad"))
        .iter()
        .map(|path| stem(path))
        .collect();
    assert_eq!(listed, there);
    for (name, expected) in BAD {
        let bytes = std::fs::read(here().join(format!("bad/{name}.json"))).unwrap();
        let message = Sketch::from_json(human, &bytes).unwrap_err().to_string();
        assert!(message.contains(expected), "{name}: {message}");
    }
}

/// The shipped figure that a sketch file names.
fn figure_of(bytes: &[u8]) -> &'static Figure {
    let file: serde_json::Value = serde_json::from_slice(bytes).unwrap();
    match file["figure"].as_str() {
        Some("horse") => Figure::horse(),
        _ => Figure::human(),
    }
}

#[test]
fn the_sample_sketches_are_natural() {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/sketches");
    let files = json_files(&samples);
    assert!(files.len() >= 8);
    for path in files {
        let bytes = std::fs::read(&path).unwrap();
        let figure = figure_of(&bytes);
        if figure_name(&bytes).unwrap() != figure.name {
            // Of a figure that does not ship.
            continue;
        }
        let drawing = Drawing::from_json(figure, &bytes).unwrap();
        let sketch = drawing.sketch(figure).unwrap();
        assert_eq!(sketch, Sketch::from_json(figure, &bytes).unwrap());
        if matches!(drawing, Drawing::Joints(_)) {
            // Metres: no bone is longer than the figure's own, and it stands on the ground.
            for (bone, &[a, b]) in figure.bones.iter().enumerate() {
                let length = sketch.points()[a].distance(sketch.points()[b]);
                let name = &figure.joints[b].name;
                let most = figure.template_bone_length(bone) * 1.2;
                assert!(
                    length <= most,
                    "{}: {name} {length} of {most}",
                    path.display()
                );
            }
            let lowest = sketch
                .points()
                .iter()
                .map(|p| p.y)
                .fold(f32::INFINITY, f32::min);
            assert!((0.0..0.5).contains(&lowest), "{}: {lowest}", path.display());
        }
    }
}

#[test]
fn walking_by_strokes_is_walking_by_joints() {
    let human = Figure::human();
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/sketches");
    let [joints, strokes] = ["walk.json", "walk_strokes.json"].map(|name| {
        let bytes = std::fs::read(samples.join(name)).unwrap();
        Sketch::from_json(human, &bytes)
            .unwrap()
            .input_vector(human)
            .unwrap()
    });
    for (a, b) in joints.iter().zip(&strokes) {
        assert!((a - b).abs() < 0.2, "{a} {b}");
    }
}

fn points(count: impl Into<prop::collection::SizeRange>) -> impl Strategy<Value = Vec<Vec2>> {
    prop::collection::vec(
        (-1.0e3f32..1.0e3, -1.0e3f32..1.0e3).prop_map(Vec2::from),
        count,
    )
}

fn drawings() -> impl Strategy<Value = Drawing> {
    let human = Figure::human();
    prop_oneof![
        points(11).prop_map(|p| Drawing::Joints(Sketch::new(human, p).unwrap())),
        points(17).prop_map(Drawing::Path),
        prop::collection::vec(points(0..20), 0..6).prop_map(|strokes| {
            let stroke = |points: Vec<Vec2>| Stroke::from_positions(points).unwrap();
            Drawing::Strokes(strokes.into_iter().map(stroke).collect())
        }),
    ]
}

proptest! {
    #[test]
    fn drawings_round_trip(drawing in drawings()) {
        let human = Figure::human();
        let text = drawing.to_json(human).unwrap();
        prop_assert_eq!(Drawing::from_json(human, text.as_bytes()).unwrap(), drawing);
    }

    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let human = Figure::human();
        prop_assert!(Sketch::from_json(human, &bytes).is_err());
    }

    #[test]
    fn broken_files_never_panic(
        drawing in drawings(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        cut_it in any::<bool>(),
    ) {
        let human = Figure::human();
        let mut bytes = drawing.to_json(human).unwrap().into_bytes();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if cut_it {
            bytes.truncate(cut.index(bytes.len()));
        }
        match Sketch::from_json(human, &bytes) {
            Ok(sketch) => {
                prop_assert!(sketch.input_vector(human).unwrap().iter().all(|v| v.is_finite()));
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }

    #[test]
    fn broken_figures_never_panic(at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in any::<bool>()) {
        let mut bytes = Figure::human().to_ron().unwrap().into_bytes();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        if cut {
            bytes.truncate(at);
        }
        let _ = Figure::from_ron(&String::from_utf8_lossy(&bytes));
    }
}
