//! The frame-rate code against the Burn modules, and what it refuses.

use burn::tensor::{Device, Tensor, TensorData};
use glam::{Vec2, Vec3};
use stick3d_figure::figure::Figure;
use stick3d_figure::sketch::Sketch;

use super::*;
use crate::network::{Decoder, Encoder2d, Encoder3d};
use crate::synthetic::{Kind, model};

const KINDS: [Kind; 4] = [Kind::Dense, Kind::Basis, Kind::Skinned, Kind::Rotations];

fn row(numbers: &[f32], device: &Device) -> Tensor<2> {
    Tensor::from_data(
        TensorData::new(numbers.to_vec(), [1, numbers.len()]),
        device,
    )
}

fn numbers<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor.into_data().try_to_vec().unwrap()
}

fn assert_close(found: &[f32], expected: &[f32]) {
    assert_eq!(found.len(), expected.len());
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= 1e-5, "{i}: {a} {b}");
    }
}

fn sketch(model: &Model) -> Sketch {
    let points = model.figure().template.iter().enumerate();
    let bent = points
        .map(|(i, p)| *p + 0.1 * Vec2::from_angle(i as f32))
        .collect();
    Sketch::new(model.figure(), bent).unwrap()
}

#[test]
fn every_final_layer_agrees_with_burn() {
    let device = Device::flex();
    for kind in KINDS {
        let model = model(kind);
        let mut inference = Inference::new(&model).unwrap();
        let sketch = sketch(&model);
        let mut latent = vec![0.0; inference.latent_len()];
        inference.encode(&sketch, &mut latent).unwrap();
        let input = sketch.input_vector(model.figure()).unwrap();
        let encoder = Encoder2d::from_weights(model.encoder2d(), &device);
        assert_close(&latent, &numbers(encoder.forward(row(&input, &device))));

        let mut positions = vec![[0.0; 3]; inference.vertex_count()];
        let mut normals = positions.clone();
        inference
            .decode(&latent, &mut positions, &mut normals)
            .unwrap();
        let decoder = Decoder::from_weights(model.head(), model.final_layer(), &device);
        let expected = numbers(decoder.forward(row(&latent, &device)));
        assert_close(positions.as_flattened(), &expected);
        assert!(
            expected.iter().any(|x| x.abs() > 0.05),
            "{kind:?}: a mesh of zeros proves nothing"
        );

        let mut joints = vec![Vec3::ZERO; model.figure().joint_count()];
        inference.joints(&latent, &mut joints).unwrap();
        for (found, expected) in joints.iter().zip(model.regressor().joints(&positions)) {
            assert!(found.distance(expected) < 1e-5, "{kind:?}");
        }
    }
}

#[test]
fn encoder3d_agrees_with_its_plain_form() {
    let device = Device::flex();
    for kind in KINDS {
        let weights = model(kind).encoder3d().clone();
        let len = weights.trunk.layers[0].input_len;
        let body: Vec<f32> = (0..len).map(|i| (i as f32 * 0.37).sin()).collect();
        let (mean, log_variance) =
            Encoder3d::from_weights(&weights, &device).forward(row(&body, &device));
        let (plain_mean, plain_log_variance) = weights.forward(&body);
        assert_close(&numbers(mean), &plain_mean);
        assert_close(&numbers(log_variance), &plain_log_variance);
        assert_eq!(
            Encoder3d::from_weights(&weights, &device)
                .to_weights()
                .unwrap(),
            weights
        );
    }
}

#[test]
fn normals_are_unit_vectors() {
    let mut inference = Inference::new(&model(Kind::Skinned)).unwrap();
    let mut positions = vec![[0.0; 3]; inference.vertex_count()];
    let mut normals = positions.clone();
    inference
        .decode(&[0.5; 8], &mut positions, &mut normals)
        .unwrap();
    assert!(
        normals
            .iter()
            .all(|n| (Vec3::from(*n).length() - 1.0).abs() < 1e-5)
    );
}

#[test]
fn wrong_lengths_and_numbers_are_refused() {
    let mut inference = Inference::new(&model(Kind::Skinned)).unwrap();
    let count = inference.vertex_count();
    let (mut positions, mut normals) = (vec![[0.0; 3]; count], vec![[0.0; 3]; count]);
    let short = inference.decode(&[0.0; 7], &mut positions, &mut normals);
    assert_eq!(
        short,
        Err(InferError::Length {
            what: "the latent",
            expected: 8,
            found: 7
        })
    );
    let short = inference.decode(&[0.0; 8], &mut positions[1..], &mut normals);
    assert!(matches!(
        short,
        Err(InferError::Length {
            what: "the positions",
            ..
        })
    ));
    let short = inference.decode(&[0.0; 8], &mut positions, &mut normals[1..]);
    assert!(matches!(
        short,
        Err(InferError::Length {
            what: "the normals",
            ..
        })
    ));
    let short = inference.joints(&[0.0; 8], &mut [Vec3::ZERO; 10]);
    assert!(matches!(
        short,
        Err(InferError::Length {
            what: "the joints",
            ..
        })
    ));
    let mut latent = [0.0; 8];
    latent[2] = f32::INFINITY;
    let error = inference.decode(&latent, &mut positions, &mut normals);
    assert_eq!(
        error,
        Err(InferError::NotFinite {
            what: "latent",
            index: 2
        })
    );
    for latent in [[1e10; 8], [f32::NAN; 8]] {
        let error = inference.decode(&latent, &mut positions, &mut normals);
        assert_eq!(
            error,
            Err(InferError::NotFinite {
                what: "latent",
                index: 0
            })
        );
    }
    let mut parts = model(Kind::Skinned).into_parts();
    parts.head.layers[2].bias[1] = 1e20;
    let mut overflowing = Inference::new(&Model::new(parts).unwrap()).unwrap();
    let error = overflowing.decode(&[0.0; 8], &mut positions, &mut normals);
    assert!(
        matches!(
            error,
            Err(InferError::NotFinite {
                what: "latent's mesh",
                ..
            })
        ),
        "{error:?}"
    );
    assert_eq!(positions, vec![[0.0; 3]; count], "nothing is written");
    let other = Figure::from_ron(&Figure::human().to_ron().unwrap()).unwrap();
    let sketch = Sketch::template(&other);
    let mut latent = vec![0.0; 8];
    assert!(inference.encode(&sketch, &mut latent[1..]).is_err());
    assert!(inference.encode(&sketch, &mut latent).is_ok());
}
