//! A body in a few strokes, turned so that its depth is seen.

use bevy::math::{Quat, Vec3};
use bevy_egui::egui::{self, Color32, Painter, Pos2, Rect, Stroke, pos2, vec2};
use stick3d_figure::Figure;
use stick3d_model::Alternative;

use super::super::canvas::bone_side;
use super::super::theme::{self, side_color};

/// From where the body is looked at: turned about the vertical from the side that is drawn, and from above.
const YAW_RAD: f32 = 0.87;
const PITCH_RAD: f32 = 0.26;
/// How thick bones are, as a share of the figure's size.
const BONE_SHARE: f32 = 0.046;
/// The head's radius, in bones' thicknesses.
const HEAD_SHARE: f32 = 0.95;
/// What is a whole figure's size nearer is drawn so much thicker, and in so much more of its colour.
const NEARER_IS_THICKER: f32 = 0.7;
const NEARER_IS_DARKER: f32 = 1.1;
/// The least and the most of a bone's colour.
const INK_RANGE: [f32; 2] = [0.42, 1.0];
/// Bones are cut into so many pieces, each with a colour of its own.
const PIECES: usize = 5;
/// The paper that is seen round a bone before another, points.
const HALO: f32 = 0.9;

/// A body to paint.
pub(super) struct Picture<'a> {
    figure: &'a Figure,
    /// As looked at: x to the right, y up, z toward who looks, metres.
    joints: Vec<Vec3>,
    /// Where they are on the ground.
    shadow: Vec<Vec3>,
    scale: f32,
    size_m: f32,
}

/// As looked at: x to the right, y up, z toward who looks.
fn turned(joint: Vec3) -> Vec3 {
    Quat::from_rotation_x(PITCH_RAD) * (Quat::from_rotation_y(-YAW_RAD) * joint)
}

fn lowest_m(body: &Alternative) -> f32 {
    body.joints
        .iter()
        .map(|j| j.y)
        .fold(f32::INFINITY, f32::min)
}

/// How thick something is that is `depth_m` nearer than the root, metres.
fn thick_m(size_m: f32, depth_m: f32) -> f32 {
    let nearer = (1.0 + NEARER_IS_THICKER * depth_m / size_m).clamp(0.5, 1.6);
    BONE_SHARE * size_m * nearer
}

/// Round everything that is painted of the joints and their shadows as looked at, y down, metres.
fn bounds(figure: &Figure, joints: &[Vec3], shadow: &[Vec3]) -> Rect {
    let size_m = figure.template_extent_m();
    let head = figure.path.first().copied();
    let dot = |at: Vec3, radius_m: f32| {
        Rect::from_center_size(pos2(at.x, -at.y), egui::Vec2::splat(2.0 * radius_m))
    };
    let of_joints = joints.iter().enumerate().map(|(joint, at)| {
        let share = if head == Some(joint) { HEAD_SHARE } else { 0.5 };
        dot(*at, share * thick_m(size_m, at.z))
    });
    let of_shadow = shadow.iter().map(|at| dot(*at, 0.5 * BONE_SHARE * size_m));
    of_joints
        .chain(of_shadow)
        .fold(Rect::NOTHING, |all, dot| all | dot)
}

fn seen(body: &Alternative) -> (Vec<Vec3>, Vec<Vec3>) {
    let ground_m = lowest_m(body);
    let joints = body.joints.iter().map(|joint| turned(*joint));
    let shadow = body.joints.iter();
    let shadow = shadow.map(|joint| turned(joint.with_y(ground_m)));
    (joints.collect(), shadow.collect())
}

/// The scale at which each of the bodies has room, points per metre.
pub(super) fn common_scale<'a>(
    figure: &Figure,
    bodies: impl Iterator<Item = &'a Alternative>,
    room: egui::Vec2,
) -> f32 {
    let scale = bodies.map(|body| {
        let (joints, shadow) = seen(body);
        let size = bounds(figure, &joints, &shadow).size();
        let size = size.max(vec2(1.0e-4, 1.0e-4));
        (room.x / size.x).min(room.y / size.y)
    });
    scale.fold(f32::INFINITY, f32::min)
}

impl<'a> Picture<'a> {
    /// A body, at so many points per metre.
    pub(super) fn new(figure: &'a Figure, body: &Alternative, scale: f32) -> Self {
        let (joints, shadow) = seen(body);
        Self {
            figure,
            joints,
            shadow,
            scale,
            size_m: figure.template_extent_m(),
        }
    }

