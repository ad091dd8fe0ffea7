//! Iterative closest point: the rigid motion that lays one mesh on another.
//!
//! Besl and McKay, "Method for registration of 3-D shapes" (1992), which the paper takes for sketches in turns that were
//! not trained (section 5.2); the rotation in closed form after Arun, Huang and Blostein (1987).

use glam::{Mat3, Vec3};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// Points of the moved mesh that look for their closest ones.
const POINTS: usize = 1500;
const ROUNDS: usize = 40;
/// A mean distance that falls by less than this from round to round is there, metres.
const STILL_M: f32 = 1e-6;

/// `mesh` moved rigidly so that its points are as close as can be to those of `target`, metres.
pub(super) fn aligned(mesh: &[Vec3], target: &[Vec3]) -> Vec<Vec3> {
    let step = mesh.len().div_ceil(POINTS).max(1);
    let points: Vec<Vec3> = mesh.iter().step_by(step).copied().collect();
    let (mut turn, mut shift) = (Mat3::IDENTITY, Vec3::ZERO);
    let mut before = f32::INFINITY;
    for _ in 0..ROUNDS {
        let moved: Vec<Vec3> = points.iter().map(|p| turn * *p + shift).collect();
        let closest: Vec<Vec3> = moved.par_iter().map(|p| nearest(*p, target)).collect();
        let distances = moved.iter().zip(&closest).map(|(a, b)| a.distance(*b));
        let mean = distances.sum::<f32>() / points.len().max(1) as f32;
        if before - mean < STILL_M {
            break;
        }
        before = mean;
        (turn, shift) = rigid(&points, &closest);
    }
    mesh.iter().map(|p| turn * *p + shift).collect()
}

fn nearest(point: Vec3, target: &[Vec3]) -> Vec3 {
    let mut best = (f32::INFINITY, point);
    for candidate in target {
        let distance = candidate.distance_squared(point);
        if distance < best.0 {
            best = (distance, *candidate);
        }
    }
    best.1
}

/// The rotation and the shift that bring `from` closest to `to`, least squares, point by point.
fn rigid(from: &[Vec3], to: &[Vec3]) -> (Mat3, Vec3) {
    let count = from.len().max(1) as f32;
    let centre = |list: &[Vec3]| list.iter().sum::<Vec3>() / count;
    let (a, b) = (centre(from), centre(to));
    let vector = |p: Vec3| Vector3::from(p.as_dvec3().to_array());
    let mut covariance = Matrix3::<f64>::zeros();
    for (p, q) in from.iter().zip(to) {
        covariance += vector(*q - b) * vector(*p - a).transpose();
    }
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return (Mat3::IDENTITY, b - a);
    };
    // A mirror image is no motion: the smallest singular value is the last.
    let sign = (u * v_t).determinant().signum();
    let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    let turn = Mat3::from_cols_array(&std::array::from_fn(|i| rotation.as_slice()[i] as f32));
    (turn, b - turn * a)
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    /// A lopsided blob.
    fn blob() -> Vec<Vec3> {
        (0..2000)
            .map(|i| {
                let (a, b) = (i as f32 * 0.37, i as f32 * 0.011);
                let r = 1.0 + 0.3 * (3.0 * a).sin() * b.cos();
                Vec3::new(
                    0.6 * r * a.cos() * b.sin(),
                    1.4 * r * b.cos(),
                    r * a.sin() * b.sin() + 0.2 * b,
                )
            })
            .collect()
    }

    #[test]
    fn a_moved_shape_is_laid_back() {
        let target = blob();
        let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.15, -0.2, 0.1);
        let moved: Vec<Vec3> = target
            .iter()
            .map(|p| turn * *p + Vec3::new(0.05, -0.08, 0.03))
            .collect();
        let far = moved
            .iter()
            .zip(&target)
            .map(|(a, b)| a.distance(*b))
            .sum::<f32>();
        let back = aligned(&moved, &target);
        let near = back
            .iter()
            .zip(&target)
            .map(|(a, b)| a.distance(*b))
            .sum::<f32>();
        assert!(near < 0.02 * far, "{near} {far}");
    }

    #[test]
    fn lengths_stay() {
        let target: Vec<Vec3> = blob().iter().map(|p| *p * 1.3).collect();
        let mesh = blob();
        let found = aligned(&mesh, &target);
        let length = |mesh: &[Vec3]| mesh[3].distance(mesh[900]);
        assert!((length(&found) / length(&mesh) - 1.0).abs() < 1e-4);
    }
}
