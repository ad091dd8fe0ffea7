//! The man's clothes and face, as one colour per vertex.

use super::surface::Surface;
use crate::rig::Skeleton;

/// Linear colours (glTF `COLOR_0`).
const SUIT: [u8; 4] = [4, 40, 48, 255];
const SKIN: [u8; 4] = [170, 100, 68, 255];

/// One linear colour per vertex.
pub(super) fn colors(surface: &Surface, skeleton: &Skeleton) -> Vec<[u8; 4]> {
    let bare = |name: &str| {
        [
            "head", "neck", "hand", "thumb", "index", "middle", "ring", "pinky", "foot", "ball",
        ]
        .iter()
        .any(|part| name.starts_with(part))
    };
    surface
        .influences
        .iter()
        .map(|list| {
            let share: f64 = list
                .iter()
                .filter(|(bone, _)| bare(&skeleton.bones[usize::from(*bone)].name))
                .map(|&(_, weight)| weight)
                .sum();
            if share > 0.5 { SKIN } else { SUIT }
        })
        .collect()
}
