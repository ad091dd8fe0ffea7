//! The paper's own system as a person runs it: trained, posed, reproduced.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn stick3d(arguments: &str, out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stick3d"));
    command.current_dir(workspace());
    for word in arguments.split_whitespace() {
        command.arg(word.replace("OUT", &out.display().to_string()));
    }
    command.output().unwrap()
}

fn error_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_papers_network_is_trained_and_poses_a_body_like_any_other_model() {
    let out = tempfile::tempdir().unwrap();
    let trained = stick3d(
        "train --paper --hidden 12 --latent 8 --epochs-scale 0.001 \
         --rig assets/rigs/horse.glb --controls assets/rigs/horse.controls.ron \
         --poses assets/poses/horse.ron --figure crates/stick3d_figure/figures/horse.ron \
         --work-dir OUT/run --out OUT/horse.stick3d",
        out.path(),
    );
    assert!(trained.status.success(), "{}", error_of(&trained));
    let said = String::from_utf8(trained.stdout).unwrap();
    assert!(
        said.contains("8 key meshes in 21 turns: 133 to learn from"),
        "{said}"
    );
    assert!(said.contains("from sketch"), "{said}");
    assert!(out.path().join("run/losses.csv").exists());
    let posed = stick3d(
        "pose --sketch assets/sketches/horse_walk.json --model OUT/horse.stick3d --out OUT/horse.png",
        out.path(),
    );
    assert!(posed.status.success(), "{}", error_of(&posed));
    assert!(out.path().join("horse.png").exists());
}

#[test]
fn tables_and_figures_are_reproduced() {
    let out = tempfile::tempdir().unwrap();
    let reproduced = stick3d(
        "reproduce --quick --only horse --epochs-scale 0.001 --vertices 200 --hidden 12 --out OUT",
        out.path(),
    );
    assert!(reproduced.status.success(), "{}", error_of(&reproduced));
    let report = std::fs::read_to_string(out.path().join("report.md")).unwrap();
    for text in [
        "stick3d reproduce --quick",
        "| VAE | 512 |",
        "what ships",
        "horse_motion.png",
    ] {
        assert!(report.contains(text), "{text}\n{report}");
    }
    let unknown = stick3d("reproduce --only hrse --out OUT", out.path());
    assert_eq!(unknown.status.code(), Some(2));
    assert!(error_of(&unknown).contains("did you mean \"horse\"?"));
}
