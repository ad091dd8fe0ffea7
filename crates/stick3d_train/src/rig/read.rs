//! Reading a rig from a binary glTF.

use std::collections::BTreeMap;

use glam::{Mat4, Vec3};
use gltf::mesh::Mode;
use gltf::{Document, Node, Primitive, Skin};
use stick3d_figure::mesh::TriangleMesh;

use super::open::open;
use super::{Bone, MAX_INFLUENCES, Rig, RigError, Skeleton};

impl Rig {
    /// Reads the first skinned mesh of a `.glb` with everything that shares its skin.
    ///
    /// The rest is the file's default posture: transforms of all nodes above the bones apply, the
    /// mesh node's own do not (glTF 2.0, section 3.7.3.3). Up to eight influences a vertex; weights
    /// are scaled to sum to 1. Vertices without `COLOR_0` take their material's base colour.
    ///
    /// # Errors
    /// [`RigError`] says what is missing, cut short, contradictory or not supported.
    pub fn from_glb(bytes: &[u8]) -> Result<Self, RigError> {
        let (document, blob) = open(bytes)?;
        let skin = document
            .nodes()
            .find_map(|node| node.mesh().and(node.skin()))
            .ok_or_else(|| missing("mesh with a skin"))?;
        let globals = node_globals(&document)?;
        let (skeleton, bone_of_joint) = read_skeleton(&document, &skin, &globals)?;
        let mut rig = Self {
            name: String::new(),
            copyright: document.as_json().asset.copyright.clone(),
            skeleton,
            mesh: TriangleMesh {
                positions: Vec::new(),
                triangles: Vec::new(),
            },
            colors: Vec::new(),
            influences: Vec::new(),
            centers: Vec::new(),
        };
        let bind = bind_matrices(&skin, &blob, &globals)?;
        let skinned = document.nodes().filter(|node| {
            node.skin()
                .is_some_and(|other| other.index() == skin.index())
        });
        for mesh in skinned.filter_map(|node| node.mesh()) {
            if rig.name.is_empty() {
                rig.name = mesh.name().unwrap_or("body").to_owned();
            }
            for primitive in mesh.primitives() {
                rig.append(&primitive, &blob, &bind, &bone_of_joint)?;
            }
        }
        let Self {
            name,
            copyright,
            skeleton,
            mesh,
            colors,
            influences,
            ..
        } = rig;
        Self::new(name, copyright, skeleton, mesh, colors, influences)
    }

    fn append(
        &mut self,
        primitive: &Primitive<'_>,
        blob: &[u8],
        bind: &[Mat4],
        bone_of_joint: &[u16],
    ) -> Result<(), RigError> {
        if primitive.mode() != Mode::Triangles {
            return Err(RigError::Unsupported {
                what: "lines, points or strips".into(),
            });
        }
        let reader = primitive.reader(|_| Some(blob));
        let first = self.mesh.positions.len() as u32;
        let points: Vec<Vec3> = reader
            .read_positions()
            .ok_or_else(|| missing("vertex positions"))?
            .map(Vec3::from)
            .collect();
        let mut joints: Vec<Vec<(u16, f32)>> = vec![Vec::new(); points.len()];
        for set in 0..(MAX_INFLUENCES / 4) as u32 {
            let (Some(numbers), Some(weights)) =
                (reader.read_joints(set), reader.read_weights(set))
            else {
                continue;
            };
            for ((list, four), shares) in joints
                .iter_mut()
                .zip(numbers.into_u16())
                .zip(weights.into_f32())
            {
                list.extend(
                    four.into_iter()
                        .zip(shares)
                        .filter(|&(_, share)| share > 0.0),
                );
            }
        }
        for (vertex, (point, list)) in points.iter().zip(&joints).enumerate() {
            let vertex = first as usize + vertex;
            let (point, influences) =
                rest_of(*point, list, bind, bone_of_joint).ok_or_else(|| {
                    RigError::Inconsistent {
                        what: format!("vertex {vertex} follows no bone of the skin"),
                    }
                })?;
            self.mesh.positions.push(point);
            self.influences.push(influences);
        }
        let flat = primitive
            .material()
            .pbr_metallic_roughness()
            .base_color_factor();
        let flat = flat.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
        match reader.read_colors(0) {
            Some(colors) => self.colors.extend(colors.into_rgba_u8()),
            None => self.colors.extend(std::iter::repeat_n(flat, points.len())),
        }
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..points.len() as u32).collect(),
        };
        self.mesh.triangles.extend(
            indices
                .as_chunks::<3>()
                .0
                .iter()
                .map(|corners| corners.map(|c| first.saturating_add(c))),
        );
        Ok(())
    }
}

fn missing(what: &str) -> RigError {
    RigError::Missing { what: what.into() }
}

