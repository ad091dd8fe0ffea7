//! Many small pictures with labels on one page.

use image::{Rgba, RgbaImage, imageops};

use super::text::{draw_text, text_width_px};

/// Space between pictures, pixels.
const GAP: u32 = 4;
/// Lines of a label under each picture, and the space for them, pixels.
const LINES: u32 = 3;
const LABEL: u32 = LINES * LINE + 4;
/// Height of a line and width of a letter, pixels.
const LINE: u32 = 9;
const LETTER: u32 = 8;
/// Colours are rounded to multiples of this divisor of 255, which the eye hardly sees and packs well.
const STEP: u8 = 5;

/// Lays out labelled pictures row by row. Cells are as large as the largest picture; labels too long for
/// the lines under their cell are cut.
pub fn contact_sheet(items: &[(String, RgbaImage)], columns: u32) -> RgbaImage {
    let columns = columns.clamp(1, items.len().max(1) as u32);
    let cell_width = items
        .iter()
        .map(|(_, image)| image.width())
        .max()
        .unwrap_or(1);
    let cell_height = items
        .iter()
        .map(|(_, image)| image.height())
        .max()
        .unwrap_or(1);
    let rows = (items.len() as u32).div_ceil(columns).max(1);
    let (step_x, step_y) = (cell_width + GAP, cell_height + GAP + LABEL);
    let mut page =
        RgbaImage::from_pixel(columns * step_x + GAP, rows * step_y + GAP, Rgba([255; 4]));
    for (i, (label, image)) in (0_u32..).zip(items) {
        let x = GAP + (i % columns) * step_x;
        let y = GAP + (i / columns) * step_y;
        imageops::replace(&mut page, image, i64::from(x), i64::from(y));
        for (line, text) in (0_u32..).zip(lines(label, (cell_width / LETTER) as usize)) {
            let indent = (cell_width - text_width_px(&text, 1).min(cell_width)) / 2;
            let top = y + cell_height + 3 + line * LINE;
            draw_text(&mut page, (x + indent, top), 1, [60, 65, 70], &text);
        }
    }
    round_colors(&mut page);
    page
}

/// A label, underscores as spaces, in at most [`LINES`] lines of so many letters; longer words are broken.
fn lines(label: &str, letters: usize) -> Vec<String> {
    let letters = letters.max(1);
    let mut lines: Vec<String> = vec![];
    for word in label.split('_') {
        for part in word.chars().collect::<Vec<_>>().chunks(letters) {
            match lines.last_mut() {
                Some(line) if line.chars().count() + 1 + part.len() <= letters => {
                    line.push(' ');
                    line.extend(part);
                }
                _ => lines.push(part.iter().collect()),
            }
        }
    }
    lines.truncate(LINES as usize);
    lines
}

/// Rounds colours so that the page packs into half the file. Black and white stay.
fn round_colors(page: &mut RgbaImage) {
    for pixel in page.pixels_mut() {
        for channel in &mut pixel.0 {
            *channel = channel.saturating_add(STEP / 2) / STEP * STEP;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_and_label_is_on_the_page() {
        let red = RgbaImage::from_pixel(40, 30, Rgba([255, 0, 0, 255]));
        let items: Vec<_> = (0..5).map(|i| (format!("p{i}"), red.clone())).collect();
        let page = contact_sheet(&items, 3);
        assert_eq!(
            (page.width(), page.height()),
            (3 * 44 + 4, 2 * (30 + GAP + LABEL) + GAP)
        );
        let reds = page.pixels().filter(|p| p.0 == [255, 0, 0, 255]).count();
        assert_eq!(reds, 5 * 40 * 30);
        assert!(
            page.pixels().any(|p| p.0 == [60, 65, 70, 255]),
            "no label was written"
        );
    }

    #[test]
    fn long_labels_break_between_words() {
        assert_eq!(lines("wave", 10), ["wave"]);
        assert_eq!(
            lines("walk_1_heel_strike_r", 13),
            ["walk 1 heel", "strike r"]
        );
        assert_eq!(lines("abcdefgh", 3), ["abc", "def", "gh"]);
        assert_eq!(lines("a_b_c_d_e", 1), ["a", "b", "c"]);
        assert_eq!(lines("", 4), Vec::<String>::new());
    }
}
