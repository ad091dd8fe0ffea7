//! PLY: a header that says what follows, then vertices and faces in text or binary.

use stick3d_model::color::linear_byte;

use super::ply_header::{Element, Form, Scalar};
use super::text::number;
use super::{Fault, FileMesh, ParseError, Place, fan, ply_header, position};

pub(super) fn parse(bytes: &[u8]) -> Result<FileMesh, ParseError> {
    let header = ply_header::parse(bytes)?;
    let mut body = Body {
        bytes,
        form: header.form,
        at: header.body.0,
        line: header.body.1,
    };
    let vertices = header.elements.iter().find(|e| e.name == "vertex");
    let vertex_count = vertices.map_or(0, |vertices| vertices.count);
    let mut file = FileMesh::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut body, &mut file)?,
            "face" => read_faces(element, vertex_count, &mut body, &mut file)?,
            _ => skip(element, &mut body)?,
        }
    }
    if file.mesh.positions.is_empty() {
        return Err(body.fault(Fault::Missing(
            "the element vertex, with one vertex at least,",
        )));
    }
    Ok(file)
}

fn read_vertices(
    element: &Element,
    body: &mut Body<'_>,
    file: &mut FileMesh,
) -> Result<(), ParseError> {
    let place = |name: &str| {
        let named = |p: &ply_header::Property| p.name == name && p.count.is_none();
        element.properties.iter().position(named)
    };
    let (Some(x), Some(y), Some(z)) = (place("x"), place("y"), place("z")) else {
        return Err(body.fault(Fault::Missing("one of the vertices' properties x, y and z")));
    };
    let color = match (place("red"), place("green"), place("blue")) {
        (Some(r), Some(g), Some(b)) => Some([r, g, b]),
        _ => None,
    };
    let mut values = vec![0.0; element.properties.len()];
    let mut colors = vec![];
    for vertex in 0..element.count {
        for (property, value) in element.properties.iter().zip(&mut values) {
            match property.count {
                None => *value = body.next(property.scalar, (element, vertex))?,
                Some(count) => body.skip_list(count, property.scalar, (element, vertex))?,
            }
        }
        let at = position([values[x], values[y], values[z]], vertex);
        file.mesh
            .positions
            .push(at.map_err(|fault| body.fault(fault))?);
        colors.extend(color.map(|rgb| {
            let [r, g, b] = rgb.map(|i| {
                let whole = element.properties[i].scalar.is_integer();
                linear_byte(values[i] as f32 / if whole { 255.0 } else { 1.0 })
            });
            [r, g, b, 255]
        }));
    }
    file.colors = color.map(|_| colors);
    Ok(())
}

fn read_faces(
    element: &Element,
    vertex_count: usize,
    body: &mut Body<'_>,
    file: &mut FileMesh,
) -> Result<(), ParseError> {
    let mut corners = vec![];
    for face in 0..element.count {
        for property in &element.properties {
            let here = (element, face);
            match property.count {
                None => drop(body.next(property.scalar, here)?),
                Some(count) if ["vertex_indices", "vertex_index"].contains(&&*property.name) => {
                    let length = body.length(count, here)?;
                    corners.clear();
                    for _ in 0..length {
                        let named = body.next(property.scalar, here)?;
                        corners.push(corner(named, vertex_count).map_err(|f| body.fault(f))?);
                    }
                    fan(&corners, &mut file.mesh.triangles);
                }
                Some(count) => body.skip_list(count, property.scalar, here)?,
            }
        }
    }
    Ok(())
}

fn corner(named: f64, vertex_count: usize) -> Result<u32, Fault> {
    if named >= 0.0 && named < vertex_count as f64 && named.fract() == 0.0 {
        return Ok(named as u32);
    }
    Err(Fault::NoSuchVertex {
        named: named as i64,
        last: vertex_count as i64 - 1,
    })
}

fn skip(element: &Element, body: &mut Body<'_>) -> Result<(), ParseError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for index in 0..element.count {
        for property in &element.properties {
            match property.count {
                None => drop(body.next(property.scalar, (element, index))?),
                Some(count) => body.skip_list(count, property.scalar, (element, index))?,
            }
        }
    }
    Ok(())
}

/// The numbers after the header.
struct Body<'a> {
    bytes: &'a [u8],
    form: Form,
    /// The next byte.
    at: usize,
    /// The line that it is in, in text files.
    line: usize,
}

/// What is being read, for errors: the kind of element and the number of this one.
type Here<'e> = (&'e Element, usize);

impl Body<'_> {
    fn fault(&self, fault: Fault) -> ParseError {
        let place = match self.form {
            Form::Ascii => Place::Line(self.line),
            Form::LittleEndian | Form::BigEndian => Place::Byte(self.at),
        };
        ParseError { place, fault }
    }

    fn truncated(&self, (element, found): Here<'_>) -> ParseError {
        self.fault(Fault::Truncated {
            what: format!("elements called {}", element.name),
            found,
            expected: element.count,
        })
    }

    /// The next number.
    fn next(&mut self, scalar: Scalar, here: Here<'_>) -> Result<f64, ParseError> {
        if self.form == Form::Ascii {
            return self.next_word(here);
        }
        let rest = &self.bytes[self.at..];
        let Some(found) = rest.get(..scalar.size()) else {
            return Err(self.truncated(here));
        };
        // Little-endian, whatever the file has, with zeros after it.
        let mut low_first = [0; 8];
        low_first[..found.len()].copy_from_slice(found);
        if self.form == Form::BigEndian {
            low_first[..found.len()].reverse();
        }
        self.at += found.len();
        let bits = u64::from_le_bytes(low_first);
        Ok(match scalar {
            Scalar::I8 => f64::from(bits as i8),
            Scalar::U8 => f64::from(bits as u8),
            Scalar::I16 => f64::from(bits as i16),
            Scalar::U16 => f64::from(bits as u16),
            Scalar::I32 => f64::from(bits as i32),
            Scalar::U32 => f64::from(bits as u32),
            Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
            Scalar::F64 => f64::from_bits(bits),
        })
    }

    fn next_word(&mut self, here: Here<'_>) -> Result<f64, ParseError> {
        while let Some(byte) = self.bytes.get(self.at).filter(|b| b.is_ascii_whitespace()) {
            self.line += usize::from(*byte == b'\n');
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let length = rest
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(rest.len());
        if length == 0 {
            return Err(self.truncated(here));
        }
        let word = String::from_utf8_lossy(&rest[..length]);
        let value = number(&word, "number").map_err(|fault| self.fault(fault))?;
        self.at += length;
        Ok(value)
    }

    /// The length of a list.
    fn length(&mut self, count: Scalar, here: Here<'_>) -> Result<usize, ParseError> {
        let length = self.next(count, here)?;
        if length >= 0.0 && length.fract() == 0.0 {
            return Ok(length as usize);
        }
        Err(self.fault(Fault::Word {
            expected: "length of a list",
            found: length.to_string(),
        }))
    }

    fn skip_list(
        &mut self,
        count: Scalar,
        scalar: Scalar,
        here: Here<'_>,
    ) -> Result<(), ParseError> {
        for _ in 0..self.length(count, here)? {
            self.next(scalar, here)?;
        }
        Ok(())
    }
}
