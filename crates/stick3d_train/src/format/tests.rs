//! Every dialect says the same mesh; whatever is wrong is an error with its place.

use glam::Vec3;
use proptest::prelude::*;
use stick3d_model::export::{ExportMesh, MeshFormat, mesh_bytes};
use stick3d_model::files::write_atomically;

use super::*;

/// A square as one polygon and a tip over it.
fn pyramid() -> TriangleMesh {
    let at = [
        [-1.0, 0.0, -1.0],
        [1.0, 0.0, -1.0],
        [1.0, 0.0, 1.0],
        [-1.0, 0.0, 1.0],
        [0.0, 1.5, 0.25],
    ];
    TriangleMesh {
        positions: at.map(Vec3::from).to_vec(),
        triangles: vec![
            [0, 1, 2],
            [0, 2, 3],
            [0, 4, 1],
            [1, 4, 2],
            [2, 4, 3],
            [3, 4, 0],
        ],
    }
}

const RED: [u8; 4] = [255, 0, 0, 255];
const FACES: &str = "4 0 1 2 3\n3 0 4 1\n3 1 4 2 0.5 0.5 0.5\n3 2 4 3 255 0 0 255\n3 3 4 0\n";

fn off(header: &str, beside: &str) -> String {
    let mut text = header.to_owned();
    for p in pyramid().positions {
        text += &format!("{} {} {}{beside}\n", p.x, p.y, p.z);
    }
    text + FACES
}

fn parsed(format: SourceFormat, bytes: &[u8]) -> FileMesh {
    format
        .parse(bytes)
        .unwrap_or_else(|error| panic!("{error}\n{}", String::from_utf8_lossy(bytes)))
}

#[test]
fn every_header_of_off_is_read() {
    let plain = [
        ("OFF\n5 5 0\n", ""),
        ("OFF 5 5 0\n", ""),
        ("OFF5 5 0\n", ""),
        ("off\n5 5\n", ""),
        ("5 5 8\n", ""),
        ("\u{feff}OFF\r\n\r\n5 5 0\r\n", "\r"),
        (
            "# made by hand\nOFF # header\n\n# counts\n5 5 0 # five\n",
            "  # at",
        ),
        ("NOFF\n5 5 0\n", " 0 1 0"),
        ("NOFF 5 5 0\n", "\t0\t1\t0"),
        ("STOFF\n5 5 0\n", " 0.25 0.75"),
        ("CNOFF\n5 5 0\n", " 0 1 0 255 0 0 255"),
        ("NCOFF\n5 5 0\n", " 255 0 0 255 0 1 0"),
        ("OFF\n5\n5 0\n", " 0.1 0.2"),
    ];
    for (header, beside) in plain {
        let file = parsed(SourceFormat::Off, off(header, beside).as_bytes());
        assert_eq!(file.mesh, pyramid(), "{header:?}");
        assert_eq!(file.colors, None, "{header:?}");
    }
    for beside in [" 255 0 0", " 255 0 0 255", " 1.0 0.0 0.0", " 1.0 0 0 1"] {
        let file = parsed(SourceFormat::Off, off("COFF\n5 5 0\n", beside).as_bytes());
        assert_eq!(
            (file.mesh, file.colors),
            (pyramid(), Some(vec![RED; 5])),
            "{beside}"
        );
    }
}

const PLY_HEADER: &str = "comment made by hand\nobj_info nothing\nelement vertex 5\n\
    property double x\nproperty float32 y\nproperty float z\nproperty uchar red\nproperty uint8 green\n\
    property uchar blue\nproperty list uchar short tags\nelement edge 1\nproperty int a\n\
    element face 5\nproperty uchar flags\nproperty list uchar int vertex_index\nend_header\n";

/// The pyramid as numbers of the header's types, each written by `put` as (number, bytes, whether it is a float).
fn ply_body(mut put: impl FnMut(f64, usize, bool)) {
    for p in pyramid().positions {
        put(f64::from(p.x), 8, true);
        put(f64::from(p.y), 4, true);
        put(f64::from(p.z), 4, true);
        for byte in [255.0, 0.0, 0.0] {
            put(byte, 1, false);
        }
        put(2.0, 1, false);
        put(-7.0, 2, false);
        put(300.0, 2, false);
    }
    put(12.0, 4, false);
    for line in FACES.lines() {
        put(1.0, 1, false);
        let words: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        put(words[0], 1, false);
        for corner in &words[1..=words[0] as usize] {
            put(*corner, 4, false);
        }
    }
}

fn ply(form: &str) -> Vec<u8> {
    let mut bytes = format!("ply\nformat {form} 1.0\n{PLY_HEADER}").into_bytes();
    ply_body(|number, size, float| {
        if form == "ascii" {
            return bytes.extend(format!("{number} ").bytes());
        }
        let mut low_first = match (float, size) {
            (true, 8) => number.to_le_bytes().to_vec(),
            (true, _) => (number as f32).to_le_bytes().to_vec(),
            _ => (number as i64).to_le_bytes()[..size].to_vec(),
        };
        if form == "binary_big_endian" {
            low_first.reverse();
        }
        bytes.extend(low_first);
    });
    bytes
}

