//! The rules of the house: which crate may know which, and what every source file looks like.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The names of all packages that `package` resolves to for use, tests aside.
fn resolved(package: &str, features: &[&str]) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO"))
        .current_dir(workspace())
        .args([
            "tree",
            "--locked",
            "--package",
            package,
            "--edges",
            "normal,build",
        ])
        .args(["--prefix", "none", "--format", "{p}"])
        .args(features)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let names: BTreeSet<String> = String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .filter_map(|line| line.split(' ').next())
        .map(str::to_owned)
        .collect();
    assert!(
        names.contains(package),
        "cargo tree did not list {package} itself"
    );
    names
}

fn names_starting_with<'a>(names: &'a BTreeSet<String>, prefixes: &[&str]) -> Vec<&'a String> {
    names
        .iter()
        .filter(|name| prefixes.iter().any(|prefix| name.starts_with(prefix)))
        .collect()
}

#[test]
fn figure_knows_neither_networks_nor_bevy() {
    let names = resolved("stick3d_figure", &[]);
    let found = names_starting_with(&names, &["bevy", "burn", "wgpu", "stick3d_model"]);
    assert!(found.is_empty(), "stick3d_figure resolves {found:?}");
}

#[test]
fn only_the_plugin_knows_bevy() {
    for package in [
        "stick3d_model",
        "stick3d_train",
        "stick3d_human",
        "stick3d_horse",
        "stick3d_cli",
    ] {
        let names = resolved(package, &[]);
        let found = names_starting_with(&names, &["bevy"]);
        assert!(found.is_empty(), "{package} resolves {found:?}");
    }
    assert!(resolved("bevy_stick3d", &[]).contains("bevy"));
}

#[test]
fn arrows_point_downward() {
    assert!(!resolved("stick3d_model", &[]).contains("stick3d_train"));
    for features in [&["--no-default-features"][..], &["--all-features"][..]] {
        let names = resolved("bevy_stick3d", features);
        assert!(
            !names.contains("stick3d_train"),
            "a game would compile the trainer"
        );
        assert!(!names.contains("stick3d_cli"));
    }
    for package in ["stick3d_human", "stick3d_horse"] {
        assert_eq!(
            resolved(package, &[]).len(),
            1,
            "the model's crate is nothing but bytes"
        );
    }
}

#[test]
fn a_game_takes_only_the_figures_it_shows() {
    let only = |feature: &str| {
        let names = resolved(
            "bevy_stick3d",
            &["--no-default-features", "--features", feature],
        );
        let models = ["stick3d_human", "stick3d_horse"];
        models.map(|package| names.contains(package))
    };
    assert_eq!(only("human"), [true, false]);
    assert_eq!(only("horse"), [false, true]);
}

/// Every Rust file of the workspace.
fn source_files() -> Vec<PathBuf> {
    let mut folders = ["crates", "examples", "tests"]
        .map(|name| workspace().join(name))
        .to_vec();
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }
    assert!(files.len() > 10, "found only {} files", files.len());
    files.sort();
    files
}

#[test]
fn every_file_says_its_subject_and_stays_small() {
    const MAX_LINES: usize = 600;
    let mut faults = Vec::new();
    for path in source_files() {
        let text = std::fs::read_to_string(&path).unwrap();
        if !text.starts_with("//!") {
            faults.push(format!("{} does not open with a //! line", path.display()));
        }
        let lines = text.lines().count();
        if lines > MAX_LINES {
            faults.push(format!(
                "{} has {lines} lines, more than {MAX_LINES}",
                path.display()
            ));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn committed_models_and_rigs_stay_under_nine_megabytes() {
    for folder in ["assets/models", "assets/rigs", "assets/poses"] {
        for entry in std::fs::read_dir(workspace().join(folder)).unwrap() {
            let entry = entry.unwrap();
            let bytes = entry.metadata().unwrap().len();
            assert!(
                bytes <= 9_000_000,
                "{} has {bytes} bytes",
                entry.path().display()
            );
        }
    }
}
