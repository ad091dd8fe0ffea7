//! Named degrees of freedom of a rig, bound to its bones.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};

use super::align::neutral_rotations;
use super::body::Body;
use super::error::{PoseError, hint};
use super::spec::{ControlsSpec, Half, Lateral, SwingSpec, mirrored_name, piecewise};
use crate::rig::{Clip, Pose, Rig, Skeleton};

/// One named degree of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// Its name, for instance `elbow_r.flexion`.
    pub name: String,
    /// Smallest value, degrees.
    pub min_deg: f32,
    /// Largest value, degrees.
    pub max_deg: f32,
    /// The value at ease, degrees.
    pub ease_deg: f32,
    /// How far the sampler strays from the ease, degrees.
    pub spread_deg: f32,
    /// The same control of the other side; itself in the middle.
    pub mirror: usize,
    /// Whether a mirrored body has the opposite value.
    pub odd: bool,
}

/// A value for every control, in the order of [`Controls::list`], and the height above the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseValues {
    /// One angle per control, degrees.
    pub degrees: Vec<f32>,
    /// How far the lowest point of the body is above the ground, metres.
    pub lift_m: f32,
}

/// A bone turned by a control about an axis of the neutral stance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    pub(super) control: usize,
    pub(super) axis: Vec3,
    pub(super) share: f32,
}

/// A ball joint, bound: the first of its three controls (plane, raise, twist) and its geometry.
#[derive(Debug, Clone)]
pub(super) struct Swing {
    pub(super) plane: usize,
    pub(super) bone: usize,
    pub(super) girdle: usize,
    /// +1 where the figure's left is, -1 at its right.
    pub(super) side: f32,
    pub(super) spec: SwingSpec,
}

/// The degrees of freedom of one rig: turns named angles into a [`crate::rig::Pose`].
#[derive(Debug, Clone)]
pub struct Controls {
    rig: String,
    list: Vec<Control>,
    by_name: BTreeMap<String, usize>,
    pub(super) skeleton: Skeleton,
    /// Rest to neutral stance, whole rotation per bone.
    pub(super) neutral: Vec<Quat>,
    /// Per bone, outermost first.
    pub(super) turns: Vec<Vec<Turn>>,
    pub(super) swings: Vec<Swing>,
    pub(super) lateral: Lateral,
    clips: Vec<Clip>,
    /// Per control the limb it belongs to, see [`ControlsSpec::limbs`].
    limb_of: Vec<Option<usize>>,
    limb_count: usize,
    whole_share: f32,
    body: Body,
}

impl Controls {
    /// Reads controls and binds them to a rig.
    ///
    /// # Errors
    /// [`PoseError::Syntax`] for a malformed file, [`PoseError::Rig`] where a bone is missing,
    /// [`PoseError::Inconsistent`] for contradictions.
    pub fn from_ron(text: &str, rig: &Rig) -> Result<Self, PoseError> {
        let spec: ControlsSpec =
            ron::from_str(text).map_err(|error| PoseError::syntax("the controls", &error))?;
        Self::bind(&spec, rig)
    }

    /// Binds a file of controls to a rig.
    ///
    /// # Errors
    /// As [`Controls::from_ron`].
    pub fn bind(spec: &ControlsSpec, rig: &Rig) -> Result<Self, PoseError> {
        if !(0.0..=1.0).contains(&spec.whole_share) {
            let why = format!(
                "{} is no share: give a number from 0 to 1",
                spec.whole_share
            );
            return Err(PoseError::inconsistent("whole_share", why));
        }
        let skeleton = rig.skeleton.clone();
        let mut controls = Self {
            rig: spec.rig.clone(),
            neutral: neutral_rotations(&skeleton, spec)?,
            turns: vec![Vec::new(); skeleton.bones.len()],
            list: Vec::new(),
            by_name: BTreeMap::new(),
            swings: Vec::new(),
            lateral: spec.lateral,
            clips: rig.clips.clone(),
            limb_of: Vec::new(),
            limb_count: 0,
            whole_share: spec.whole_share,
            body: Body::fit(rig, spec)?,
            skeleton,
        };
        controls.add_turns(spec)?;
        controls.add_swings(spec)?;
        controls.pair()?;
        controls.add_limbs(spec)?;
        Ok(controls)
    }

    fn add_limbs(&mut self, spec: &ControlsSpec) -> Result<(), PoseError> {
        self.limb_of = vec![None; self.list.len()];
        for stems in &spec.limbs {
            for &half in Half::of(&stems.concat()) {
                for stem in stems {
                    let stem = half.name(stem);
                    let place = format!("limb {}", self.limb_count + 1);
                    let mut known = false;
                    for (index, control) in self.list.iter().enumerate() {
                        if control.name.split('.').next() == Some(&stem) {
                            self.limb_of[index] = Some(self.limb_count);
                            known = true;
                        }
                    }
                    if !known {
                        self.index(&stem, &place)?;
                    }
                }
                self.limb_count += 1;
            }
        }
        Ok(())
    }

