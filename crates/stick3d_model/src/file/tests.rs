//! Whole, damaged and foreign model files.

use proptest::prelude::*;
use safetensors::tensor::TensorView;

use super::*;
use crate::metadata::FORMAT_VERSION;
use crate::model::Model;
use crate::synthetic::{Kind, model};

const KINDS: [Kind; 4] = [Kind::Dense, Kind::Basis, Kind::Skinned, Kind::Rotations];

fn bytes() -> Vec<u8> {
    model(Kind::Rotations).to_bytes().unwrap()
}

fn read(bytes: &[u8]) -> Result<Model, ModelError> {
    Model::from_bytes(bytes)
}

#[test]
fn what_is_written_is_read() {
    for kind in KINDS {
        let model = model(kind);
        let bytes = model.to_bytes().unwrap();
        assert_eq!(read(&bytes).unwrap(), model);
        assert_eq!(
            bytes,
            model.to_bytes().unwrap(),
            "the same model gives the same bytes"
        );
    }
}

#[test]
fn files_are_saved_and_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("torus.stick3d");
    let model = model(Kind::Basis);
    model.save(&path).unwrap();
    assert_eq!(Model::load(&path).unwrap(), model);
    let error = Model::load(&folder.path().join("none.stick3d")).unwrap_err();
    assert!(matches!(error, ModelError::Io { .. }) && error.to_string().contains("none.stick3d"));
    let error = model
        .save(&folder.path().join("no/such/folder.stick3d"))
        .unwrap_err();
    assert!(matches!(error, ModelError::Io { .. }));
}

#[test]
fn empty_and_cut_files_are_told_apart() {
    let bytes = bytes();
    assert!(matches!(read(&[]), Err(ModelError::Empty)));
    for len in [1, 7, 8, 9, 100, bytes.len() / 2, bytes.len() - 1] {
        let error = read(&bytes[..len]).unwrap_err();
        match error {
            ModelError::Truncated { expected, found } => {
                assert!(
                    found == len as u64 && expected > found,
                    "{len}: {expected} {found}"
                );
            }
            // Eight bytes alone are a length, not yet recognisable as a header.
            other => assert!(len == 8, "{len}: {other}"),
        }
    }
    match read(&bytes[..bytes.len() - 1]) {
        Err(ModelError::Truncated { expected, .. }) => assert_eq!(expected, bytes.len() as u64),
        other => panic!("{other:?}"),
    }
}

#[test]
fn other_files_are_foreign() {
    let text = b"solid cube\nfacet normal 0 0 1\n";
    assert!(matches!(read(text), Err(ModelError::NotSafetensors(_))));
    let data = [0_u8; 8];
    let view = TensorView::new(Dtype::F32, vec![2], &data).unwrap();
    let foreign = safetensors::serialize([("weight", view)], None).unwrap();
    assert!(matches!(read(&foreign), Err(ModelError::Foreign)));
}

/// Replaces text in the metadata by text of the same length, so that all offsets stay.
fn patched(from: &str, to: &str) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut bytes = bytes();
    let at = bytes
        .windows(from.len())
        .position(|window| window == from.as_bytes())
        .unwrap();
    bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
    bytes
}

#[test]
fn a_newer_version_is_named_before_anything_else() {
    let newer = patched(
        &format!("\\\"format_version\\\":{FORMAT_VERSION}"),
        "\\\"format_version\\\":9",
    );
    assert!(matches!(
        read(&newer),
        Err(ModelError::NewerVersion {
            found: 9,
            supported: FORMAT_VERSION
        })
    ));
}

#[test]
fn changed_metadata_fails_the_checksum() {
    let changed = patched("\\\"latent_len\\\":8", "\\\"latent_len\\\":7");
    assert!(matches!(read(&changed), Err(ModelError::Checksum)));
}

#[test]
fn another_topology_or_latent_is_refused() {
    let sound = model(Kind::Skinned);
    assert!(
        sound
            .require_topology(&sound.metadata().topology_hash)
            .is_ok()
    );
    assert!(matches!(
        sound.require_topology("00ff"),
        Err(ModelError::WrongTopology { .. })
    ));

    let mut parts = sound.clone().into_parts();
    parts.triangles.swap(0, 1);
    assert!(matches!(
        Model::new(parts),
        Err(ModelError::WrongTopology { .. })
    ));

    let mut parts = sound.clone().into_parts();
    parts.metadata.latent_len = 9;
    // The checksum holds: such a file was written on purpose, by a broken tool.
    assert!(matches!(
        Model::new(parts),
        Err(ModelError::WrongLatentLength {
            expected: 9,
            found: 8
        })
    ));

    let mut parts = sound.clone().into_parts();
    parts.head.layers.pop();
    assert!(matches!(
        Model::new(parts),
        Err(ModelError::Architecture { .. })
    ));

    let mut parts = sound.clone().into_parts();
    parts.colors.pop();
    assert!(matches!(Model::new(parts), Err(ModelError::Count { .. })));

    let mut parts = sound.into_parts();
    parts.regressor.rows[3] = vec![(1000, 1.0)];
    assert!(matches!(Model::new(parts), Err(ModelError::Regressor(_))));
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let mut parts = model(Kind::Basis).into_parts();
    parts.head.layers[1].bias[3] = f32::NAN;
    let bytes = write(&parts).unwrap();
    match read(&bytes) {
        Err(ModelError::NotFinite { name, index }) => {
            assert_eq!((name.as_str(), index), ("head.1.bias", 3));
        }
        other => panic!("{other:?}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, ..ProptestConfig::default() })]

    #[test]
    fn a_flipped_bit_is_found(position in any::<prop::sample::Index>(), bit in 0_u8..8) {
        let original = bytes();
        let mut damaged = original.clone();
        damaged[position.index(original.len())] ^= 1 << bit;
        if let Ok(model) = read(&damaged) {
            prop_assert_eq!(model, read(&original).unwrap());
        }
    }

    #[test]
    fn mangled_files_never_panic(
        cuts in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0_usize..40), 1..6),
    ) {
        let original = bytes();
        let mut damaged = original.clone();
        for (position, byte, len) in cuts {
            let start = position.index(damaged.len().max(1));
            let end = (start + len).min(damaged.len());
            match byte % 3 {
                0 => drop(damaged.drain(start..end)),
                1 => damaged[start..end].fill(byte),
                _ => drop(damaged.splice(start..start, std::iter::repeat_n(byte, len))),
            }
        }
        if let Ok(model) = read(&damaged) {
            prop_assert_eq!(model, read(&original).unwrap());
        }
    }

    #[test]
    fn noise_never_panics(noise in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(read(&noise).is_err());
    }
}
