//! The losses of a run as a picture.

use std::path::Path;

use glam::Vec2;
use image::RgbaImage;

use super::log::LossLog;
use super::{StageName, TrainError};
use crate::render::{draw_line, draw_text, text_width_px};

/// Size of the picture, pixels.
const SIZE_PX: (u32, u32) = (960, 540);
/// Room left for labels: left, top, right, bottom.
const MARGIN_PX: [f32; 4] = [70.0, 30.0, 190.0, 40.0];
/// Distinct for colour-blind eyes too (Okabe and Ito).
const COLORS: [[u8; 3]; 8] = [
    [0, 0, 0],
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [213, 94, 0],
    [0, 114, 178],
    [204, 121, 167],
    [150, 150, 60],
];

/// Writes `losses.csv` and `losses.png` into a run's folder.
pub(crate) fn leave(log: &LossLog, folder: &Path) -> Result<(), TrainError> {
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        stick3d_model::files::write_atomically(&path, bytes)
            .map_err(|source| TrainError::Io { path, source })
    };
    write("losses.csv", log.to_csv().as_bytes())?;
    write("losses.png", &png(log)?)
}

/// All terms over all epochs on a logarithmic scale, as PNG.
fn png(log: &LossLog) -> Result<Vec<u8>, TrainError> {
    let mut bytes = std::io::Cursor::new(vec![]);
    draw(log)
        .write_to(&mut bytes, image::ImageFormat::Png)
        .map_err(|error| TrainError::Plot(error.to_string()))?;
    Ok(bytes.into_inner())
}

fn draw(log: &LossLog) -> RgbaImage {
    let mut image = RgbaImage::from_pixel(SIZE_PX.0, SIZE_PX.1, image::Rgba([255; 4]));
    let series = series(log);
    let logs = series
        .iter()
        .flat_map(|(_, values)| values)
        .filter(|(_, v)| *v > 0.0)
        .map(|(_, v)| v.log10());
    let (low, high) = logs.fold((f64::MAX, f64::MIN), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    if low > high {
        return image;
    }
    let frame = Frame {
        epochs: log.records.len().max(2) - 1,
        low: low.floor(),
        high: high.ceil().max(low.floor() + 1.0),
    };
    frame.draw_grid(&mut image, log);
    for (index, (name, values)) in series.iter().enumerate() {
        let color = COLORS[index % COLORS.len()];
        let points: Vec<(usize, Vec2)> = values
            .iter()
            .filter(|(_, v)| *v > 0.0)
            .map(|(epoch, v)| (*epoch, frame.point(*epoch, v.log10())))
            .collect();
        for pair in points.windows(2).filter(|pair| pair[1].0 == pair[0].0 + 1) {
            draw_line(&mut image, pair[0].1, pair[1].1, 2.0, color);
        }
        let y = MARGIN_PX[1] as u32 + 20 * index as u32;
        draw_text(
            &mut image,
            (SIZE_PX.0 - MARGIN_PX[2] as u32 + 15, y),
            1,
            color,
            name,
        );
    }
    image
}

/// Every term (and the loss) with the epochs that have it.
fn series(log: &LossLog) -> Vec<(&str, Vec<(usize, f64)>)> {
    let records = || log.records.iter().enumerate();
    let mut all = vec![(
        "loss",
        records().map(|(i, record)| (i, record.loss)).collect(),
    )];
    for name in log.term_names() {
        let value = |record: &super::LossRecord| {
            record
                .terms
                .iter()
                .find(|(term, _)| term == name)
                .map(|(_, v)| *v)
        };
        all.push((
            name,
            records()
                .filter_map(|(i, record)| Some((i, value(record)?)))
                .collect(),
        ));
    }
    all
}

/// What the picture's axes show.
struct Frame {
    epochs: usize,
    /// Powers of ten.
    low: f64,
    high: f64,
}

impl Frame {
    fn point(&self, epoch: usize, power: f64) -> Vec2 {
        let [left, top, right, bottom] = MARGIN_PX;
        let (width, height) = (
            SIZE_PX.0 as f32 - left - right,
            SIZE_PX.1 as f32 - top - bottom,
        );
        let share = (power - self.low) / (self.high - self.low);
        Vec2::new(
            left + width * epoch as f32 / self.epochs as f32,
            top + height * (1.0 - share as f32),
        )
    }

    fn draw_grid(&self, image: &mut RgbaImage, log: &LossLog) {
        const LIGHT: [u8; 3] = [220, 220, 220];
        const DARK: [u8; 3] = [70, 70, 70];
        for power in self.low as i32..=self.high as i32 {
            let from = self.point(0, f64::from(power));
            draw_line(
                image,
                from,
                self.point(self.epochs, f64::from(power)),
                1.0,
                LIGHT,
            );
            let label = format!("1e{power}");
            let x = (from.x as u32).saturating_sub(text_width_px(&label, 1) + 6);
            draw_text(
                image,
                (x, (from.y as u32).saturating_sub(4)),
                1,
                DARK,
                &label,
            );
        }
        let mut stage: Option<StageName> = None;
        for (epoch, record) in log.records.iter().enumerate() {
            if stage != Some(record.stage) {
                let bottom = self.point(epoch, self.low);
                draw_line(image, bottom, self.point(epoch, self.high), 1.0, DARK);
                draw_text(
                    image,
                    (bottom.x as u32 + 4, bottom.y as u32 + 10),
                    1,
                    DARK,
                    record.stage.label(),
                );
            }
            stage = Some(record.stage);
        }
    }
}
