//! The measures: distances between meshes, joints, drawings and bones.

use glam::Vec3;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use stick3d_figure::figure::Figure;

use super::spread::Spread;
use crate::dataset::rounded;

/// How far meshes are from the truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// How many meshes were compared.
    pub cases: usize,
    /// Distance between a vertex and where it should be: mean, centimetres.
    pub vertex_mean_cm: f64,
    /// Its standard deviation.
    pub vertex_std_cm: f64,
    /// 95 of 100 vertices are closer.
    pub vertex_p95_cm: f64,
    /// The mean in normalised units: half of the rest mesh's largest extent is 1.
    pub vertex_mean_normalised: f64,
    /// Mean squared error of a coordinate, normalised units.
    pub mse_normalised: f64,
    /// Mean distance between joints (mean per-joint position error), millimetres.
    pub mpjpe_mm: f64,
    /// The same after the best similarity (rotation, shift, scale) of each case's joints.
    pub pa_mpjpe_mm: f64,
    /// Mean distance between joints on the sketch plane, against the true body (not the disturbed drawing), centimetres.
    pub reprojection_cm: f64,
    /// Mean angle between a bone and the true one, degrees.
    pub bone_direction_deg: f64,
    /// Mean error of a bone's length, per cent of the true length.
    pub bone_length_percent: f64,
    /// 95 of 100 bones are closer.
    pub bone_length_p95_percent: f64,
}

/// Gathers cases for [`Metrics`].
#[derive(Debug, Clone, Default)]
pub struct Collector {
    cases: usize,
    vertex_m: Spread,
    joint_m: Spread,
    aligned_joint_m: Spread,
    flat_m: Spread,
    bone_turn_rad: Spread,
    bone_share: Spread,
}

impl Collector {
    /// Adds a case: vertices and joints found, and the true ones; metres, both centred on the root joint.
    pub fn add(&mut self, figure: &Figure, found: (&[Vec3], &[Vec3]), truth: (&[Vec3], &[Vec3])) {
        let ((mesh, joints), (true_mesh, true_joints)) = (found, truth);
        self.cases += 1;
        for (vertex, truth) in mesh.iter().zip(true_mesh) {
            self.vertex_m.add(vertex.distance(*truth));
        }
        for (joint, truth) in joints.iter().zip(true_joints) {
            self.joint_m.add(joint.distance(*truth));
            let flat = joint.truncate().distance(truth.truncate());
            self.flat_m.add(flat);
        }
        let aligned = procrustes_mean_distance(joints, true_joints);
        self.aligned_joint_m.add(aligned as f32);
        for &[a, b] in &figure.bones {
            let (bone, truth) = (joints[b] - joints[a], true_joints[b] - true_joints[a]);
            let length = truth.length().max(f32::EPSILON);
            self.bone_share.add((bone.length() - length).abs() / length);
            self.bone_turn_rad.add(angle_rad(bone, truth));
        }
    }

    /// How many cases were added.
    #[must_use]
    pub fn cases(&self) -> usize {
        self.cases
    }

    /// Adds the cases of another collector.
    pub fn merge(&mut self, other: &Self) {
        self.cases += other.cases;
        self.vertex_m.merge(&other.vertex_m);
        self.joint_m.merge(&other.joint_m);
        self.aligned_joint_m.merge(&other.aligned_joint_m);
        self.flat_m.merge(&other.flat_m);
        self.bone_turn_rad.merge(&other.bone_turn_rad);
        self.bone_share.merge(&other.bone_share);
    }

    /// The measures; all 0 when there is no case. `extent_m` is the unit of the normalised ones.
    #[must_use]
    pub fn metrics(&self, extent_m: f32) -> Metrics {
        let extent = f64::from(extent_m);
        let vertex = &self.vertex_m;
        Metrics {
            cases: self.cases,
            vertex_mean_cm: rounded(100.0 * vertex.mean()),
            vertex_std_cm: rounded(100.0 * vertex.deviation()),
            vertex_p95_cm: rounded(100.0 * vertex.percentile(95.0)),
            vertex_mean_normalised: rounded(vertex.mean() / extent),
            mse_normalised: rounded(vertex.mean_square() / (3.0 * extent * extent)),
            mpjpe_mm: rounded(1000.0 * self.joint_m.mean()),
            pa_mpjpe_mm: rounded(1000.0 * self.aligned_joint_m.mean()),
            reprojection_cm: rounded(100.0 * self.flat_m.mean()),
            bone_direction_deg: rounded(self.bone_turn_rad.mean().to_degrees()),
            bone_length_percent: rounded(100.0 * self.bone_share.mean()),
            bone_length_p95_percent: rounded(100.0 * self.bone_share.percentile(95.0)),
        }
    }
}

/// The angle between two directions; a right one where either has no length and so says nothing.
fn angle_rad(a: Vec3, b: Vec3) -> f32 {
    let (cross, dot) = (a.cross(b).length(), a.dot(b));
    if cross == 0.0 && dot == 0.0 {
        return std::f32::consts::FRAC_PI_2;
    }
    cross.atan2(dot)
}

