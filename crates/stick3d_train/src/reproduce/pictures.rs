//! The cells that figures are made of.

use std::path::Path;

use glam::Vec3;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{Rgba, RgbaImage};
use stick3d_figure::mesh::{MeshError, NormalAdjacency};
use stick3d_figure::sketch::Sketch;
use stick3d_model::ModelError;
use stick3d_model::files::write_atomically;

use super::ReproduceError;
use crate::paper::PaperSet;
use crate::render::{Camera, RenderMesh, draw_sketch, render};

/// Width and height of a cell, pixels.
pub(super) const CELL_PX: [u32; 2] = [140, 170];

/// The yaws of the cameras that see a body from the front and from its left, radians.
pub(super) const FRONT: f32 = 0.0;
pub(super) const SIDE: f32 = std::f32::consts::FRAC_PI_2;

/// What meshes of one set need to be drawn.
pub(super) struct Studio<'a> {
    set: &'a PaperSet,
    adjacency: NormalAdjacency,
}

impl<'a> Studio<'a> {
    pub(super) fn new(set: &'a PaperSet) -> Result<Self, ReproduceError> {
        let fault = |error: MeshError| ModelError::Metadata(error.to_string());
        let adjacency = NormalAdjacency::new(&set.triangles, set.vertex_count()).map_err(fault)?;
        Ok(Self { set, adjacency })
    }

    /// A camera that holds bodies from one side, as large as `height_m` metres.
    pub(super) fn camera(&self, bodies: &[&[Vec3]], yaw_rad: f32) -> Camera {
        let points: Vec<Vec3> = bodies
            .iter()
            .flat_map(|body| body.iter().copied())
            .collect();
        let [width, height] = CELL_PX.map(|px| px as f32);
        Camera::framing(&points, yaw_rad, 0.0, width / height)
    }

    /// A body in its own colours.
    pub(super) fn body(&self, positions: &[Vec3], camera: &Camera) -> RgbaImage {
        self.colored(positions, &self.set.colors, camera)
    }

    /// A body in given colours, one per vertex.
    pub(super) fn colored(
        &self,
        positions: &[Vec3],
        colors: &[[u8; 4]],
        camera: &Camera,
    ) -> RgbaImage {
        let plain: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
        let mut normals = vec![[0.0; 3]; positions.len()];
        self.adjacency.vertex_normals(&plain, &mut normals);
        let normals: Vec<Vec3> = normals.into_iter().map(Vec3::from).collect();
        let mesh = RenderMesh {
            positions,
            normals: &normals,
            colors,
            triangles: &self.set.triangles,
        };
        let [width, height] = CELL_PX;
        render(&[mesh], camera, width, height)
    }

    /// A sketch in metres, seen by the camera that sees its body.
    pub(super) fn sketch(&self, sketch: &Sketch, camera: &Camera) -> RgbaImage {
        let [width, height] = CELL_PX;
        let mut image = RgbaImage::from_pixel(width, height, Rgba([255; 4]));
        let points = sketch.points().iter();
        let pixels: Vec<_> = points
            .map(|p| camera.project_px(p.extend(0.0), width, height))
            .collect();
        draw_sketch(&mut image, &self.set.figure, &pixels, 2.5);
        image
    }
}

/// An empty cell.
pub(super) fn blank() -> (String, RgbaImage) {
    let [width, height] = CELL_PX;
    (
        String::new(),
        RgbaImage::from_pixel(width, height, Rgba([255; 4])),
    )
}

/// Writes a picture, whole or not at all.
pub(super) fn save(path: &Path, picture: &RgbaImage) -> Result<(), ReproduceError> {
    let mut bytes = std::io::Cursor::new(vec![]);
    // They stand in documents: as small as they get. Four equal channels pack no better for being there.
    let encoder =
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive);
    image::DynamicImage::from(picture.clone())
        .to_rgb8()
        .write_with_encoder(encoder)?;
    write_atomically(path, &bytes.into_inner()).map_err(|source| ReproduceError::Io {
        path: path.to_owned(),
        source,
    })
}
