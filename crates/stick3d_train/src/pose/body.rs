//! The body as a few rigid parts: capsules for running into itself, outermost points for the ground.

use std::collections::BTreeSet;

use glam::{Quat, Vec3};
use nalgebra::Matrix3;

use super::error::{PoseError, hint};
use super::spec::{ControlsSpec, Half, PartSpec};
use crate::rig::{Rig, Skeleton};

/// The fewest vertices that a part is fitted to.
pub(super) const LEAST_VERTICES: usize = 8;

/// Directions in which a part's outermost vertices are looked for.
const DIRECTIONS: usize = 96;

/// A rigid piece of the body, fitted to the vertices that mostly follow its bones.
///
/// Points are offsets from the head of its bone, model space at rest, metres.
#[derive(Debug, Clone)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// The bone that carries it.
    pub bone: usize,
    /// Both ends of the capsule's middle line.
    pub segment: [Vec3; 2],
    /// The capsule's radius, metres.
    pub radius_m: f32,
    /// Outermost vertices in all directions.
    pub hull: Vec<Vec3>,
    /// Volume of the capsule, cubic metres: stands for the mass.
    pub volume_m3: f32,
}

/// Two parts that run into each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// Index of the first part.
    pub first: usize,
    /// Index of the second part.
    pub second: usize,
    /// How deep, metres.
    pub depth_m: f32,
}

/// The parts of one rig, and which of them may overlap.
#[derive(Debug, Clone)]
pub struct Body {
    parts: Vec<Part>,
    /// Pairs to be tested for running into each other.
    tested: Vec<(usize, usize)>,
    allowed_overlap_m: f32,
}

