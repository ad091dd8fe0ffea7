//! Wavefront OBJ: vertices and faces in named groups; everything else is passed over.

use stick3d_model::color::linear_byte;

use super::text::{Lines, coordinates, number};
use super::{Fault, FileMesh, ParseError, fan, position};

/// A line of an OBJ file that matters here.
#[derive(Debug)]
pub(crate) enum Record<'a> {
    /// A vertex; after its position some programs write a colour, numbers between 0 and 1.
    Vertex([f64; 3], Option<[f64; 3]>),
    /// What follows belongs to this group.
    Group(&'a str),
    /// A polygon: vertices counted from 0, all of which exist.
    Face(&'a [u32]),
}

/// Calls `take` with every vertex, group and face.
pub(crate) fn each_record(
    text: &str,
    mut take: impl FnMut(Record<'_>) -> Result<(), Fault>,
) -> Result<(), ParseError> {
    let mut lines = Lines::new(text);
    let (mut vertex_count, mut corners) = (0_usize, vec![]);
    while let Some(line) = lines.next() {
        let mut words = line.split_whitespace();
        let taken = match words.next() {
            Some("v") => {
                vertex_count += 1;
                coordinates(&mut words).and_then(|at| take(Record::Vertex(at, color(words))))
            }
            Some("g") => take(Record::Group(words.next().unwrap_or_default())),
            Some("f") => read_face(words, vertex_count, &mut corners)
                .and_then(|()| take(Record::Face(&corners))),
            _ => Ok(()),
        };
        taken.map_err(|fault| lines.fault(fault))?;
    }
    Ok(())
}

pub(super) fn parse(bytes: &[u8]) -> Result<FileMesh, ParseError> {
    let text = String::from_utf8_lossy(bytes);
    let mut file = FileMesh::default();
    let mut colors = Some(vec![]);
    each_record(&text, |record| {
        match record {
            Record::Vertex(at, color) => {
                let vertex = file.mesh.positions.len();
                file.mesh.positions.push(position(at, vertex)?);
                colors = colors.take().zip(color).map(|(mut colors, [r, g, b])| {
                    let [r, g, b] = [r, g, b].map(|part| linear_byte(part as f32));
                    colors.push([r, g, b, 255]);
                    colors
                });
            }
            Record::Face(corners) => fan(corners, &mut file.mesh.triangles),
            Record::Group(_) => {}
        }
        Ok(())
    })?;
    file.colors = colors;
    Ok(file)
}

fn color<'a>(words: impl Iterator<Item = &'a str>) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
    numbers.try_into().ok()
}

/// The vertices of a face: `7`, `7/1`, `7//3`, `7/1/3`, counted from 1, or from the last one backward below 0.
fn read_face<'a>(
    words: impl Iterator<Item = &'a str>,
    vertex_count: usize,
    corners: &mut Vec<u32>,
) -> Result<(), Fault> {
    corners.clear();
    let last = vertex_count as i64;
    for word in words {
        let word = word.split('/').next().unwrap_or_default();
        let named: i64 = number(word, "vertex number")?;
        let index = if named < 0 {
            last.saturating_add(named)
        } else {
            named - 1
        };
        match u32::try_from(index) {
            Ok(corner) if index < last => corners.push(corner),
            _ => return Err(Fault::NoSuchVertex { named, last }),
        }
    }
    Ok(())
}
