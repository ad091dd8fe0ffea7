//! Meshes of a rig, written in every dialect and read back without the rig, train the model that the rig trains.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::path::Path;

use glam::{Quat, Vec3};
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use stick3d_figure::figure::Figure;
use stick3d_figure::mesh::TriangleMesh;
use stick3d_model::export::{ExportMesh, save_mesh};
use stick3d_model::files::write_atomically;
use stick3d_model::{Model, ModelParts};
use stick3d_train::dataset::{BasisConfig, PoseStream};
use stick3d_train::evaluate::{EvalConfig, EvalInput, evaluate, evaluate_meshes};
use stick3d_train::meshes::{MeshSet, MeshSetOptions};
use stick3d_train::rig::{Bone, Pose, Rig, Skeleton};
use stick3d_train::training::{
    HiddenLayers, MeshTrainInput, Quiet, StageConfig, TrainConfig, TrainInput, train, train_meshes,
};

const POSES: usize = 12;
const HELD_OUT: usize = 3;
const RINGS: usize = 9;
const ROUND: usize = 6;

/// A trunk and two arms: tubes of two bones each, 1.4 m high.
fn rig() -> Rig {
    let mut mesh = TriangleMesh::default();
    let (mut bones, mut influences) = (vec![], vec![]);
    let tubes = [
        ("trunk", None, Vec3::ZERO, 1.4 * Vec3::Y),
        ("arm_l", Some(1), Vec3::new(0.1, 1.2, 0.0), 0.7 * Vec3::X),
        ("arm_r", Some(1), Vec3::new(-0.1, 1.2, 0.0), -0.7 * Vec3::X),
    ];
    for (name, parent, start, along) in tubes {
        let first = bones.len() as u16;
        for (end, at) in [("lower", 0.0), ("upper", 0.5)] {
            bones.push(Bone {
                name: format!("{name}.{end}"),
                parent: if at > 0.0 {
                    Some(usize::from(first))
                } else {
                    parent
                },
                head: start + at * along,
                rest_rotation: Quat::IDENTITY,
            });
        }
        tube(&mut mesh, start, along, |share| {
            let second = (4.0 * (share - 0.375)).clamp(0.0, 1.0);
            let both = vec![(first, 1.0 - second), (first + 1, second)];
            influences.push(both.into_iter().filter(|(_, w)| *w > 0.0).collect());
        });
    }
    let colors = vec![[200, 180, 160, 255]; mesh.positions.len()];
    let skeleton = Skeleton { bones };
    Rig::new("tubes".to_owned(), None, skeleton, mesh, colors, influences).unwrap()
}

