//! One trained figure: its networks, its mesh, its joints.

use std::path::Path;

use stick3d_figure::figure::Figure;
use stick3d_figure::mesh::unique_edges;
use stick3d_figure::regressor::JointRegressor;

use crate::file::{self, ModelError};
use crate::files::write_atomically;
use crate::final_layer::FinalLayer;
use crate::latent::TrainingStatistics;
use crate::metadata::{Metadata, topology_hash};
use crate::weights::{Encoder3dWeights, MlpWeights};

/// The parts of a [`Model`].
#[derive(Debug, Clone, PartialEq)]
pub struct ModelParts {
    /// What the file says about itself.
    pub metadata: Metadata,
    /// The mesh's triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// One sRGB colour and opacity per vertex.
    pub colors: Vec<[u8; 4]>,
    /// Joints as weighted means of vertices.
    pub regressor: JointRegressor,
    /// Sketch to latent.
    pub encoder2d: MlpWeights,
    /// Body to latent.
    pub encoder3d: Encoder3dWeights,
    /// Latent to coefficients.
    pub head: MlpWeights,
    /// Coefficients to vertices.
    pub final_layer: FinalLayer,
    /// What the training set was like. Model files need not have it.
    pub statistics: Option<TrainingStatistics>,
}

/// Everything of one trained figure. Its parts fit together: that is checked when it is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    parts: ModelParts,
}

impl Model {
    /// A model from its parts.
    ///
    /// # Errors
    /// [`ModelError`] for the first part that does not fit the others.
    pub fn new(parts: ModelParts) -> Result<Self, ModelError> {
        check_mesh(&parts)?;
        check_networks(&parts)?;
        if let Some(statistics) = &parts.statistics {
            let edges = unique_edges(&parts.triangles).len();
            statistics.validate(parts.metadata.latent_len, edges)?;
        }
        Ok(Self { parts })
    }

    /// Reads a model from the bytes of a `.stick3d` file.
    ///
    /// # Errors
    /// [`ModelError`], which says what is wrong with the bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ModelError> {
        file::read(bytes).and_then(Self::new)
    }

    /// The bytes of a `.stick3d` file; the same model gives the same bytes. Network weights are stored in half
    /// precision, so reading them back gives a model whose weights are rounded.
    ///
    /// # Errors
    /// [`ModelError::Write`] when the parts cannot be serialised.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ModelError> {
        file::write(&self.parts)
    }

    /// Reads a model file.
    ///
    /// # Errors
    /// [`ModelError::Io`], and those of [`Model::from_bytes`].
    pub fn load(path: &Path) -> Result<Self, ModelError> {
        let bytes = std::fs::read(path).map_err(|source| ModelError::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::from_bytes(&bytes)
    }

    /// Writes a model file: to a temporary one beside it, then renamed.
    ///
    /// # Errors
    /// [`ModelError::Io`], and those of [`Model::to_bytes`].
    pub fn save(&self, path: &Path) -> Result<(), ModelError> {
        write_atomically(path, &self.to_bytes()?).map_err(|source| ModelError::Io {
            path: path.to_owned(),
            source,
        })
    }

    /// Fails unless the mesh is wired as `expected_hash` says (see [`topology_hash`]).
    ///
    /// # Errors
    /// [`ModelError::WrongTopology`].
    pub fn require_topology(&self, expected_hash: &str) -> Result<(), ModelError> {
        let found = &self.metadata().topology_hash;
        if found == expected_hash {
            return Ok(());
        }
        Err(ModelError::WrongTopology {
            expected: expected_hash.to_owned(),
            found: found.clone(),
        })
    }

    /// The figure it draws.
    #[must_use]
    pub fn figure(&self) -> &Figure {
        &self.parts.metadata.figure
    }

    /// What the file says about itself.
    #[must_use]
    pub fn metadata(&self) -> &Metadata {
        &self.parts.metadata
    }

    /// The mesh's triangles, counter-clockwise seen from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.parts.triangles
    }

    /// One sRGB colour and opacity per vertex.
    #[must_use]
    pub fn colors(&self) -> &[[u8; 4]] {
        &self.parts.colors
    }

    /// How many vertices its meshes have.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.parts.metadata.vertex_count
    }

    /// Length of the latent.
    #[must_use]
    pub fn latent_len(&self) -> usize {
        self.parts.metadata.latent_len
    }

    /// Joints as weighted means of vertices.
    #[must_use]
    pub fn regressor(&self) -> &JointRegressor {
        &self.parts.regressor
    }

    /// Sketch to latent.
    #[must_use]
    pub fn encoder2d(&self) -> &MlpWeights {
        &self.parts.encoder2d
    }

    /// Body to latent.
    #[must_use]
    pub fn encoder3d(&self) -> &Encoder3dWeights {
        &self.parts.encoder3d
    }

    /// Latent to coefficients.
    #[must_use]
    pub fn head(&self) -> &MlpWeights {
        &self.parts.head
    }

    /// Coefficients to vertices.
    #[must_use]
    pub fn final_layer(&self) -> &FinalLayer {
        &self.parts.final_layer
    }

    /// What the training set was like, where the model file says.
    #[must_use]
    pub fn statistics(&self) -> Option<&TrainingStatistics> {
        self.parts.statistics.as_ref()
    }

    /// Takes the model apart, to make another from its parts.
    #[must_use]
    pub fn into_parts(self) -> ModelParts {
        self.parts
    }
}