    /// Paints it round a centre: shadow, then the bones from the farthest to the nearest.
    pub(super) fn paint(&self, painter: &Painter, centre: Pos2) {
        let middle = bounds(self.figure, &self.joints, &self.shadow).center();
        let on_screen = |p: Vec3| centre + (pos2(p.x, -p.y) - middle) * self.scale;
        let width = BONE_SHARE * self.size_m * self.scale;
        let shade = theme::PAPER.lerp_to_gamma(theme::INK, 0.11);
        for &bone in &self.figure.bones {
            let ends = bone.map(|joint| on_screen(self.shadow[joint]));
            painter.line_segment(ends, Stroke::new(width, shade));
            for end in ends {
                painter.circle_filled(end, width / 2.0, shade);
            }
        }
        let mut bones = self.figure.bones.clone();
        let depth = |bone: &[usize; 2]| self.joints[bone[0]].z + self.joints[bone[1]].z;
        bones.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
        for bone in bones {
            self.paint_bone(painter, bone, &on_screen);
        }
    }

    fn paint_bone(&self, painter: &Painter, bone: [usize; 2], on_screen: &impl Fn(Vec3) -> Pos2) {
        let [from, to] = bone.map(|joint| self.joints[joint]);
        let pieces = (0..PIECES).map(|piece| {
            let at = |step: usize| from.lerp(to, step as f32 / PIECES as f32);
            [at(piece), at(piece + 1)]
        });
        let color = side_color(bone_side(self.figure, bone));
        let head = self.figure.path.first().filter(|head| bone.contains(head));
        let head = head.map(|head| self.joints[*head]);
        for (grow, is_halo) in [(HALO, true), (0.0, false)] {
            let paper = |depth_m: f32| match is_halo {
                true => theme::PAPER,
                false => self.inked(color, depth_m),
            };
            for ends in pieces.clone() {
                let middle_m = (ends[0].z + ends[1].z) / 2.0;
                let half = self.thick(middle_m) / 2.0 + grow;
                let color = paper(middle_m);
                let ends = ends.map(on_screen);
                painter.line_segment(ends, Stroke::new(2.0 * half, color));
                for end in ends {
                    painter.circle_filled(end, half, color);
                }
            }
            if let Some(head) = head {
                let radius = HEAD_SHARE * self.thick(head.z) + grow;
                painter.circle_filled(on_screen(head), radius, paper(head.z));
            }
        }
    }

    /// How thick something is that is `depth_m` nearer than the root, points.
    fn thick(&self, depth_m: f32) -> f32 {
        self.scale * thick_m(self.size_m, depth_m)
    }

    fn inked(&self, color: Color32, depth_m: f32) -> Color32 {
        let [least, most] = INK_RANGE;
        let share = 0.78 + NEARER_IS_DARKER * depth_m / self.size_m;
        theme::PAPER.lerp_to_gamma(color, share.clamp(least, most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(forward_m: f32) -> Alternative {
        let mut body = Alternative::default();
        let joints = Figure::human().template.iter();
        body.joints = joints.map(|point| point.extend(0.0)).collect();
        let hand = Figure::human().joint_index("hand_r").unwrap();
        body.joints[hand].z = forward_m;
        body
    }

    #[test]
    fn depth_is_seen_as_place_and_thickness() {
        let hand = Figure::human().joint_index("hand_r").unwrap();
        let [toward, away] =
            [0.4, -0.4].map(|depth| Picture::new(Figure::human(), &body(depth), 40.0));
        let [near, far] = [&toward, &away].map(|picture| picture.joints[hand]);
        assert!((near.x - far.x).abs() > 0.5, "seen from the side");
        assert!(near.z > far.z);
        assert!(toward.thick(near.z) > away.thick(far.z));
    }

    #[test]
    fn every_body_has_room_at_the_common_scale() {
        let bodies = [body(0.0), body(1.5)];
        let room = vec2(44.0, 40.0);
        let scale = common_scale(Figure::human(), bodies.iter(), room);
        let sizes = bodies.each_ref().map(|body| {
            let (joints, shadow) = seen(body);
            bounds(Figure::human(), &joints, &shadow).size() * scale
        });
        assert!(
            sizes
                .iter()
                .all(|s| s.x < room.x + 0.01 && s.y < room.y + 0.01)
        );
        assert!(
            sizes
                .iter()
                .any(|s| s.x > room.x - 0.01 || s.y > room.y - 0.01)
        );
    }
}