    fn add_turns(&mut self, spec: &ControlsSpec) -> Result<(), PoseError> {
        for control in &spec.controls {
            for &half in Half::of(&control.name) {
                let spread = control
                    .spread
                    .unwrap_or((control.limits.1 - control.limits.0) / 5.0);
                let index = self.add(
                    half.name(&control.name),
                    control.limits,
                    control.ease,
                    spread,
                )?;
                self.list[index].odd = control.odd;
                for drive in &control.drives {
                    let bone = self.skeleton.bone_index(&half.name(&drive.bone))?;
                    let axis = half.axis(drive.axis, spec.lateral).try_normalize();
                    let axis = axis.filter(|_| drive.share.is_finite()).ok_or_else(|| {
                        let why = "an axis has no length, or a share is no number";
                        PoseError::inconsistent(control.name.clone(), why)
                    })?;
                    self.turns[bone].push(Turn {
                        control: index,
                        axis,
                        share: drive.share,
                    });
                }
            }
        }
        Ok(())
    }

    fn add_swings(&mut self, spec: &ControlsSpec) -> Result<(), PoseError> {
        for swing in &spec.swings {
            for &half in Half::of(&swing.name) {
                let mut first = 0;
                for (i, kind) in ["plane", "raise", "twist"].into_iter().enumerate() {
                    let name = format!("{}.{kind}", half.name(&swing.name));
                    let index = self.add(name, swing.limits[i], swing.ease[i], swing.spread[i])?;
                    if i == 0 {
                        first = index;
                    }
                }
                self.swings.push(Swing {
                    plane: first,
                    bone: self.skeleton.bone_index(&half.name(&swing.bone))?,
                    girdle: self.skeleton.bone_index(&half.name(&swing.girdle))?,
                    side: half.direction(Vec3::X, Lateral::X).x,
                    spec: swing.clone(),
                });
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        name: String,
        (min_deg, max_deg): (f32, f32),
        ease_deg: f32,
        spread_deg: f32,
    ) -> Result<usize, PoseError> {
        let index = self.list.len();
        if !(min_deg <= ease_deg && ease_deg <= max_deg) {
            let why = format!("the ease {ease_deg} is not between {min_deg} and {max_deg}");
            return Err(PoseError::inconsistent(name, why));
        }
        if !(spread_deg.is_finite() && min_deg.is_finite() && max_deg.is_finite()) {
            let why = format!(
                "its spread is {spread_deg} and its limits are {min_deg} and {max_deg}; degrees are expected"
            );
            return Err(PoseError::inconsistent(name, why));
        }
        if self.by_name.insert(name.clone(), index).is_some() {
            return Err(PoseError::inconsistent(
                name,
                "this control is defined twice",
            ));
        }
        let mirror = index;
        self.list.push(Control {
            name,
            min_deg,
            max_deg,
            ease_deg,
            spread_deg,
            mirror,
            odd: false,
        });
        Ok(index)
    }

    fn pair(&mut self) -> Result<(), PoseError> {
        for index in 0..self.list.len() {
            self.list[index].mirror =
                self.index(&mirrored_name(&self.list[index].name), "the controls")?;
        }
        Ok(())
    }

    /// All controls. [`PoseValues::degrees`] has this order.
    pub fn list(&self) -> &[Control] {
        &self.list
    }

    /// What the file of controls calls the rig; pose libraries are for the same.
    pub fn rig(&self) -> &str {
        &self.rig
    }

    /// The motions that came with the rig.
    pub fn clips(&self) -> &[Clip] {
        &self.clips
    }

    /// The control that bows the body as a whole, if there is one.
    pub fn body_pitch(&self) -> Option<usize> {
        self.list
            .iter()
            .position(|control| control.name == "body.pitch")
    }

    /// The limb that control `index` belongs to, of [`Controls::limb_count`]; none: the trunk and what
    /// stays with it.
    pub fn limb_of(&self, index: usize) -> Option<usize> {
        self.limb_of.get(index).copied().flatten()
    }

    /// How many limbs may be posed apart from the trunk.
    pub fn limb_count(&self) -> usize {
        self.limb_count
    }

    /// See [`ControlsSpec::whole_share`].
    pub fn whole_share(&self) -> f32 {
        self.whole_share
    }

    /// The body's parts: what touches the ground, and what may not run into each other.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The index of the control called `name`; `place` goes into the error.
    ///
    /// # Errors
    /// [`PoseError::UnknownControl`] with the nearest valid name.
    pub fn index(&self, name: &str, place: &str) -> Result<usize, PoseError> {
        self.by_name
            .get(name)
            .copied()
            .ok_or_else(|| PoseError::UnknownControl {
                place: place.to_owned(),
                name: name.to_owned(),
                hint: hint(name, self.by_name.keys().map(String::as_str)),
            })
    }

    /// The indices that a name in a pose stands for: `elbow.flexion` means both elbows, `hip_r` all
    /// that the right hip can do, `ankle` all of both ankles.
    ///
    /// # Errors
    /// [`PoseError::UnknownControl`] with the nearest valid name.
    pub fn indices(&self, name: &str, place: &str) -> Result<Vec<usize>, PoseError> {
        let (stem, kind) = name
            .split_once('.')
            .map_or((name, None), |(a, b)| (a, Some(b)));
        let meant = |control: &Control| {
            let (own, own_kind) = control.name.split_once('.').unwrap_or((&control.name, ""));
            let unsided = own
                .strip_suffix("_l")
                .or_else(|| own.strip_suffix("_r"))
                .unwrap_or(own);
            (own == stem || unsided == stem) && kind.is_none_or(|kind| kind == own_kind)
        };
        let found: Vec<usize> = (0..self.list.len())
            .filter(|&i| meant(&self.list[i]))
            .collect();
        if found.is_empty() {
            self.index(name, place).map(|index| vec![index])
        } else {
            Ok(found)
        }
    }

    /// A moment of one of the rig's own clips.
    pub(super) fn clip_pose(
        &self,
        name: &str,
        time_s: f32,
        place: &str,
    ) -> Result<Pose, PoseError> {
        let names = self.clips.iter().map(|clip| clip.name.as_str());
        let clip = self.clips.iter().find(|clip| clip.name == name);
        let clip = clip.ok_or_else(|| {
            let why = format!("the rig has no clip `{name}`; {}", hint(name, names));
            PoseError::inconsistent(place, why)
        })?;
        let inside = (0.0..=clip.duration_s()).contains(&time_s);
        clip.sample(time_s).filter(|_| inside).ok_or_else(|| {
            let why = format!(
                "clip `{name}` lasts {} s and has no moment at {time_s} s",
                clip.duration_s()
            );
            PoseError::inconsistent(place, why)
        })
    }

    /// Everything at ease, on the ground.
    pub fn ease(&self) -> PoseValues {
        PoseValues {
            degrees: self.list.iter().map(|c| c.ease_deg).collect(),
            lift_m: 0.0,
        }
    }

    /// The limits of control `index`, degrees. The highest raise depends on the plane it is in.
    pub fn limits(&self, index: usize, values: &PoseValues) -> (f32, f32) {
        let control = &self.list[index];
        let mut max = control.max_deg;
        if let Some(swing) = self.swings.iter().find(|swing| swing.plane + 1 == index) {
            max = max.min(piecewise(
                &swing.spec.raise_max,
                values.degrees[swing.plane],
            ));
        }
        (control.min_deg, max)
    }

    /// Brings every value inside its limits.
    pub fn clamp(&self, values: &mut PoseValues) {
        // A swing's plane comes before its raise, so that the raise meets the final plane.
        for index in 0..self.list.len() {
            let (min, max) = self.limits(index, values);
            values.degrees[index] = values.degrees[index].clamp(min, max);
        }
    }

    /// Whether all values lie inside their limits (to a hundredth of a degree).
    ///
    /// # Errors
    /// [`PoseError::OutsideLimits`] for the first that does not; `place` says whose values these are.
    pub fn check(&self, values: &PoseValues, place: &str) -> Result<(), PoseError> {
        for (index, (control, &degrees)) in self.list.iter().zip(&values.degrees).enumerate() {
            let (min, max) = self.limits(index, values);
            if !(degrees >= min - 0.01 && degrees <= max + 0.01) {
                return Err(PoseError::OutsideLimits {
                    place: place.to_owned(),
                    name: control.name.clone(),
                    degrees,
                    min,
                    max,
                });
            }
        }
        Ok(())
    }

    /// The mirror image: left and right exchanged, turns to a side reversed.
    #[must_use]
    pub fn mirror(&self, values: &PoseValues) -> PoseValues {
        let degrees = self.list.iter().map(|control| {
            let value = values.degrees[control.mirror];
            if control.odd { -value } else { value }
        });
        PoseValues {
            degrees: degrees.collect(),
            lift_m: values.lift_m,
        }
    }

    /// `sum of weight x pose` over the given poses, kept inside the limits.
    #[must_use]
    pub fn blend(&self, poses: &[(f32, &PoseValues)]) -> PoseValues {
        let mut blended = PoseValues {
            degrees: vec![0.0; self.list.len()],
            lift_m: 0.0,
        };
        for (weight, pose) in poses {
            blended.lift_m += weight * pose.lift_m;
            for (sum, degrees) in blended.degrees.iter_mut().zip(&pose.degrees) {
                *sum += weight * degrees;
            }
        }
        self.clamp(&mut blended);
        blended
    }
}