#[test]
fn ply_is_read_in_all_three_forms() {
    for form in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let file = parsed(SourceFormat::Ply, &ply(form));
        assert_eq!(file.mesh, pyramid(), "{form}");
        assert_eq!(file.colors, Some(vec![RED; 5]), "{form}");
    }
    // Line ends of another system, in the header and in the text after it.
    let text = String::from_utf8(ply("ascii"))
        .unwrap()
        .replace('\n', "\r\n");
    assert_eq!(parsed(SourceFormat::Ply, text.as_bytes()).mesh, pyramid());
}

#[test]
fn obj_counts_from_one_and_backward() {
    let mut text = "mtllib nothing\no pyramid\n".to_owned();
    for p in pyramid().positions {
        text += &format!("v {} {} {} 1 0 0\nvn 0 1 0\nvt 0 0\n", p.x, p.y, p.z);
    }
    text += "g all\ns off\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf 1 5 2\nf 2//1 5//1 3//1\nf 3/1 5/1 4/1\nf -2 -1 -5\n";
    let file = parsed(SourceFormat::Obj, text.as_bytes());
    assert_eq!((file.mesh, file.colors), (pyramid(), Some(vec![RED; 5])));
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    use SourceFormat::{Obj, Off, Ply};
    let good = off("OFF\n5 5 0\n", "");
    let swapped = |from: &str, to: &str| good.replacen(from, to, 1);
    let big =
        |what: &str, count: &str| String::from_utf8_lossy(&ply("ascii")).replacen(what, count, 1);
    let cases: Vec<(SourceFormat, String, &str)> = vec![
        (Off, String::new(), "OFF"),
        (
            Off,
            "ply\n".to_owned(),
            "line 1: OFF files begin with OFF, NOFF",
        ),
        (Off, "OFF".to_owned(), "count"),
        (
            Off,
            swapped("5 5 0", "-5 5 0"),
            "line 2: \"-5\" is no count",
        ),
        (
            Off,
            swapped("5 5 0", "5 -5 0"),
            "line 2: \"-5\" is no count",
        ),
        (
            Off,
            swapped("5 5 0", "4000000000 5 0"),
            "more than a file of",
        ),
        (
            Off,
            swapped("5 5 0", "5 99999999999999999 0"),
            "faces are promised",
        ),
        (Off, swapped("5 5 0", "5 6 0"), "ends with 5 of 6 faces"),
        (Off, good[..31].to_owned(), "of 5 vertices"),
        (Off, swapped("\n1 0 -1", "\n1 nan -1"), "line 4: vertex 1"),
        (Off, swapped("\n1 0 -1", "\n1 -inf -1"), "line 4: vertex 1"),
        (Off, swapped("\n1 0 -1", "\n1 1e60 -1"), "line 4: vertex 1"),
        (
            Off,
            swapped("\n1 0 -1", "\n1 0,5 -1"),
            "line 4: \"0,5\" is no coordinate",
        ),
        (Off, swapped("\n1 0 -1", "\n1 0"), "line 4: a coordinate"),
        (
            Off,
            swapped("3 0 4 1", "3 0 5 1"),
            "line 9: a face names vertex 5",
        ),
        (
            Off,
            swapped("3 0 4 1", "3 0 -1 1"),
            "line 9: a face names vertex -1",
        ),
        (Off, swapped("3 0 4 1", "4 0 4 1"), "line 9: a corner"),
        (
            Off,
            swapped("3 0 4 1", "-3 0 4 1"),
            "line 9: \"-3\" is no count of corners",
        ),
        (Off, swapped("OFF", "4OFF"), "4OFF"),
        (Off, swapped("OFF", "nOFF"), "nOFF"),
        (Off, swapped("OFF", "OFF BINARY"), "binary OFF"),
        (Ply, "OFF\n".to_owned(), "line 1: PLY files begin with ply"),
        (Ply, String::new(), "PLY"),
        (
            Ply,
            "ply\nformat ascii 1.0\n".to_owned(),
            "line 3: the end of the header",
        ),
        (
            Ply,
            big("ascii", "base64"),
            "line 2: \"base64\" is no format",
        ),
        (
            Ply,
            big("vertex 5", "vertex 4000000000"),
            "line 5: 4000000000",
        ),
        (
            Ply,
            big("vertex 5", "vertex -5"),
            "line 5: \"-5\" is no count",
        ),
        (
            Ply,
            big("property double x", "property double w"),
            "properties x, y and z",
        ),
        (
            Ply,
            big("property double x", "property half x"),
            "line 6: \"half\" is no type",
        ),
        (
            Ply,
            big("vertex 5", "vertex 6"),
            "4 of 5 elements called face",
        ),
        (Ply, big("-1 0 -1", "-1 nan -1"), "vertex 0"),
        (Obj, "v 1 2\n".to_owned(), "line 1: a coordinate"),
        (
            Obj,
            "v 1 2 x\n".to_owned(),
            "line 1: \"x\" is no coordinate",
        ),
        (Obj, "v 1 2 inf\n".to_owned(), "line 1: vertex 0"),
        (
            Obj,
            "v 1 2 3\n\nf 1 1 2\n".to_owned(),
            "line 3: a face names vertex 2",
        ),
        (
            Obj,
            "v 1 2 3\nf 1 1 0\n".to_owned(),
            "line 2: a face names vertex 0",
        ),
        (
            Obj,
            "v 1 2 3\nf 1 1 -2\n".to_owned(),
            "line 2: a face names vertex -2",
        ),
    ];
    for (format, text, expected) in cases {
        let found = format.parse(text.as_bytes());
        let message = found.map(|_| ()).unwrap_err().to_string();
        assert!(message.contains(expected), "{message:?} for {expected:?}");
    }
    let whole = ply("binary_little_endian");
    let cut = Ply.parse(&whole[..whole.len() - 3]).unwrap_err();
    assert!(matches!(cut.place, Place::Byte(_)), "{cut}");
    assert!(matches!(cut.fault, Fault::Truncated { .. }), "{cut}");
}

