//! The header of a PLY file: which elements with which properties, in which form.
//!
//! Source: Greg Turk, "The PLY Polygon File Format".

use super::text::number;
use super::{Fault, ParseError};

/// How the numbers after the header are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A type of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn of(word: &str) -> Result<Self, Fault> {
        Ok(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => {
                return Err(Fault::Word {
                    expected: "type of number",
                    found: word.chars().take(40).collect(),
                });
            }
        })
    }

    /// How many bytes one takes in binary files.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// One property of an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of a list's length, for lists.
    pub(super) count: Option<Scalar>,
    pub(super) scalar: Scalar,
}

/// A kind of element and how many there are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

/// What the header says.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) form: Form,
    pub(super) elements: Vec<Element>,
    /// Where the numbers begin: byte, and line from 1.
    pub(super) body: (usize, usize),
}

pub(super) fn parse(bytes: &[u8]) -> Result<Header, ParseError> {
    let (mut form, mut elements) = (None, vec![]);
    let (mut start, mut number) = (0, 0);
    while let Some(length) = bytes[start..].iter().position(|byte| *byte == b'\n') {
        let line = String::from_utf8_lossy(&bytes[start..start + length]);
        start += length + 1;
        number += 1;
        if number == 1 {
            check_magic(&line)?;
            continue;
        }
        let mut words = line.split_whitespace();
        let read = match words.next() {
            Some("format") => read_form(words).map(|found| form = Some(found)),
            Some("element") => read_element(words, bytes.len()).map(|found| elements.push(found)),
            Some("property") => read_property(words).and_then(|property| {
                let element: &mut Element = elements
                    .last_mut()
                    .ok_or(Fault::Missing("an element before its property"))?;
                element.properties.push(property);
                Ok(())
            }),
            Some("end_header") => {
                let form = form.ok_or(ParseError::line(number, Fault::Missing("the format")))?;
                let body = (start, number + 1);
                return Ok(Header {
                    form,
                    elements,
                    body,
                });
            }
            Some("comment" | "obj_info") | None => Ok(()),
            Some(word) => Err(Fault::Word {
                expected: "word of a header",
                found: word.chars().take(40).collect(),
            }),
        };
        read.map_err(|fault| ParseError::line(number, fault))?;
    }
    if number == 0 {
        check_magic(&String::from_utf8_lossy(&bytes[..bytes.len().min(20)]))?;
    }
    Err(ParseError::line(
        number + 1,
        Fault::Missing("the end of the header"),
    ))
}

fn check_magic(line: &str) -> Result<(), ParseError> {
    if line.trim_start_matches('\u{feff}').trim_end() == "ply" {
        return Ok(());
    }
    let fault = Fault::Header {
        format: "PLY",
        expected: "ply",
        found: line.chars().take(20).collect(),
    };
    Err(ParseError::line(1, fault))
}

fn read_form<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<Form, Fault> {
    match words.next().unwrap_or_default() {
        "ascii" => Ok(Form::Ascii),
        "binary_little_endian" => Ok(Form::LittleEndian),
        "binary_big_endian" => Ok(Form::BigEndian),
        word => Err(Fault::Word {
            expected: "format",
            found: word.chars().take(40).collect(),
        }),
    }
}

fn read_element<'a>(
    mut words: impl Iterator<Item = &'a str>,
    bytes: usize,
) -> Result<Element, Fault> {
    let name = words
        .next()
        .ok_or(Fault::Missing("the name of an element"))?;
    let count: u64 = number(words.next().unwrap_or_default(), "count")?;
    // An element takes a byte at least.
    if count > bytes as u64 {
        let what = format!("elements called {name}");
        return Err(Fault::TooMany { what, count, bytes });
    }
    Ok(Element {
        name: name.to_owned(),
        count: count as usize,
        properties: vec![],
    })
}

fn read_property<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<Property, Fault> {
    let mut next = || words.next().ok_or(Fault::Missing("a word of a property"));
    let kind = next()?;
    let (count, scalar) = if kind == "list" {
        (Some(Scalar::of(next()?)?), Scalar::of(next()?)?)
    } else {
        (None, Scalar::of(kind)?)
    };
    let name = next()?.to_owned();
    if count.is_some_and(|count| !count.is_integer()) {
        return Err(Fault::Word {
            expected: "type of a length",
            found: "float".to_owned(),
        });
    }
    Ok(Property {
        name,
        count,
        scalar,
    })
}
