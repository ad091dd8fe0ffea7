//! Pictures of bodies, taken without a GPU, and the files they go to.

use std::io::{self, Cursor};
use std::path::Path;

use anyhow::Context as _;
use glam::Vec3;
use image::{ImageError, ImageFormat, RgbaImage};
use stick3d_model::Model;
use stick3d_model::export::animation::{Frame, frame_name};
use stick3d_model::files::{write_atomically, write_folder_atomically};
use stick3d_train::render::{Camera, RenderMesh, render};

use crate::failure::{Failure, Outcome};

/// The longer and the shorter side of a picture, pixels.
const PICTURE_PX: [u32; 2] = [1000, 800];
/// Where a picture is taken from: a little from the body's left and from above, radians.
const YAW_PITCH_RAD: (f32, f32) = (0.3, 0.16);

/// A camera and the size of its pictures, pixels.
pub(crate) struct Stage {
    camera: Camera,
    size_px: [u32; 2],
}

impl Stage {
    /// A stage that just holds some points, metres.
    pub(crate) fn holding(points: &[[f32; 3]]) -> Self {
        let points: Vec<Vec3> = points.iter().copied().map(Vec3::from).collect();
        let size_px = size_px(&points);
        let [width, height] = size_px.map(|px| px as f32);
        let (yaw_rad, pitch_rad) = YAW_PITCH_RAD;
        Self {
            camera: Camera::framing(&points, yaw_rad, pitch_rad, width / height),
            size_px,
        }
    }

    /// A picture of a model's body.
    pub(crate) fn picture(
        &self,
        model: &Model,
        positions: &[[f32; 3]],
        normals: &[[f32; 3]],
    ) -> RgbaImage {
        let vectors = |list: &[[f32; 3]]| list.iter().copied().map(Vec3::from).collect::<Vec<_>>();
        let (positions, normals) = (vectors(positions), vectors(normals));
        let mesh = RenderMesh {
            positions: &positions,
            normals: &normals,
            colors: model.colors(),
            triangles: model.triangles(),
        };
        let [width, height] = self.size_px;
        render(&[mesh], &self.camera, width, height)
    }
}

/// Width and height of a picture, pixels: lying for what is longer than high, else standing.
fn size_px(points: &[Vec3]) -> [u32; 2] {
    let [low, high] = corners(points.iter().copied());
    let extent = high - low;
    let [long, short] = PICTURE_PX;
    if extent.x > extent.y {
        [long, short]
    } else {
        [short, long]
    }
}

/// The lowest and the highest corner of the box round some points.
fn corners(points: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    points.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], at| {
        [low.min(at), high.max(at)]
    })
}

/// Writes a picture, whole or not at all.
pub(crate) fn write_png(path: &Path, picture: &RgbaImage) -> Outcome {
    let bytes = png(picture).context("cannot encode the picture")?;
    write_atomically(path, &bytes).map_err(Failure::output)
}

/// Writes a picture of every frame of a motion into a new folder, whole or not at all. All are taken from one place, which
/// sees them all.
pub(crate) fn save_png_sequence(folder: &Path, model: &Model, mut frames: Vec<Frame>) -> Outcome {
    frames.iter_mut().for_each(Frame::apply_root);
    let seen = frames.iter().flat_map(|frame| {
        let points = frame.positions.iter().copied().map(Vec3::from);
        corners(points).map(|corner| corner.to_array())
    });
    let stage = Stage::holding(&seen.collect::<Vec<_>>());
    let files = (1..).zip(&frames).map(|(number, frame)| {
        let picture = stage.picture(model, &frame.positions, &frame.normals);
        let bytes = png(&picture).map_err(io::Error::other)?;
        Ok::<_, io::Error>((frame_name(number, "png"), bytes))
    });
    write_folder_atomically(folder, files).map_err(Failure::output)
}

/// A picture as the bytes of a PNG file.
fn png(picture: &RgbaImage) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}
