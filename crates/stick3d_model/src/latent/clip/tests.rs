//! Clip files: there and back, and what is wrong with bad ones.

use super::*;
use crate::latent::PathError;
use crate::synthetic::{Kind, model};

const CLIP: &str = r#"Clip(
    figure: "human",
    interpolation: Cubic,
    repeat: Loop(closing_s: 0.5),
    keys: [
        (time_s: 0, pose: Sketch("stand.json")),
        (time_s: 0.4, easing: InOut, pose: Sketch("stand.json")),
        (time_s: 0.9, pose: Latent([1, 0, 0, 0, 0, 0, 0, 0])),
    ],
)"#;

fn inference() -> Inference {
    Inference::new(&model(Kind::Rotations)).unwrap()
}

fn stand(file: &str) -> io::Result<Vec<u8>> {
    if file != "stand.json" {
        return Err(io::Error::from(io::ErrorKind::NotFound));
    }
    let human = Figure::human();
    Ok(Sketch::template(human).to_json(human).unwrap().into_bytes())
}

fn message(text: &str) -> String {
    let clip = ClipFile::from_ron(text);
    let motion = clip.and_then(|clip| clip.motion(&mut inference(), stand));
    motion.unwrap_err().to_string()
}

#[test]
fn there_and_back() {
    let mut clip = ClipFile::from_ron(CLIP).unwrap();
    assert!(clip.grounded && clip.extrapolation == Extrapolation::default());
    assert_eq!(clip.sketch_files().count(), 2);
    let human = Figure::human();
    clip.keys[1].pose = ClipPose::of_sketch(human, &Sketch::template(human));
    for repeat in [
        Repeat::Once,
        Repeat::PingPong,
        Repeat::Loop { closing_s: None },
        Repeat::Loop {
            closing_s: Some(1.0),
        },
    ] {
        clip.repeat = repeat;
        for extrapolation in [
            Extrapolation::Hold,
            Extrapolation::Unbounded,
            Extrapolation::PingPong { least_trust: 0.25 },
        ] {
            clip.extrapolation = extrapolation;
            let text = clip.to_ron().unwrap();
            assert_eq!(ClipFile::from_ron(&text).unwrap(), clip, "{text}");
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.clip.ron");
    clip.save(&path).unwrap();
    let sketch = stand("stand.json").unwrap();
    write_atomically(&folder.path().join("stand.json"), &sketch).unwrap();
    let loaded = ClipFile::load(&path).unwrap();
    assert_eq!(loaded, clip);
    let motion = loaded
        .motion(&mut inference(), ClipFile::beside(&path))
        .unwrap();
    let again = clip.motion(&mut inference(), stand).unwrap();
    assert_eq!(motion, again);
    let missing = ClipFile::load(&folder.path().join("none.clip.ron")).unwrap_err();
    assert!(missing.to_string().contains("none.clip.ron"));
}

#[test]
fn a_sketch_in_the_clip_is_the_sketch_in_a_file() {
    let mut clip = ClipFile::from_ron(CLIP).unwrap();
    let human = Figure::human();
    clip.keys[1].pose = ClipPose::of_sketch(human, &Sketch::template(human));
    let keys = clip.latent_keys(&mut inference(), stand).unwrap();
    assert_eq!(keys[0].latent, keys[1].latent);
    assert_eq!((keys[1].time_s, keys[1].easing), (0.4, Easing::InOut));
    let sketches = clip.sketches(human, stand).unwrap();
    assert_eq!(sketches[1], Some(Sketch::template(human)));
    assert_eq!(sketches[2], None);
}

#[test]
fn syntax_errors_name_the_line() {
    for (from, to, line, word) in [
        (
            "interpolation: Cubic",
            "interpolation: Cubik",
            "line 3",
            "Cubik",
        ),
        ("easing: InOut", "easing: Bounce", "line 7", "Bounce"),
        ("time_s: 0.9", "time: 0.9", "line 8", "time"),
        ("figure", "figur", "line 2", "figur"),
    ] {
        let message = message(&CLIP.replace(from, to));
        assert!(
            message.contains(line) && message.contains(word),
            "{message}"
        );
    }
    assert!(message("").contains("line 1"));
}

#[test]
fn wrong_keys_are_numbered() {
    for (from, to, words) in [
        (
            "\"human\"",
            "\"horse\"",
            "figure \"horse\", but the model draws \"human\"",
        ),
        (
            "easing: InOut, pose: Sketch(\"stand",
            "pose: Sketch(\"sit",
            "key 2: sketch file \"sit.json\"",
        ),
        (
            "Latent([1, 0,",
            "Latent([1,",
            "latent of key 3 has 7 numbers, expected 8",
        ),
        (
            "Latent([1, 0,",
            "Latent([NaN, 0,",
            "key 3 has a number that is not finite, or huge, at index 0",
        ),
        (
            "time_s: 0.9",
            "time_s: 0.4",
            "keys 2 and 3 are both at 0.4 s",
        ),
        (
            "time_s: 0.9",
            "time_s: 0.1",
            "key 3 is at 0.1 s, before key 2 at 0.4 s",
        ),
        ("time_s: 0.9", "time_s: inf", "time of key 3"),
        ("closing_s: 0.5", "closing_s: 0", "in 0 s"),
    ] {
        let message = message(&CLIP.replacen(from, to, 1));
        assert!(message.contains(words), "{message}");
    }
    let message = message(&CLIP.replace("Sketch(\"stand.json\")", "Joints({\"nek\": (0, 1)})"));
    assert!(
        message.contains("key 1") && message.contains("neck"),
        "{message}"
    );
    let one = ClipFile {
        keys: ClipFile::from_ron(CLIP).unwrap().keys[..1].to_vec(),
        ..ClipFile::from_ron(CLIP).unwrap()
    };
    assert!(matches!(
        one.motion(&mut inference(), stand),
        Err(ClipError::Path(PathError::TooFewKeys { found: 1 }))
    ));
}

#[test]
fn a_sketch_of_another_figure_is_named() {
    let clip = ClipFile::from_ron(CLIP).unwrap();
    let other = |_: &str| Ok(br#"{"figure": "horse", "joints": {}}"#.to_vec());
    let message = clip
        .motion(&mut inference(), other)
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("key 1") && message.contains("horse"),
        "{message}"
    );
}
