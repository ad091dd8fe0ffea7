//! The template of a guessed figure: its joints at rest on the sketch plane.

use glam::{Vec2, Vec3};
use stick3d_figure::{Figure, Side};

use crate::rig::Rig;

/// Joints of both sides nearer to each other than this share of the body's height hide each other.
const HIDDEN: f32 = 0.06;

/// A hidden far leg is drawn this much ahead, metres for every metre that it is below the root.
const AHEAD: f32 = 0.13;

/// No body is larger than this, metres: a file that says so is in another unit.
const LARGEST_M: f32 = 30.0;

/// Metres of the unit that a rig is in: 1 as glTF has it, unless the body would be a giant's.
pub(super) fn unit_m(rig: &Rig) -> f32 {
    let points = || rig.mesh.positions.iter().copied();
    let low = points().fold(Vec3::INFINITY, Vec3::min);
    let size = (points().fold(Vec3::NEG_INFINITY, Vec3::max) - low).max_element();
    let fits = |unit: &f32| unit * size <= LARGEST_M;
    [1.0, 0.01, 0.001].into_iter().find(fits).unwrap_or(1.0)
}

/// One point per joint, metres: x along `right` from the middle of the body, y up from the ground.
///
/// Joints without a place are where the template has them that the figure came with, at the body's size.
pub(super) fn template(
    figure: &Figure,
    places: &[Option<Vec3>],
    right: Vec3,
    rig: &Rig,
) -> Vec<Vec2> {
    let unit_m = unit_m(rig);
    let ground = lowest(rig.mesh.positions.iter().map(|p| p.y));
    let flat = |place: &Vec3| unit_m * Vec2::new(right.dot(*place), place.y - ground);
    let flat: Vec<Option<Vec2>> = places.iter().map(|p| p.as_ref().map(flat)).collect();
    let middle_x = middle_x(figure, &flat);
    let likeness = size(flat.iter().flatten()) / size(figure.template.iter());
    let usual = |joint: usize| likeness * figure.template[joint];
    let mut template: Vec<Vec2> = flat
        .iter()
        .enumerate()
        .map(|(joint, at)| at.map_or_else(|| usual(joint), |at| at - Vec2::new(middle_x, 0.0)))
        .collect();
    step_ahead(figure, &mut template);
    // A millimetre is enough for a file that people read.
    template.iter().map(|p| (1e3 * p).round() / 1e3).collect()
}

/// Legs of the far side are drawn a step ahead of the near ones, which would hide them.
fn step_ahead(figure: &Figure, template: &mut [Vec2]) {
    let height = template.iter().map(|p| p.y).fold(0.0, f32::max);
    let root = template[figure.root];
    for joint in 0..template.len() {
        let near = template[figure.mirror_of(joint)];
        if figure.joints[joint].side == Side::Left
            && near.distance(template[joint]) < HIDDEN * height
        {
            template[joint].x += AHEAD * (root.y - template[joint].y).max(0.0);
        }
    }
}

/// The mean of what is found of the root and of the joints of the middle that carry limbs.
fn middle_x(figure: &Figure, flat: &[Option<Vec2>]) -> f32 {
    let carries = |joint: &usize| {
        let bones = figure.bones.iter().filter(|bone| bone.contains(joint));
        figure.joints[*joint].side == Side::Center && bones.count() > 2
    };
    let found: Vec<f32> = (0..flat.len())
        .filter(carries)
        .filter_map(|joint| flat[joint].map(|at| at.x))
        .collect();
    found.iter().sum::<f32>() / found.len().max(1) as f32
}

/// How high some points reach; 1 without any.
fn size<'a>(points: impl Iterator<Item = &'a Vec2>) -> f32 {
    let highest = points.map(|p| p.y).fold(0.0, f32::max);
    if highest > 0.0 { highest } else { 1.0 }
}

fn lowest(heights: impl Iterator<Item = f32>) -> f32 {
    let lowest = heights.fold(f32::INFINITY, f32::min);
    if lowest.is_finite() { lowest } else { 0.0 }
}