#[test]
fn files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh7.noff");
    assert!(matches!(read_mesh(&path), Err(MeshFileError::Io { .. })));
    write_atomically(&path, b"NOFF\n1 1\n").unwrap();
    let message = read_mesh(&path).unwrap_err().to_string();
    assert!(message.contains("mesh7.noff, line 2: "), "{message}");
    let other = read_mesh(&folder.path().join("mesh7.stl")).unwrap_err();
    assert!(other.to_string().contains("mesh7.stl"), "{other}");
}

fn any_mesh() -> impl Strategy<Value = TriangleMesh> {
    (3_usize..30).prop_flat_map(|count| {
        let corner = 0..count as u32;
        let positions = prop::collection::vec(prop::array::uniform3(-100.0_f32..100.0), count);
        let triangles = prop::collection::vec(prop::array::uniform3(corner), 1..40);
        (positions, triangles).prop_map(|(positions, triangles)| TriangleMesh {
            positions: positions.into_iter().map(Vec3::from).collect(),
            triangles,
        })
    })
}

const WRITTEN: [(MeshFormat, SourceFormat); 3] = [
    (MeshFormat::Off, SourceFormat::Off),
    (MeshFormat::Ply, SourceFormat::Ply),
    (MeshFormat::Obj, SourceFormat::Obj),
];

fn written(mesh: &TriangleMesh, format: MeshFormat) -> Vec<u8> {
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(Vec3::to_array).collect();
    let count = positions.len();
    let mesh = ExportMesh {
        name: "any mesh",
        positions: &positions,
        normals: &vec![[0.0, 1.0, 0.0]; count],
        colors: &vec![RED; count],
        triangles: &mesh.triangles,
    };
    mesh_bytes(&mesh, format).unwrap()
}

proptest! {
    #[test]
    fn what_the_exporter_writes_is_read_back(mesh in any_mesh()) {
        for (format, source) in WRITTEN {
            let read = parsed(source, &written(&mesh, format));
            prop_assert_eq!(&read.mesh.triangles, &mesh.triangles);
            prop_assert_eq!(read.mesh.positions.len(), mesh.positions.len());
            for (a, b) in read.mesh.positions.iter().zip(&mesh.positions) {
                // Six decimals are written; a 32-bit number of this size has about five.
                prop_assert!(a.distance(*b) < 2e-5, "{} {}", a, b);
            }
            let colors = (format == MeshFormat::Ply).then(|| vec![RED; mesh.positions.len()]);
            prop_assert_eq!(read.colors, colors);
        }
    }

    /// Bytes changed, cut out, doubled: a mesh that is sound, or an error, but no panic.
    #[test]
    fn mutilated_files_do_no_harm(
        mesh in any_mesh(),
        kind in 0_usize..6,
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0_u8..4, any::<u8>()), 1..12),
    ) {
        let (source, mut bytes) = match kind {
            0..3 => (WRITTEN[kind].1, written(&mesh, WRITTEN[kind].0)),
            _ => {
                let form = ["ascii", "binary_little_endian", "binary_big_endian"][kind - 3];
                (SourceFormat::Ply, ply(form))
            }
        };
        for (at, what, byte) in edits {
            let at = at.index(bytes.len().max(1));
            match what {
                0 if at < bytes.len() => bytes[at] = byte,
                1 => bytes.insert(at, b"0123456789-. \n#efnaOFFply"[byte as usize % 25]),
                2 => bytes.truncate(bytes.len() - bytes.len().min(usize::from(byte) / 8)),
                _ => {
                    let copy: Vec<u8> = bytes.iter().skip(at).take(usize::from(byte)).copied().collect();
                    bytes.splice(at..at, copy);
                }
            }
        }
        if let Ok(file) = source.parse(&bytes) {
            prop_assert!(file.mesh.validate().is_ok());
            if let Some(colors) = file.colors {
                prop_assert_eq!(colors.len(), file.mesh.positions.len());
            }
        }
    }
}
