//! A small software renderer for contact sheets, without GPU or display.
//!
//! [`render`] draws triangle meshes with a z-buffer: normals interpolated per pixel, three lights, a
//! shadow map, a soft contact shadow on the ground plane y = 0, four samples per pixel. A picture of the
//! 12,500-vertex body at 400 x 500 takes some hundredths of a second on one core.

mod camera;
mod overlay;
mod raster;
mod shade;
mod shadow;
mod sheet;
mod text;

use glam::Vec3;
use image::RgbaImage;

pub use camera::Camera;
pub use overlay::{draw_line, draw_sketch};
pub use sheet::contact_sheet;
pub use text::{draw_text, text_width_px};

/// A mesh to be drawn. Model space, metres, ground at y = 0.
#[derive(Debug, Clone, Copy)]
pub struct RenderMesh<'a> {
    /// One position per vertex.
    pub positions: &'a [Vec3],
    /// One unit normal per vertex; a vertex without one is lit as if it faced up.
    pub normals: &'a [Vec3],
    /// One colour per vertex: linear red, green, blue; the fourth number is ignored.
    pub colors: &'a [[u8; 4]],
    /// Vertex numbers, counter-clockwise seen from outside. Numbers past the last vertex draw nothing.
    pub triangles: &'a [[u32; 3]],
}

/// Draws meshes over a light background, `width` x `height` pixels.
pub fn render(meshes: &[RenderMesh<'_>], camera: &Camera, width: u32, height: u32) -> RgbaImage {
    let (fine_width, fine_height) = (width * 2, height * 2);
    let visible = raster::visible_triangles(meshes, camera, fine_width, fine_height);
    let lights = shade::Lights::of(camera);
    let shadows = shadow::Shadows::cast(meshes, lights.key);
    let fine = shade::shade(meshes, camera, &visible, &shadows, lights);
    shade::downsample(&fine, width, height)
}
