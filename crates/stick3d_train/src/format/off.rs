//! OFF: a header, counts, one vertex a line, one face a line.
//!
//! The header is `OFF` with letters before it for what the vertices' lines hold beside positions: `N` normals, `C`
//! colours, `ST` texture coordinates. Counts follow on the same line, even without a space, or on the next. Some
//! programs write no header at all. Source: the manual of Geomview, "OFF: Object File Format".

use stick3d_model::color::linear_byte;

use super::text::{Lines, coordinates, number};
use super::{Fault, FileMesh, ParseError, fan, position};

/// Shortest line of a vertex and of a face, bytes.
const LEAST_VERTEX: u64 = 6;
const LEAST_FACE: u64 = 2;

/// What the header says.
struct Header {
    vertices: usize,
    faces: usize,
    has_colors: bool,
}

pub(super) fn parse(bytes: &[u8]) -> Result<FileMesh, ParseError> {
    // Comments may be in any encoding; what matters is ASCII.
    let text = String::from_utf8_lossy(bytes);
    let mut lines = Lines::new(&text);
    let header = header(&mut lines, bytes.len())?;
    let mut file = FileMesh::default();
    let mut colors: Option<Vec<[u8; 4]>> = header.has_colors.then(Vec::new);
    for vertex in 0..header.vertices {
        let line = element(&mut lines, "vertices", vertex, header.vertices)?;
        let mut words = line.split_whitespace();
        let place = coordinates(&mut words).and_then(|numbers| position(numbers, vertex));
        file.mesh
            .positions
            .push(place.map_err(|fault| lines.fault(fault))?);
        // A line without a colour among lines with one: then there are none.
        colors = colors.zip(color(words)).map(|(mut colors, color)| {
            colors.push(color);
            colors
        });
    }
    file.colors = colors;
    let mut corners = vec![];
    for face in 0..header.faces {
        let line = element(&mut lines, "faces", face, header.faces)?;
        read_face(line, header.vertices, &mut corners).map_err(|fault| lines.fault(fault))?;
        fan(&corners, &mut file.mesh.triangles);
    }
    Ok(file)
}

fn header(lines: &mut Lines<'_>, bytes: usize) -> Result<Header, ParseError> {
    let line = lines.next().unwrap_or_default();
    let mut words = line.split_whitespace();
    let first = words.next().unwrap_or_default();
    let mut counts: Vec<&str> = vec![];
    let mut has_colors = false;
    if first.starts_with(|c: char| c.is_ascii_digit()) {
        counts.push(first);
    } else {
        let (letters, rest) = keyword(first).map_err(|fault| lines.fault(fault))?;
        // With normals too, programs disagree about which comes first.
        has_colors = letters.contains('C') && !letters.contains('N');
        counts.extend((!rest.is_empty()).then_some(rest));
    }
    counts.extend(words);
    if counts
        .first()
        .is_some_and(|word| word.eq_ignore_ascii_case("binary"))
    {
        return Err(lines.fault(Fault::Unsupported("binary OFF".to_owned())));
    }
    while counts.len() < 2 {
        let Some(line) = lines.next() else {
            return Err(lines.fault(Fault::Missing("the count of vertices or of faces")));
        };
        counts.extend(line.split_whitespace());
    }
    let count = |word: &str, what: &str, least: u64| -> Result<usize, Fault> {
        let count: u64 = number(word, "count")?;
        if count > bytes as u64 / least {
            let what = what.to_owned();
            return Err(Fault::TooMany { what, count, bytes });
        }
        Ok(count as usize)
    };
    let vertices = count(counts[0], "vertices", LEAST_VERTEX);
    let faces = count(counts[1], "faces", LEAST_FACE);
    Ok(Header {
        vertices: vertices.map_err(|fault| lines.fault(fault))?,
        faces: faces.map_err(|fault| lines.fault(fault))?,
        has_colors,
    })
}

/// The letters before `OFF`, and what follows it without a space.
fn keyword(word: &str) -> Result<(&str, &str), Fault> {
    let foreign = || Fault::Header {
        format: "OFF",
        expected: "OFF, NOFF, COFF or the like",
        found: word.chars().take(20).collect(),
    };
    let at = word
        .find("OFF")
        .or_else(|| word.find("off"))
        .ok_or_else(foreign)?;
    let (letters, rest) = (&word[..at], &word[at + 3..]);
    if letters.contains(['4', 'n']) {
        return Err(Fault::Unsupported(format!(
            "{word}, with positions of other than three coordinates,"
        )));
    }
    let known = letters
        .chars()
        .all(|c| "STCN".contains(c.to_ascii_uppercase()));
    let counted = rest.chars().all(|c| c.is_ascii_digit());
    (known && counted)
        .then_some((letters, rest))
        .ok_or_else(foreign)
}

fn element<'a>(
    lines: &mut Lines<'a>,
    what: &str,
    found: usize,
    expected: usize,
) -> Result<&'a str, ParseError> {
    lines.next().ok_or_else(|| {
        let what = what.to_owned();
        lines.fault(Fault::Truncated {
            what,
            found,
            expected,
        })
    })
}

/// Three or four more numbers: bytes, or, where one has a point, between 0 and 1.
fn color<'a>(words: impl Iterator<Item = &'a str>) -> Option<[u8; 4]> {
    let words: Vec<&str> = words.take(4).collect();
    let numbers: Vec<f64> = words.iter().map_while(|word| word.parse().ok()).collect();
    let unit = if words.iter().any(|word| word.contains('.')) {
        1.0
    } else {
        255.0
    };
    match numbers[..] {
        [r, g, b] | [r, g, b, _] => {
            let [r, g, b] = [r, g, b].map(|number| linear_byte(number as f32 / unit));
            Some([r, g, b, 255])
        }
        _ => None,
    }
}

fn read_face(line: &str, vertex_count: usize, corners: &mut Vec<u32>) -> Result<(), Fault> {
    let mut words = line.split_whitespace();
    let count: usize = number(words.next().unwrap_or_default(), "count of corners")?;
    corners.clear();
    for _ in 0..count {
        let word = words.next().ok_or(Fault::Missing("a corner of a face"))?;
        let named: i64 = number(word, "vertex number")?;
        match u32::try_from(named) {
            Ok(corner) if (corner as usize) < vertex_count => corners.push(corner),
            _ => {
                let last = vertex_count as i64 - 1;
                return Err(Fault::NoSuchVertex { named, last });
            }
        }
    }
    Ok(())
}
