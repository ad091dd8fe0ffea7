//! The text formats: OBJ, PLY, OFF.

use std::fmt::Write as _;

use super::ExportMesh;
use crate::color::srgb_byte;

/// Writing into a `String` cannot fail; this says so in one place.
macro_rules! put {
    ($text:expr, $($arguments:tt)*) => {
        let _ = writeln!($text, $($arguments)*);
    };
}

pub(super) fn obj(mesh: &ExportMesh<'_>) -> String {
    let mut text = format!(
        "# metres, y up\no {}\n",
        mesh.name.replace(char::is_whitespace, "_")
    );
    for [x, y, z] in mesh.positions {
        put!(text, "v {x:.6} {y:.6} {z:.6}");
    }
    for [x, y, z] in mesh.normals {
        put!(text, "vn {x:.5} {y:.5} {z:.5}");
    }
    for triangle in mesh.triangles {
        let [a, b, c] = triangle.map(|corner| corner + 1);
        put!(text, "f {a}//{a} {b}//{b} {c}//{c}");
    }
    text
}

pub(super) fn ply(mesh: &ExportMesh<'_>) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment {}, metres, y up\nelement vertex {}\n",
        mesh.name.replace(char::is_whitespace, " "),
        mesh.positions.len()
    );
    for property in ["x", "y", "z", "nx", "ny", "nz"] {
        put!(text, "property float {property}");
    }
    for property in ["red", "green", "blue", "alpha"] {
        put!(text, "property uchar {property}");
    }
    put!(
        text,
        "element face {}\nproperty list uchar int vertex_indices\nend_header",
        mesh.triangles.len()
    );
    for (([x, y, z], [nx, ny, nz]), [r, g, b, a]) in
        mesh.positions.iter().zip(mesh.normals).zip(mesh.colors)
    {
        let [r, g, b] = [*r, *g, *b].map(|linear| srgb_byte(f32::from(linear) / 255.0));
        put!(
            text,
            "{x:.6} {y:.6} {z:.6} {nx:.5} {ny:.5} {nz:.5} {r} {g} {b} {a}"
        );
    }
    for [a, b, c] in mesh.triangles {
        put!(text, "3 {a} {b} {c}");
    }
    text
}

pub(super) fn off(mesh: &ExportMesh<'_>) -> String {
    let mut text = format!("OFF\n{} {} 0\n", mesh.positions.len(), mesh.triangles.len());
    for [x, y, z] in mesh.positions {
        put!(text, "{x:.6} {y:.6} {z:.6}");
    }
    for [a, b, c] in mesh.triangles {
        put!(text, "3 {a} {b} {c}");
    }
    text
}
