//! Sets of registered meshes: one topology, vertex *i* the same point of the body in every mesh, no rig.
//!
//! A set is a folder of OFF, PLY and OBJ files, ordered by name as people count (`mesh2` before `mesh10`). One of them,
//! the *pilot*, gives triangles, colours, size and heading; of the others only positions matter.

mod error;
mod natural;
mod place;

use std::path::{Path, PathBuf};

use glam::Vec3;
use rand::seq::SliceRandom as _;
use rayon::prelude::*;
use stick3d_figure::figure::{Anchor, Figure};
use stick3d_figure::mesh::TriangleMesh;
use stick3d_figure::regressor::JointRegressor;

use crate::dataset::random;
use crate::format::{FileMesh, SourceFormat, read_mesh};
use crate::rig::mean_of;
pub use error::MeshSetError;
pub use place::UpAxis;

/// The colour of meshes whose files have none: a light clay, linear.
const CLAY: [u8; 4] = [168, 158, 146, 255];

/// A mesh of a set.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedMesh {
    /// Its file's name without the folder.
    pub name: String,
    /// One per vertex; metres once the set is [placed](MeshSet::place).
    pub positions: Vec<Vec3>,
}

/// A mesh that was left out because its vertex count is not the set's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Skipped {
    /// Its file's name.
    pub name: String,
    /// How many vertices it has.
    pub vertex_count: usize,
}

/// How a set is read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshSetOptions {
    /// File name of the pilot; the first mesh without it.
    pub pilot: Option<String>,
    /// Leaves meshes with another vertex count out instead of refusing the set.
    pub skip_mismatched: bool,
    /// Which axis of the files points up.
    pub up: UpAxis,
}

/// Registered meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSet {
    /// In the order of their names.
    pub meshes: Vec<NamedMesh>,
    /// Which of them is the pilot.
    pub pilot: usize,
    /// The pilot's triangles.
    pub triangles: Vec<[u32; 3]>,
    /// One per vertex: linear red, green, blue and coverage, 255 = 1.
    pub colors: Vec<[u8; 4]>,
    /// What was left out.
    pub skipped: Vec<Skipped>,
}

impl MeshSet {
    /// Reads a folder. Files that are no meshes by their names, and hidden ones, are passed over.
    ///
    /// # Errors
    /// [`MeshSetError`], which names the file at fault.
    pub fn read(folder: &Path, options: &MeshSetOptions) -> Result<Self, MeshSetError> {
        let paths = mesh_files(folder)?;
        let mut files: Vec<(String, FileMesh)> = paths
            .par_iter()
            .map(|path| Ok((name_of(path), read_mesh(path)?)))
            .collect::<Vec<Result<_, MeshSetError>>>()
            .into_iter()
            .collect::<Result<_, _>>()?;
        for (_, file) in &mut files {
            options.up.turn(&mut file.mesh.positions);
        }
        let expected = expected_count(&files, options)?;
        let (mut skipped, mut kept) = (vec![], vec![]);
        for (name, file) in files {
            let vertex_count = file.mesh.positions.len();
            match vertex_count == expected.count {
                true => kept.push((name, file)),
                false if options.skip_mismatched => skipped.push(Skipped { name, vertex_count }),
                false => {
                    return Err(MeshSetError::Mismatch {
                        file: folder.join(name),
                        found: vertex_count,
                        expected: expected.count,
                        like: expected.name,
                    });
                }
            }
        }
        let folder = folder.to_owned();
        Self::assemble(folder, kept, &expected.name, skipped)
    }

    fn assemble(
        folder: PathBuf,
        mut files: Vec<(String, FileMesh)>,
        pilot: &str,
        skipped: Vec<Skipped>,
    ) -> Result<Self, MeshSetError> {
        let pilot = files
            .iter()
            .position(|(name, _)| name == pilot)
            .unwrap_or(0);
        if files.len() < 2 {
            return Err(MeshSetError::TooFew {
                folder,
                found: files.len(),
            });
        }
        let (name, file) = &mut files[pilot];
        if file.mesh.triangles.is_empty() {
            return Err(MeshSetError::NoTriangles {
                file: folder.join(&*name),
            });
        }
        let (low, high) = file.mesh.bounds();
        if (high - low).max_element() <= 0.0 {
            return Err(MeshSetError::Flat {
                file: folder.join(&*name),
            });
        }
        let triangles = std::mem::take(&mut file.mesh.triangles);
        let count = file.mesh.positions.len();
        let colors = file.colors.take().unwrap_or_else(|| vec![CLAY; count]);
        let named = |(name, file): (String, FileMesh)| NamedMesh {
            name,
            positions: file.mesh.positions,
        };
        Ok(Self {
            meshes: files.into_iter().map(named).collect(),
            pilot,
            triangles,
            colors,
            skipped,
        })
    }