fn tube(mesh: &mut TriangleMesh, start: Vec3, along: Vec3, mut each: impl FnMut(f32)) {
    let (side, across) = along.normalize().any_orthonormal_pair();
    let first = mesh.positions.len() as u32;
    for ring in 0..RINGS {
        let share = ring as f32 / (RINGS - 1) as f32;
        for point in 0..ROUND {
            let (sin, cos) = (std::f32::consts::TAU * point as f32 / ROUND as f32).sin_cos();
            let out = 0.09 * cos * side + 0.07 * sin * across;
            mesh.positions.push(start + share * along + out);
            each(share);
        }
    }
    let at = |ring: usize, point: usize| first + (ring * ROUND + point % ROUND) as u32;
    for ring in 0..RINGS - 1 {
        for point in 0..ROUND {
            let [a, b, c, d] = [
                at(ring, point),
                at(ring, point + 1),
                at(ring + 1, point + 1),
                at(ring + 1, point),
            ];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
}

/// Joints at the ends and in the middle of the tubes.
fn figure() -> Figure {
    let ring = |tube: usize, ring: usize| {
        let first = (tube * RINGS + ring) * ROUND;
        format!("Vertices({:?})", (first..first + ROUND).collect::<Vec<_>>())
    };
    let mut joints = String::new();
    for (name, side, template, anchor) in [
        ("foot", "Center", "(0.0, 0.0)", ring(0, 0)),
        ("waist", "Center", "(0.0, 0.7)", ring(0, 4)),
        ("neck", "Center", "(0.0, 1.4)", ring(0, 8)),
        ("elbow_l", "Left", "(0.45, 1.2)", ring(1, 4)),
        ("hand_l", "Left", "(0.8, 1.2)", ring(1, 8)),
        ("elbow_r", "Right", "(-0.45, 1.2)", ring(2, 4)),
        ("hand_r", "Right", "(-0.8, 1.2)", ring(2, 8)),
    ] {
        writeln!(
            joints,
            "(name: \"{name}\", side: {side}, template: {template}, anchor: {anchor}),"
        )
        .unwrap();
    }
    let path = [
        "foot", "waist", "neck", "elbow_l", "hand_l", "elbow_l", "neck", "elbow_r", "hand_r",
    ];
    let bones = [
        ("foot", "waist"),
        ("waist", "neck"),
        ("neck", "elbow_l"),
        ("elbow_l", "hand_l"),
        ("neck", "elbow_r"),
        ("elbow_r", "hand_r"),
    ];
    let text = format!(
        "Figure(name: \"tubes\", root: \"waist\", joints: [{joints}], path: {path:?}, bones: {bones:?})"
    );
    Figure::from_ron(&text).unwrap()
}

/// The pose at rest, then bent ones.
fn poses(rig: &Rig) -> Vec<Pose> {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut poses = vec![Pose::rest(rig.skeleton.bones.len()); POSES];
    for rotation in poses[1..]
        .iter_mut()
        .flat_map(|pose| &mut pose.rotations[1..])
    {
        let mut number = || rng.random::<f32>() - 0.5;
        *rotation = Quat::from_scaled_axis(1.8 * Vec3::new(number(), number(), number()));
    }
    poses
}

fn config() -> TrainConfig {
    let stage = |epochs| StageConfig {
        epochs,
        learning_rate: 2e-3,
    };
    TrainConfig {
        hidden: HiddenLayers {
            encoder3d: vec![24],
            head: vec![24],
            encoder2d: vec![24],
        },
        latent_len: 8,
        basis: BasisConfig {
            helpers: 0,
            poses: 0,
        },
        principal_components: Some(16),
        sampled_bodies: 0,
        library_repeats: 20,
        batch_size: 20,
        stages: [stage(3), stage(3), stage(3)],
        ..TrainConfig::of(Figure::human())
    }
}

/// What is trained, without what is only said about it.
fn trained_parts(model: Model) -> ModelParts {
    let mut parts = model.into_parts();
    parts.metadata.metrics = serde_json::Value::Null;
    parts
}

fn names() -> Vec<String> {
    let ending = |i: usize| ["off", "ply", "obj", "noff", "coff"][i % 5];
    (0..POSES)
        .map(|i| format!("mesh{i}.{}", ending(i)))
        .collect()
}

/// Writes mesh number `i` with every digit that its numbers have.
fn write_exactly(path: &Path, i: usize, positions: &[Vec3], triangles: &[[u32; 3]]) {
    let (n, m) = (positions.len(), triangles.len());
    let lines = |beside: &str| -> String {
        let line = |p: &Vec3| format!("{} {} {}{beside}\n", p.x, p.y, p.z);
        positions.iter().map(line).collect()
    };
    let faces = |before: &str, from: u32| -> String {
        let line =
            |t: &[u32; 3]| format!("{before}{} {} {}\n", t[0] + from, t[1] + from, t[2] + from);
        triangles.iter().map(line).collect()
    };
    let colored = " 200 180 160 255";
    let text = match i {
        0 => format!("OFF\n{n} {m} 0\n{}{}", lines(""), faces("3 ", 0)),
        5 => format!(
            "OFF {n} {m} 0\n# vertices\n\n{}# faces\n{}",
            lines("  # at"),
            faces("3 ", 0)
        ),
        10 => format!("OFF{n} {m} 0\r\n{}{}", lines("\r"), faces("3 ", 0)),
        3 => format!("NOFF\n{n} {m} 0\n{}{}", lines(" 0 0 1"), faces("3 ", 0)),
        8 => format!(
            "CNOFF {n} {m} 0\n{}{}",
            lines(" 0 0 1 9 9 9 255"),
            faces("3  ", 0)
        ),
        4 => format!(
            "COFF\n# counts\n{n} {m} 0\n{}{}",
            lines(colored),
            faces("3 ", 0)
        ),
        // Fewer faces than the others: only vertices must agree.
        9 => format!("COFF {n} 1 0\n{}3 0 1 2 0.5 0.5 0.5\n", lines(colored)),
        2 | 7 => format!(
            "# by hand\n{}{}",
            lines("")
                .lines()
                .fold(String::new(), |t, l| t + "v " + l + "\n"),
            faces("f ", 1)
        ),
        _ => return write_atomically(path, &ply(i, positions, triangles)).unwrap(),
    };
    write_atomically(path, text.as_bytes()).unwrap();
}

/// ASCII, little-endian or big-endian, in turn.
fn ply(i: usize, positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u8> {
    let form = ["ascii", "binary_little_endian", "binary_big_endian"][(i / 5) % 3];
    let mut bytes = format!(
        "ply\nformat {form} 1.0\ncomment tubes\nelement vertex {}\nproperty float x\nproperty float y\n\
         property double z\nproperty float nx\nelement face {}\nproperty list uchar uint vertex_index\nend_header\n",
        positions.len(),
        triangles.len()
    )
    .into_bytes();
    let mut put = |text: String, low_first: &[u8]| match form {
        "ascii" => bytes.extend((text + "\n").bytes()),
        "binary_little_endian" => bytes.extend(low_first),
        _ => bytes.extend(low_first.iter().rev()),
    };
    for p in positions {
        put(p.x.to_string(), &p.x.to_le_bytes());
        put(p.y.to_string(), &p.y.to_le_bytes());
        put(p.z.to_string(), &f64::from(p.z).to_le_bytes());
        put("1".to_owned(), &1.0_f32.to_le_bytes());
    }
    for triangle in triangles {
        put("3".to_owned(), &[3]);
        triangle
            .iter()
            .for_each(|corner| put(corner.to_string(), &corner.to_le_bytes()));
    }
    bytes
}

fn read(folder: &Path, figure: &Figure) -> MeshSet {
    let mut set = MeshSet::read(folder, &MeshSetOptions::default()).unwrap();
    let placement = set.place(figure, None).unwrap();
    assert_eq!((placement.scale, placement.yaw_deg), (1.0, 0.0));
    set
}

fn trained_on(set: &MeshSet, figure: &Figure) -> Model {
    let held_out = names().split_off(POSES - HELD_OUT);
    let input = MeshTrainInput {
        figure,
        set,
        held_out,
    };
    train_meshes(&input, &config(), None, false, &Quiet)
        .unwrap()
        .model
}

#[test]
fn meshes_in_every_dialect_train_what_their_rig_trains() {
    let (rig, figure) = (rig(), figure());
    let poses = poses(&rig);
    let (library, held_out) = poses.split_at(POSES - HELD_OUT);
    let still = |_| -> PoseStream<'_> { Box::new(std::iter::repeat_n(poses[1].clone(), 100)) };
    let input = TrainInput {
        figure: &figure,
        rig: &rig,
        library,
        streams: &still,
        held_out_poses: names().split_off(POSES - HELD_OUT),
    };
    let of_rig = train(&input, &config(), None, false, &Quiet).unwrap().model;

    let (exact, rounded) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    for ((i, pose), name) in poses.iter().enumerate().zip(names()) {
        let mut positions = vec![];
        rig.skin(pose, &mut positions);
        write_exactly(
            &exact.path().join(&name),
            i,
            &positions,
            &rig.mesh.triangles,
        );
        let positions: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
        let mesh = ExportMesh {
            name: "tubes",
            positions: &positions,
            normals: &vec![[0.0, 0.0, 1.0]; positions.len()],
            colors: &rig.colors,
            triangles: &rig.mesh.triangles,
        };
        let path = rounded
            .path()
            .join(&name)
            .with_extension(["off", "ply", "obj"][i % 3]);
        save_mesh(&mesh, &path).unwrap();
    }
    // Where no digit is lost, nothing differs.
    let mut set = read(exact.path(), &figure);
    set.colors.clone_from(&rig.colors);
    let of_meshes = trained_on(&set, &figure);
    assert!(trained_parts(of_meshes.clone()) == trained_parts(of_rig.clone()));

    // Both are measured alike, too.
    let eval = EvalConfig {
        natural_cases: 2 * HELD_OUT,
        broad_cases: 0,
        turns_per_mesh: 2,
        flat_drawings: 5,
        ..EvalConfig::default()
    };
    let of_rig_report = evaluate(
        &of_rig,
        EvalInput {
            rig: &rig,
            library,
            natural: Box::new(held_out.iter().cloned().cycle()),
            broad: still(0),
        },
        &eval,
        &Quiet,
    )
    .unwrap();
    let report = evaluate_meshes(&of_meshes, &set, &eval, &Quiet).unwrap();
    assert_eq!(report.parts.len(), 1, "there is no broad part");
    assert_eq!(report.parts[0].cases, 2 * HELD_OUT);
    assert!(report == of_rig_report);

    // Six decimals, as the exporter writes, are half a micrometre: the bodies that the networks give to the same sketches
    // differ by less than a tenth of a millimetre. Refinement weighs answers, so there it may be half a millimetre.
    let mut set = read(rounded.path(), &figure);
    for (mesh, name) in set.meshes.iter_mut().zip(names()) {
        mesh.name = name;
    }
    let of_rounded = trained_on(&set, &figure);
    let bodies = |model: &Model, refined: bool| -> Vec<Vec3> {
        let mut inference = stick3d_model::Inference::new(model).unwrap();
        let (mut latent, mut body) = (vec![0.0; 8], vec![[0.0; 3]; set.vertex_count()]);
        let sketches = [0.0, 0.4, 1.1].map(|bend: f32| {
            let mut points = figure.template.clone();
            points[4].y += bend;
            stick3d_figure::sketch::Sketch::new(&figure, points).unwrap()
        });
        let mut all = vec![];
        for sketch in sketches {
            match refined {
                true => inference.encode(&sketch, &mut latent).unwrap(),
                false => inference.encode_plain(&sketch, &mut latent).unwrap(),
            }
            inference.decode_positions(&latent, &mut body).unwrap();
            all.extend(body.iter().copied().map(Vec3::from));
        }
        all
    };
    for (refined, bound_m) in [(false, 1e-4), (true, 5e-4)] {
        let pair = [&of_meshes, &of_rounded].map(|model| bodies(model, refined));
        let distances = pair[0].iter().zip(&pair[1]).map(|(a, b)| a.distance(*b));
        let farthest = distances.fold(0.0, f32::max);
        assert!(
            farthest > 0.0 && farthest < bound_m,
            "refined: {refined}: {farthest} m"
        );
    }
}
