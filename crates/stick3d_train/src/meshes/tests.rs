//! Folders of small meshes.

use stick3d_figure::figure::FigureError;
use stick3d_model::files::write_atomically;

use super::*;

fn put(folder: &Path, name: &str, text: &str) {
    write_atomically(&folder.join(name), text.as_bytes()).unwrap();
}

/// Writes an OFF file of a tetrahedron whose tip is `tip` away, with `extra` vertices that nothing uses.
fn write(folder: &Path, name: &str, tip: f32, extra: usize) {
    let mut text = format!("OFF\n{} 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 {tip}\n", 4 + extra);
    text += &"0 0 0\n".repeat(extra);
    text += "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    put(folder, name, &text);
}

fn names(set: &MeshSet) -> Vec<&str> {
    set.meshes.iter().map(|mesh| mesh.name.as_str()).collect()
}

#[test]
fn a_folder_is_read_in_the_order_of_its_numbers() {
    let folder = tempfile::tempdir().unwrap();
    for (i, name) in ["mesh10.off", "mesh2.off", "mesh1.OFF"]
        .into_iter()
        .enumerate()
    {
        write(folder.path(), name, 1.0 + i as f32, 0);
    }
    // Without faces, and without being the pilot, that is no fault.
    put(
        folder.path(),
        "mesh3.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 9\n",
    );
    for name in ["readme.txt", "._mesh1.off"] {
        put(folder.path(), name, "no mesh");
    }
    let set = MeshSet::read(folder.path(), &MeshSetOptions::default()).unwrap();
    assert_eq!(
        names(&set),
        ["mesh1.OFF", "mesh2.off", "mesh3.obj", "mesh10.off"]
    );
    assert_eq!(
        (set.pilot, set.triangles.len(), set.vertex_count()),
        (0, 4, 4)
    );
    let tips: Vec<f32> = set.meshes.iter().map(|mesh| mesh.positions[3].z).collect();
    assert_eq!(tips, [3.0, 2.0, 9.0, 1.0]);
    let options = MeshSetOptions {
        pilot: Some("mesh10.off".to_owned()),
        up: UpAxis::Z,
        ..MeshSetOptions::default()
    };
    let set = MeshSet::read(folder.path(), &options).unwrap();
    assert_eq!(set.pilot, 3);
    assert_eq!(set.meshes[3].positions[3], Vec3::Y);
    assert_eq!(set.pilot_mesh().volume(), 1.0 / 6.0);
}

#[test]
fn other_vertex_counts_are_refused_or_skipped() {
    let folder = tempfile::tempdir().unwrap();
    for (name, extra) in [("a.off", 3), ("b.off", 0), ("c.off", 0), ("d.off", 5)] {
        write(folder.path(), name, 1.0, extra);
    }
    let refused = MeshSet::read(folder.path(), &MeshSetOptions::default()).unwrap_err();
    let message = refused.to_string();
    for part in ["a.off", "7 vertices", "b.off", " 4;", "--skip-mismatched"] {
        assert!(message.contains(part), "{part}: {message}");
    }
    let mut options = MeshSetOptions {
        skip_mismatched: true,
        ..MeshSetOptions::default()
    };
    let set = MeshSet::read(folder.path(), &options).unwrap();
    assert_eq!(names(&set), ["b.off", "c.off"]);
    let skipped = |name: &str, vertex_count| Skipped {
        name: name.to_owned(),
        vertex_count,
    };
    assert_eq!(set.skipped, [skipped("a.off", 7), skipped("d.off", 9)]);
    options.pilot = Some("a.off".to_owned());
    let alone = MeshSet::read(folder.path(), &options).unwrap_err();
    assert!(
        matches!(alone, MeshSetError::TooFew { found: 1, .. }),
        "{alone}"
    );
    options.pilot = Some("a.of".to_owned());
    let unknown = MeshSet::read(folder.path(), &options)
        .unwrap_err()
        .to_string();
    assert!(
        unknown.contains("`a.of`") && unknown.contains("mean `a.off`"),
        "{unknown}"
    );
}

#[test]
fn faults_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let read = || MeshSet::read(folder.path(), &MeshSetOptions::default()).map(|_| ());
    assert!(matches!(read(), Err(MeshSetError::Empty { .. })));
    write(folder.path(), "mesh0.off", 1.0, 0);
    assert!(matches!(read(), Err(MeshSetError::TooFew { found: 1, .. })));
    write(folder.path(), "mesh1.off", f32::NAN, 0);
    let message = read().unwrap_err().to_string();
    assert!(message.contains("mesh1.off, line 6: vertex 3"), "{message}");
    let points = "v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\n";
    put(folder.path(), "mesh1.obj", points);
    std::fs::remove_file(folder.path().join("mesh1.off")).unwrap();
    std::fs::rename(
        folder.path().join("mesh0.off"),
        folder.path().join("mesh2.off"),
    )
    .unwrap();
    let message = read().unwrap_err().to_string();
    assert!(message.contains("mesh1.obj has no faces"), "{message}");
    put(
        folder.path(),
        "mesh1.obj",
        &(points.to_owned() + "f 1 2 3\n"),
    );
    let message = read().unwrap_err().to_string();
    assert!(message.contains("mesh1.obj are at one place"), "{message}");
    let missing = folder.path().join("nowhere");
    let message = MeshSet::read(&missing, &MeshSetOptions::default())
        .unwrap_err()
        .to_string();
    assert!(message.contains("nowhere"), "{message}");
}