    /// How many vertices every mesh has.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.colors.len()
    }

    /// The pilot with its triangles.
    #[must_use]
    pub fn pilot_mesh(&self) -> TriangleMesh {
        let positions = self.meshes.get(self.pilot);
        TriangleMesh {
            positions: positions.map(|m| m.positions.clone()).unwrap_or_default(),
            triangles: self.triangles.clone(),
        }
    }

    /// Half of the pilot's largest extent.
    #[must_use]
    pub fn extent_m(&self) -> f32 {
        let (low, high) = self.pilot_mesh().bounds();
        (high - low).max_element() / 2.0
    }

    /// Names of a `share` of the meshes, one at least, the pilot never: for the evaluation.
    #[must_use]
    pub fn held_out(&self, seed: u64, share: f32) -> Vec<String> {
        let mut others: Vec<usize> = (0..self.meshes.len())
            .filter(|i| *i != self.pilot)
            .collect();
        let count = (share * self.meshes.len() as f32).round().max(1.0) as usize;
        others.shuffle(&mut random(seed, "held-out meshes", 0));
        others.truncate(count);
        others.sort_unstable();
        others
            .iter()
            .map(|i| self.meshes[*i].name.clone())
            .collect()
    }

    /// The set in two: meshes whose names are not among `held_out`, and those whose names are.
    #[must_use]
    pub fn split_by(&self, held_out: &[String]) -> (Vec<&NamedMesh>, Vec<&NamedMesh>) {
        self.meshes
            .iter()
            .partition(|mesh| !held_out.contains(&mesh.name))
    }
}

/// The joint regressor of a figure whose joints are lists of vertices.
///
/// # Errors
/// [`MeshSetError::Joint`] for a joint that is anchored to bones, or to vertices that do not exist.
pub fn joint_regressor(
    figure: &Figure,
    vertex_count: usize,
) -> Result<JointRegressor, MeshSetError> {
    let row = |joint: &stick3d_figure::figure::Joint| {
        match &joint.anchor {
            Anchor::Vertices(vertices) => mean_of(vertices, vertex_count),
            Anchor::Bones(_) => Err("it is anchored to bones, and meshes have none".to_owned()),
        }
        .map_err(|why| MeshSetError::Joint {
            figure: figure.name.clone(),
            joint: joint.name.clone(),
            why,
        })
    };
    let rows = figure.joints.iter().map(row).collect::<Result<_, _>>()?;
    Ok(JointRegressor { rows })
}

/// The vertex count of a set, and whose it is.
struct Expected {
    count: usize,
    name: String,
}

/// The pilot's count, or without one the most frequent; then the first mesh that has it is the pilot.
fn expected_count(
    files: &[(String, FileMesh)],
    options: &MeshSetOptions,
) -> Result<Expected, MeshSetError> {
    let count_of = |file: &FileMesh| file.mesh.positions.len();
    if let Some(wanted) = &options.pilot {
        return match files.iter().find(|(name, _)| name == wanted) {
            Some((name, file)) => Ok(Expected {
                count: count_of(file),
                name: name.clone(),
            }),
            None => Err(MeshSetError::UnknownPilot {
                name: wanted.clone(),
                nearest: nearest(wanted, files.iter().map(|(name, _)| name.as_str())),
            }),
        };
    }
    let votes = |count: usize| files.iter().filter(|(_, f)| count_of(f) == count).count();
    let (mut best, mut most) = (0, 0);
    for (i, (_, file)) in files.iter().enumerate() {
        let votes = votes(count_of(file));
        if votes > most {
            (best, most) = (i, votes);
        }
    }
    let (name, file) = &files[best];
    Ok(Expected {
        count: count_of(file),
        name: name.clone(),
    })
}

fn nearest<'a>(given: &str, known: impl Iterator<Item = &'a str>) -> String {
    known
        .max_by(|a, b| strsim::jaro_winkler(given, a).total_cmp(&strsim::jaro_winkler(given, b)))
        .unwrap_or_default()
        .to_owned()
}

/// The mesh files of a folder in the order of their names.
fn mesh_files(folder: &Path) -> Result<Vec<PathBuf>, MeshSetError> {
    let fault = |source| MeshSetError::Folder {
        folder: folder.to_owned(),
        source,
    };
    let mut paths = vec![];
    for entry in std::fs::read_dir(folder).map_err(fault)? {
        let path = entry.map_err(fault)?.path();
        // Some systems leave hidden files beside each file, with its ending.
        let hidden = name_of(&path).starts_with('.');
        if SourceFormat::of_path(&path).is_some() && !hidden && path.is_file() {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        return Err(MeshSetError::Empty {
            folder: folder.to_owned(),
        });
    }
    paths.sort_by(|a, b| natural::compare(&name_of(a), &name_of(b)));
    Ok(paths)
}

fn name_of(path: &Path) -> String {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned());
    name.unwrap_or_default()
}

#[cfg(test)]
mod tests;
