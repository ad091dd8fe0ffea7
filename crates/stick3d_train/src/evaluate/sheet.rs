//! A sheet of sketches, each with the bodies that a model finds it may mean.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use image::{Rgba, RgbaImage, imageops};
use rayon::prelude::*;
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::Sketch;
use stick3d_model::{Alternatives, Inference, Model};

use super::EvalError;
use crate::render::{
    Camera, RenderMesh, contact_sheet, draw_sketch, draw_text, render, text_width_px,
};

/// The longer and the shorter side of a picture, pixels.
const SIDES_PX: [u32; 2] = [240, 200];
/// Space between the pictures of a strip, and at both its ends, pixels.
const GAP: u32 = 3;
const END: u32 = 9;
/// How many alternatives there are pictures of, beside the first answer.
const OTHERS: usize = 3;
/// Where views are from: yaw and pitch, radians. Drawings are from the front.
const FRONT_RAD: (f32, f32) = (0.0, 0.0);
const TURNED_RAD: (f32, f32) = (PI / 3.0, 0.16);
/// Sketches side by side on the sheet.
const COLUMNS: u32 = 3;
/// Colours of the paper that sketches are on, and of what is written.
const PAPER: Rgba<u8> = Rgba([252, 251, 247, 255]);
const INK: [u8; 3] = [70, 75, 82];
/// Space round a sketch, in parts of the picture's shorter side, and how thick its lines are, pixels.
const MARGIN: f32 = 0.1;
const LINE_PX: f32 = 3.5;