impl Body {
    /// Fits the parts of a file of controls to a rig.
    pub(super) fn fit(rig: &Rig, spec: &ControlsSpec) -> Result<Self, PoseError> {
        let mut parts: Vec<Part> = Vec::new();
        for part in &spec.parts {
            for &half in Half::of(&part.name) {
                parts.push(fit_part(rig, part, half)?);
            }
        }
        let mut body = Self {
            tested: Vec::new(),
            allowed_overlap_m: spec.overlap_m,
            parts,
        };
        let mut exempt = BTreeSet::new();
        for (first, second) in &spec.may_overlap {
            for &half in Half::of(&format!("{first}{second}")) {
                let pair = (
                    body.index(&half.name(first))?,
                    body.index(&half.name(second))?,
                );
                exempt.insert((pair.0.min(pair.1), pair.0.max(pair.1)));
            }
        }
        for second in 0..body.parts.len() {
            for first in 0..second {
                let joined = joined(&rig.skeleton, &body.parts, first, second);
                if !joined && !exempt.contains(&(first, second)) {
                    body.tested.push((first, second));
                }
            }
        }
        Ok(body)
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The index of a part.
    ///
    /// # Errors
    /// [`PoseError::Inconsistent`] with the nearest valid name.
    pub fn index(&self, name: &str) -> Result<usize, PoseError> {
        self.parts
            .iter()
            .position(|part| part.name == name)
            .ok_or_else(|| {
                let names = self.parts.iter().map(|part| part.name.as_str());
                let why = format!(
                    "there is no part `{name}` of the body; {}",
                    hint(name, names)
                );
                PoseError::inconsistent("parts", why)
            })
    }

    /// The height of the lowest point of all parts, metres.
    pub fn lowest_m(&self, transforms: &[(Quat, Vec3)]) -> f32 {
        (0..self.parts.len())
            .map(|i| self.lowest_of_m(i, transforms))
            .fold(f32::INFINITY, f32::min)
    }

    /// The height of the lowest point of one part, metres.
    pub fn lowest_of_m(&self, part: usize, transforms: &[(Quat, Vec3)]) -> f32 {
        let part = &self.parts[part];
        let (rotation, head) = transforms[part.bone];
        let up = rotation.inverse() * Vec3::Y;
        part.hull
            .iter()
            .map(|p| up.dot(*p))
            .fold(f32::INFINITY, f32::min)
            + head.y
    }

    /// The middle of a part, model space, metres.
    pub fn middle(&self, part: usize, transforms: &[(Quat, Vec3)]) -> Vec3 {
        let [a, b] = self.segment(part, transforms);
        (a + b) / 2.0
    }

    /// The centre of mass, if flesh were equally heavy everywhere, metres.
    pub fn centre_of_mass(&self, transforms: &[(Quat, Vec3)]) -> Vec3 {
        let mut sum = (Vec3::ZERO, 0.0);
        for (index, part) in self.parts.iter().enumerate() {
            sum.0 += self.middle(index, transforms) * part.volume_m3;
            sum.1 += part.volume_m3;
        }
        sum.0 / sum.1
    }

    fn segment(&self, part: usize, transforms: &[(Quat, Vec3)]) -> [Vec3; 2] {
        let part = &self.parts[part];
        let (rotation, head) = transforms[part.bone];
        part.segment.map(|end| head + rotation * end)
    }

    /// How deep parts may run into each other, metres.
    pub fn allowed_overlap_m(&self) -> f32 {
        self.allowed_overlap_m
    }

    /// All pairs of parts that run deeper than `allowed_m` into each other, where they should not.
    pub fn overlaps(&self, transforms: &[(Quat, Vec3)], allowed_m: f32) -> Vec<Overlap> {
        let segments: Vec<[Vec3; 2]> = (0..self.parts.len())
            .map(|part| self.segment(part, transforms))
            .collect();
        let mut overlaps = Vec::new();
        for &(first, second) in &self.tested {
            let reach = self.parts[first].radius_m + self.parts[second].radius_m;
            let depth_m = reach - segment_distance(segments[first], segments[second]);
            if depth_m > allowed_m {
                overlaps.push(Overlap {
                    first,
                    second,
                    depth_m,
                });
            }
        }
        overlaps
    }
}

/// Whether one part's bone carries the other's, with no third part in between.
fn joined(skeleton: &Skeleton, parts: &[Part], first: usize, second: usize) -> bool {
    let carrier = |part: usize| {
        let mut at = skeleton.bones[parts[part].bone].parent;
        while let Some(bone) = at {
            if let Some(found) = parts.iter().position(|other| other.bone == bone) {
                return Some(parts[found].bone);
            }
            at = skeleton.bones[bone].parent;
        }
        None
    };
    let bones = (parts[first].bone, parts[second].bone);
    bones.0 == bones.1 || carrier(first) == Some(bones.1) || carrier(second) == Some(bones.0)
}

/// The vertices that mostly follow these bones, as offsets from the head of the first.
pub(super) fn followers(rig: &Rig, bones: &[usize]) -> Vec<Vec3> {
    let head = bones
        .first()
        .map_or(Vec3::ZERO, |bone| rig.skeleton.bones[*bone].head);
    let followed = |list: &[(u16, f32)]| -> f32 {
        list.iter()
            .filter(|(b, _)| bones.contains(&usize::from(*b)))
            .map(|(_, w)| w)
            .sum()
    };
    rig.influences
        .iter()
        .zip(&rig.mesh.positions)
        .filter(|(list, _)| followed(list) > 0.5)
        .map(|(_, p)| *p - head)
        .collect()
}

fn fit_part(rig: &Rig, spec: &PartSpec, half: Half) -> Result<Part, PoseError> {
    let bone = rig.skeleton.bone_index(&half.name(&spec.bone))?;
    let mut bones = vec![bone];
    for name in &spec.with {
        bones.push(rig.skeleton.bone_index(&half.name(name))?);
    }
    let points = followers(rig, &bones);
    let name = half.name(&spec.name);
    if points.len() < LEAST_VERTICES {
        let why = format!(
            "only {} vertices follow its bones; at least {LEAST_VERTICES} must",
            points.len()
        );
        return Err(PoseError::inconsistent(format!("part `{name}`"), why));
    }
    let (segment, radius_m) = fit_capsule(&points, spec.slim);
    let length = segment[0].distance(segment[1]);
    let volume_m3 = std::f32::consts::PI * radius_m * radius_m * (length + radius_m * 4.0 / 3.0);
    Ok(Part {
        name,
        bone,
        segment,
        radius_m,
        hull: hull(&points),
        volume_m3,
    })
}

/// The capsule along the points' longest direction: it holds most of them, but not their bumps.
fn fit_capsule(points: &[Vec3], slim: f32) -> ([Vec3; 2], f32) {
    let mean = points.iter().sum::<Vec3>() / points.len() as f32;
    let mut covariance = Matrix3::<f32>::zeros();
    for point in points {
        let d = nalgebra::Vector3::from((*point - mean).to_array());
        covariance += d * d.transpose();
    }
    let eigen = covariance.symmetric_eigen();
    let longest = eigen.eigenvalues.imax();
    let axis = eigen.eigenvectors.column(longest);
    let axis = Vec3::new(axis[0], axis[1], axis[2]).normalize();
    let quantile = |mut values: Vec<f32>, q: f32| {
        values.sort_by(f32::total_cmp);
        values[((values.len() - 1) as f32 * q) as usize]
    };
    let along: Vec<f32> = points.iter().map(|p| (*p - mean).dot(axis)).collect();
    let across = points
        .iter()
        .map(|p| (*p - mean).reject_from_normalized(axis).length())
        .collect();
    let radius = quantile(across, 0.6) * slim;
    let from = quantile(along.clone(), 0.02) + radius;
    let to = quantile(along, 0.98) - radius;
    let (from, to) = if from < to {
        (from, to)
    } else {
        ((from + to) / 2.0, (from + to) / 2.0)
    };
    ([mean + axis * from, mean + axis * to], radius)
}

/// The outermost points in directions spread evenly over the sphere.
fn hull(points: &[Vec3]) -> Vec<Vec3> {
    let golden = std::f32::consts::PI * (3.0 - 5.0_f32.sqrt());
    let outermost: BTreeSet<usize> = (0..DIRECTIONS)
        .filter_map(|i| {
            let y = 1.0 - 2.0 * (i as f32 + 0.5) / DIRECTIONS as f32;
            let (sin, cos) = (golden * i as f32).sin_cos();
            let r = (1.0 - y * y).sqrt();
            let direction = Vec3::new(r * cos, y, r * sin);
            (0..points.len()).max_by(|&a, &b| {
                points[a]
                    .dot(direction)
                    .total_cmp(&points[b].dot(direction))
            })
        })
        .collect();
    outermost.into_iter().map(|i| points[i]).collect()
}

/// The shortest distance between two line segments (Ericson, Real-Time Collision Detection, 5.1.9).
fn segment_distance([p1, q1]: [Vec3; 2], [p2, q2]: [Vec3; 2]) -> f32 {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, f) = (d1.dot(d1).max(1e-12), d2.dot(d2).max(1e-12), d2.dot(r));
    let (b, c) = (d1.dot(d2), d1.dot(r));
    let denominator = a * e - b * b;
    let mut s = if denominator > 1e-9 {
        ((b * f - c * e) / denominator).clamp(0.0, 1.0)
    } else {
        0.5
    };
    let t = ((b * s + f) / e).clamp(0.0, 1.0);
    s = ((b * t - c) / a).clamp(0.0, 1.0);
    (p1 + d1 * s).distance(p2 + d2 * t)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn any_point() -> impl Strategy<Value = Vec3> {
        proptest::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from_array)
    }

    proptest! {
        #[test]
        fn segments_are_as_near_as_their_nearest_points(
            p1 in any_point(), q1 in any_point(), p2 in any_point(), q2 in any_point(),
        ) {
            let found = segment_distance([p1, q1], [p2, q2]);
            let mut sampled = f32::INFINITY;
            for i in 0..=60 {
                for j in 0..=60 {
                    let (s, t) = (i as f32 / 60.0, j as f32 / 60.0);
                    sampled = sampled.min(p1.lerp(q1, s).distance(p2.lerp(q2, t)));
                }
            }
            prop_assert!(found <= sampled + 1e-4, "{found} > {sampled}");
            prop_assert!(found >= sampled - 0.08, "{found} < {sampled}");
        }
    }
}
