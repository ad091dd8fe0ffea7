//! Written files, read back by other code.

use super::*;

const POSITIONS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.5, 0.0, 0.0],
    [0.0, 2.0, 0.0],
    [0.0, 0.0, -3.0],
];
const NORMALS: [[f32; 3]; 4] = [
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, -1.0],
];
const COLORS: [[u8; 4]; 4] = [
    [255, 0, 0, 255],
    [0, 55, 0, 255],
    [0, 0, 255, 255],
    [1, 2, 3, 255],
];
const TRIANGLES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn mesh() -> ExportMesh<'static> {
    ExportMesh {
        name: "human pose",
        positions: &POSITIONS,
        normals: &NORMALS,
        colors: &COLORS,
        triangles: &TRIANGLES,
    }
}

fn text(format: MeshFormat) -> String {
    String::from_utf8(mesh_bytes(&mesh(), format).unwrap()).unwrap()
}

#[test]
fn glb_is_read_back_by_the_gltf_crate() {
    let bytes = mesh_bytes(&mesh(), MeshFormat::Glb).unwrap();
    assert_eq!(bytes, mesh_bytes(&mesh(), MeshFormat::Glb).unwrap());
    let file = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = file.blob.as_deref().unwrap();
    assert_eq!(file.default_scene().unwrap().nodes().count(), 1);
    let mesh = file.meshes().next().unwrap();
    assert_eq!(mesh.name(), Some("human pose"));
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(blob));
    assert_eq!(
        reader.read_positions().unwrap().collect::<Vec<_>>(),
        POSITIONS
    );
    assert_eq!(reader.read_normals().unwrap().collect::<Vec<_>>(), NORMALS);
    assert_eq!(
        reader
            .read_colors(0)
            .unwrap()
            .into_rgba_u8()
            .collect::<Vec<_>>(),
        COLORS
    );
    assert_eq!(
        reader
            .read_indices()
            .unwrap()
            .into_u32()
            .collect::<Vec<_>>(),
        TRIANGLES.as_flattened()
    );
    assert_eq!(primitive.bounding_box().min, [0.0, 0.0, -3.0]);
    assert_eq!(primitive.bounding_box().max, [1.5, 2.0, 0.0]);
}

#[test]
fn obj_counts_corners_from_one() {
    let text = text(MeshFormat::Obj);
    assert!(
        text.contains("\no human_pose\n") && text.contains("\nv 0.000000 0.000000 -3.000000\n")
    );
    assert!(text.contains("\nvn 1.00000 0.00000 0.00000\n"));
    assert!(text.ends_with("\nf 2//2 3//3 4//4\n"));
}

#[test]
fn ply_has_srgb_colors() {
    let text = text(MeshFormat::Ply);
    assert!(text.starts_with("ply\nformat ascii 1.0\n"));
    assert!(text.contains("element vertex 4\n") && text.contains("element face 4\n"));
    // Linear 55 of 255 is sRGB 128.
    assert!(
        text.contains("\n1.500000 0.000000 0.000000 1.00000 0.00000 0.00000 0 128 0 255\n"),
        "{text}"
    );
    assert!(text.ends_with("\n3 1 2 3\n"));
    let body = text.split("end_header\n").nth(1).unwrap();
    assert_eq!(body.lines().count(), 8);
}

#[test]
fn off_is_counted_and_complete() {
    let text = text(MeshFormat::Off);
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("OFF"));
    assert_eq!(lines.next(), Some("4 4 0"));
    assert_eq!(lines.count(), 8);
}

#[test]
fn the_name_says_the_format() {
    for (name, format) in [
        ("a.glb", MeshFormat::Glb),
        ("b.x.OBJ", MeshFormat::Obj),
        ("c.ply", MeshFormat::Ply),
    ] {
        assert_eq!(MeshFormat::of_path(name.as_ref()).unwrap(), format);
    }
    for name in ["mesh", "mesh.fbx", ".glb"] {
        let error = MeshFormat::of_path(name.as_ref()).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
}

#[test]
fn unsound_meshes_and_folders_are_refused() {
    let sound = mesh();
    let check = |mesh: ExportMesh<'_>| mesh_bytes(&mesh, MeshFormat::Obj).is_err();
    assert!(check(ExportMesh {
        normals: &NORMALS[1..],
        ..sound
    }));
    assert!(check(ExportMesh {
        triangles: &[],
        ..sound
    }));
    assert!(check(ExportMesh {
        triangles: &[[0, 1, 4]],
        ..sound
    }));
    assert!(check(ExportMesh {
        positions: &[[f32::NAN; 3]; 4],
        ..sound
    }));
    let error = save_mesh(&sound, "/no-such-folder/a.glb".as_ref()).unwrap_err();
    assert!(
        matches!(error, ExportError::Io(_)) && error.to_string().contains("/no-such-folder/a.glb")
    );
}