fn check_mesh(parts: &ModelParts) -> Result<(), ModelError> {
    let ModelParts {
        metadata,
        triangles,
        colors,
        regressor,
        final_layer,
        ..
    } = parts;
    let vertex_count = metadata.vertex_count;
    expect(
        "vertices of the final layer",
        final_layer.vertex_count(),
        vertex_count,
    )?;
    expect("colours", colors.len(), vertex_count)?;
    expect(
        "joints of the regressor",
        regressor.joint_count(),
        metadata.figure.joint_count(),
    )?;
    regressor.validate(vertex_count)?;
    if let Some(index) = triangles
        .as_flattened()
        .iter()
        .find(|i| **i as usize >= vertex_count)
    {
        return Err(ModelError::TriangleOutOfRange {
            index: *index,
            vertex_count,
        });
    }
    let found = topology_hash(vertex_count, triangles);
    if found != metadata.topology_hash {
        return Err(ModelError::WrongTopology {
            expected: metadata.topology_hash.clone(),
            found,
        });
    }
    Ok(())
}

fn check_networks(parts: &ModelParts) -> Result<(), ModelError> {
    let ModelParts {
        metadata,
        encoder2d,
        encoder3d,
        head,
        final_layer,
        ..
    } = parts;
    let latent_len = metadata.latent_len;
    let sizes = metadata.architecture.sizes(
        metadata.figure.input_len(),
        latent_len,
        metadata.vertex_count,
    );
    for found in [
        encoder3d.mean.output_len,
        encoder3d.log_variance.output_len,
        head.widths().first().copied().unwrap_or(0),
    ] {
        if found != latent_len {
            return Err(ModelError::WrongLatentLength {
                expected: latent_len,
                found,
            });
        }
    }
    let trunk_width = sizes.encoder3d_trunk.last().copied().unwrap_or(0);
    expect(
        "input of Encoder3D's mean",
        encoder3d.mean.input_len,
        trunk_width,
    )?;
    expect(
        "input of Encoder3D's variance",
        encoder3d.log_variance.input_len,
        trunk_width,
    )?;
    expect(
        "coefficients of the final layer",
        final_layer.coefficient_len(),
        sizes.coefficient_len(),
    )?;
    for (part, mlp, widths, relu) in [
        ("Encoder2D", encoder2d, &sizes.encoder2d, false),
        (
            "the trunk of Encoder3D",
            &encoder3d.trunk,
            &sizes.encoder3d_trunk,
            true,
        ),
        (
            "the decoder's head",
            head,
            &sizes.head,
            sizes.relu_after_head,
        ),
    ] {
        let consistent = mlp
            .layers
            .iter()
            .all(crate::weights::LinearWeights::is_consistent);
        if &mlp.widths() != widths || mlp.relu_after_last != relu || !consistent {
            return Err(ModelError::Architecture {
                part,
                expected: widths.clone(),
                found: mlp.widths(),
            });
        }
    }
    for (part, layer) in [
        ("mean", &encoder3d.mean),
        ("log-variance", &encoder3d.log_variance),
    ] {
        if !layer.is_consistent() {
            return Err(ModelError::Count {
                what: part,
                expected: layer.output_len,
                found: layer.bias.len(),
            });
        }
    }
    Ok(())
}

fn expect(what: &'static str, found: usize, expected: usize) -> Result<(), ModelError> {
    if found == expected {
        Ok(())
    } else {
        Err(ModelError::Count {
            what,
            expected,
            found,
        })
    }
}
