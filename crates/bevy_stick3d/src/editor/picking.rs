//! Which limb of the body is under the pointer in the 3D view: pure arithmetic.

use bevy::math::{Vec2, Vec3};
use bevy::transform::components::Transform;
use bevy_egui::egui::{Pos2, Rect};
use stick3d_figure::Figure;
use stick3d_figure::edit::nearest_bone;

use super::orbit::on_view;

/// A bone farther away than this share of the view's height is not meant.
const REACH_SHARE: f32 = 0.05;

/// The end of the limb whose bone is nearest to a place in the view, if one is near.
///
/// `joints` are where they stand on the stage.
pub(super) fn limb_at(
    figure: &Figure,
    joints: &[Vec3],
    camera: &Transform,
    view: Rect,
    at: Pos2,
) -> Option<usize> {
    let on_screen = |joint: &Vec3| {
        let place = on_view(*joint, camera, view.aspect_ratio())?;
        let half = view.size() / 2.0;
        Some(Vec2::new(place.x * half.x, -place.y * half.y))
    };
    let points: Vec<Vec2> = joints.iter().map(on_screen).collect::<Option<_>>()?;
    let at = at - view.center();
    let reach = REACH_SHARE * view.height();
    let bone = nearest_bone(figure, &points, Vec2::new(at.x, at.y), reach)?;
    let limb = figure.limb_of_bone(figure.bones[bone])?;
    Some(limb.end())
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::{pos2, vec2};

    use super::super::orbit::{Framing, Orbit, camera_transform};
    use super::*;

    #[test]
    fn the_limb_under_the_pointer_is_found_from_everywhere() {
        let human = Figure::human();
        let joints: Vec<Vec3> = human.template.iter().map(|p| p.extend(0.0)).collect();
        let [elbow, hand, neck, abdomen] =
            ["elbow_r", "hand_r", "neck", "abdomen"].map(|name| human.joint_index(name).unwrap());
        let view = Rect::from_min_size(pos2(700.0, 20.0), vec2(500.0, 600.0));
        for yaw_rad in [-0.6, 0.0, 0.45, 2.8] {
            let orbit = Orbit {
                yaw_rad,
                ..Orbit::default()
            };
            let aspect = view.aspect_ratio();
            let camera = camera_transform(&orbit, &Framing::of_extent(0.9), aspect);
            let place = |a: usize, b: usize| {
                let on_view = on_view(joints[a].midpoint(joints[b]), &camera, aspect).unwrap();
                let half = view.size() / 2.0;
                view.center() + vec2(on_view.x * half.x, -on_view.y * half.y)
            };
            let found = |at| limb_at(human, &joints, &camera, view, at);
            assert_eq!(found(place(elbow, hand)), Some(hand), "from {yaw_rad}");
            assert_eq!(found(place(neck, abdomen)), None, "the trunk");
            assert_eq!(found(view.left_top()), None);
        }
    }
}
