//! A final layer for some of the vertices.

use super::{BasisLayer, DenseLayer, FinalLayer, FinalLayerError, SkinnedLayer, SkinnedParts};
use crate::weights::LinearWeights;

impl FinalLayer {
    /// A layer that writes only the given vertices, in the given order, and reads the same coefficients.
    ///
    /// # Errors
    /// [`FinalLayerError`] when a vertex does not exist or none is given.
    pub fn of_vertices(&self, vertices: &[u32]) -> Result<Self, FinalLayerError> {
        let count = self.vertex_count();
        if let Some(vertex) = vertices.iter().find(|v| **v as usize >= count) {
            return Err(FinalLayerError {
                what: "part",
                problem: format!("vertex {vertex} is asked for, there are {count}"),
            });
        }
        Ok(match self {
            Self::Dense(layer) => Self::Dense(dense(layer, vertices)?),
            Self::Basis(layer) => Self::Basis(basis(layer, vertices)?),
            Self::Skinned(layer) => Self::Skinned(skinned(layer.parts(), vertices)?),
        })
    }
}

fn dense(layer: &DenseLayer, vertices: &[u32]) -> Result<DenseLayer, FinalLayerError> {
    let whole = layer.linear();
    let columns: Vec<usize> = vertices
        .iter()
        .flat_map(|v| [0, 1, 2].map(|axis| 3 * *v as usize + axis))
        .collect();
    let pick = |row: &[f32]| -> Vec<f32> { columns.iter().map(|column| row[*column]).collect() };
    let linear = LinearWeights {
        input_len: whole.input_len,
        output_len: columns.len(),
        weight: whole
            .weight
            .chunks_exact(whole.output_len.max(1))
            .flat_map(pick)
            .collect(),
        bias: pick(&whole.bias),
    };
    DenseLayer::new(linear, layer.extent_m())
}

fn basis(layer: &BasisLayer, vertices: &[u32]) -> Result<BasisLayer, FinalLayerError> {
    let columns = layer
        .columns()
        .chunks_exact(layer.vertex_count())
        .flat_map(|column| vertices.iter().map(|v| column[*v as usize]))
        .collect();
    BasisLayer::new(vertices.len(), columns)
}

fn skinned(parts: &SkinnedParts, vertices: &[u32]) -> Result<SkinnedLayer, FinalLayerError> {
    let mut part = SkinnedParts {
        rest: vec![],
        offsets: vec![0],
        bones: vec![],
        weights: vec![],
        ..parts.clone()
    };
    for vertex in vertices.iter().map(|v| *v as usize) {
        let range = parts.offsets[vertex] as usize..parts.offsets[vertex + 1] as usize;
        part.rest.push(parts.rest[vertex]);
        part.bones.extend(&parts.bones[range.clone()]);
        part.weights.extend(&parts.weights[range]);
        part.offsets.push(part.bones.len() as u32);
    }
    SkinnedLayer::new(part)
}

#[cfg(test)]
mod tests {
    use crate::synthetic::{Kind, model};

    #[test]
    fn a_part_is_evaluated_as_in_the_whole() {
        for kind in [Kind::Dense, Kind::Basis, Kind::Skinned, Kind::Rotations] {
            let whole = model(kind).final_layer().clone();
            let vertices = [40, 3, 3, 53];
            let part = whole.of_vertices(&vertices).unwrap();
            let coefficients: Vec<f32> = (0..whole.coefficient_len())
                .map(|i| (i as f32).sin())
                .collect();
            let mut all = vec![[0.0; 3]; whole.vertex_count()];
            let mut some = [[0.0; 3]; 4];
            whole.evaluate(&coefficients, &mut whole.scratch(), &mut all);
            part.evaluate(&coefficients, &mut part.scratch(), &mut some);
            for (vertex, position) in vertices.iter().zip(&some) {
                let whole = all[*vertex as usize];
                assert!(
                    whole
                        .iter()
                        .zip(position)
                        .all(|(a, b)| (a - b).abs() < 1e-5),
                    "{kind:?}"
                );
            }
            assert!(whole.of_vertices(&[54]).is_err());
        }
    }
}