/// Mean distance between two point lists after moving the first by the similarity that brings it closest in the least squares sense.
///
/// Source: Umeyama, "Least-squares estimation of transformation parameters between two point patterns", IEEE PAMI 13 (1991).
#[must_use]
pub fn procrustes_mean_distance(points: &[Vec3], target: &[Vec3]) -> f64 {
    let vector = |p: &Vec3| Vector3::new(f64::from(p.x), f64::from(p.y), f64::from(p.z));
    let count = points.len().max(1) as f64;
    let centre = |list: &[Vec3]| list.iter().map(vector).sum::<Vector3<f64>>() / count;
    let (from, to) = (centre(points), centre(target));
    let mut covariance = Matrix3::zeros();
    let mut spread = 0.0;
    for (p, t) in points.iter().zip(target) {
        let (p, t) = (vector(p) - from, vector(t) - to);
        covariance += t * p.transpose();
        spread += p.norm_squared();
    }
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return f64::NAN;
    };
    let mut signs = Vector3::new(1.0, 1.0, 1.0);
    if (u * v_t).determinant() < 0.0 {
        // The smallest singular value is the last: nalgebra sorts them.
        signs.z = -1.0;
    }
    let rotation = u * Matrix3::from_diagonal(&signs) * v_t;
    let scale = if spread > 0.0 {
        svd.singular_values.dot(&signs) / spread
    } else {
        1.0
    };
    let distance =
        |(p, t): (&Vec3, &Vec3)| (scale * rotation * (vector(p) - from) - (vector(t) - to)).norm();
    points.iter().zip(target).map(distance).sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    #[test]
    fn similar_shapes_align_exactly() {
        let target: Vec<Vec3> = (0..11)
            .map(|i| Vec3::new((i * 7 % 5) as f32, (i * 3 % 4) as f32, (i * 5 % 3) as f32))
            .collect();
        let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -1.2, 0.7);
        let moved: Vec<Vec3> = target
            .iter()
            .map(|p| turn * (*p * 0.4) + Vec3::new(1.0, -2.0, 0.5))
            .collect();
        assert!(procrustes_mean_distance(&moved, &target) < 1e-5);
        // A mirror image is no similarity.
        let mirrored: Vec<Vec3> = target.iter().map(|p| Vec3::new(-p.x, p.y, p.z)).collect();
        assert!(procrustes_mean_distance(&mirrored, &target) > 0.1);
    }

    #[test]
    fn measures_of_a_known_shift() {
        let figure = Figure::human();
        let truth: Vec<Vec3> = figure.template.iter().map(|p| p.extend(0.0)).collect();
        let found: Vec<Vec3> = truth
            .iter()
            .map(|p| *p + Vec3::new(0.03, 0.0, 0.04))
            .collect();
        let mut collector = Collector::default();
        collector.add(figure, (&found, &found), (&truth, &truth));
        let metrics = collector.metrics(0.9);
        assert!((metrics.vertex_mean_cm - 5.0).abs() < 1e-3 && metrics.vertex_std_cm < 0.01);
        assert!((metrics.mpjpe_mm - 50.0).abs() < 1e-2 && metrics.pa_mpjpe_mm < 1e-2);
        assert!((metrics.reprojection_cm - 3.0).abs() < 1e-3);
        assert!(metrics.bone_length_percent < 1e-3 && metrics.bone_direction_deg < 1e-3);
        assert!((metrics.vertex_mean_normalised - 0.05 / 0.9).abs() < 1e-5);
        assert!((metrics.mse_normalised - 0.0025 / (3.0 * 0.81)).abs() < 1e-6);
    }

    #[test]
    fn shorter_bones_are_seen() {
        let figure = Figure::human();
        let truth: Vec<Vec3> = figure.template.iter().map(|p| p.extend(0.1)).collect();
        let found: Vec<Vec3> = truth.iter().map(|p| *p * 0.9).collect();
        let mut collector = Collector::default();
        collector.add(figure, (&found, &found), (&truth, &truth));
        let metrics = collector.metrics(0.9);
        assert!((metrics.bone_length_percent - 10.0).abs() < 1e-3);
        assert!((metrics.bone_length_p95_percent - 10.0).abs() < 0.1);
    }

    #[test]
    fn turned_bones_are_seen() {
        let figure = Figure::human();
        let truth: Vec<Vec3> = figure.template.iter().map(|p| p.extend(0.1)).collect();
        let turn = Quat::from_rotation_z(0.3);
        let found: Vec<Vec3> = truth.iter().map(|p| turn * *p).collect();
        let mut collector = Collector::default();
        collector.add(figure, (&found, &found), (&truth, &truth));
        let metrics = collector.metrics(0.9);
        let expected = 0.3_f64.to_degrees();
        assert!((metrics.bone_direction_deg - expected).abs() < 0.01);
        assert!(metrics.bone_length_percent < 1e-3);
        assert_eq!(angle_rad(Vec3::ZERO, Vec3::X), std::f32::consts::FRAC_PI_2);
        assert!((angle_rad(Vec3::X, -Vec3::X) - std::f32::consts::PI).abs() < 1e-6);
    }
}
