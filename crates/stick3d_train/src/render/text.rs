//! Labels in a small bitmap font.

use font8x8::{BASIC_FONTS, UnicodeFonts};
use image::{Rgba, RgbaImage};

/// Width and height of a letter at scale 1, pixels.
const LETTER: u32 = 8;

/// How wide a text is, pixels.
pub fn text_width_px(text: &str, scale: u32) -> u32 {
    text.chars().count() as u32 * LETTER * scale
}

/// Writes `text` with its top left corner at (`x`, `y`). Letters outside ASCII show as `?`; what does not
/// fit into the picture is cut off.
pub fn draw_text(
    image: &mut RgbaImage,
    (x, y): (u32, u32),
    scale: u32,
    color: [u8; 3],
    text: &str,
) {
    let [r, g, b] = color;
    for (i, letter) in text.chars().enumerate() {
        let rows = BASIC_FONTS
            .get(letter)
            .or_else(|| BASIC_FONTS.get('?'))
            .unwrap_or_default();
        for (row, bits) in (0_u32..).zip(rows) {
            for column in (0..LETTER).filter(|column| bits >> column & 1 == 1) {
                let left = x + (i as u32 * LETTER + column) * scale;
                let top = y + row * scale;
                for (dx, dy) in (0..scale).flat_map(|dx| (0..scale).map(move |dy| (dx, dy))) {
                    if left + dx < image.width() && top + dy < image.height() {
                        image.put_pixel(left + dx, top + dy, Rgba([r, g, b, 255]));
                    }
                }
            }
        }
    }
}
