//! The surface of a file: what its primitives say of vertices, triangles, colours and weights.

use std::collections::BTreeMap;

use glam::{Mat4, Vec3};
use gltf::mesh::Mode;
use gltf::{Mesh, Primitive};

use super::open::{Source, named};
use super::report::RigReport;
use super::{MAX_INFLUENCES, RigError};

/// Weights count as summing to one within this; bytes as weights are off by a few thousandths.
const WEIGHT_SLACK: f32 = 5e-3;

/// Vertices and triangles as they are read, joints not yet numbered as bones.
#[derive(Debug, Default)]
pub(super) struct Surface {
    /// At rest, model space, metres.
    pub(super) positions: Vec<Vec3>,
    /// Per vertex: (joint, weight), strongest first, weights summing to 1.
    pub(super) influences: Vec<Vec<(u16, f32)>>,
    /// Linear bytes.
    pub(super) colors: Vec<[u8; 4]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// What carries the vertices of a mesh.
pub(super) enum Carrier<'a> {
    /// A skin: per joint of its own the joint of the skeleton, and the matrix to model space at rest.
    Skin(&'a [(u16, Mat4)]),
    /// One joint, whole.
    Joint(u16, Mat4),
}

impl Surface {
    /// Adds a mesh; counts in the report what was put right.
    pub(super) fn add(
        &mut self,
        source: &Source,
        mesh: &Mesh<'_>,
        carrier: &Carrier<'_>,
        report: &mut RigReport,
    ) -> Result<(), RigError> {
        for primitive in mesh.primitives() {
            let place = format!(
                "mesh {}, part {}",
                named(mesh.name(), mesh.index()),
                primitive.index()
            );
            if primitive.mode() != Mode::Triangles {
                return Err(RigError::Unsupported {
                    what: format!("lines, points or strips ({place})"),
                });
            }
            self.add_primitive(source, &primitive, carrier, &place, report)?;
        }
        Ok(())
    }

    fn add_primitive(
        &mut self,
        source: &Source,
        primitive: &Primitive<'_>,
        carrier: &Carrier<'_>,
        place: &str,
        report: &mut RigReport,
    ) -> Result<(), RigError> {
        let reader = primitive.reader(|buffer| source.bytes(&buffer));
        let first = self.positions.len() as u32;
        let points: Vec<Vec3> = reader
            .read_positions()
            .ok_or_else(|| RigError::Missing {
                what: format!("vertex positions in {place}"),
            })?
            .map(Vec3::from)
            .collect();
        report.file_vertices += points.len();
        let lists = match carrier {
            Carrier::Skin(_) => read_influences(source, primitive, points.len()),
            Carrier::Joint(joint, _) => vec![vec![(*joint, 1.0)]; points.len()],
        };
        let mut mirrored = false;
        for (vertex, (point, list)) in points.iter().zip(&lists).enumerate() {
            if !point.is_finite() || list.iter().any(|(_, weight)| !weight.is_finite()) {
                return Err(RigError::Inconsistent {
                    what: format!(
                        "{place}: vertex {vertex} has a position or weights that are no numbers"
                    ),
                });
            }
            let placed = match carrier {
                Carrier::Skin(joints) => blended(*point, list, joints),
                Carrier::Joint(joint, matrix) => Some((
                    matrix.transform_point3(*point),
                    vec![(*joint, 1.0)],
                    *matrix,
                )),
            };
            let (point, mut influences, matrix) = placed.ok_or_else(|| RigError::Inconsistent {
                what: format!(
                    "{place}: vertex {vertex} follows no bone of the skin; give it weights"
                ),
            })?;
            let sum: f32 = list.iter().map(|&(_, weight)| weight).sum();
            report.normalized += usize::from((sum - 1.0).abs() > WEIGHT_SLACK);
            report.truncated += usize::from(keep_strongest(&mut influences));
            mirrored = matrix.determinant() < 0.0;
            self.positions.push(point);
            self.influences.push(influences);
        }
        let flat = primitive
            .material()
            .pbr_metallic_roughness()
            .base_color_factor();
        let byte = |part: f32| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
        match reader.read_colors(0) {
            Some(colors) if flat == [1.0; 4] => self.colors.extend(colors.into_rgba_u8()),
            Some(colors) => self.colors.extend(
                colors
                    .into_rgba_f32()
                    .map(|own| [0, 1, 2, 3].map(|i| byte(own[i] * flat[i]))),
            ),
            None => self
                .colors
                .extend(std::iter::repeat_n(flat.map(byte), points.len())),
        }
        // A file may state fewer colours than vertices; the checks before this cannot know.
        self.colors.resize(self.positions.len(), flat.map(byte));
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..points.len() as u32).collect(),
        };
        for corners in indices.as_chunks::<3>().0 {
            if let Some(corner) = corners.iter().find(|&&c| c as usize >= points.len()) {
                return Err(RigError::Inconsistent {
                    what: format!(
                        "{place}: a triangle uses vertex {corner} of {}",
                        points.len()
                    ),
                });
            }
            let [a, b, c] = corners.map(|corner| first + corner);
            // A mirroring transform turns triangles inside out (glTF 2.0, section 3.7.4).
            self.triangles
                .push(if mirrored { [a, c, b] } else { [a, b, c] });
        }
        Ok(())
    }
}

/// Per vertex all (joint of the skin, weight) with weight.
fn read_influences(
    source: &Source,
    primitive: &Primitive<'_>,
    count: usize,
) -> Vec<Vec<(u16, f32)>> {
    let reader = primitive.reader(|buffer| source.bytes(&buffer));
    let mut lists: Vec<Vec<(u16, f32)>> = vec![Vec::new(); count];
    for set in 0.. {
        let (Some(numbers), Some(weights)) = (reader.read_joints(set), reader.read_weights(set))
        else {
            break;
        };
        for ((list, four), shares) in lists
            .iter_mut()
            .zip(numbers.into_u16())
            .zip(weights.into_f32())
        {
            list.extend(
                four.into_iter()
                    .zip(shares)
                    .filter(|&(_, share)| share > 0.0 || share.is_nan()),
            );
        }
    }
    lists
}

/// A vertex's place at rest, its influences, strongest first, and the matrix of one of its joints; `None`
/// if it follows no joint.
fn blended(
    point: Vec3,
    list: &[(u16, f32)],
    joints: &[(u16, Mat4)],
) -> Option<(Vec3, Vec<(u16, f32)>, Mat4)> {
    let sum: f32 = list.iter().map(|&(_, weight)| weight).sum();
    if !sum.is_finite() || sum <= 0.0 {
        return None;
    }
    let mut placed = Vec3::ZERO;
    let mut merged: BTreeMap<u16, f32> = BTreeMap::new();
    let mut any = Mat4::IDENTITY;
    for &(joint, weight) in list {
        let (joint, matrix) = joints.get(usize::from(joint))?;
        placed += matrix.transform_point3(point) * (weight / sum);
        *merged.entry(*joint).or_default() += weight / sum;
        any = *matrix;
    }
    Some((placed, merged.into_iter().collect(), any))
}

/// Sorts by weight and leaves at most [`MAX_INFLUENCES`]; whether any were dropped.
fn keep_strongest(influences: &mut Vec<(u16, f32)>) -> bool {
    if influences.len() <= MAX_INFLUENCES {
        return false;
    }
    influences.sort_by(|a, b| b.1.total_cmp(&a.1));
    influences.truncate(MAX_INFLUENCES);
    let sum: f32 = influences.iter().map(|&(_, weight)| weight).sum();
    influences.iter_mut().for_each(|(_, weight)| *weight /= sum);
    true
}
