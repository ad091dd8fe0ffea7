//! Poses for a library from the rig's own clips, and from the joints' limits where those are too few.

use std::collections::BTreeSet;

use super::controls::Controls;
use super::library::{NamedPose, PoseLibrary};
use super::sampler::{PoseSampler, SampleKind};
use crate::rig::{Clip, Pose, Rig};

/// Into how many stretches a clip is parted; a library is split between them, so that what is held out is not a
/// moment beside one that was trained on.
const STRETCHES: usize = 4;

/// The fewest moments of a clip.
const LEAST_MOMENTS: usize = STRETCHES;

/// Seed of the poses that fill up a library.
const FILLING_SEED: u64 = 0xf111;

/// How far a clip turns all bones on its way, radians.
fn liveliness(clip: &Clip) -> f32 {
    let steps = clip.poses.iter().zip(clip.poses.iter().skip(1));
    let step = |(before, after): (&Pose, &Pose)| -> f32 {
        let bones = before.rotations.iter().zip(&after.rotations);
        bones.map(|(from, to)| from.angle_between(*to)).sum()
    };
    steps.map(step).sum()
}

impl PoseLibrary {
    /// About `count` moments of the rig's clips, called `CLIP@SECONDS`: the more a clip moves the more of them, evenly
    /// spread over it.
    ///
    /// With controls that can make any rotation ([`Controls::unfold`]) they are exactly the clips' poses, else as near as
    /// the controls come.
    #[must_use]
    pub fn from_clips(controls: &Controls, count: usize) -> Self {
        let total: f32 = controls.clips().iter().map(liveliness).sum();
        let mut library = Self::default();
        let mut names = BTreeSet::new();
        for clip in controls.clips() {
            let share = liveliness(clip) / total.max(f32::MIN_POSITIVE);
            let moments = if clip.duration_s() > 0.0 {
                ((count as f32 * share).round() as usize).max(LEAST_MOMENTS)
            } else {
                1
            };
            library.add_moments(clip, moments, controls, &mut names);
        }
        library
    }

    fn add_moments(
        &mut self,
        clip: &Clip,
        moments: usize,
        controls: &Controls,
        names: &mut BTreeSet<String>,
    ) {
        let mut before = controls.ease();
        let step_s = clip.duration_s() / moments.max(1) as f32;
        for (number, pose) in clip.spread(moments).iter().enumerate() {
            let (values, clip_miss_rad) = match controls.unfold(pose) {
                Some(values) => (values, 0.0),
                None => controls.fit_from(pose, &before),
            };
            let name = format!("{}@{:.3}", clip.name, step_s * number as f32);
            // Clips of one name are told apart by nobody; the first is kept.
            if names.insert(name.clone()) {
                self.poses.push(NamedPose {
                    name,
                    values: values.clone(),
                    family: format!("{} {}", clip.name, number * STRETCHES / moments),
                    clip_miss_rad,
                    miss: 0.0,
                });
            }
            before = values;
        }
    }

    /// Adds poses from inside the joints' limits, called `free_1` and so on, until there are `count`.
    pub fn fill(&mut self, rig: &Rig, controls: &Controls, count: usize) {
        let mut sampler = PoseSampler::new(rig, controls, &Self::default(), FILLING_SEED);
        for number in 1..=count.saturating_sub(self.poses.len()) {
            let name = format!("free_{number}");
            self.poses.push(NamedPose {
                values: sampler.sample_values(SampleKind::Free),
                family: name.clone(),
                name,
                clip_miss_rad: 0.0,
                miss: 0.0,
            });
        }
    }
}
