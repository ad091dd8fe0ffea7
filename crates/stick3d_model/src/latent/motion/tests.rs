//! Motions of the shipped man and of a synthetic model.

use stick3d_figure::sketch::Sketch;

use super::*;
use crate::Model;
use crate::latent::Easing;
use crate::synthetic::{Kind, model};

fn man() -> Inference {
    let bytes = include_bytes!("../../../../../assets/models/human.stick3d");
    Inference::new(&Model::from_bytes(bytes).unwrap()).unwrap()
}

fn keys(inference: &mut Inference, sketches: &[&[u8]]) -> Vec<LatentKey> {
    let mut keys = vec![];
    for (index, sketch) in sketches.iter().enumerate() {
        let sketch = Sketch::from_json(inference.figure(), sketch).unwrap();
        let mut latent = vec![0.0; inference.latent_len()];
        inference.encode(&sketch, &mut latent).unwrap();
        keys.push(LatentKey {
            latent,
            time_s: 0.5 * index as f32,
            easing: Easing::Linear,
        });
    }
    keys
}

const STANDING: &[u8] = include_bytes!("../../../../../assets/sketches/standing.json");
const WAVE: &[u8] = include_bytes!("../../../../../assets/sketches/wave.json");
const KICK: &[u8] = include_bytes!("../../../../../assets/sketches/kick.json");
const STAR: &[u8] = include_bytes!("../../../../../assets/sketches/star_jump.json");

const PAIRS: [[&[u8]; 2]; 4] = [
    [STANDING, WAVE],
    [KICK, STANDING],
    [STANDING, STAR],
    [STAR, KICK],
];

#[test]
fn a_bounded_motion_eases_to_a_stop_while_it_is_to_be_trusted() {
    let mut man = man();
    for pair in PAIRS {
        let keys = keys(&mut man, &pair);
        let motion = Motion::new(&keys, MotionSettings::default(), &mut man).unwrap();
        let (start_s, end_s) = motion.path().range_s();
        assert!(
            start_s < 0.0 && end_s > 0.5 && end_s < 10.0,
            "{start_s} {end_s}"
        );
        let [before, after] = motion.path().horizons();
        assert!(before > 0.0 && after > 0.0);
        let mut latent = vec![0.0; man.latent_len()];
        let mut stopped = latent.clone();
        motion.sample_into(1e6, &mut stopped).unwrap();
        motion.sample_into(end_s, &mut latent).unwrap();
        assert_eq!(latent, stopped);
        for i in 0..200 {
            let time_s = -3.0 + 0.05 * i as f32;
            let beyond = !(0.0..=0.5).contains(&time_s);
            assert_eq!(motion.is_beyond(time_s), beyond);
            let trust = motion.trust(time_s);
            assert!(trust >= 0.45 || !beyond, "{trust} at {time_s}");
        }
    }
}

#[test]
fn an_unbounded_motion_is_trusted_less_and_less_where_a_bounded_one_stops() {
    let mut man = man();
    let keys = keys(&mut man, &[STANDING, STAR]);
    let settings = MotionSettings {
        extrapolation: Extrapolation::Unbounded,
        ..MotionSettings::default()
    };
    let motion = Motion::new(&keys, settings, &mut man).unwrap();
    assert_eq!(motion.path().range_s(), (f32::NEG_INFINITY, f32::INFINITY));
    assert!(motion.trust(4.0) < 0.3, "{}", motion.trust(4.0));
    assert!(motion.trust(0.5) == 1.0 && motion.trust(f32::NAN) == 0.0);
    let bounded = Motion::new(&keys, MotionSettings::default(), &mut man).unwrap();
    let [_, horizon] = bounded.path().horizons();
    assert!(motion.trust(0.5 + 0.5 * (horizon + 0.3)) < 0.5);
}

#[test]
fn ping_pong_turns_at_the_horizons_and_comes_back() {
    let mut man = man();
    let keys = keys(&mut man, &[STANDING, WAVE]);
    let extrapolation = Extrapolation::PingPong { least_trust: 0.5 };
    let settings = MotionSettings {
        extrapolation,
        ..MotionSettings::default()
    };
    let motion = Motion::new(&keys, settings, &mut man).unwrap();
    let (_, end_s) = motion.path().range_s();
    let mut there = vec![0.0; man.latent_len()];
    let mut back = there.clone();
    motion.sample_into(end_s - 0.3, &mut there).unwrap();
    motion.sample_into(end_s + 0.3, &mut back).unwrap();
    let apart = there
        .iter()
        .zip(&back)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max);
    assert!(apart < 1e-3, "{apart}");
    assert!((motion.trust(end_s - 0.3) - motion.trust(end_s + 0.3)).abs() < 1e-3);
}

#[test]
fn keys_of_another_model_and_bad_settings_are_refused() {
    let mut synthetic = Inference::new(&model(Kind::Rotations)).unwrap();
    let key = |len: usize, time_s| LatentKey {
        latent: vec![time_s; len],
        time_s,
        easing: Easing::Linear,
    };
    let other = [key(9, 0.0), key(9, 1.0)];
    let refused = Motion::new(&other, MotionSettings::default(), &mut synthetic);
    assert!(matches!(
        refused,
        Err(PathError::LatentLength {
            expected: 8,
            found: 9,
            ..
        })
    ));
    let own = [key(8, 0.0), key(8, 1.0)];
    let settings = MotionSettings {
        extrapolation: Extrapolation::Bounded { least_trust: 1.5 },
        ..MotionSettings::default()
    };
    let refused = Motion::new(&own, settings, &mut synthetic);
    assert!(matches!(refused, Err(PathError::LeastTrust { .. })));
}

#[test]
fn statistics_make_far_latents_distrusted() {
    let mut synthetic = Inference::new(&model(Kind::Rotations)).unwrap();
    let ray = |length: f32| vec![length; 8];
    let trusts: Vec<_> = (0..20)
        .map(|i| synthetic.trust(&ray(0.5 * i as f32)).unwrap())
        .collect();
    let distances: Vec<f32> = trusts.iter().filter_map(|trust| trust.distance).collect();
    assert_eq!(distances.len(), 20);
    assert!(distances[1..].is_sorted());
    let values: Vec<f32> = trusts[1..].iter().map(|trust| trust.value()).collect();
    assert!(
        values.windows(2).all(|pair| pair[1] <= pair[0]),
        "{values:?}"
    );
    assert!(values[0] == 1.0 && values[18] == 0.0, "{values:?}");
    let mut without = Inference::new(&model(Kind::Skinned)).unwrap();
    assert_eq!(without.trust(&ray(1.0)).unwrap().distance, None);
}