/// A body that stands on the ground.
struct Answer {
    probability: f32,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

/// Draws sketches, each with its label below: the drawing, the likeliest body from the front and turned by 60 degrees, and up
/// to three more that it may mean, small, turned likewise. Numbers in the pictures are ranks and probabilities.
///
/// # Errors
/// [`EvalError::NoSketches`] without sketches, [`EvalError::Infer`] for one of another figure.
pub fn answer_sheet(model: &Model, sketches: &[(String, Sketch)]) -> Result<RgbaImage, EvalError> {
    if sketches.is_empty() {
        return Err(EvalError::NoSketches);
    }
    let answers: Vec<Vec<Answer>> = sketches
        .par_iter()
        .map(|(_, sketch)| answers(model, sketch))
        .collect::<Result<_, _>>()?;
    let with_others = answers.iter().any(|answers| answers.len() > 1);
    let strips: Vec<(String, RgbaImage)> = sketches
        .par_iter()
        .zip(&answers)
        .map(|((label, sketch), answers)| {
            (label.clone(), strip(model, sketch, answers, with_others))
        })
        .collect();
    Ok(contact_sheet(&strips, COLUMNS))
}

fn answers(model: &Model, sketch: &Sketch) -> Result<Vec<Answer>, EvalError> {
    let mut inference = Inference::new(model)?;
    let mut alternatives = Alternatives::default();
    inference.infer(sketch, &mut alternatives)?;
    let mut positions = vec![[0.0; 3]; inference.vertex_count()];
    let mut normals = positions.clone();
    let vectors = |list: &[[f32; 3]]| list.iter().copied().map(Vec3::from).collect::<Vec<_>>();
    let mut answers = vec![];
    for alternative in alternatives.as_slice() {
        inference.decode(&alternative.latent, &mut positions, &mut normals)?;
        let lowest = positions.iter().map(|p| p[1]).fold(f32::INFINITY, f32::min);
        positions.iter_mut().for_each(|p| p[1] -= lowest);
        answers.push(Answer {
            probability: alternative.probability,
            positions: vectors(&positions),
            normals: vectors(&normals),
        });
    }
    Ok(answers)
}

/// The pictures of one sketch, side by side, all bodies at one scale.
fn strip(model: &Model, sketch: &Sketch, answers: &[Answer], with_others: bool) -> RgbaImage {
    let [width, height] = size_px(model.figure());
    let shown = &answers[..answers.len().min(1 + OTHERS)];
    let seen_from = |answer: &Answer, (yaw_rad, pitch_rad): (f32, f32)| {
        let aspect = width as f32 / height as f32;
        Camera::framing(&answer.positions, yaw_rad, pitch_rad, aspect)
    };
    let front = shown.first().map(|first| seen_from(first, FRONT_RAD));
    let turned: Vec<Camera> = shown
        .iter()
        .map(|answer| seen_from(answer, TURNED_RAD))
        .collect();
    let height_m = front
        .iter()
        .chain(&turned)
        .map(|camera| camera.height_m)
        .fold(0.0, f32::max);
    let picture = |answer: &Answer, camera: &Camera, [width, height]: [u32; 2]| {
        let camera = Camera {
            height_m,
            ..*camera
        };
        let mesh = RenderMesh {
            positions: &answer.positions,
            normals: &answer.normals,
            colors: model.colors(),
            triangles: model.triangles(),
        };
        render(&[mesh], &camera, width, height)
    };

    let pictures = if with_others { 4 } else { 3 };
    let left = |picture: u32| END + picture * (width + GAP);
    let mut strip = RgbaImage::from_pixel(left(pictures) - GAP + END, height, Rgba([255; 4]));
    let mut put = |picture: &RgbaImage, x: u32, y: u32| {
        imageops::replace(&mut strip, picture, i64::from(x), i64::from(y));
    };
    put(
        &drawing(model.figure(), sketch, [width, height]),
        left(0),
        0,
    );
    if let (Some(first), Some(front), Some(turned)) = (shown.first(), &front, turned.first()) {
        put(&picture(first, front, [width, height]), left(1), 0);
        let mut picture = picture(first, turned, [width, height]);
        write(&mut picture, &percent(1, first));
        put(&picture, left(2), 0);
    }
    // The others share the place of one picture, two in a row.
    let small = [(width - GAP) / 2, (height - GAP) / 2];
    for ((rank, answer), camera) in (1..).zip(shown).zip(&turned).skip(1) {
        let mut picture = picture(answer, camera, small);
        write(&mut picture, &percent(rank, answer));
        let (column, row) = ((rank - 2) % 2, (rank - 2) / 2);
        put(
            &picture,
            left(3) + column * (small[0] + GAP),
            row * (small[1] + GAP),
        );
    }
    strip
}

/// Width and height of a picture, pixels: lying for a figure that is longer than high, else standing.
fn size_px(figure: &Figure) -> [u32; 2] {
    let [low, high] = corners(&figure.template);
    let [long, short] = SIDES_PX;
    if high.x - low.x > high.y - low.y {
        [long, short]
    } else {
        [short, long]
    }
}

fn corners(points: &[Vec2]) -> [Vec2; 2] {
    points
        .iter()
        .fold([Vec2::INFINITY, Vec2::NEG_INFINITY], |[low, high], at| {
            [low.min(*at), high.max(*at)]
        })
}

/// The sketch on paper.
fn drawing(figure: &Figure, sketch: &Sketch, [width, height]: [u32; 2]) -> RgbaImage {
    let mut paper = RgbaImage::from_pixel(width, height, PAPER);
    let [low, high] = corners(sketch.points());
    let size = Vec2::new(width as f32, height as f32);
    let room = size - 2.0 * MARGIN * size.min_element();
    let scale = (room / (high - low).max(Vec2::splat(f32::MIN_POSITIVE))).min_element();
    let middle = (low + high) / 2.0;
    let joints_px: Vec<Vec2> = sketch
        .points()
        .iter()
        .map(|point| size / 2.0 + (*point - middle) * scale * Vec2::new(1.0, -1.0))
        .collect();
    draw_sketch(&mut paper, figure, &joints_px, LINE_PX);
    paper
}

/// Rank and probability.
fn percent(rank: u32, answer: &Answer) -> String {
    format!("{rank}: {:.0} %", 100.0 * answer.probability)
}

/// Writes into the upper right corner of a picture, away from feet and shadows.
fn write(picture: &mut RgbaImage, text: &str) {
    let x = picture.width().saturating_sub(text_width_px(text, 1) + 4);
    draw_text(picture, (x, 5), 1, INK, text);
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn horse() -> Model {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/models/horse.stick3d");
        Model::load(&path).unwrap()
    }

    fn as_tall(figure: &Figure, tall: f32) -> Sketch {
        let points = figure.template.iter().map(|p| *p * Vec2::new(1.0, tall));
        Sketch::new(figure, points.collect()).unwrap()
    }

    /// How many pixels in the middle of a place of a picture are darker than any background.
    fn shown_in(picture: &RgbaImage, [left, top]: [u32; 2], [width, height]: [u32; 2]) -> usize {
        (left + width / 4..left + 3 * width / 4)
            .flat_map(|x| (top + height / 4..top + 3 * height / 4).map(move |y| (x, y)))
            .filter(|(x, y)| {
                let [r, g, b, _] = picture.get_pixel(*x, *y).0;
                r.max(g).max(b) < 170
            })
            .count()
    }

    #[test]
    fn three_more_answers_share_the_place_of_one() {
        let model = horse();
        let sketch = as_tall(model.figure(), 1.0);
        let four: Vec<Answer> = [1.0, 0.8, 1.3, 0.6, 1.1]
            .map(|tall| as_tall(model.figure(), tall))
            .iter()
            .flat_map(|sketch| answers(&model, sketch).unwrap().into_iter().take(1))
            .collect();
        let [width, height] = size_px(model.figure());
        let strip = strip(&model, &sketch, &four, true);
        let left = END + 3 * (width + GAP);
        assert_eq!(strip.width(), left + width + END);
        let small = [(width - GAP) / 2, (height - GAP) / 2];
        let at = |column, row| [left + column * (small[0] + GAP), row * (small[1] + GAP)];
        let shown = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)].map(|at| shown_in(&strip, at, small));
        assert!(shown[..3].iter().all(|pixels| *pixels > 50), "{shown:?}");
        assert_eq!(shown[3], 0, "no more than three");
    }

    #[test]
    fn a_sheet_shows_drawing_and_body_of_every_sketch() {
        let model = horse();
        let figure = model.figure();
        let sketches: Vec<_> = [1.0, 0.9, 1.1]
            .map(|tall| (format!("horse {tall}"), as_tall(figure, tall)))
            .into();
        let sheet = answer_sheet(&model, &sketches).unwrap();
        let [width, height] = size_px(figure);
        assert!(width > height, "a horse is longer than high");
        assert!(sheet.width() >= 3 * 3 * width && sheet.height() > height);
        let strip = sheet.width() / 3;
        for (column, picture) in (0..3).flat_map(|column| (0..3).map(move |p| (column, p))) {
            let left = column * strip + END + picture * (width + GAP);
            let shown = shown_in(&sheet, [left, 0], [width, height]);
            assert!(shown > 100, "{column} {picture}: {shown}");
        }
        assert!(matches!(
            answer_sheet(&model, &[]),
            Err(EvalError::NoSketches)
        ));
        let man = Sketch::template(Figure::human());
        assert!(answer_sheet(&model, &[("man".to_owned(), man)]).is_err());
    }
}
