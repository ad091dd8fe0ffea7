//! Strokes: what a pen drew between touching down and lifting, in canvas pixels with times.

use glam::Vec2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::sketch::MAX_COORDINATE;

/// Why a pen position cannot be taken.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum StrokeError {
    /// A coordinate is NaN, infinite or huge.
    #[error(
        "point {index} of the stroke is at ({x}, {y}); coordinates must be finite and within ±{MAX_COORDINATE}"
    )]
    Coordinate {
        /// Which point of the stroke.
        index: usize,
        /// As given.
        x: f32,
        /// As given.
        y: f32,
    },
    /// A time is NaN or infinite.
    #[error("point {index} of the stroke has the time {time_s} s; times must be finite")]
    Time {
        /// Which point of the stroke.
        index: usize,
        /// As given.
        time_s: f64,
    },
}

/// One position of the pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StrokePoint {
    /// Canvas pixels, x right, y **up**.
    pub position_px: Vec2,
    /// Seconds since any moment that is the same for the whole drawing.
    pub time_s: f64,
}

/// A point of the screen, y down from the top of a canvas of this height, as a canvas point, y up from its bottom.
///
/// The one place where y turns round: call it where pointer positions come in. It is its own inverse.
pub fn flip_y(position_px: Vec2, canvas_height_px: f32) -> Vec2 {
    Vec2::new(position_px.x, canvas_height_px - position_px.y)
}

/// One polyline from pen-down to pen-up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<StrokePoint>", into = "Vec<StrokePoint>")]
pub struct Stroke {
    points: Vec<StrokePoint>,
}

impl Stroke {
    /// A stroke of the given points.
    ///
    /// # Errors
    /// [`StrokeError`] for the first point at fault.
    pub fn new(points: impl IntoIterator<Item = StrokePoint>) -> Result<Self, StrokeError> {
        let mut stroke = Self::default();
        for point in points {
            stroke.push(point.position_px, point.time_s)?;
        }
        Ok(stroke)
    }

    /// A stroke of positions alone, all at time 0.
    ///
    /// # Errors
    /// [`StrokeError::Coordinate`] for the first point at fault.
    pub fn from_positions(
        positions_px: impl IntoIterator<Item = Vec2>,
    ) -> Result<Self, StrokeError> {
        Self::new(positions_px.into_iter().map(|position_px| StrokePoint {
            position_px,
            time_s: 0.0,
        }))
    }

    /// Adds where the pen is now (y up: see [`flip_y`]).
    ///
    /// # Errors
    /// [`StrokeError`]; the stroke is then unchanged.
    pub fn push(&mut self, position_px: Vec2, time_s: f64) -> Result<(), StrokeError> {
        let index = self.points.len();
        if !position_px.is_finite() || position_px.abs().max_element() > MAX_COORDINATE {
            let Vec2 { x, y } = position_px;
            return Err(StrokeError::Coordinate { index, x, y });
        }
        if !time_s.is_finite() {
            return Err(StrokeError::Time { index, time_s });
        }
        self.points.push(StrokePoint {
            position_px,
            time_s,
        });
        Ok(())
    }

    /// The points in the order drawn.
    pub fn points(&self) -> &[StrokePoint] {
        &self.points
    }

