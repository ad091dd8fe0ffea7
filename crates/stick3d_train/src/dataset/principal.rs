//! The shape of a figure without a rig: principal components of its meshes.
//!
//! One component is a number per vertex, shared by x, y and z, so that turning a mesh is turning its code. The samples
//! are therefore the three coordinate functions of every mesh, and their mean is left in: meshes are turned, and a turned
//! mean must be held too. There are far fewer samples than vertices, so the components come from the samples' Gram
//! matrix, exactly.

use glam::Vec3;
use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;
use stick3d_figure::regressor::JointRegressor;
use stick3d_model::final_layer::{BasisLayer, FinalLayer};

use super::{BasisError, Shape};

/// Components below this share of the strongest's variance are noise: a tenth of a millimetre beside a metre.
const LEAST_SHARE: f64 = 1e-8;

/// The most meshes that the components are found from; of more, as many are taken, evenly spread.
const MOST_MESHES: usize = 400;

/// The shape whose codes are coefficients of at most `components` principal components of `meshes`, which are centred on
/// the root joint and have equally many vertices.
///
/// The columns are orthonormal under the mean over the vertices: a distance between codes is the root mean square
/// distance between vertices.
///
/// # Errors
/// [`BasisError::NoPoses`] without meshes, [`BasisError::Degenerate`] when all vertices are at one place.
pub fn principal_shape(
    regressor: &JointRegressor,
    meshes: &[Vec<Vec3>],
    components: usize,
) -> Result<Shape, BasisError> {
    let taken = meshes.len().min(MOST_MESHES);
    let samples: Vec<&[Vec3]> = (0..taken)
        .map(|i| meshes[i * meshes.len() / taken].as_slice())
        .collect();
    let vertex_count = samples.first().ok_or(BasisError::NoPoses)?.len();
    let eigen = SymmetricEigen::new(gram(&samples));
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let largest = eigen.eigenvalues[order[0]];
    if !(largest.is_finite() && largest > 0.0) {
        return Err(BasisError::Degenerate);
    }
    order.retain(|i| eigen.eigenvalues[*i] > LEAST_SHARE * largest);
    order.truncate(components.max(1));
    let columns: Vec<f32> = order
        .par_iter()
        .flat_map_iter(|&i| {
            let direction: Vec<f64> = eigen.eigenvectors.column(i).iter().copied().collect();
            // An eigenvector and its opposite serve alike; one of them is always taken.
            let leading = direction
                .iter()
                .fold(0.0_f64, |a, b| if b.abs() > a.abs() { *b } else { a });
            let factor = leading.signum() / eigen.eigenvalues[i].sqrt();
            column(&samples, &direction, factor, vertex_count)
        })
        .collect();
    let layer = FinalLayer::Basis(BasisLayer::new(vertex_count, columns)?);
    Ok(Shape::new(layer, regressor))
}

/// Inner products of all samples' coordinate functions, mean over the vertices: sample `3 · mesh + axis`.
fn gram(samples: &[&[Vec3]]) -> DMatrix<f64> {
    let rows: Vec<Vec<[[f64; 3]; 3]>> = (0..samples.len())
        .into_par_iter()
        .map(|i| (0..=i).map(|j| products(samples[i], samples[j])).collect())
        .collect();
    DMatrix::from_fn(3 * samples.len(), 3 * samples.len(), |row, column| {
        let (i, a, j, b) = (row / 3, row % 3, column / 3, column % 3);
        if i >= j {
            rows[i][j][a][b]
        } else {
            rows[j][i][b][a]
        }
    })
}

fn products(left: &[Vec3], right: &[Vec3]) -> [[f64; 3]; 3] {
    let mut sums = [[0.0; 3]; 3];
    for (l, r) in left.iter().zip(right) {
        let (l, r) = (l.as_dvec3().to_array(), r.as_dvec3().to_array());
        for (sums, l) in sums.iter_mut().zip(l) {
            for (sum, r) in sums.iter_mut().zip(r) {
                *sum += l * r;
            }
        }
    }
    sums.map(|row| row.map(|sum| sum / left.len() as f64))
}