/// The model-space matrix of every node.
fn node_globals(document: &Document) -> Result<Vec<Mat4>, RigError> {
    let parents = node_parents(document);
    let locals: Vec<Mat4> = document
        .nodes()
        .map(|node| Mat4::from_cols_array_2d(&node.transform().matrix()))
        .collect();
    (0..locals.len())
        .map(|node| {
            let mut global = locals[node];
            let mut at = node;
            for _ in 0..=locals.len() {
                match parents.get(&at) {
                    Some(&parent) => {
                        global = locals[parent] * global;
                        at = parent;
                    }
                    None => return Ok(global),
                }
            }
            Err(RigError::Inconsistent {
                what: format!("node {node} hangs below itself"),
            })
        })
        .collect()
}

fn node_parents(document: &Document) -> BTreeMap<usize, usize> {
    let children = |node: Node<'_>| {
        let parent = node.index();
        node.children()
            .map(move |child| (child.index(), parent))
            .collect::<Vec<_>>()
    };
    document.nodes().flat_map(children).collect()
}

/// The bones, parents first, and for every joint of the skin the number of its bone.
fn read_skeleton(
    document: &Document,
    skin: &Skin<'_>,
    globals: &[Mat4],
) -> Result<(Skeleton, Vec<u16>), RigError> {
    let parents = node_parents(document);
    let joints: Vec<Node<'_>> = skin.joints().collect();
    let joint_of_node: BTreeMap<usize, usize> = joints
        .iter()
        .enumerate()
        .map(|(joint, node)| (node.index(), joint))
        .collect();
    let parent_joint = |joint: usize| {
        let mut at = joints[joint].index();
        while let Some(&parent) = parents.get(&at) {
            if let Some(&found) = joint_of_node.get(&parent) {
                return Some(found);
            }
            at = parent;
        }
        None
    };
    let depth = |joint: usize| std::iter::successors(Some(joint), |&j| parent_joint(j)).count();
    let mut order: Vec<usize> = (0..joints.len()).collect();
    order.sort_by_cached_key(|&joint| depth(joint));
    let mut bone_of_joint = vec![0u16; joints.len()];
    for (bone, &joint) in order.iter().enumerate() {
        bone_of_joint[joint] = u16::try_from(bone).map_err(|_| RigError::Unsupported {
            what: "more than 65,535 bones".into(),
        })?;
    }
    let bones = order
        .iter()
        .map(|&joint| {
            let (_, rest_rotation, head) =
                globals[joints[joint].index()].to_scale_rotation_translation();
            Bone {
                name: joints[joint]
                    .name()
                    .map_or_else(|| format!("bone_{joint}"), str::to_owned),
                parent: parent_joint(joint).map(|parent| usize::from(bone_of_joint[parent])),
                head,
                rest_rotation,
            }
        })
        .collect();
    Ok((Skeleton { bones }, bone_of_joint))
}

/// Per joint the matrix from the file's vertices to model space at rest.
fn bind_matrices(skin: &Skin<'_>, blob: &[u8], globals: &[Mat4]) -> Result<Vec<Mat4>, RigError> {
    let joints: Vec<usize> = skin.joints().map(|node| node.index()).collect();
    let reader = skin.reader(|_| Some(blob));
    let inverse: Vec<Mat4> = match reader.read_inverse_bind_matrices() {
        Some(matrices) => matrices.map(|m| Mat4::from_cols_array_2d(&m)).collect(),
        None => vec![Mat4::IDENTITY; joints.len()],
    };
    if inverse.len() < joints.len() {
        return Err(RigError::Inconsistent {
            what: format!(
                "{} bones but {} inverse bind matrices",
                joints.len(),
                inverse.len()
            ),
        });
    }
    Ok(joints
        .iter()
        .zip(inverse)
        .map(|(&node, inverse)| globals[node] * inverse)
        .collect())
}

/// A vertex's place at rest and its influences, strongest first; `None` if it follows no bone.
fn rest_of(
    point: Vec3,
    list: &[(u16, f32)],
    bind: &[Mat4],
    bone_of_joint: &[u16],
) -> Option<(Vec3, Vec<(u16, f32)>)> {
    let sum: f32 = list.iter().map(|&(_, weight)| weight).sum();
    if !sum.is_finite() || sum <= 0.0 {
        return None;
    }
    let mut placed = Vec3::ZERO;
    let mut merged: BTreeMap<u16, f32> = BTreeMap::new();
    for &(joint, weight) in list {
        let matrix = bind.get(usize::from(joint))?;
        placed += matrix.transform_point3(point) * (weight / sum);
        *merged.entry(bone_of_joint[usize::from(joint)]).or_default() += weight / sum;
    }
    let mut influences: Vec<(u16, f32)> = merged.into_iter().collect();
    influences.sort_by(|a, b| b.1.total_cmp(&a.1));
    Some((placed, influences))
}
