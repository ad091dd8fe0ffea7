//! Lines and stick figures over a picture.

use glam::Vec2;
use image::{Rgba, RgbaImage};
use stick3d_figure::{Figure, Side};

/// Draws a smooth line with round ends. `width_px` is its thickness; the ends are in pixels, y down.
pub fn draw_line(image: &mut RgbaImage, from: Vec2, to: Vec2, width_px: f32, color: [u8; 3]) {
    if !from.is_finite() || !to.is_finite() {
        return;
    }
    let half = width_px / 2.0;
    let low = (from.min(to) - half - 1.0).max(Vec2::ZERO);
    let high =
        (from.max(to) + half + 1.0).min(Vec2::new(image.width() as f32, image.height() as f32));
    for y in low.y as u32..high.y.max(0.0) as u32 {
        for x in low.x as u32..high.x.max(0.0) as u32 {
            let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let line = to - from;
            let t = ((p - from).dot(line) / line.length_squared().max(1e-9)).clamp(0.0, 1.0);
            let cover = (half + 0.5 - p.distance(from + line * t)).clamp(0.0, 1.0);
            let Rgba([r, g, b, a]) = *image.get_pixel(x, y);
            let mix = |old: u8, new: u8| {
                (f32::from(old) + (f32::from(new) - f32::from(old)) * cover + 0.5) as u8
            };
            image.put_pixel(
                x,
                y,
                Rgba([mix(r, color[0]), mix(g, color[1]), mix(b, color[2]), a]),
            );
        }
    }
}

/// Draws a stick figure: one point per joint of `figure`, pixels, y down. The right side is orange, the
/// left blue (told apart with every kind of colour vision), the middle dark.
pub fn draw_sketch(image: &mut RgbaImage, figure: &Figure, joints_px: &[Vec2], width_px: f32) {
    for &[from, to] in &figure.bones {
        let (Some(&a), Some(&b)) = (joints_px.get(from), joints_px.get(to)) else {
            continue;
        };
        let side = match figure.joints[from].side {
            Side::Center => figure.joints[to].side,
            side => side,
        };
        let color = match side {
            Side::Center => [45, 45, 50],
            Side::Left => [0, 100, 190],
            Side::Right => [215, 95, 0],
        };
        draw_line(image, a, b, width_px, color);
    }
    for &joint in joints_px {
        draw_line(image, joint, joint, width_px * 2.0, [45, 45, 50]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_covers_its_length_and_leaves_the_rest() {
        let mut image = RgbaImage::from_pixel(40, 20, Rgba([255; 4]));
        draw_line(
            &mut image,
            Vec2::new(5.0, 10.0),
            Vec2::new(35.0, 10.0),
            3.0,
            [0, 0, 0],
        );
        assert_eq!(image.get_pixel(20, 10).0, [0, 0, 0, 255]);
        assert_eq!(image.get_pixel(20, 2).0, [255; 4]);
        // A line that leaves the picture, or is nowhere, does no harm.
        draw_line(
            &mut image,
            Vec2::new(-50.0, 3.0),
            Vec2::new(90.0, 3.0),
            3.0,
            [0, 0, 0],
        );
        draw_line(&mut image, Vec2::NAN, Vec2::ONE, 3.0, [0, 0, 0]);
    }
}
