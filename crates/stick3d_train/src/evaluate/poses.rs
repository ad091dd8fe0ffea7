//! The poses that a model is measured on.

use crate::dataset::PoseStream;
use crate::pose::{Controls, PoseLibrary, PoseSampler, SampleKind};
use crate::rig::Rig;

/// How often a held-out pose is perturbed for each time that it stands as it is.
const PERTURBED: usize = 3;
/// How far, in parts of how far its controls stray.
const STRENGTH: f32 = 0.3;

/// Natural poses, endlessly: each held-out pose as it is and then perturbed, over and over. None without held-out poses.
#[must_use]
pub fn natural_poses<'a>(
    rig: &Rig,
    controls: &'a Controls,
    held_out: &'a PoseLibrary,
    seed: u64,
) -> PoseStream<'a> {
    let mut sampler = PoseSampler::new(rig, controls, held_out, seed);
    let rounds = (0..=PERTURBED).cycle();
    if held_out.poses.is_empty() {
        return Box::new(std::iter::empty());
    }
    Box::new(rounds.flat_map(move |round| {
        let poses: Vec<_> = held_out
            .poses
            .iter()
            .map(|pose| match round {
                0 => controls.pose(&pose.values),
                _ => controls.pose(&sampler.perturbed(&pose.values, STRENGTH)),
            })
            .collect();
        poses
    }))
}

/// Broad poses, endlessly: anything inside the joints' limits.
#[must_use]
pub fn broad_poses<'a>(rig: &Rig, controls: &'a Controls, seed: u64) -> PoseStream<'a> {
    let mut sampler = PoseSampler::new(rig, controls, &PoseLibrary::default(), seed);
    Box::new(std::iter::repeat_with(move || {
        sampler.sample(SampleKind::Free)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::ShippedBody;

    #[test]
    fn held_out_poses_come_as_they_are_and_then_perturbed() {
        let rig = Rig::from_glb(include_bytes!("../../../../assets/rigs/human.glb")).unwrap();
        let human = ShippedBody::named("human").unwrap();
        let controls = Controls::from_ron(human.controls, &rig).unwrap();
        let library = PoseLibrary::from_ron(human.poses, &controls).unwrap();
        let some = PoseLibrary {
            poses: library.poses[..3].to_vec(),
        };
        let drawn: Vec<_> = natural_poses(&rig, &controls, &some, 1).take(15).collect();
        for (number, pose) in drawn.iter().enumerate() {
            let original = controls.pose(&some.poses[number % 3].values);
            let as_it_is = number / 3 % (1 + PERTURBED) == 0;
            assert_eq!(*pose == original, as_it_is, "{number}");
        }
        let none = PoseLibrary::default();
        let mut natural = natural_poses(&rig, &controls, &none, 1);
        assert!(natural.next().is_none());
        let mut broad = broad_poses(&rig, &controls, 1);
        assert!(broad.next() != broad.next());
    }
}
