//! Many small pictures with labels on one page.

use image::{Rgba, RgbaImage, imageops};

use super::text::{draw_text, text_width_px};

/// Space between pictures, pixels.
const GAP: u32 = 4;
/// Space for a label under each picture, pixels.
const LABEL: u32 = 12;

/// Lays out labelled pictures row by row. Cells are as large as the largest picture; labels too long for
/// their cell are cut.
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
        let fits: String = label.chars().take((cell_width / 8) as usize).collect();
        let indent = (cell_width - text_width_px(&fits, 1).min(cell_width)) / 2;
        draw_text(
            &mut page,
            (x + indent, y + cell_height + 3),
            1,
            [60, 64, 70],
            &fits,
        );
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_and_label_is_on_the_page() {
        let red = RgbaImage::from_pixel(40, 30, Rgba([255, 0, 0, 255]));
        let items: Vec<_> = (0..5).map(|i| (format!("p{i}"), red.clone())).collect();
        let page = contact_sheet(&items, 3);
        assert_eq!((page.width(), page.height()), (3 * 44 + 4, 2 * 46 + 4));
        let reds = page.pixels().filter(|p| p.0 == [255, 0, 0, 255]).count();
        assert_eq!(reds, 5 * 40 * 30);
        assert!(
            page.pixels().any(|p| p.0 == [60, 64, 70, 255]),
            "no label was written"
        );
    }
}
