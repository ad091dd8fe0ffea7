//! Reading a rig from a glTF.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{Quat, Vec3};
use gltf::Document;
use stick3d_figure::mesh::TriangleMesh;

use super::animation::Animation;
use super::clips::{Clip, Frame, Motion};
use super::hang::hang_sliding_bones;
use super::joints::Joints;
use super::nodes::NodeTree;
use super::open::{Source, named, open};
use super::report::RigReport;
use super::surface::{Carrier, Surface};
use super::weld::Weld;
use super::{Pose, Rig, RigError, Skeleton};

/// A rig as it came from a file, with what was seen on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct RigFile {
    /// The rig.
    pub rig: Rig,
    /// One colour per triangle, linear bytes: sharper than [`Rig::colors`] where vertices of different
    /// colours were welded.
    pub triangle_colors: Vec<[u8; 4]>,
    /// What was put right, and what is worth knowing.
    pub report: RigReport,
}

impl Rig {
    /// Reads a rig from a `.glb`: [`RigFile::from_bytes`] without its report, colour borders kept.
    ///
    /// # Errors
    /// [`RigError`] says what is missing, cut short, contradictory or not supported.
    pub fn from_glb(bytes: &[u8]) -> Result<Self, RigError> {
        RigFile::from_bytes(bytes, Weld::default()).map(|file| file.rig)
    }
}

