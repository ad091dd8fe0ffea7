//! From a drawing to the text of a sketch file.

use glam::Vec2;
use serde_json::{Value, json};

use super::{Drawing, InterchangeError};
use crate::figure::Figure;
use crate::sketch::check_count;

pub(super) fn json(figure: &Figure, drawing: &Drawing) -> Result<String, InterchangeError> {
    let (key, open, lines, close) = match drawing {
        Drawing::Joints(sketch) => {
            check_count(
                figure,
                "joints",
                figure.joint_count(),
                sketch.points().len(),
            )?;
            let lines = figure.joints.iter().zip(sketch.points());
            let lines = lines.map(|(joint, p)| format!("{}: {}", json!(joint.name), point(*p)));
            ("joints", '{', lines.collect::<Vec<_>>(), '}')
        }
        Drawing::Path(points) => {
            check_count(figure, "path points", figure.path_len(), points.len())?;
            (
                "path",
                '[',
                points.iter().map(|p| point(*p).to_string()).collect(),
                ']',
            )
        }
        Drawing::Strokes(strokes) => {
            let lines = strokes.iter().map(|stroke| {
                let points = stroke.points().iter();
                let points = points
                    .map(|p| json!([short(p.position_px.x), short(p.position_px.y), p.time_s]));
                Value::Array(points.collect()).to_string()
            });
            ("strokes", '[', lines.collect(), ']')
        }
    };
    let name = json!(figure.name);
    let body = lines.join(",\n    ");
    let body = if body.is_empty() {
        body
    } else {
        format!("\n    {body}\n  ")
    };
    Ok(format!(
        "{{\n  \"figure\": {name},\n  \"{key}\": {open}{body}{close}\n}}\n"
    ))
}

fn point(p: Vec2) -> Value {
    json!([short(p.x), short(p.y)])
}

/// As few digits as bring the same `f32` back.
fn short(value: f32) -> Value {
    value
        .to_string()
        .parse::<f64>()
        .map_or(Value::Null, Value::from)
}
