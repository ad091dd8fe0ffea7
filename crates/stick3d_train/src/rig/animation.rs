//! Reading a file's animations (glTF 2.0, section 3.11 and appendix C).

use glam::{Quat, Vec3, Vec4};
use gltf::animation::util::ReadOutputs;
use gltf::animation::{Channel, Interpolation, Property};

use super::RigError;
use super::clips::short_way;
use super::nodes::{Local, NodeTree};
use super::open::{Source, named};

/// Poses are taken at all keys and at least this often, seconds: between keys, rotations in the file's
/// own terms and rotations against the rest part ways a little.
const LONGEST_STEP_S: f32 = 1.0 / 30.0;

/// How long before a step's key the old value is taken once more, seconds.
const BEFORE_STEP_S: f32 = 1e-4;

/// The longest animation that is read, in poses.
const MOST_POSES: usize = 100_000;

/// One animated property of one node.
#[derive(Debug)]
struct Track {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    times_s: Vec<f32>,
    /// Per key one value, for cubic splines three: in-tangent, value, out-tangent.
    values: Vec<Vec4>,
}

/// One animation of a file.
#[derive(Debug)]
pub(super) struct Animation {
    pub(super) name: String,
    tracks: Vec<Track>,
}

impl Animation {
    /// All animations of a file that move nodes.
    pub(super) fn read_all(source: &Source) -> Result<Vec<Self>, RigError> {
        let mut animations = Vec::new();
        for animation in source.document.animations() {
            let name = animation
                .name()
                .map_or_else(|| format!("clip_{}", animation.index()), str::to_owned);
            let mut tracks = Vec::new();
            for channel in animation.channels() {
                let place = || {
                    format!(
                        "animation {}, channel {}",
                        named(animation.name(), animation.index()),
                        channel.index()
                    )
                };
                tracks.extend(
                    read_track(source, &channel).map_err(|why| RigError::Accessor {
                        accessor: channel.sampler().output().index(),
                        place: place(),
                        why,
                    })?,
                );
            }
            if !tracks.is_empty() {
                animations.push(Self { name, tracks });
            }
        }
        Ok(animations)
    }

    /// The times at which poses are taken, seconds.
    ///
    /// # Errors
    /// An animation of more than [`MOST_POSES`] poses.
    pub(super) fn times_s(&self) -> Result<Vec<f32>, RigError> {
        let mut keys: Vec<f32> = Vec::new();
        for track in &self.tracks {
            keys.extend(&track.times_s);
            if track.interpolation == Interpolation::Step {
                keys.extend(track.times_s.iter().skip(1).map(|key| key - BEFORE_STEP_S));
            }
        }
        keys.sort_by(f32::total_cmp);
        keys.dedup_by(|a, b| *a - *b < BEFORE_STEP_S / 2.0);
        let mut times: Vec<f32> = Vec::new();
        for pair in keys.windows(2) {
            // A little less, so that rounded times of 30 a second do not count as longer steps.
            let steps = ((pair[1] - pair[0]) / LONGEST_STEP_S - 0.01)
                .ceil()
                .max(1.0);
            if steps.is_nan() || steps >= MOST_POSES as f32 || times.len() > MOST_POSES {
                return Err(RigError::Unsupported {
                    what: format!("the overlong animation `{}`", self.name),
                });
            }
            times.extend(
                (0..steps as usize).map(|step| pair[0] + (pair[1] - pair[0]) * step as f32 / steps),
            );
        }
        times.extend(keys.last());
        Ok(times)
    }

    /// Where every node is in its parent at a time.
    pub(super) fn posture(&self, nodes: &NodeTree, time_s: f32) -> Vec<Local> {
        let mut posture = nodes.locals.clone();
        for track in &self.tracks {
            let value = track.at(time_s);
            let local = &mut posture[track.node];
            match track.property {
                Property::Translation => local.translation = value.truncate(),
                Property::Scale => local.scale = value.truncate(),
                Property::Rotation => local.rotation = Quat::from_vec4(value).normalize(),
                Property::MorphTargetWeights => {}
            }
        }
        posture
    }

