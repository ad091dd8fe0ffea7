//! Distances as colours.

use image::{Rgba, RgbaImage};

use crate::render::draw_text;

/// Viridis: even to the eye, and readable with every kind of colour vision and in grey. Every eighth of the way, sRGB.
///
/// Source: van der Walt and Smith, "A better default colormap for Matplotlib", 2015.
const VIRIDIS: [[f32; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 44.0, 122.0],
    [59.0, 81.0, 139.0],
    [44.0, 113.0, 142.0],
    [33.0, 144.0, 141.0],
    [39.0, 173.0, 129.0],
    [92.0, 200.0, 99.0],
    [170.0, 220.0, 50.0],
    [253.0, 231.0, 37.0],
];

/// The colour of a share between 0 and 1, sRGB.
pub(super) fn viridis(share: f32) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f32;
    let index = (at as usize).min(VIRIDIS.len() - 2);
    let part = at - index as f32;
    std::array::from_fn(|channel| {
        let [from, to] = [VIRIDIS[index][channel], VIRIDIS[index + 1][channel]];
        (from + part * (to - from)).round() as u8
    })
}

/// The same as meshes have colours: linear red, green and blue.
pub(super) fn viridis_linear(share: f32) -> [u8; 4] {
    let [r, g, b] = viridis(share).map(|byte| {
        let encoded = f32::from(byte) / 255.0;
        let linear = if encoded <= 0.040_45 {
            encoded / 12.92
        } else {
            ((encoded + 0.055) / 1.055).powf(2.4)
        };
        (255.0 * linear).round() as u8
    });
    [r, g, b, 255]
}

/// A bar of all colours from 0 below to `top_cm` above, in a picture of the given size.
pub(super) fn bar(top_cm: f32, width: u32, height: u32) -> RgbaImage {
    const INK: [u8; 3] = [60, 65, 70];
    const WIDTH: u32 = 22;
    const MARGIN: u32 = 16;
    let mut image = RgbaImage::from_pixel(width, height, Rgba([255; 4]));
    let length = height.saturating_sub(2 * MARGIN).max(1);
    for y in 0..length {
        let [r, g, b] = viridis(1.0 - y as f32 / length as f32);
        for x in 8..(8 + WIDTH).min(width) {
            image.put_pixel(x, MARGIN + y, Rgba([r, g, b, 255]));
        }
    }
    for quarter in 0..=4_u32 {
        let y = MARGIN + length * (4 - quarter) / 4 - 4;
        let label = format!("{:.1} cm", top_cm * quarter as f32 / 4.0);
        draw_text(&mut image, (8 + WIDTH + 6, y), 1, INK, &label);
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_grows_brighter_all_the_way() {
        let brightness = |share: f32| {
            let [r, g, b] = viridis(share).map(f32::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let steps: Vec<f32> = (0..=40).map(|i| brightness(i as f32 / 40.0)).collect();
        assert!(
            steps.windows(2).all(|pair| pair[1] > pair[0] - 0.6),
            "{steps:?}"
        );
        assert_eq!(viridis(-1.0), [68, 1, 84]);
        assert_eq!(viridis(2.0), [253, 231, 37]);
        assert_eq!(viridis_linear(1.0)[3], 255);
    }

    #[test]
    fn the_bar_has_both_ends() {
        let bar = bar(4.0, 100, 120);
        assert_eq!(bar.get_pixel(12, 16).0, [253, 231, 37, 255]);
        let low = bar.get_pixel(12, 16 + 87).0;
        assert!(low[2] < 100 && low[1] < 20, "{low:?}");
    }
}
