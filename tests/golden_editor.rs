//! The editor's own picture of a sketch, compared with the one that was approved.
//!
//! `UPDATE_GOLDEN=1 cargo test -p bevy_stick3d --examples --test golden_editor` approves the present picture; look at it first.
//! Where there is no graphics adapter the test says so and passes, unless `STICK3D_REQUIRE_GPU=1`.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

use std::path::{Path, PathBuf};
use std::process::Command;

use image::RgbImage;

/// What the editor ends with where there is no graphics adapter.
const NO_GPU: i32 = 4;
/// Drivers round differently: so much may the mean channel differ, of 255 ...
const MEAN_DIFFERENCE: f64 = 1.5;
/// ... and this share of the pixels may differ by more than [`PIXEL_DIFFERENCE`].
const DIFFERING_SHARE: f64 = 0.01;
const PIXEL_DIFFERENCE: u8 = 24;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The example, which Cargo builds beside the tests.
fn editor() -> PathBuf {
    let tests = std::env::current_exe().unwrap();
    let profile = tests.parent().and_then(Path::parent).unwrap();
    let editor = profile
        .join("examples")
        .join(format!("pose_editor{}", std::env::consts::EXE_SUFFIX));
    assert!(
        editor.exists(),
        "{} is not built; run `cargo build -p bevy_stick3d --examples` first",
        editor.display()
    );
    editor
}

/// Takes a picture of a sketch or clip; none where there is no graphics adapter.
fn picture(what: &[&str], out: &Path) -> Option<RgbImage> {
    let output = Command::new(editor())
        .current_dir(workspace())
        .args(["--size", "960x540"])
        .args(what)
        .arg("--screenshot")
        .arg(out)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(NO_GPU) {
        let required = std::env::var_os("STICK3D_REQUIRE_GPU").is_some_and(|value| value == "1");
        assert!(!required, "a graphics adapter is required: {said}");
        println!("skipped: {said}");
        return None;
    }
    assert!(
        output.status.success(),
        "the editor ended with {}: {said}",
        output.status
    );
    Some(image::open(out).unwrap().to_rgb8())
}

/// The mean difference of a channel, and the share of pixels that differ visibly.
fn difference(a: &RgbImage, b: &RgbImage) -> (f64, f64) {
    assert_eq!(a.dimensions(), b.dimensions());
    let (mut sum, mut differing) = (0_u64, 0_u64);
    for (a, b) in a.pixels().zip(b.pixels()) {
        let channels = a.0.iter().zip(&b.0).map(|(a, b)| a.abs_diff(*b));
        sum += channels.clone().map(u64::from).sum::<u64>();
        differing += u64::from(channels.max().unwrap_or(0) > PIXEL_DIFFERENCE);
    }
    let pixels = f64::from(a.width()) * f64::from(a.height());
    (sum as f64 / (3.0 * pixels), differing as f64 / pixels)
}

/// Fails unless the picture is the approved one; approves it where that is asked for.
fn assert_approved(what: &[&str], golden: &str) {
    let golden = workspace().join("tests/golden").join(golden);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("editor.png");
    let Some(shown) = picture(what, &out) else {
        return;
    };
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::create_dir_all(golden.parent().unwrap()).unwrap();
        std::fs::copy(&out, &golden).unwrap();
        return;
    }
    let approved = image::open(&golden)
        .unwrap_or_else(|error| panic!("{}: {error}; see the top of this file", golden.display()))
        .to_rgb8();
    let (mean, share) = difference(&shown, &approved);
    if mean > MEAN_DIFFERENCE || share > DIFFERING_SHARE {
        let name = golden.file_name().unwrap().to_string_lossy().into_owned();
        let kept = std::env::temp_dir().join(format!("stick3d_differs_{name}"));
        std::fs::copy(&out, &kept).unwrap();
        panic!(
            "the picture differs: mean {mean:.2} of 255 (at most {MEAN_DIFFERENCE}), {:.2} % of the pixels \
             (at most {:.2} %); look at {}",
            share * 100.0,
            DIFFERING_SHARE * 100.0,
            kept.display()
        );
    }
}

#[test]
fn the_editor_shows_a_man_as_he_was_approved() {
    assert_approved(&["--sketch", "assets/sketches/wave.json"], "editor.png");
}

#[test]
fn the_editor_shows_a_horse_as_it_was_approved() {
    assert_approved(
        &["--sketch", "assets/sketches/horse_walk.json"],
        "editor_horse.png",
    );
}

#[test]
fn the_animation_mode_shows_a_clip_as_it_was_approved() {
    assert_approved(
        &["--clip", "tests/data/wave.clip.ron", "--at", "0.5"],
        "editor_animate.png",
    );
}

#[test]
fn the_comparison_sees_a_moved_figure() {
    let blank = RgbImage::from_pixel(100, 100, image::Rgb([250, 247, 240]));
    let mut drawn = blank.clone();
    for y in 20..80 {
        for x in 45..55 {
            drawn.put_pixel(x, y, image::Rgb([40, 40, 40]));
        }
    }
    assert_eq!(difference(&blank, &blank), (0.0, 0.0));
    let (mean, share) = difference(&blank, &drawn);
    assert!(mean > MEAN_DIFFERENCE && share > DIFFERING_SHARE);
}

#[test]
fn a_bad_sketch_ends_with_one_sentence_and_code_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("never.png");
    let output = Command::new(editor())
        .arg("--sketch")
        .arg(folder.path().join("missing.json"))
        .arg("--screenshot")
        .arg(&out)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(
        said.contains("missing.json") && !said.contains("panicked"),
        "{said}"
    );
    assert!(!out.exists());
}

#[test]
fn a_clip_with_one_key_ends_with_one_sentence_and_code_one() {
    let output = Command::new(editor())
        .current_dir(workspace())
        .args(["--clip", "tests/data/one_key.clip.ron"])
        .args(["--screenshot", "never.png"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("one_key.clip.ron") && said.contains("at least two keys"),
        "{said}"
    );
    assert_eq!(said.lines().count(), 1, "{said}");
}

#[test]
fn an_unknown_figure_ends_with_the_nearest_name_and_code_two() {
    let output = Command::new(editor())
        .args(["--figure", "hrose", "--screenshot", "never.png"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("mean \"horse\"?") && said.lines().count() == 1,
        "{said}"
    );
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_display_it_ends_with_one_sentence_and_code_three() {
    let output = Command::new(editor())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(
        said.contains("no display") && !said.contains("panicked"),
        "{said}"
    );
}
