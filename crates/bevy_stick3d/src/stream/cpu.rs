//! The CPU path: decode straight into the vertex buffers of a mesh asset, in place.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use stick3d_model::{InferError, Inference};
use thiserror::Error;

/// Why a body could not be made from a latent.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StreamError {
    /// The latent has another length than the model's.
    #[error(
        "the latent has {got} numbers, the model {expected}; set a sketch, or a latent of this model"
    )]
    LatentLength {
        /// The model's.
        expected: usize,
        /// The component's.
        got: usize,
    },
    /// A number of the latent is NaN or infinite.
    #[error("number {index} of the latent is {value}; all must be finite")]
    LatentNotFinite {
        /// Which.
        index: usize,
        /// As given.
        value: f32,
    },
    /// Somebody removed the mesh asset, or took its vertices away.
    #[error("the figure's mesh asset is gone or has lost its positions and normals")]
    MeshGone,
    /// The networks refused.
    #[error(transparent)]
    Infer(#[from] InferError),
}

/// The box round a body, in the entity's space, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BodyBounds {
    /// The smallest coordinates.
    pub(crate) low: Vec3,
    /// The largest coordinates.
    pub(crate) high: Vec3,
    /// How high the root joint is.
    pub(crate) root_height_m: f32,
}

/// Whether a latent can be decoded at all.
pub(crate) fn check(latent: &[f32], expected: usize) -> Result<(), StreamError> {
    if latent.len() != expected {
        return Err(StreamError::LatentLength {
            expected,
            got: latent.len(),
        });
    }
    match latent.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(StreamError::LatentNotFinite {
            index,
            value: latent[index],
        }),
        None => Ok(()),
    }
}

/// Decodes a latent into the positions and normals of `mesh`, its lowest vertex at the height `lowest_m`; where there is none,
/// its root joint at the origin. Allocates nothing.
pub(crate) fn write_body(
    inference: &mut Inference,
    latent: &[f32],
    lowest_m: Option<f32>,
    mesh: &mut Mesh,
) -> Result<BodyBounds, StreamError> {
    let (positions, normals) = vertex_buffers(mesh)?;
    inference.decode(latent, positions, normals)?;
    let mut bounds = bounds_of(positions);
    if let Some(lowest_m) = lowest_m {
        let lift_m = lowest_m - bounds.low.y;
        for position in positions {
            position[1] += lift_m;
        }
        bounds.low.y = lowest_m;
        bounds.high.y += lift_m;
        bounds.root_height_m = lift_m;
    }
    Ok(bounds)
}

/// The positions and normals of a mesh.
fn vertex_buffers(mesh: &mut Mesh) -> Result<(&mut [[f32; 3]], &mut [[f32; 3]]), StreamError> {
    let (mut positions, mut normals) = (None, None);
    let attributes = mesh
        .try_attributes_mut()
        .map_err(|_| StreamError::MeshGone)?;
    for (attribute, values) in attributes {
        let VertexAttributeValues::Float32x3(values) = values else {
            continue;
        };
        if attribute.id == Mesh::ATTRIBUTE_POSITION.id {
            positions = Some(values.as_mut_slice());
        } else if attribute.id == Mesh::ATTRIBUTE_NORMAL.id {
            normals = Some(values.as_mut_slice());
        }
    }
    positions.zip(normals).ok_or(StreamError::MeshGone)
}

fn bounds_of(positions: &[[f32; 3]]) -> BodyBounds {
    let first = positions.first().copied().map_or(Vec3::ZERO, Vec3::from);
    let mut bounds = BodyBounds {
        low: first,
        high: first,
        root_height_m: 0.0,
    };
    for &position in positions {
        bounds.low = bounds.low.min(Vec3::from(position));
        bounds.high = bounds.high.max(Vec3::from(position));
    }
    bounds
}

#[cfg(test)]
mod tests {
    use bevy::asset::RenderAssetUsages;
    use bevy::mesh::PrimitiveTopology;

    use super::*;

    #[test]
    fn bad_latents_are_named() {
        assert!(check(&[0.0, 1.0], 2).is_ok());
        let length = check(&[0.0], 2).unwrap_err().to_string();
        assert!(length.contains("1 numbers, the model 2"), "{length}");
        let nan = check(&[0.0, f32::NAN], 2).unwrap_err().to_string();
        assert!(nan.contains("number 1 of the latent is NaN"), "{nan}");
    }

    #[test]
    fn a_mesh_without_normals_is_an_error() {
        let mut mesh = Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        );
        assert!(vertex_buffers(&mut mesh).is_err());
        mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0_f32; 3]; 3]);
        assert!(vertex_buffers(&mut mesh).is_err());
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0_f32; 3]; 3]);
        let (positions, normals) = vertex_buffers(&mut mesh).unwrap();
        assert_eq!((positions.len(), normals.len()), (3, 3));
    }

    #[test]
    fn bounds_hold_every_vertex() {
        let bounds = bounds_of(&[[1.0, -2.0, 3.0], [-1.0, 2.0, 0.0]]);
        assert_eq!(bounds.low, Vec3::new(-1.0, -2.0, 0.0));
        assert_eq!(bounds.high, Vec3::new(1.0, 2.0, 3.0));
    }
}