fn column(samples: &[&[Vec3]], direction: &[f64], factor: f64, vertex_count: usize) -> Vec<f32> {
    let mut column = vec![0.0_f64; vertex_count];
    for (sample, along) in samples.iter().zip(direction.chunks_exact(3)) {
        let along = glam::DVec3::from_slice(along);
        for (entry, position) in column.iter_mut().zip(*sample) {
            *entry += along.dot(position.as_dvec3());
        }
    }
    column.into_iter().map(|x| (factor * x) as f32).collect()
}

#[cfg(test)]
mod tests {
    use glam::Quat;
    use rand::Rng as _;

    use super::*;
    use crate::dataset::random;

    /// Blends of three random clouds about one, in any turn.
    fn clouds(count: usize) -> Vec<Vec<Vec3>> {
        let mut rng = random(4, "clouds", 0);
        let mut cloud = || -> Vec<Vec3> {
            let mut number = || rng.random::<f32>() - 0.5;
            (0..50)
                .map(|_| Vec3::new(number(), number(), number()))
                .collect()
        };
        let basic: [Vec<Vec3>; 3] = std::array::from_fn(|_| cloud());
        let mut rng = random(5, "blends", 0);
        let blend = |_| {
            let [a, b, yaw] = [0; 3].map(|_| rng.random::<f32>());
            let turn = Quat::from_rotation_y(6.0 * yaw);
            let mut mesh: Vec<Vec3> = (0..50)
                .map(|v| turn * (basic[0][v] + a * basic[1][v] + b * basic[2][v]))
                .collect();
            let root = mesh[7];
            mesh.iter_mut().for_each(|point| *point -= root);
            mesh
        };
        (0..count).map(blend).collect()
    }

    fn regressor() -> JointRegressor {
        JointRegressor {
            rows: vec![vec![(7, 1.0)], vec![(1, 0.5), (2, 0.5)]],
        }
    }

    fn code(shape: &Shape, mesh: &[Vec3]) -> Vec<f32> {
        shape.layer().project(mesh).unwrap()
    }

    #[test]
    fn components_hold_what_the_meshes_are_made_of() {
        let meshes = clouds(12);
        // Three clouds of three coordinates each span nine dimensions, however they are turned and mixed.
        let shape = principal_shape(&regressor(), &meshes[..9], 50).unwrap();
        assert_eq!(shape.code_columns(), 9);
        assert!(shape.rotations().is_none());
        let fresh = meshes[9..]
            .iter()
            .map(|mesh| (mesh.clone(), code(&shape, mesh)));
        let fit = shape.measure(fresh);
        assert!(fit.max_m < 1e-5, "{fit:?}");
        let coarse = principal_shape(&regressor(), &meshes[..9], 4).unwrap();
        assert_eq!(coarse.code_columns(), 4);
        let fresh = meshes[9..]
            .iter()
            .map(|mesh| (mesh.clone(), code(&coarse, mesh)));
        assert!(coarse.measure(fresh).mean_m > 0.01);
    }

    #[test]
    fn codes_measure_distances_and_give_joints() {
        let meshes = clouds(8);
        let shape = principal_shape(&regressor(), &meshes, 50).unwrap();
        let [a, b] = [&meshes[1], &meshes[6]];
        let squares: f32 = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).sum();
        let between = (squares / a.len() as f32).sqrt();
        let codes = [code(&shape, a), code(&shape, b)];
        let squares: f32 = codes[0]
            .iter()
            .zip(&codes[1])
            .map(|(a, b)| (a - b).powi(2))
            .sum();
        assert!((squares.sqrt() - between).abs() < 1e-4);
        let joints = shape.joints(&codes[0]);
        for (found, expected) in joints.iter().zip(regressor().joints(a)) {
            assert!(found.distance(expected) < 1e-5);
        }
    }

    #[test]
    fn meshes_without_shape_have_no_components() {
        let none = principal_shape(&regressor(), &[], 4);
        assert!(matches!(none, Err(BasisError::NoPoses)));
        let still = principal_shape(&regressor(), &vec![vec![Vec3::ZERO; 9]; 3], 4);
        assert!(matches!(still, Err(BasisError::Degenerate)));
    }
}
