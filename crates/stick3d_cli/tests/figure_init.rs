//! `stick3d figure init` on rigs, as a person runs it: what it writes, what it says, how it ends.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use stick3d_figure::Figure;
use stick3d_train::rig::{Rig, regressor};

fn shipped(file: &str) -> PathBuf {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    assets.join("rigs").join(file).canonicalize().unwrap()
}

fn init(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stick3d"))
        .current_dir(folder)
        .args(["figure", "init"])
        .args(arguments)
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    text(&output.stdout) + &text(&output.stderr)
}

/// A shipped rig with some of its bones renamed or left without surface, written into a folder.
fn altered(folder: &Path, file: &str, alter: impl Fn(&mut Rig)) -> PathBuf {
    let mut rig = Rig::from_glb(&std::fs::read(shipped(file)).unwrap()).unwrap();
    alter(&mut rig);
    let path = folder.join(format!("altered_{file}"));
    stick3d_model::files::write_atomically(&path, &rig.to_glb().unwrap()).unwrap();
    path
}

#[test]
fn a_rig_gives_a_figure_that_fits_it() {
    let folder = tempfile::tempdir().unwrap();
    let rig = shipped("human.glb");
    let output = init(folder.path(), &[rig.to_str().unwrap(), "--name", "hero"]);
    let text = said(&output);
    assert!(output.status.success(), "{text}");
    assert!(text.contains("11 joints of hero, which faces +Z"), "{text}");
    assert!(text.contains("elbow_l    bone lowerarm_l"), "{text}");
    let written = std::fs::read_to_string(folder.path().join("figure.ron")).unwrap();
    let figure = Figure::from_ron(&written).unwrap();
    assert_eq!(figure.name, "hero");
    let rig = Rig::from_glb(&std::fs::read(rig).unwrap()).unwrap();
    assert!(regressor(&figure, &rig).is_ok());
}

#[test]
fn a_figure_that_is_there_is_not_written_over_unless_it_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let there = folder.path().join("figure.ron");
    stick3d_model::files::write_atomically(&there, b"made by hand").unwrap();
    let rig = shipped("horse.glb");
    let output = init(folder.path(), &[rig.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(5));
    let text = said(&output);
    assert!(text.contains("figure.ron is there already"), "{text}");
    assert_eq!(std::fs::read(there).unwrap(), b"made by hand");
}

#[test]
fn two_candidates_are_named_and_the_rest_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let rig = altered(folder.path(), "human.glb", |rig| {
        // As if the thigh were a second shin beside the real one, on another branch.
        for (from, to) in [("foot_r", "calf_r_2"), ("ball_r", "toe_r")] {
            let bone = rig.skeleton.bone_index(from).unwrap();
            rig.skeleton.bones[bone].name = to.to_owned();
        }
        let hip = rig.skeleton.bone_index("thigh_r").unwrap();
        let second = rig.skeleton.bone_index("calf_r_2").unwrap();
        rig.skeleton.bones[second].parent = Some(hip);
    });
    let output = init(
        folder.path(),
        &[rig.to_str().unwrap(), "--out", "draft.ron"],
    );
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    for part in [
        "draft.ron is written",
        "\"knee_r\"",
        "`calf_r`",
        "`calf_r_2`",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let draft = std::fs::read_to_string(folder.path().join("draft.ron")).unwrap();
    let figure = Figure::from_ron(&draft).unwrap();
    // Training would say which joint is left to do.
    let rig = Rig::from_glb(&std::fs::read(rig).unwrap()).unwrap();
    let error = regressor(&figure, &rig).unwrap_err().to_string();
    assert!(error.contains("knee_r"), "{error}");
}

#[test]
fn what_is_no_body_is_refused_with_its_bones() {
    let folder = tempfile::tempdir().unwrap();
    let rig = altered(folder.path(), "horse.glb", |rig| {
        // All that is left of it is its trunk, a snake.
        for list in &mut rig.influences {
            *list = vec![(0, 1.0)];
        }
    });
    let output = init(folder.path(), &[rig.to_str().unwrap()]);
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(
        text.contains("no two pairs") && text.contains("pelvis"),
        "{text}"
    );
    assert!(!folder.path().join("figure.ron").exists());
}

#[test]
fn a_rig_and_a_mesh_are_not_taken_together() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &[][..],
        &["a.glb", "--mesh", "b.off", "--preset", "scape"],
        &["--mesh", "b.off"],
        &["a.glb", "--preset", "scape"],
    ] {
        let output = init(folder.path(), arguments);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{arguments:?}: {}",
            said(&output)
        );
    }
    let output = init(folder.path(), &["nowhere.glb"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(said(&output).contains("nowhere.glb"));
}
