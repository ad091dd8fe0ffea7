//! From the bytes of a sketch file to a drawing.

use std::borrow::Cow;
use std::fmt;

use glam::Vec2;
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::{Drawing, InterchangeError};
use crate::figure::Figure;
use crate::sketch::Sketch;
use crate::stroke::Stroke;

/// The file as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File<'a> {
    #[serde(borrow)]
    figure: Cow<'a, str>,
    #[serde(default)]
    joints: Option<Named>,
    #[serde(default)]
    path: Option<Vec<Point<2>>>,
    #[serde(default)]
    strokes: Option<Vec<Vec<Point<3>>>>,
    #[serde(default)]
    y: YAxis,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum YAxis {
    #[default]
    Up,
    Down,
}

impl YAxis {
    fn upward(self, [x, y]: [f32; 2]) -> Vec2 {
        match self {
            Self::Up => Vec2::new(x, y),
            // Adding zero keeps a negative zero out of the files that are written again.
            Self::Down => Vec2::new(x, 0.0 - y),
        }
    }
}

/// Two numbers, and up to `MOST` of them; the third is a time.
struct Point<const MOST: usize> {
    position: [f32; 2],
    time_s: f64,
}

impl<'de, const MOST: usize> Deserialize<'de> for Point<MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Numbers<const MOST: usize>;

        impl<'de, const MOST: usize> Visitor<'de> for Numbers<MOST> {
            type Value = Point<MOST>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(if MOST == 2 {
                    "a point [x, y]"
                } else {
                    "a point [x, y] or [x, y, seconds]"
                })
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
                let short = |got| serde::de::Error::invalid_length(got, &self);
                let x: f64 = seq.next_element()?.ok_or_else(|| short(0))?;
                let y: f64 = seq.next_element()?.ok_or_else(|| short(1))?;
                let time_s = if MOST > 2 {
                    seq.next_element()?.unwrap_or(0.0)
                } else {
                    0.0
                };
                if seq.next_element::<IgnoredAny>()?.is_some() {
                    return Err(short(MOST + 1));
                }
                // Beyond f32 this becomes infinite, which the sketch refuses with the joint's name.
                Ok(Point {
                    position: [x as f32, y as f32],
                    time_s,
                })
            }
        }

        deserializer.deserialize_seq(Numbers::<MOST>)
    }
}

/// A map in which no name is lost when it occurs twice.
struct Named(Vec<(String, Point<2>)>);

impl<'de> Deserialize<'de> for Named {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries;

        impl<'de> Visitor<'de> for Entries {
            type Value = Named;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("joints by name: {\"neck\": [x, y], ...}")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Named(entries))
            }
        }

        deserializer.deserialize_map(Entries)
    }
}

pub(super) fn drawing(figure: &Figure, bytes: &[u8]) -> Result<Drawing, InterchangeError> {
    let file: File<'_> = serde_json::from_slice(bytes).map_err(syntax)?;
    if file.figure != figure.name {
        return Err(InterchangeError::WrongFigure {
            expected: figure.name.clone(),
            got: file.figure.chars().take(64).collect(),
        });
    }
    let y = file.y;
    match (file.joints, file.path, file.strokes) {
        (Some(Named(joints)), None, None) => {
            let joints = joints
                .iter()
                .map(|(name, p)| (name.as_str(), y.upward(p.position)));
            Ok(Drawing::Joints(Sketch::from_named(figure, joints)?))
        }
        (None, Some(path), None) => {
            let points: Vec<Vec2> = path.iter().map(|p| y.upward(p.position)).collect();
            Sketch::from_path(figure, &points)?;
            Ok(Drawing::Path(points))
        }
        (None, None, Some(strokes)) => {
            let strokes = strokes
                .iter()
                .enumerate()
                .map(|(i, points)| stroke(i, points, y));
            Ok(Drawing::Strokes(strokes.collect::<Result<_, _>>()?))
        }
        (joints, path, strokes) => Err(InterchangeError::Forms {
            count: [joints.is_some(), path.is_some(), strokes.is_some()]
                .into_iter()
                .filter(|there| *there)
                .count(),
        }),
    }
}

fn stroke(index: usize, points: &[Point<3>], y: YAxis) -> Result<Stroke, InterchangeError> {
    let mut stroke = Stroke::default();
    for point in points {
        stroke
            .push(y.upward(point.position), point.time_s)
            .map_err(|source| InterchangeError::Stroke {
                stroke: index,
                source,
            })?;
    }
    Ok(stroke)
}

pub(super) fn figure_name(bytes: &[u8]) -> Result<String, InterchangeError> {
    #[derive(Deserialize)]
    struct Head {
        figure: String,
    }
    let head: Head = serde_json::from_slice(bytes).map_err(syntax)?;
    Ok(head.figure)
}

fn syntax(error: serde_json::Error) -> InterchangeError {
    let (line, column) = (error.line(), error.column());
    // The place has fields of its own.
    let message = error.to_string();
    let message = message
        .split(" at line ")
        .next()
        .unwrap_or(&message)
        .to_owned();
    InterchangeError::Syntax {
        line,
        column,
        message,
    }
}