impl RigFile {
    /// Reads a `.glb`, or a `.gltf` with its buffers embedded or beside it.
    ///
    /// # Errors
    /// [`RigError`] says what is missing, cut short, contradictory or not supported.
    pub fn read(path: &Path, weld: Weld) -> Result<Self, RigError> {
        let bytes = std::fs::read(path).map_err(|source| RigError::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::from_source(&open(&bytes, path.parent())?, weld)
    }

    /// Reads all skinned meshes of a `.glb`, or of a `.gltf` whose buffers are embedded.
    ///
    /// The transforms of all nodes above the bones apply, those of a skinned mesh's own node do not
    /// (glTF 2.0, section 3.7.3.3). The rest is the pose that the skin was bound in. Meshes without a skin
    /// that hang on a bone follow it whole. Weights are scaled to sum to 1; colours are `COLOR_0` times the
    /// material's base colour, both linear; textures are not read. Animations become [`Rig::clips`]: bones
    /// turn, and the roots move by [`Pose::root_translation`]; bones that the clips slide are hung where
    /// they stay in place, if there is such a place.
    ///
    /// # Errors
    /// [`RigError`] says what is missing, cut short, contradictory or not supported.
    pub fn from_bytes(bytes: &[u8], weld: Weld) -> Result<Self, RigError> {
        Self::from_source(&open(bytes, None)?, weld)
    }

    fn from_source(source: &Source, weld: Weld) -> Result<Self, RigError> {
        let mut report = RigReport::default();
        let tree = NodeTree::new(&source.document)?;
        let mut joints = Joints::read(source, &tree, &mut report)?;
        let mut surface = read_surface(source, &tree, &joints, &mut report)?;
        let triangle_colors = surface
            .triangles
            .iter()
            .map(|t| mean_color(&surface.colors, *t));
        let triangle_colors = triangle_colors.collect();
        report.welded = surface.weld(weld);
        let motions = read_motions(source, &tree, &joints, &mut report)?;
        let mut weights = vec![0.0; joints.nodes.len()];
        for &(joint, weight) in surface.influences.iter().flatten() {
            weights[usize::from(joint)] += weight;
        }
        hang_sliding_bones(&mut joints, &weights, &motions, &mut report);
        let (skeleton, bone_of_joint) = joints.skeleton();
        let influences: Vec<Vec<(u16, f32)>> = surface
            .influences
            .iter()
            .map(|list| renumbered(list, &bone_of_joint))
            .collect();
        let clips = motions
            .iter()
            .map(|motion| clip(motion, &skeleton, &bone_of_joint, &influences))
            .collect();
        let mesh = TriangleMesh {
            positions: surface.positions,
            triangles: surface.triangles,
        };
        report.degenerate = mesh
            .corners()
            .filter(|[a, b, c]| (*b - *a).cross(*c - *a).length_squared() <= f32::MIN_POSITIVE)
            .count();
        note_what_is_not_read(&source.document, &mut report);
        let mut rig = Rig::new(
            body_name(&source.document),
            source.document.as_json().asset.copyright.clone(),
            skeleton,
            mesh,
            surface.colors,
            influences,
        )?;
        rig.clips = clips;
        Ok(Self {
            rig,
            triangle_colors,
            report,
        })
    }
}

/// Everything that follows the joints: skinned meshes, and meshes that hang on one.
fn read_surface(
    source: &Source,
    tree: &NodeTree,
    joints: &Joints,
    report: &mut RigReport,
) -> Result<Surface, RigError> {
    let mut surface = Surface::default();
    let globals = tree.globals();
    for node in source.document.nodes() {
        let Some(mesh) = node.mesh() else { continue };
        if let Some(skin) = node.skin() {
            let bind = joints.bind(source, &skin)?;
            surface.add(source, &mesh, &Carrier::Skin(&bind), report)?;
            continue;
        }
        let joint_of = |node: usize| joints.nodes.iter().position(|&other| other == node);
        let carrier = joint_of(node.index()).or_else(|| {
            let above = tree.above(node.index(), |at| joint_of(at).is_some())?;
            joint_of(above)
        });
        let name = named(node.name(), node.index());
        match carrier {
            Some(joint) => {
                let above = globals[joints.nodes[joint]];
                let place = joints.rest[joint] * above.inverse() * globals[node.index()];
                surface.add(source, &mesh, &Carrier::Joint(joint as u16, place), report)?;
            }
            None => report.notes.push(format!(
                "mesh node {name} has no skin and hangs on no bone; it is left out"
            )),
        }
    }
    Ok(surface)
}

fn read_motions(
    source: &Source,
    tree: &NodeTree,
    joints: &Joints,
    report: &mut RigReport,
) -> Result<Vec<Motion>, RigError> {
    let animations = Animation::read_all(source)?;
    if let Some((animation, node)) = animations
        .iter()
        .find_map(|animation| Some((animation, animation.scaled_node(tree)?)))
    {
        let name = source.document.nodes().nth(node);
        report.notes.push(format!(
            "clip `{}` stretches node {}, which poses cannot; only turns are kept",
            animation.name,
            named(name.and_then(|node| node.name()), node)
        ));
    }
    animations
        .iter()
        .map(|animation| joints.motion(animation, tree))
        .collect()
}

fn renumbered(list: &[(u16, f32)], bone_of_joint: &[u16]) -> Vec<(u16, f32)> {
    let by_bone: BTreeMap<u16, f32> = list
        .iter()
        .map(|&(joint, weight)| (bone_of_joint[usize::from(joint)], weight))
        .collect();
    let mut list: Vec<(u16, f32)> = by_bone.into_iter().collect();
    list.sort_by(|a, b| b.1.total_cmp(&a.1));
    list
}

/// A motion as poses of the skeleton; the root that carries most of the surface leads the way.
fn clip(
    motion: &Motion,
    skeleton: &Skeleton,
    bone_of_joint: &[u16],
    influences: &[Vec<(u16, f32)>],
) -> Clip {
    let mut carried = vec![0.0_f32; skeleton.bones.len()];
    for &(bone, weight) in influences.iter().flatten() {
        carried[skeleton.root_of(usize::from(bone))] += weight;
    }
    let leader = (0..carried.len()).max_by(|&a, &b| {
        let rank = |bone: usize| (carried[bone], std::cmp::Reverse(bone));
        let (a, b) = (rank(a), rank(b));
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
    });
    let pose = |frame: &Frame| {
        let mut posed = vec![(Quat::IDENTITY, Vec3::ZERO); skeleton.bones.len()];
        for (joint, &place) in frame.joints.iter().enumerate() {
            posed[usize::from(bone_of_joint[joint])] = place;
        }
        let rotations = skeleton.bones.iter().zip(&posed).map(|(bone, (turn, _))| {
            let above = bone.parent.map_or(Quat::IDENTITY, |parent| posed[parent].0);
            (above.inverse() * *turn).normalize()
        });
        Pose {
            rotations: rotations.collect(),
            root_translation: leader
                .map_or(Vec3::ZERO, |bone| posed[bone].1 - skeleton.bones[bone].head),
        }
    };
    Clip {
        name: motion.name.clone(),
        times_s: motion.frames.iter().map(|frame| frame.time_s).collect(),
        poses: motion.frames.iter().map(pose).collect(),
    }
}

fn mean_color(colors: &[[u8; 4]], corners: [u32; 3]) -> [u8; 4] {
    let [a, b, c] = corners.map(|corner| colors[corner as usize].map(u16::from));
    [0, 1, 2, 3].map(|i| ((a[i] + b[i] + c[i] + 1) / 3) as u8)
}

/// The name of the skinned mesh that comes first.
fn body_name(document: &Document) -> String {
    let skinned = document.nodes().find_map(|node| {
        let mesh = node.mesh()?;
        node.skin()?;
        node.name().or(mesh.name()).map(str::to_owned)
    });
    skinned.unwrap_or_else(|| "body".to_owned())
}

fn note_what_is_not_read(document: &Document, report: &mut RigReport) {
    let textured: Vec<String> = document
        .materials()
        .filter(|material| {
            material
                .pbr_metallic_roughness()
                .base_color_texture()
                .is_some()
        })
        .map(|material| named(material.name(), material.index().unwrap_or_default()))
        .collect();
    if !textured.is_empty() {
        report.notes.push(format!(
            "textures are not read: {} shows its base colour and vertex colours only",
            textured.join(", ")
        ));
    }
    let shaped = |mesh: &gltf::Mesh<'_>| {
        mesh.primitives()
            .any(|p| p.morph_targets().next().is_some())
    };
    for mesh in document.meshes().filter(shaped) {
        report.notes.push(format!(
            "the morph targets of mesh {} are not read",
            named(mesh.name(), mesh.index())
        ));
    }
}
