//! The tree of a file's nodes, and where a posture of them puts each.

use glam::{Mat4, Quat, Vec3};
use gltf::Document;

use super::RigError;
use super::open::named;

/// A node's place in its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Local {
    pub(super) translation: Vec3,
    pub(super) rotation: Quat,
    pub(super) scale: Vec3,
}

impl Local {
    fn matrix(&self) -> Mat4 {
        Mat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// All nodes of a file.
#[derive(Debug)]
pub(super) struct NodeTree {
    /// Per node the one above it.
    pub(super) parents: Vec<Option<usize>>,
    /// The posture that the file shows without animation.
    pub(super) locals: Vec<Local>,
    /// As the file states them: a matrix may hold shear, which [`Local`] cannot.
    matrices: Vec<Mat4>,
}

impl NodeTree {
    pub(super) fn new(document: &Document) -> Result<Self, RigError> {
        let count = document.nodes().count();
        let mut parents = vec![None; count];
        for node in document.nodes() {
            for child in node.children() {
                if let Some(first) = parents[child.index()].replace(node.index()) {
                    return Err(RigError::Inconsistent {
                        what: format!(
                            "node {} hangs below two nodes, {first} and {}",
                            named(child.name(), child.index()),
                            node.index()
                        ),
                    });
                }
            }
        }
        let depth = |node: usize| {
            std::iter::successors(Some(node), |&at| parents[at])
                .take(count + 1)
                .count()
        };
        if let Some(node) = (0..count).find(|&node| depth(node) > count) {
            return Err(RigError::Inconsistent {
                what: format!("node {node} hangs below itself"),
            });
        }
        let local = |node: gltf::Node<'_>| {
            let (translation, rotation, scale) = node.transform().decomposed();
            Local {
                translation: translation.into(),
                rotation: Quat::from_array(rotation),
                scale: scale.into(),
            }
        };
        Ok(Self {
            matrices: document
                .nodes()
                .map(|node| Mat4::from_cols_array_2d(&node.transform().matrix()))
                .collect(),
            locals: document.nodes().map(local).collect(),
            parents,
        })
    }

    /// The model-space matrix of every node, as the file stands.
    pub(super) fn globals(&self) -> Vec<Mat4> {
        self.compose(|node| self.matrices[node])
    }

    /// The model-space matrix of every node in another posture.
    pub(super) fn globals_of(&self, posture: &[Local]) -> Vec<Mat4> {
        self.compose(|node| {
            if posture[node] == self.locals[node] {
                self.matrices[node]
            } else {
                posture[node].matrix()
            }
        })
    }

    fn compose(&self, local: impl Fn(usize) -> Mat4) -> Vec<Mat4> {
        (0..self.parents.len())
            .map(|node| {
                let above = std::iter::successors(self.parents[node], |&at| self.parents[at]);
                above.fold(local(node), |global, parent| local(parent) * global)
            })
            .collect()
    }

    /// The nearest node above `node` for which `wanted` holds.
    pub(super) fn above(&self, node: usize, wanted: impl Fn(usize) -> bool) -> Option<usize> {
        std::iter::successors(self.parents[node], |&at| self.parents[at]).find(|&at| wanted(at))
    }
}
