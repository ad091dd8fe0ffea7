//! Where the rest of an unfinished sketch goes: the faint figure, and what a preview shows.

use bevy::math::Vec2;
use stick3d_figure::{Figure, Side, complete_from_template};

use super::canvas::CANVAS_SIZE;

/// The height of the template and of loaded sketches, canvas units.
const FIGURE_HEIGHT: f32 = CANVAS_SIZE * 0.84;
/// The widest that a template or a loaded sketch may be, canvas units.
const FIGURE_WIDTH: f32 = CANVAS_SIZE * 0.86;

/// One point per joint: the known ones where they were drawn, the others where they may come to be.
///
/// While nothing is drawn, that is the template in the middle of the canvas.
pub(super) fn guide(figure: &Figure, placed: &[Option<Vec2>]) -> Vec<Vec2> {
    if let Some(sketch) = complete_from_template(figure, placed) {
        return sketch.points().to_vec();
    }
    let mut points = fitted(&figure.template);
    if let Some((joint, drawn)) = placed
        .iter()
        .enumerate()
        .find_map(|(joint, point)| point.map(|drawn| (joint, drawn)))
    {
        let shift = points.get(joint).map_or(Vec2::ZERO, |point| drawn - *point);
        for point in &mut points {
            *point += shift;
        }
    }
    points
}

/// Points of any scale, turned into canvas units and put in the middle of the canvas.
pub(super) fn fitted(points: &[Vec2]) -> Vec<Vec2> {
    centred(points, fitting_scale(points))
}

/// Sketches of any unit, turned into canvas units and each put in the middle of its canvas: all at one scale, that of the
/// largest, so that they can be compared.
pub fn fit_to_canvas(sketches: &[&[Vec2]]) -> Vec<Vec<Vec2>> {
    let scale = sketches
        .iter()
        .map(|points| fitting_scale(points))
        .fold(f32::INFINITY, f32::min);
    sketches
        .iter()
        .map(|points| centred(points, scale))
        .collect()
}

/// How large the faint figure is, canvas units per metre.
pub(super) fn usual_scale(figure: &Figure) -> f32 {
    fitting_scale(&figure.template)
}

fn fitting_scale(points: &[Vec2]) -> f32 {
    let (low, high) = bounds(points);
    let size = (high - low).max(Vec2::splat(f32::MIN_POSITIVE));
    (FIGURE_HEIGHT / size.y).min(FIGURE_WIDTH / size.x)
}

fn centred(points: &[Vec2], scale: f32) -> Vec<Vec2> {
    let (low, high) = bounds(points);
    let centre = (low + high) / 2.0;
    points
        .iter()
        .map(|&point| (point - centre) * scale)
        .collect()
}

/// Whether enough is drawn to guess the rest: every joint in the middle of the body from which limbs go out,
/// and one more to tell the scale by.
pub(super) fn is_enough(figure: &Figure, placed: &[Option<Vec2>]) -> bool {
    let branches = |joint: usize| figure.bones_at(joint) > 1;
    placed.len() == figure.joint_count()
        && placed.iter().flatten().count() > 1
        && (0..placed.len()).all(|joint| {
            placed[joint].is_some() || figure.joints[joint].side != Side::Center || !branches(joint)
        })
}

fn bounds(points: &[Vec2]) -> (Vec2, Vec2) {
    let first = points.first().copied().unwrap_or_default();
    points
        .iter()
        .fold((first, first), |(low, high), &p| (low.min(p), high.max(p)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_drawn_is_the_template_in_its_place() {
        let points = guide(Figure::human(), &[None; 11]);
        let (low, high) = bounds(&points);
        assert!((high.y - low.y - FIGURE_HEIGHT).abs() < 0.1);
        assert!(((low + high) / 2.0).length() < 0.1);
    }

    #[test]
    fn one_joint_moves_the_whole_and_equal_ones_do_not_break_it() {
        let human = Figure::human();
        let mut placed = [None; 11];
        placed[0] = Some(Vec2::new(10.0, 20.0));
        assert_eq!(guide(human, &placed)[0], Vec2::new(10.0, 20.0));
        placed[1] = placed[0];
        assert!(guide(human, &placed).iter().all(|point| point.is_finite()));
    }

    #[test]
    fn wide_sketches_fit_too() {
        let points = fitted(&[Vec2::ZERO, Vec2::new(50.0, 1.0)]);
        let (low, high) = bounds(&points);
        assert!((high.x - low.x - FIGURE_WIDTH).abs() < 0.1);
    }

    #[test]
    fn sketches_that_belong_together_keep_their_sizes() {
        let (tall, low) = ([Vec2::ZERO, Vec2::Y * 2.0], [Vec2::ZERO, Vec2::Y]);
        let fitted = fit_to_canvas(&[&tall, &low]);
        let heights = [&fitted[0], &fitted[1]].map(|points| points[1].y - points[0].y);
        assert!((heights[0] - FIGURE_HEIGHT).abs() < 0.1);
        assert!((heights[1] - FIGURE_HEIGHT / 2.0).abs() < 0.1);
        assert!(fit_to_canvas(&[]).is_empty());
    }

    #[test]
    fn the_middle_line_is_enough() {
        let human = Figure::human();
        let placed: Vec<Option<Vec2>> = human
            .joints
            .iter()
            .zip(&human.template)
            .map(|(joint, &point)| (joint.side == Side::Center).then_some(point))
            .collect();
        assert!(is_enough(human, &placed));
        let mut headless = placed.clone();
        headless[human.joint_index("forehead").unwrap()] = None;
        assert!(is_enough(human, &headless));
        let mut without_trunk = placed.clone();
        without_trunk[human.joint_index("abdomen").unwrap()] = None;
        assert!(!is_enough(human, &without_trunk));
        assert!(!is_enough(human, &placed[1..]));
        assert!(!is_enough(human, &[None; 11]));
    }
}
