//! Optimised centres of rotation: the point that each vertex turns about where bones meet.
//!
//! Le, Hodgins, "Real-time Skeletal Skinning with Optimized Centers of Rotation", ACM Transactions on
//! Graphics 35 (2016), equations 1 and 4: the centre of vertex i is the mean of the surface over all
//! points that follow the same bones in a like proportion.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use stick3d_figure::TriangleMesh;

/// How alike two proportions must be (sigma in the paper).
const WIDTH: f64 = 0.1;

/// A triangle that follows two bones: centroid weighted by area, area, and the two weights.
struct Shared {
    moment: DVec3,
    area: f64,
    weights: (f64, f64),
}

/// One centre per vertex, model space at rest. A vertex that follows one bone only is its own centre.
pub(super) fn centers_of_rotation(
    mesh: &TriangleMesh,
    influences: &[Vec<(u16, f32)>],
) -> Vec<Vec3> {
    let shared = triangles_by_bones(mesh, influences);
    mesh.positions
        .par_iter()
        .zip(influences)
        .map(|(&position, list)| {
            let (mut moment, mut mass) = (DVec3::ZERO, 0.0);
            for ((first, second), (w, v)) in pairs(list) {
                for triangle in shared.get(&(first, second)).into_iter().flatten() {
                    let (t, u) = triangle.weights;
                    let unlike = (w * u - v * t) / WIDTH;
                    let alike = w * v * t * u * (-unlike * unlike).exp();
                    moment += alike * triangle.moment;
                    mass += alike * triangle.area;
                }
            }
            if mass > 1e-12 {
                (moment / mass).as_vec3()
            } else {
                position
            }
        })
        .collect()
}

/// The triangles that follow both bones of a pair, for every pair that occurs.
fn triangles_by_bones(
    mesh: &TriangleMesh,
    influences: &[Vec<(u16, f32)>],
) -> BTreeMap<(u16, u16), Vec<Shared>> {
    let mut shared: BTreeMap<(u16, u16), Vec<Shared>> = BTreeMap::new();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize].as_dvec3());
        let area = (b - a).cross(c - a).length() / 2.0;
        let moment = (a + b + c) / 3.0 * area;
        let mut mean: BTreeMap<u16, f32> = BTreeMap::new();
        for &(bone, weight) in corners
            .iter()
            .flat_map(|&corner| &influences[corner as usize])
        {
            *mean.entry(bone).or_default() += weight / 3.0;
        }
        let mean: Vec<(u16, f32)> = mean.into_iter().collect();
        for (bones, weights) in pairs(&mean) {
            shared.entry(bones).or_default().push(Shared {
                moment,
                area,
                weights,
            });
        }
    }
    shared
}

/// All pairs of bones of a list, the smaller number first, with their weights.
fn pairs(list: &[(u16, f32)]) -> impl Iterator<Item = ((u16, u16), (f64, f64))> {
    list.iter().enumerate().flat_map(move |(rank, &left)| {
        list[rank + 1..].iter().map(move |&right| {
            let (low, high) = if left.0 < right.0 {
                (left, right)
            } else {
                (right, left)
            };
            ((low.0, high.0), (f64::from(low.1), f64::from(high.1)))
        })
    })
}