    /// A node whose scale leaves that of the rest by more than a hundredth.
    pub(super) fn scaled_node(&self, nodes: &NodeTree) -> Option<usize> {
        let scales = |track: &&Track| {
            let rest = nodes.locals[track.node].scale;
            track.property == Property::Scale
                && (0..track.times_s.len()).any(|key| {
                    let scale = track.value(key).truncate();
                    (scale - rest).abs().max_element() > 0.01 * rest.abs().max_element()
                })
        };
        self.tracks.iter().find(scales).map(|track| track.node)
    }
}

/// Reads a channel; `None` where it moves no node or has no keys.
fn read_track(source: &Source, channel: &Channel<'_>) -> Result<Option<Track>, String> {
    let property = channel.target().property();
    if property == Property::MorphTargetWeights {
        return Ok(None);
    }
    let reader = channel.reader(|buffer| source.bytes(&buffer));
    let (Some(times), Some(outputs)) = (reader.read_inputs(), reader.read_outputs()) else {
        return Ok(None);
    };
    let times_s: Vec<f32> = times.collect();
    let values: Vec<Vec4> = match outputs {
        ReadOutputs::Translations(list) | ReadOutputs::Scales(list) => {
            list.map(|v| Vec3::from(v).extend(0.0)).collect()
        }
        ReadOutputs::Rotations(list) => list.into_f32().map(Vec4::from).collect(),
        ReadOutputs::MorphTargetWeights(_) => return Ok(None),
    };
    let interpolation = channel.sampler().interpolation();
    let per_key = if interpolation == Interpolation::CubicSpline {
        3
    } else {
        1
    };
    if times_s.len() * per_key != values.len() {
        return Err(format!(
            "{} keys but {} values",
            times_s.len(),
            values.len()
        ));
    }
    if times_s
        .windows(2)
        .any(|pair| pair[0].is_nan() || pair[1].is_nan() || pair[0] >= pair[1])
    {
        return Err("its key times do not ascend".into());
    }
    let finite = times_s.iter().all(|time| time.is_finite() && *time >= 0.0)
        && values.iter().all(|value| value.is_finite());
    if !finite {
        return Err("a time or value is no finite number".into());
    }
    let node = channel.target().node().index();
    Ok((!times_s.is_empty()).then_some(Track {
        node,
        property,
        interpolation,
        times_s,
        values,
    }))
}

impl Track {
    /// The value at a key.
    fn value(&self, key: usize) -> Vec4 {
        match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * key + 1],
            _ => self.values[key],
        }
    }

    fn at(&self, time_s: f32) -> Vec4 {
        let after = self.times_s.partition_point(|&key| key <= time_s);
        let Some(before) = after.checked_sub(1) else {
            return self.value(0);
        };
        if after == self.times_s.len() {
            return self.value(before);
        }
        let span = self.times_s[after] - self.times_s[before];
        let part = (time_s - self.times_s[before]) / span;
        let (from, to) = (self.value(before), self.value(after));
        match self.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear if self.property == Property::Rotation => {
                let (from, to) = (Quat::from_vec4(from), Quat::from_vec4(to));
                short_way(from.normalize(), to.normalize(), part).into()
            }
            Interpolation::Linear => from.lerp(to, part),
            Interpolation::CubicSpline => {
                let (out, into) = (self.values[3 * before + 2], self.values[3 * after]);
                hermite(part, from, out * span, to, into * span)
            }
        }
    }
}

/// The cubic through two values with given slopes (appendix C.5).
fn hermite(t: f32, from: Vec4, slope_from: Vec4, to: Vec4, slope_to: Vec4) -> Vec4 {
    let (t2, t3) = (t * t, t * t * t);
    from * (2.0 * t3 - 3.0 * t2 + 1.0)
        + slope_from * (t3 - 2.0 * t2 + t)
        + to * (3.0 * t2 - 2.0 * t3)
        + slope_to * (t3 - t2)
}