/// Two joints, 2 m apart from left to right in the template.
fn figure(anchors: [&str; 3]) -> Result<Figure, FigureError> {
    let [a, b, c] = anchors;
    Figure::from_ron(&format!(
        r#"Figure(name: "beam", root: "middle", joints: [
            (name: "end_l", side: Left, template: (1.0, 0.0), anchor: {a}),
            (name: "middle", side: Center, template: (0.0, 0.5), anchor: {b}),
            (name: "end_r", side: Right, template: (-1.0, 0.0), anchor: {c}),
        ], path: ["end_r", "middle", "end_l"], bones: [("end_r", "middle"), ("middle", "end_l")])"#
    ))
}

fn beam(unit: f32, heading_deg: f32) -> MeshSet {
    let turn = glam::Quat::from_rotation_y(heading_deg.to_radians());
    let at = [Vec3::X, 0.5 * Vec3::Y, -Vec3::X, Vec3::Z];
    let positions: Vec<Vec3> = at.iter().map(|p| turn * (unit * *p)).collect();
    let mesh = |name: &str| NamedMesh {
        name: name.to_owned(),
        positions: positions.clone(),
    };
    MeshSet {
        meshes: ["a", "b", "c"].map(mesh).to_vec(),
        pilot: 0,
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        colors: vec![CLAY; 4],
        skipped: vec![],
    }
}

#[test]
fn sets_are_brought_to_size_and_heading() {
    let figure = figure(["Vertices([0])", "Vertices([1])", "Vertices([2])"]).unwrap();
    let placed = |unit: f32, heading: f32, scale: Option<f32>| {
        let mut set = beam(unit, heading);
        let placement = set.place(&figure, scale).unwrap();
        (set, placement)
    };
    // Plausible metres stay as they are, to the bit.
    for unit in [0.6, 1.0, 1.2, 1.9] {
        let (set, placement) = placed(unit, 0.0, None);
        assert_eq!((placement.scale, placement.yaw_deg), (1.0, 0.0));
        assert_eq!(set, beam(unit, 0.0));
        assert!((placement.upright - 1.0).abs() < 1e-5);
    }
    // How large the beam is in the files, how it is turned, and what a unit of the files is.
    for (size, heading, metres) in [
        (110.0, 90.0, 0.01),
        (1200.0, 180.0, 0.001),
        (39.0, 8.0, 0.0254),
        (9.0, -50.0, 0.1),
        (1.0, -50.0, 1.0),
        (5.0, 0.0, 0.2),
        (0.004, 0.0, 250.0),
    ] {
        let (set, placement) = placed(size, heading, None);
        assert!(
            (placement.scale / metres - 1.0).abs() < 1e-4,
            "{placement:?}"
        );
        let [left, right] = [0, 2].map(|end| set.meshes[2].positions[end]);
        assert!((left.distance(right) - 2.0 * metres * size).abs() < 1e-3);
        let off = (placement.yaw_deg + heading).rem_euclid(360.0);
        let most = if heading == 8.0 { 8.1 } else { 0.1 };
        assert!(off.min(360.0 - off) < most, "{off}");
    }
    let (set, _) = placed(1.0, 0.0, Some(3.0));
    assert_eq!(set.extent_m(), 3.0);
    for bad in [0.0, -1.0, f32::NAN] {
        let refused = beam(1.0, 0.0).place(&figure, Some(bad));
        assert!(matches!(refused, Err(MeshSetError::Scale(_))));
    }
}

#[test]
fn joints_that_are_no_vertices_are_named() {
    let cases = [
        (
            ["Vertices([0])", "Bones([\"spine\"])", "Vertices([2])"],
            "middle",
        ),
        (["Vertices([])", "Vertices([1])", "Vertices([2])"], "end_l"),
        (
            ["Vertices([0])", "Vertices([1])", "Vertices([4])"],
            "vertex 4",
        ),
    ];
    for (anchors, expected) in cases {
        let message = joint_regressor(&figure(anchors).unwrap(), 4)
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(expected) && message.contains("beam"),
            "{message}"
        );
    }
}

#[test]
fn a_tenth_is_held_out_and_never_the_pilot() {
    let mut set = beam(1.0, 0.0);
    for seed in 0..20 {
        let held_out = set.held_out(seed, 0.1);
        assert_eq!(held_out.len(), 1);
        assert_ne!(held_out[0], "a");
        assert_eq!(held_out, set.held_out(seed, 0.1));
        let (rest, unseen) = set.split_by(&held_out);
        assert_eq!((rest.len(), unseen.len()), (2, 1));
    }
    set.meshes = (0..40)
        .map(|i| NamedMesh {
            name: i.to_string(),
            positions: vec![],
        })
        .collect();
    assert_eq!(set.held_out(1, 0.1).len(), 4);
    assert_ne!(set.held_out(1, 0.1), set.held_out(2, 0.1));
}