    /// The positions in the order drawn.
    pub fn positions(
        &self,
    ) -> impl DoubleEndedIterator<Item = Vec2> + ExactSizeIterator + Clone + '_ {
        self.points.iter().map(|p| p.position_px)
    }

    /// The length of the polyline, pixels.
    pub fn length_px(&self) -> f32 {
        self.points
            .windows(2)
            .map(|w| w[0].position_px.distance(w[1].position_px))
            .sum()
    }

    /// From the first point to the last, seconds; 0 where times are missing.
    pub fn duration_s(&self) -> f64 {
        match (self.points.first(), self.points.last()) {
            (Some(first), Some(last)) => (last.time_s - first.time_s).max(0.0),
            _ => 0.0,
        }
    }

    /// `count` points (at least 2) at equal distances along the polyline, its two ends among them; times are
    /// interpolated. An empty stroke gives none, a dot gives copies of itself.
    pub fn resampled(&self, count: usize) -> Vec<StrokePoint> {
        let (Some(&first), Some(&last)) = (self.points.first(), self.points.last()) else {
            return Vec::new();
        };
        let count = count.max(2);
        let step = self.length_px() / (count - 1) as f32;
        let mut samples = Vec::with_capacity(count);
        samples.push(first);
        let mut walked = 0.0;
        for pair in self.points.windows(2) {
            let length = pair[0].position_px.distance(pair[1].position_px);
            while samples.len() < count - 1 && walked + length >= step * samples.len() as f32 {
                let t = if length > 0.0 {
                    (step * samples.len() as f32 - walked) / length
                } else {
                    0.0
                };
                samples.push(StrokePoint {
                    position_px: pair[0].position_px.lerp(pair[1].position_px, t),
                    time_s: pair[0].time_s + f64::from(t) * (pair[1].time_s - pair[0].time_s),
                });
            }
            walked += length;
        }
        samples.resize(count, last);
        samples[count - 1] = last;
        samples
    }
}

impl TryFrom<Vec<StrokePoint>> for Stroke {
    type Error = StrokeError;

    fn try_from(points: Vec<StrokePoint>) -> Result<Self, StrokeError> {
        Self::new(points)
    }
}

impl From<Stroke> for Vec<StrokePoint> {
    fn from(stroke: Stroke) -> Self {
        stroke.points
    }
}

/// The lowest and highest corner round all strokes; none when there is no point.
pub fn bounds_px(strokes: &[Stroke]) -> Option<(Vec2, Vec2)> {
    strokes
        .iter()
        .flat_map(Stroke::positions)
        .fold(None, |bounds, p| {
            let (low, high) = bounds.unwrap_or((p, p));
            Some((low.min(p), high.max(p)))
        })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_is_not_finite_is_refused_and_named() {
        let mut stroke = Stroke::default();
        stroke.push(Vec2::ONE, 0.0).unwrap();
        let message = stroke
            .push(Vec2::new(0.0, f32::NAN), 0.0)
            .unwrap_err()
            .to_string();
        assert!(message.contains("point 1"), "{message}");
        assert!(stroke.push(Vec2::splat(1.0e9), 0.0).is_err());
        assert!(stroke.push(Vec2::ONE, f64::INFINITY).is_err());
        assert_eq!(stroke.points().len(), 1);
    }

    #[test]
    fn flipping_turns_the_top_into_the_height() {
        assert_eq!(flip_y(Vec2::new(3.0, 0.0), 600.0), Vec2::new(3.0, 600.0));
        assert_eq!(
            flip_y(flip_y(Vec2::new(3.0, 7.0), 600.0), 600.0),
            Vec2::new(3.0, 7.0)
        );
    }

    #[test]
    fn dots_and_nothing_are_resampled_too() {
        assert!(Stroke::default().resampled(5).is_empty());
        let dot = Stroke::from_positions([Vec2::ONE]).unwrap();
        assert_eq!(dot.resampled(4).len(), 4);
        let still = Stroke::from_positions([Vec2::ONE; 9]).unwrap();
        assert!(
            still
                .resampled(4)
                .iter()
                .all(|p| p.position_px == Vec2::ONE)
        );
    }

    proptest! {
        #[test]
        fn resampling_keeps_ends_and_spacing(
            points in prop::collection::vec((-300.0f32..300.0, -300.0f32..300.0), 2..40),
            count in 2usize..200,
        ) {
            let stroke = Stroke::from_positions(points.into_iter().map(Vec2::from)).unwrap();
            let samples = stroke.resampled(count);
            prop_assert_eq!(samples.len(), count);
            prop_assert_eq!(samples[0], stroke.points()[0]);
            prop_assert_eq!(samples.last(), stroke.points().last());
            let step = stroke.length_px() / (count - 1) as f32;
            for pair in samples.windows(2) {
                // Corners may be cut, never lengthened.
                prop_assert!(pair[0].position_px.distance(pair[1].position_px) <= step * 1.01 + 0.01);
            }
        }
    }
}
