//! Between the timeline and its file, `*.clip.ron`.

use std::path::Path;

use bevy::math::Vec2;
use stick3d_figure::{Figure, Sketch, SketchError};
use stick3d_model::latent::{ClipError, ClipFile, ClipKey, ClipPose};
use stick3d_model::{InferError, Inference, Model, ModelError};
use thiserror::Error;

use super::state::{LATEST_S, Scene};
use crate::sketch_input::{CANVAS_SIZE, Ink, fit_to_canvas};

/// Why a clip file is no timeline, or a timeline no clip file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ClipFileError {
    /// It cannot be read or written, or its keys are no motion.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// It is of a figure that is not here.
    #[error(
        "the clip is of figure \"{name}\", which is not here; {suggestion} Start the editor with --model FILE for a figure of your own"
    )]
    UnknownFigure {
        /// The figure that it names.
        name: String,
        /// What was probably meant, a sentence.
        suggestion: String,
    },
    /// It is longer than the timeline.
    #[error("the clip is {found_s} s long; the timeline has {LATEST_S} s")]
    TooLong {
        /// From its first to its last key.
        found_s: f32,
    },
    /// The model cannot be run.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A latent of it cannot be drawn.
    #[error("a key of the clip cannot be drawn: {0}")]
    Latent(#[from] InferError),
    /// A key of it is no drawing.
    #[error("a key of the clip cannot be drawn: {0}")]
    Sketch(#[from] SketchError),
}

/// The drawing of the body of a latent, seen from the side that is drawn, metres.
///
/// # Errors
/// [`InferError`] when the latent is of another model, or nothing that can be decoded.
pub(crate) fn drawing_of_latent(
    inference: &mut Inference,
    latent: &[f32],
) -> Result<Sketch, ClipFileError> {
    let mut joints = vec![bevy::math::Vec3::ZERO; inference.figure().joint_count()];
    inference.joints(latent, &mut joints)?;
    let points = joints.iter().map(|joint| joint.truncate()).collect();
    Ok(Sketch::new(inference.figure(), points)?)
}

/// The drawn keys as a clip, their drawings inside.
pub(crate) fn clip_of_scene(figure: &Figure, scene: &Scene) -> ClipFile {
    let mut clip = ClipFile::new(&figure.name, scene.settings());
    clip.keys = scene
        .complete()
        .map(|(key, sketch)| ClipKey {
            time_s: key.time_s,
            easing: key.easing,
            pose: ClipPose::of_sketch(figure, sketch),
        })
        .collect();
    clip
}

/// The timeline of a clip, which was read from `path`, for the model of its figure.
///
/// # Errors
/// [`ClipFileError`]: everything that is wrong with it is found here, and not when it is played.
pub(crate) fn scene_of_clip(
    clip: &ClipFile,
    path: &Path,
    model: &Model,
) -> Result<Scene, ClipFileError> {
    let figure = model.figure();
    let mut inference = Inference::new(model)?;
    clip.motion(&mut inference, ClipFile::beside(path))?;
    let mut sketches = vec![];
    let given = clip.sketches(figure, ClipFile::beside(path))?;
    for (key, sketch) in clip.keys.iter().zip(given) {
        sketches.push(match (&key.pose, sketch) {
            (ClipPose::Latent(latent), None) => drawing_of_latent(&mut inference, latent)?,
            (_, Some(sketch)) => sketch,
            (_, None) => Sketch::template(figure),
        });
    }
    // A motion has keys, by rising time.
    let first_s = clip.keys.first().map_or(0.0, |key| key.time_s);
    let found_s = clip.keys.last().map_or(0.0, |key| key.time_s) - first_s;
    let (shift_s, latest_s) = (first_s.min(0.0), first_s.max(0.0) + found_s);
    if latest_s > LATEST_S {
        return Err(ClipFileError::TooLong { found_s: latest_s });
    }
    let mut keys = vec![];
    for (key, points) in clip.keys.iter().zip(on_canvas(figure, &sketches)) {
        let ink = Ink::of_sketch(Sketch::new(figure, points)?);
        keys.push((key.time_s - shift_s, key.easing, ink));
    }
    Ok(Scene::of_keys(keys, clip.settings()))
}

/// The points of sketches in canvas units: those that were drawn on a canvas as they are, others fitted.
fn on_canvas(figure: &Figure, sketches: &[Sketch]) -> Vec<Vec<Vec2>> {
    if sketches.iter().all(is_on_canvas) {
        return sketches
            .iter()
            .map(|sketch| sketch.points().to_vec())
            .collect();
    }
    let unit: Vec<Vec<Vec2>> = sketches
        .iter()
        .map(|sketch| {
            let scale = sketch.scale(figure).max(f32::MIN_POSITIVE);
            sketch.points().iter().map(|point| *point / scale).collect()
        })
        .collect();
    fit_to_canvas(&unit.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

fn is_on_canvas(sketch: &Sketch) -> bool {
    let within = |limit: f32| move |point: &Vec2| point.abs().max_element() <= limit;
    let points = sketch.points();
    points.iter().all(within(CANVAS_SIZE)) && !points.iter().all(within(CANVAS_SIZE * 0.1))
}

/// A drawing of the body of a latent in the manner of another: as large, and in the same place.
///
/// # Errors
/// [`ClipFileError`] when the latent cannot be drawn.
pub(crate) fn drawing_beside(
    inference: &mut Inference,
    latent: &[f32],
    beside: &Sketch,
) -> Result<Sketch, ClipFileError> {
    let drawn = drawing_of_latent(inference, latent)?;
    let figure = inference.figure();
    let scale = beside.scale(figure) / drawn.scale(figure).max(f32::MIN_POSITIVE);
    let middle = |points: &[Vec2]| points.iter().sum::<Vec2>() / points.len().max(1) as f32;
    let (from, to) = (middle(drawn.points()), middle(beside.points()));
    let points = drawn.points().iter().map(|p| (*p - from) * scale + to);
    Ok(Sketch::new(figure, points.collect())?)
}

#[cfg(test)]
mod tests {
    use stick3d_model::latent::{Easing, MotionSettings};

    use super::*;
    use crate::EMBEDDED_MODELS;

    fn man() -> &'static Model {
        EMBEDDED_MODELS[0].model().unwrap().model()
    }

    fn stretched(figure: &Figure, stretch: f32, unit: f32) -> Sketch {
        let mut points: Vec<Vec2> = figure.template.iter().map(|p| *p * unit).collect();
        points[0].y += stretch * unit;
        Sketch::new(figure, points).unwrap()
    }

    fn clip(keys: Vec<(f32, ClipPose)>) -> ClipFile {
        let mut clip = ClipFile::new("human", MotionSettings::default());
        clip.keys = keys
            .into_iter()
            .map(|(time_s, pose)| ClipKey {
                time_s,
                easing: Easing::InOut,
                pose,
            })
            .collect();
        clip
    }

    #[test]
    fn what_was_drawn_on_the_canvas_comes_back_as_it_was() {
        let human = Figure::human();
        let ink = |stretch| Ink::of_sketch(stretched(human, stretch, 400.0));
        let keys = [
            (0.5, Easing::In, ink(0.0)),
            (1.25, Easing::Linear, ink(0.2)),
        ];
        let scene = Scene::of_keys(keys, MotionSettings::default());
        let clip = clip_of_scene(human, &scene);
        let text = clip.to_ron().unwrap();
        let read = ClipFile::from_ron(&text).unwrap();
        assert_eq!(
            scene_of_clip(&read, Path::new("x.clip.ron"), man()).unwrap(),
            scene
        );
    }

    #[test]
    fn sketches_in_metres_and_latents_are_put_on_the_canvas() {
        let human = Figure::human();
        let mut inference = Inference::new(man()).unwrap();
        let sketch = stretched(human, 0.1, 1.0);
        let mut latent = vec![0.0; inference.latent_len()];
        inference.encode(&sketch, &mut latent).unwrap();
        let clip = clip(vec![
            (-1.0, ClipPose::of_sketch(human, &sketch)),
            (1.0, ClipPose::Latent(latent)),
        ]);
        let scene = scene_of_clip(&clip, Path::new("x.clip.ron"), man()).unwrap();
        let times: Vec<f32> = scene.keys().iter().map(|key| key.time_s).collect();
        assert_eq!(times, [0.0, 2.0], "the timeline begins at 0");
        let drawn: Vec<&Sketch> = scene.complete().map(|(_, sketch)| sketch).collect();
        let ratio = drawn[0].scale(human) / drawn[1].scale(human);
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
        for (a, b) in drawn[0].points().iter().zip(drawn[1].points()) {
            assert!(a.distance(*b) < 0.15 * CANVAS_SIZE, "{a} {b}");
        }
    }

    #[test]
    fn what_is_no_motion_is_refused() {
        let human = Figure::human();
        let pose = || ClipPose::of_sketch(human, &Sketch::template(human));
        let said = |clip: &ClipFile| {
            let refused = scene_of_clip(clip, Path::new("x.clip.ron"), man());
            refused.unwrap_err().to_string()
        };
        let one = said(&clip(vec![(0.0, pose())]));
        assert!(one.contains("at least two keys"), "{one}");
        let equal = said(&clip(vec![(1.0, pose()), (1.0, pose())]));
        assert!(equal.contains("both at 1 s"), "{equal}");
        let late = said(&clip(vec![(0.0, pose()), (500.0, pose())]));
        assert!(late.contains("500 s long"), "{late}");
        let mut horse = clip(vec![(0.0, pose()), (1.0, pose())]);
        horse.figure = "horse".to_owned();
        assert!(said(&horse).contains("\"horse\""));
        let file = clip(vec![
            (0.0, ClipPose::Sketch("gone.json".to_owned())),
            (1.0, pose()),
        ]);
        assert!(said(&file).contains("gone.json"));
    }
}
