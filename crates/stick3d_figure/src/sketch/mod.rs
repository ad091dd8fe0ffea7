//! A sketch: where each joint of a figure was drawn, and the numbers a network reads of it.

mod error;

use glam::Vec2;
use serde::{Deserialize, Serialize};

pub use error::SketchError;

use crate::figure::Figure;

/// The largest coordinate that is taken for a drawing; beyond it `f32` differences lose their meaning.
pub const MAX_COORDINATE: f32 = 1.0e6;

/// One point per joint of a figure, x right, y up, in any unit (canvas pixels or metres).
///
/// All coordinates are finite and within [`MAX_COORDINATE`]. Which figure it belongs to is known to
/// its owner; every method that takes a [`Figure`] checks that the number of points fits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Vec2>", into = "Vec<Vec2>")]
pub struct Sketch {
    points: Vec<Vec2>,
}

impl Sketch {
    /// A sketch from one point per joint, in the order of [`Figure::joints`].
    ///
    /// # Errors
    /// [`SketchError::Count`], [`SketchError::Coordinate`], [`SketchError::Coincident`].
    pub fn new(figure: &Figure, points: Vec<Vec2>) -> Result<Self, SketchError> {
        check_count(figure, "joints", figure.joint_count(), points.len())?;
        for (point, joint) in points.iter().zip(&figure.joints) {
            check_coordinate(*point, || format!("joint \"{}\"", joint.name))?;
        }
        check_size(&points)?;
        Ok(Self { points })
    }

    /// A sketch from one point per path point; a joint that the path visits more than once is put at the mean.
    ///
    /// # Errors
    /// As [`Sketch::new`].
    pub fn from_path(figure: &Figure, path_points: &[Vec2]) -> Result<Self, SketchError> {
        check_count(figure, "path points", figure.path_len(), path_points.len())?;
        for (i, point) in path_points.iter().enumerate() {
            check_coordinate(*point, || format!("path point {i}"))?;
        }
        let mut sums = vec![(Vec2::ZERO, 0.0_f32); figure.joint_count()];
        for (&joint, &point) in figure.path.iter().zip(path_points) {
            sums[joint].0 += point;
            sums[joint].1 += 1.0;
        }
        // A figure's path visits every joint, so no count is zero.
        Self::new(
            figure,
            sums.into_iter().map(|(sum, count)| sum / count).collect(),
        )
    }

