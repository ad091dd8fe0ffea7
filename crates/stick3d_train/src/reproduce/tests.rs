//! The whole of it, tiny.

use std::sync::Mutex;

use glam::{Quat, Vec3};
use stick3d_figure::figure::Figure;
use stick3d_model::Model;

use super::*;
use crate::rig::{Pose, Rig};
use crate::training::Quiet;

/// Writes notes down.
#[derive(Default)]
struct Notes(Mutex<Vec<String>>);

impl Progress for Notes {
    fn note(&self, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }
}

fn subject() -> Subject {
    let rig = Rig::from_glb(include_bytes!("../../../../assets/rigs/human.glb")).unwrap();
    let poses: Vec<(String, Pose)> = (0..4)
        .map(|number| {
            let mut pose = Pose::rest(rig.skeleton.bones.len());
            for (bone, rotation) in rig.skeleton.bones.iter().zip(&mut pose.rotations) {
                if bone.name.starts_with("upperarm") {
                    *rotation = Quat::from_axis_angle(Vec3::Z, 0.3 * number as f32);
                }
            }
            (format!("pose {number}"), pose)
        })
        .collect();
    let set = PaperSet::of_rig(Figure::human(), &rig, &poses).unwrap();
    let shipped = include_bytes!("../../../../assets/models/human.stick3d");
    Subject {
        name: "human".to_owned(),
        set: set.coarsened(300),
        held_out: vec!["pose 2".to_owned()],
        shipped: Some(Model::from_bytes(shipped).unwrap()),
        published: true,
    }
}

#[test]
fn the_report_has_tables_and_pictures_and_a_second_call_trains_nothing() {
    let subjects = [subject()];
    let config = ReproduceConfig {
        device: ComputeDevice::Flex,
        seed: 1,
        epochs_share: 0.01,
        hidden: 16,
        command: "stick3d reproduce".to_owned(),
    };
    let out = tempfile::tempdir().unwrap();
    let read = |name: &str| std::fs::read_to_string(out.path().join(name)).unwrap();
    let notes = Notes::default();
    reproduce(&subjects, &config, out.path(), &notes).unwrap();
    let said = notes.0.into_inner().unwrap().join("\n");
    assert_eq!(said.matches("training human_").count(), 4, "{said}");
    assert!(said.contains("min left in all"), "{said}");

    let (report, csv) = (read("report.md"), read("results.csv"));
    for cell in [
        "| VAE | 512 | 10.830 (6.888) | pose |",
        "| AE | 256 | 2.996 (1.568) | random |",
        "what ships",
    ] {
        assert!(report.contains(cell), "{cell}\n{report}");
    }
    assert!(!report.contains("Not trained yet"));
    // Four models two ways on two parts, and two baselines.
    assert_eq!(csv.lines().count(), 1 + 4 * 4 + 2 * 2);
    for what in ["generation", "distances", "motion"] {
        let picture = image::open(out.path().join(format!("human_{what}.png")))
            .unwrap()
            .to_rgb8();
        let colors: std::collections::HashSet<[u8; 3]> = picture.pixels().map(|p| p.0).collect();
        assert!(
            picture.width() > 900 && colors.len() > 200,
            "{what}: {}",
            colors.len()
        );
    }
    assert!(
        !out.path()
            .join("models/human_vae_256/checkpoint.safetensors")
            .exists()
    );

    let notes = Notes::default();
    reproduce(&subjects, &config, out.path(), &notes).unwrap();
    assert_eq!(notes.0.into_inner().unwrap().len(), 0);
    assert_eq!(
        (read("report.md"), read("results.csv")),
        (report, csv.clone())
    );
    // Another seed is another reproduction.
    let other = ReproduceConfig { seed: 2, ..config };
    reproduce(&subjects, &other, out.path(), &Quiet).unwrap();
    assert_ne!(read("results.csv"), csv);
}
