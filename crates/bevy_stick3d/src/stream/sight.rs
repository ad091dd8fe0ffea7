//! Which playing figures need not be decoded, because nobody sees them.

use bevy::animation::AnimatedBy;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::ViewVisibility;
use bevy::ecs::query::QueryData;
use bevy::math::Vec3A;
use bevy::prelude::*;

use crate::animation::DecodeOutOfSight;

/// There while Bevy finds out which entities are in sight. Without a renderer nothing ever is, and everything is decoded.
#[derive(Resource, Debug, Default)]
pub(super) struct SightIsChecked;

/// What decides whether a figure is decoded.
#[derive(QueryData)]
pub(super) struct Sight {
    /// As of the last frame.
    visibility: &'static ViewVisibility,
    is_animated: Has<AnimatedBy>,
    opted_out: Has<DecodeOutOfSight>,
}

impl SightItem<'_, '_> {
    /// Whether no view saw the figure in the last frame, and it is one that changes in every frame. A figure that is posed
    /// once is decoded at once.
    pub(super) fn is_out(&self) -> bool {
        self.is_animated && !self.opted_out && !self.visibility.get()
    }
}

/// A box about the same place that holds the body in any pose, so that it is found to be in sight whatever it does
/// meanwhile.
pub(super) fn any_pose(shown: &Aabb) -> Aabb {
    // A body that bends or stretches stays within twice its own reach.
    let reach = 2.0 * shown.half_extents.length();
    Aabb {
        center: shown.center,
        half_extents: Vec3A::splat(reach),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_of_any_pose_holds_the_body_stretched_out_in_any_direction() {
        let crouched = Aabb::from_min_max(Vec3::new(-0.35, 0.0, -0.4), Vec3::new(0.35, 1.0, 0.4));
        let any = any_pose(&crouched);
        for far in [Vec3::Y * 1.8, Vec3::new(1.0, 0.0, 0.0), Vec3::NEG_Z] {
            assert!(
                Vec3::from(any.min()).cmple(far).all() && Vec3::from(any.max()).cmpge(far).all()
            );
        }
    }
}