    /// A sketch from named joints in any order.
    ///
    /// # Errors
    /// [`SketchError::Figure`] for an unknown name, [`SketchError::Duplicate`], [`SketchError::Missing`],
    /// and those of [`Sketch::new`].
    pub fn from_named<'a>(
        figure: &Figure,
        named: impl IntoIterator<Item = (&'a str, Vec2)>,
    ) -> Result<Self, SketchError> {
        let mut points = vec![None; figure.joint_count()];
        for (name, point) in named {
            let slot = &mut points[figure.joint_index(name)?];
            if slot.replace(point).is_some() {
                return Err(SketchError::Duplicate {
                    name: name.to_owned(),
                });
            }
        }
        let points = points
            .into_iter()
            .zip(&figure.joints)
            .map(|(point, joint)| {
                point.ok_or_else(|| SketchError::Missing {
                    figure: figure.name.clone(),
                    name: joint.name.clone(),
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        Self::new(figure, points)
    }

    /// The figure's template as a sketch, metres.
    pub fn template(figure: &Figure) -> Self {
        Self {
            points: figure.template.clone(),
        }
    }

    /// One point per joint, in the order of [`Figure::joints`].
    pub fn points(&self) -> &[Vec2] {
        &self.points
    }

    /// Moves one joint.
    ///
    /// # Errors
    /// [`SketchError::Coordinate`] when the point is not finite, [`SketchError::Count`] when there is no such joint;
    /// the sketch is then unchanged.
    pub fn set_point(
        &mut self,
        figure: &Figure,
        joint: usize,
        point: Vec2,
    ) -> Result<(), SketchError> {
        check_coordinate(point, || match figure.joints.get(joint) {
            Some(joint) => format!("joint \"{}\"", joint.name),
            None => format!("joint {joint}"),
        })?;
        let got = self.points.len();
        match self.points.get_mut(joint) {
            Some(slot) => {
                *slot = point;
                Ok(())
            }
            None => check_count(figure, "joints", joint + 1, got),
        }
    }

    /// The sketch along the figure's path: one point per path point.
    ///
    /// # Errors
    /// [`SketchError::Count`] when the sketch is of another figure.
    pub fn path_points(&self, figure: &Figure) -> Result<Vec<Vec2>, SketchError> {
        check_count(figure, "joints", figure.joint_count(), self.points.len())?;
        Ok(figure
            .path
            .iter()
            .map(|&joint| self.points[joint])
            .collect())
    }

    /// What the networks read: `2 * path_len` numbers.
    ///
    /// With path points `p_0 .. p_(n-1)`, entry 0 is `(0, 0)` and entry `i` is `(p_i - p_(i-1)) / s`, x before y,
    /// where `s` is [`Sketch::scale`]: the root mean square length of the `n - 1` offsets. So the vector does not
    /// depend on where or how big the figure was drawn, and the mean square length of its offsets is 1.
    /// (The paper, section 4.1, gives the offsets; it states no scale.)
    ///
    /// # Errors
    /// [`SketchError::Count`] when the sketch is of another figure, [`SketchError::Coincident`].
    pub fn input_vector(&self, figure: &Figure) -> Result<Vec<f32>, SketchError> {
        let mut input = vec![0.0; figure.input_len()];
        self.write_input_vector(figure, &mut input)?;
        Ok(input)
    }

    /// Writes [`Sketch::input_vector`] without allocating.
    ///
    /// # Errors
    /// As [`Sketch::input_vector`], and [`SketchError::BufferLength`].
    pub fn write_input_vector(
        &self,
        figure: &Figure,
        input: &mut [f32],
    ) -> Result<(), SketchError> {
        check_count(figure, "joints", figure.joint_count(), self.points.len())?;
        if input.len() != figure.input_len() {
            return Err(SketchError::BufferLength {
                figure: figure.name.clone(),
                expected: figure.input_len(),
                got: input.len(),
            });
        }
        check_size(&self.points)?;
        let scale = self.scale(figure);
        input[..2].fill(0.0);
        for (entry, pair) in input[2..].chunks_exact_mut(2).zip(figure.path.windows(2)) {
            let offset = (self.points[pair[1]] - self.points[pair[0]]) / scale;
            entry.copy_from_slice(&offset.to_array());
        }
        Ok(())
    }

    /// The root mean square length of the steps along the figure's path, in the sketch's unit: by what
    /// [`Sketch::input_vector`] divides. 0 for a sketch of another figure.
    pub fn scale(&self, figure: &Figure) -> f32 {
        if self.points.len() != figure.joint_count() {
            return 0.0;
        }
        let steps = figure.path.windows(2);
        let count = steps.len() as f32;
        let squares: f32 = steps
            .map(|pair| self.points[pair[1]].distance_squared(self.points[pair[0]]))
            .sum();
        (squares / count).sqrt()
    }

    /// The sketch as a mirror shows it: sides exchanged and x negated. A sketch of another figure comes back unchanged.
    #[must_use]
    pub fn mirrored(&self, figure: &Figure) -> Self {
        if self.points.len() != figure.joint_count() {
            return self.clone();
        }
        let flip = Vec2::new(-1.0, 1.0);
        let points = (0..self.points.len())
            .map(|j| self.points[figure.mirror_of(j)] * flip)
            .collect();
        Self { points }
    }
}

impl TryFrom<Vec<Vec2>> for Sketch {
    type Error = SketchError;

    fn try_from(points: Vec<Vec2>) -> Result<Self, SketchError> {
        for (i, point) in points.iter().enumerate() {
            check_coordinate(*point, || format!("joint {i}"))?;
        }
        Ok(Self { points })
    }
}

impl From<Sketch> for Vec<Vec2> {
    fn from(sketch: Sketch) -> Self {
        sketch.points
    }
}

/// Fails unless as many points came as the figure needs.
pub(crate) fn check_count(
    figure: &Figure,
    what: &'static str,
    expected: usize,
    got: usize,
) -> Result<(), SketchError> {
    if expected == got {
        return Ok(());
    }
    Err(SketchError::Count {
        figure: figure.name.clone(),
        what,
        expected,
        got,
    })
}

fn check_coordinate(point: Vec2, place: impl Fn() -> String) -> Result<(), SketchError> {
    if point.x.abs() <= MAX_COORDINATE && point.y.abs() <= MAX_COORDINATE {
        return Ok(());
    }
    Err(SketchError::Coordinate {
        place: place(),
        x: point.x,
        y: point.y,
    })
}

/// An extent that is nothing beside the coordinates themselves is rounding, not a drawing.
fn check_size(points: &[Vec2]) -> Result<(), SketchError> {
    let first = points.first().copied().unwrap_or_default();
    let (mut low, mut high) = (first, first);
    for &point in points {
        (low, high) = (low.min(point), high.max(point));
    }
    let magnitude = low.abs().max(high.abs()).max_element();
    if (high - low).max_element() > (magnitude * 1.0e-5).max(1.0e-12) {
        return Ok(());
    }
    Err(SketchError::Coincident {
        x: first.x,
        y: first.y,
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn template() -> Sketch {
        Sketch::template(Figure::human())
    }

    #[test]
    fn input_vector_is_offsets_of_unit_mean_square() {
        let human = Figure::human();
        let input = template().input_vector(human).unwrap();
        assert_eq!(input.len(), 34);
        assert_eq!(input[..2], [0.0, 0.0]);
        let mean_square = input.iter().map(|v| v * v).sum::<f32>() / 16.0;
        assert!((mean_square - 1.0).abs() < 1.0e-5);
        // Forehead to neck is straight down, 0.2 m.
        assert!(input[2].abs() < 1.0e-6);
        assert!((input[3] * template().scale(human) + 0.2).abs() < 1.0e-5);
    }

    #[test]
    fn bad_points_are_named() {
        let human = Figure::human();
        let mut points = human.template.clone();
        points[1].x = f32::NAN;
        let message = Sketch::new(human, points).unwrap_err().to_string();
        assert!(
            message.contains("joint \"neck\"") && message.contains("NaN"),
            "{message}"
        );
        let coincident = Sketch::new(human, vec![Vec2::splat(3.0); 11]);
        assert_eq!(coincident, Err(SketchError::Coincident { x: 3.0, y: 3.0 }));
        let count = Sketch::from_path(human, &[Vec2::ZERO; 16])
            .unwrap_err()
            .to_string();
        assert!(
            count.contains("16 points given for 17 path points"),
            "{count}"
        );
        let missing = Sketch::from_named(human, [("neck", Vec2::ZERO)]);
        assert!(matches!(missing, Err(SketchError::Missing { name, .. }) if name == "forehead"));
        let twice = Sketch::from_named(human, [("neck", Vec2::ZERO), ("neck", Vec2::ONE)]);
        assert!(matches!(twice, Err(SketchError::Duplicate { .. })));
        let mut sketch = template();
        assert!(
            sketch
                .set_point(human, 0, Vec2::splat(f32::INFINITY))
                .is_err()
        );
        assert!(sketch.set_point(human, 99, Vec2::ZERO).is_err());
        assert_eq!(sketch, template());
    }

    #[test]
    fn serde_refuses_what_new_refuses() {
        let json = serde_json::to_string(&template()).unwrap();
        assert_eq!(serde_json::from_str::<Sketch>(&json).unwrap(), template());
        assert!(serde_json::from_str::<Sketch>("[[0.0, 1e30]]").is_err());
    }

    proptest! {
        #[test]
        fn input_vector_ignores_place_and_size(
            jitter in prop::collection::vec((-0.2f32..0.2, -0.2f32..0.2), 11),
            size in 0.01f32..1000.0,
            dx in -100.0f32..100.0,
            dy in -100.0f32..100.0,
        ) {
            let human = Figure::human();
            let points: Vec<Vec2> =
                human.template.iter().zip(jitter).map(|(p, j)| *p + Vec2::from(j)).collect();
            let offset = Vec2::new(dx, dy) * size;
            let moved = points.iter().map(|p| *p * size + offset).collect();
            let a = Sketch::new(human, points).unwrap().input_vector(human).unwrap();
            let b = Sketch::new(human, moved).unwrap().input_vector(human).unwrap();
            for (a, b) in a.iter().zip(&b) {
                prop_assert!((a - b).abs() < 2.0e-3, "{a} {b}");
            }
        }

        #[test]
        fn mirroring_twice_changes_nothing_and_paths_round_trip(
            coordinates in prop::collection::vec((-500.0f32..500.0, -500.0f32..500.0), 11),
        ) {
            let human = Figure::human();
            let points: Vec<Vec2> = coordinates.into_iter().map(Vec2::from).collect();
            let sketch = Sketch::new(human, points.clone()).unwrap();
            prop_assert_eq!(&sketch.mirrored(human).mirrored(human), &sketch);
            let again = Sketch::from_path(human, &sketch.path_points(human).unwrap()).unwrap();
            for (a, b) in again.points().iter().zip(&points) {
                prop_assert!(a.distance(*b) < 1.0e-3);
            }
            let named = human.joints.iter().rev().map(|j| j.name.as_str()).zip(points.into_iter().rev());
            prop_assert_eq!(Sketch::from_named(human, named).unwrap(), sketch);
        }
    }
}
