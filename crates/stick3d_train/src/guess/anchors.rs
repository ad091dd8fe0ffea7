//! From where a joint is to be to what a figure file says of it: names of bones, or vertices.

use glam::Vec3;
use stick3d_figure::{Anchor, Figure, Joint};

use super::body::Body;
use super::plan::{Face, Place};
use super::symmetry::Symmetry;
use crate::landmark::facing;
use crate::rig::{Rig, regressor};

/// The most vertices that an anchor names.
const VERTICES: usize = 24;

/// The most vertices at the end of a limb, and their share of all that it has.
const END_VERTICES: usize = 12;
const END_SHARE: f32 = 0.1;

/// The middle of a head is nearer to its plane than the first of these shares of its half width that leaves enough of
/// it. Antlers are wide.
const PROFILE: [f32; 5] = [0.02, 0.05, 0.1, 0.3, 1.0];

/// A profile has at least so many vertices.
const PROFILE_VERTICES: usize = 12;

/// Puts joints on the surface of a rig.
pub(super) struct Anchors<'a> {
    pub(super) rig: &'a Rig,
    pub(super) body: &'a Body,
    pub(super) symmetry: &'a Symmetry,
    /// The way that the body faces, a unit vector.
    pub(super) forward: Vec3,
}

impl Anchors<'_> {
    /// The anchor of a joint; where too little surface surrounds its bones, the vertices nearest to their heads.
    pub(super) fn of(&self, place: &Place, figure: &Figure, joint: &Joint) -> Anchor {
        match place {
            Place::Heads(bones) => {
                let anchor = Anchor::Bones(bones.iter().map(|&b| self.body.name(b)).collect());
                if self.can_follow(figure, joint, &anchor) {
                    anchor
                } else {
                    Anchor::Vertices(self.nearest(self.position(&anchor)))
                }
            }
            Place::Middle(bones) => Anchor::Vertices(thinned(&self.surface_of(bones))),
            Place::End(bone) => Anchor::Vertices(self.end(*bone)),
            Place::Forehead(head, face) => Anchor::Vertices(self.forehead(*head, *face)),
        }
    }

    /// Where an anchor is at rest, model space, metres.
    pub(super) fn position(&self, anchor: &Anchor) -> Vec3 {
        let points: Vec<Vec3> = match anchor {
            Anchor::Bones(names) => {
                let bones = self.rig.skeleton.bones.iter();
                let named = bones.filter(|bone| names.contains(&bone.name));
                named.map(|bone| bone.head).collect()
            }
            Anchor::Vertices(vertices) => {
                let at = |&vertex: &u32| self.rig.mesh.positions[vertex as usize];
                vertices.iter().map(at).collect()
            }
        };
        points.iter().sum::<Vec3>() / points.len().max(1) as f32
    }

    /// Whether a mean of vertices can follow the anchor, as training will need it to.
    fn can_follow(&self, figure: &Figure, joint: &Joint, anchor: &Anchor) -> bool {
        let mut only = figure.clone();
        only.joints = vec![Joint {
            anchor: anchor.clone(),
            ..joint.clone()
        }];
        regressor(&only, self.rig).is_ok()
    }

    /// The vertices that follow one of the bones more than any other.
    fn surface_of(&self, bones: &[usize]) -> Vec<u32> {
        let mostly = |list: &Vec<(u16, f32)>| {
            list.first()
                .is_some_and(|&(bone, _)| bones.contains(&usize::from(bone)))
        };
        (0_u32..)
            .zip(&self.rig.influences)
            .filter(|(_, list)| mostly(list))
            .map(|(vertex, _)| vertex)
            .collect()
    }

    fn nearest(&self, point: Vec3) -> Vec<u32> {
        let all = 0..self.rig.mesh.positions.len() as u32;
        self.first_by(all.collect(), END_VERTICES, |at| at.distance(point))
    }

    fn end(&self, bone: usize) -> Vec<u32> {
        let head = self.rig.skeleton.bones[bone].head;
        let surface = self.surface_of(&self.body.below(bone));
        let share = (END_SHARE * surface.len() as f32) as usize;
        self.first_by(surface, share.clamp(3, END_VERTICES), |at| {
            -at.distance(head)
        })
    }

    /// The vertices of which a measure is smallest.
    fn first_by(
        &self,
        vertices: Vec<u32>,
        count: usize,
        measure: impl Fn(Vec3) -> f32,
    ) -> Vec<u32> {
        let mut measured: Vec<(f32, u32)> = vertices
            .into_iter()
            .map(|v| (measure(self.rig.mesh.positions[v as usize]), v))
            .collect();
        measured.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut first: Vec<u32> = measured.iter().take(count).map(|(_, v)| *v).collect();
        first.sort_unstable();
        first
    }

    fn forehead(&self, head: usize, face: Face) -> Vec<u32> {
        let profile = self.profile(&self.surface_of(&self.body.below(head)));
        let at = |vertex: &u32| self.rig.mesh.positions[*vertex as usize];
        let (from, toward) = match face {
            Face::Flat(rise_rad) => {
                let (sin, cos) = rise_rad.sin_cos();
                let low = profile.iter().map(at).fold(Vec3::INFINITY, Vec3::min);
                let high = profile.iter().map(at).fold(Vec3::NEG_INFINITY, Vec3::max);
                ((low + high) / 2.0, cos * self.forward + sin * Vec3::Y)
            }
            Face::Muzzle(turn_rad) => {
                let (sin, cos) = turn_rad.sin_cos();
                let from = self.rig.skeleton.bones[head].head;
                let out = |vertex: &u32| (at(vertex) - from).reject_from(self.symmetry.across);
                let nose = profile
                    .iter()
                    .map(out)
                    .filter(|out| out.dot(self.forward) > 0.0)
                    .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
                    .and_then(Vec3::try_normalize)
                    .unwrap_or(self.forward);
                let up = nose.cross(-self.forward.cross(Vec3::Y));
                (from, cos * nose + sin * up)
            }
        };
        let count = (profile.len() / 4).clamp(3, END_VERTICES);
        let mut vertices = facing(&self.rig.mesh.positions, profile, from, toward);
        vertices.truncate(count);
        vertices.sort_unstable();
        vertices
    }

    /// Those of a head's vertices that are about on the plane of the body.
    fn profile(&self, head: &[u32]) -> Vec<u32> {
        let away = |vertex: u32| {
            let at = self.rig.mesh.positions[vertex as usize];
            self.symmetry.away_m(at).abs()
        };
        let widest = head.iter().map(|&v| away(v)).fold(0.0, f32::max);
        let within = |share: f32| -> Vec<u32> {
            let near = head.iter().copied();
            near.filter(|&v| away(v) <= share * widest).collect()
        };
        let enough = |profile: &Vec<u32>| profile.len() >= PROFILE_VERTICES;
        PROFILE
            .into_iter()
            .map(within)
            .find(enough)
            .unwrap_or_else(|| head.to_vec())
    }
}

/// Every so many of a list, so that no more than [`VERTICES`] are left.
fn thinned(vertices: &[u32]) -> Vec<u32> {
    let step = vertices.len().div_ceil(VERTICES).max(1);
    vertices.iter().copied().step_by(step).collect()
}
