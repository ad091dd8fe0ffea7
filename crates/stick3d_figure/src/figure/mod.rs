//! A figure: a kind of articulated body as data: its joints, its sketch path, its bones, its template.

mod error;
mod file;
mod limbs;
mod views;

use std::sync::LazyLock;

use glam::Vec2;
use serde::{Deserialize, Serialize};

pub use error::FigureError;
use file::FigureFile;
pub use limbs::Limb;
pub use views::Views;

use crate::names;

const HUMAN_RON: &str = include_str!("../../figures/human.ron");
const HORSE_RON: &str = include_str!("../../figures/horse.ron");

// Not input: the texts are compiled in, and unit tests load them.
static HUMAN: LazyLock<Figure> =
    LazyLock::new(|| Figure::from_ron(HUMAN_RON).expect("the embedded human figure is valid"));
static HORSE: LazyLock<Figure> =
    LazyLock::new(|| Figure::from_ron(HORSE_RON).expect("the embedded horse figure is valid"));

/// Which half of the body a joint belongs to, from the figure's own point of view.
///
/// In a front view of the human his right is on the viewer's left, at negative x.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Side {
    /// On the middle plane of the body.
    #[default]
    Center,
    /// The figure's own left.
    Left,
    /// The figure's own right.
    Right,
}

/// Where a joint sits on a rig.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Anchor {
    /// At the mean of the heads of these bones of the rig.
    Bones(Vec<String>),
    /// At the mean of these vertices of the mesh. An empty list says that no mesh has been baked for
    /// the figure yet.
    Vertices(Vec<u32>),
}

/// One landmark point of a figure.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Joint {
    /// Unique within the figure.
    pub name: String,
    /// Which half of the body it is on.
    pub side: Side,
    /// Where it is on a rig of the figure.
    pub anchor: Anchor,
}

/// A kind of articulated body: what is drawn, in which order, and how it is built.
///
/// Made by [`Figure::human`], [`Figure::horse`], [`Figure::from_ron`] or any serde format; all of them validate. Joints are
/// referred to by their index in [`joints`](Self::joints), in files by their name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "FigureFile", into = "FigureFile")]
#[non_exhaustive]
pub struct Figure {
    /// What files call the figure: `"human"`.
    pub name: String,
    /// The landmark points.
    pub joints: Vec<Joint>,
    /// The sketch path: the joints in the order in which they are drawn. Joints repeat where a bone is
    /// retraced, neighbours are always joined by a bone.
    pub path: Vec<usize>,
    /// Which joints are joined by a line. Together they are a tree over all joints.
    pub bones: Vec<[usize; 2]>,
    /// From where the figure is usually drawn.
    pub views: Views,
    /// The figure at rest in its usual view: one point per joint, metres, x right, y up.
    pub template: Vec<Vec2>,
    /// The joint at which decoded meshes are centred.
    pub root: usize,
    mirror: Vec<usize>,
}

impl Figure {
    /// The human: 11 joints, a path of 17 points.
    pub fn human() -> &'static Self {
        &HUMAN
    }

    /// The horse: 12 joints, a path of 20 points.
    pub fn horse() -> &'static Self {
        &HORSE
    }

    /// The figures of this crate.
    pub fn shipped() -> [&'static Self; 2] {
        [Self::human(), Self::horse()]
    }

    /// Reads a figure from RON text (the form of `figures/human.ron` in this crate).
    ///
    /// # Errors
    /// [`FigureError::Syntax`] with line and column when the text is not RON of that form; the other
    /// variants when what it says does not fit together.
    pub fn from_ron(text: &str) -> Result<Self, FigureError> {
        let file: FigureFile = ron::from_str(text).map_err(|e| FigureError::Syntax {
            line: e.span.start.line,
            column: e.span.start.col,
            message: e.code.to_string(),
        })?;
        file.try_into()
    }

    /// Writes the figure as RON text that [`Figure::from_ron`] reads back to an equal figure.
    ///
    /// # Errors
    /// [`FigureError::Write`] when the serialiser gives up.
    pub fn to_ron(&self) -> Result<String, FigureError> {
        let style = ron::ser::PrettyConfig::new()
            .depth_limit(3)
            .struct_names(true);
        ron::ser::to_string_pretty(&FigureFile::from(self.clone()), style)
            .map_err(|e| FigureError::Write(e.to_string()))
    }

    /// The index of the joint called `name`.
    ///
    /// # Errors
    /// [`FigureError::UnknownJoint`], which names the nearest joint.
    pub fn joint_index(&self, name: &str) -> Result<usize, FigureError> {
        self.joints
            .iter()
            .position(|j| j.name == name)
            .ok_or_else(|| FigureError::UnknownJoint {
                figure: self.name.clone(),
                name: name.to_owned(),
                suggestion: names::suggestion(name, self.joints.iter().map(|j| j.name.as_str())),
            })
    }

    /// The figure without one of its ends, as for a body that has no tail.
    ///
    /// # Errors
    /// [`FigureError::UnknownJoint`]; [`FigureError::Inconsistent`] or [`FigureError::NoMirror`] when the rest is no
    /// figure, as the joint was none that ends a limb of the middle.
    pub fn without(&self, joint: &str) -> Result<Self, FigureError> {
        self.joint_index(joint)?;
        FigureFile::from(self.clone()).without(joint).try_into()
    }

    /// The joint on the other side of the body; a joint of the middle, or an index out of range, is its own mirror.
    pub fn mirror_of(&self, joint: usize) -> usize {
        self.mirror.get(joint).copied().unwrap_or(joint)
    }

    /// How many joints the figure has.
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// How many points the sketch path has.
    pub fn path_len(&self) -> usize {
        self.path.len()
    }

    /// How many numbers the input vector has: two per path point.
    pub fn input_len(&self) -> usize {
        2 * self.path.len()
    }

    /// The length of a bone in the template, metres; 0 where the figure has no such bone index.
    pub fn template_bone_length(&self, bone: usize) -> f32 {
        self.bones
            .get(bone)
            .map_or(0.0, |&[a, b]| self.template[a].distance(self.template[b]))
    }

    /// How many bones meet at a joint: one at the end of a limb.
    pub fn bones_at(&self, joint: usize) -> usize {
        let meets = |bone: &&[usize; 2]| bone.contains(&joint);
        self.bones.iter().filter(meets).count()
    }

    /// The bones from the root outward, each as (nearer the root, farther from it): a bone comes after the one that it hangs
    /// on. Of a figure's bones, which are a tree over all joints, none is left out.
    pub fn bones_outward(&self) -> Vec<[usize; 2]> {
        let mut reached = vec![false; self.joints.len()];
        if let Some(root) = reached.get_mut(self.root) {
            *root = true;
        }
        let mut outward = Vec::with_capacity(self.bones.len());
        for _ in &self.bones {
            for &[a, b] in &self.bones {
                let bone = match (reached[a], reached[b]) {
                    (true, false) => [a, b],
                    (false, true) => [b, a],
                    _ => continue,
                };
                reached[bone[1]] = true;
                outward.push(bone);
            }
        }
        outward
    }

    /// The largest distance between two points of the template, metres.
    pub fn template_extent_m(&self) -> f32 {
        let pairs = self
            .template
            .iter()
            .flat_map(|a| self.template.iter().map(|b| a.distance(*b)));
        pairs.fold(0.0, f32::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bones_lead_outward_and_reach_every_joint() {
        for figure in Figure::shipped() {
            let outward = figure.bones_outward();
            assert_eq!(outward.len(), figure.bones.len());
            let mut reached = vec![figure.root];
            for [near, far] in outward {
                assert!(reached.contains(&near) && !reached.contains(&far));
                reached.push(far);
            }
            assert_eq!(reached.len(), figure.joint_count());
        }
    }

    #[test]
    fn the_human_is_the_one_of_the_paper() {
        let human = Figure::human();
        assert_eq!(
            (human.joint_count(), human.path_len(), human.input_len()),
            (11, 17, 34)
        );
        assert_eq!(human.joints[human.root].name, "abdomen");
        let path: Vec<&str> = human
            .path
            .iter()
            .map(|&j| human.joints[j].name.as_str())
            .collect();
        let expected = "forehead neck elbow_r hand_r elbow_r neck elbow_l hand_l elbow_l neck abdomen knee_r foot_r knee_r abdomen knee_l foot_l";
        assert_eq!(path.join(" "), expected);
        for (i, joint) in human.joints.iter().enumerate() {
            let mirror = human.mirror_of(i);
            assert_eq!(human.mirror_of(mirror), i);
            assert_eq!(mirror == i, joint.side == Side::Center);
            // Right is at negative x in a front view.
            match joint.side {
                Side::Center => assert_eq!(human.template[i].x, 0.0),
                Side::Left => assert!(human.template[i].x > 0.0),
                Side::Right => assert!(human.template[i].x < 0.0),
            }
        }
    }

    #[test]
    fn the_horse_is_the_one_of_the_paper_seen_from_its_right() {
        let horse = Figure::horse();
        assert_eq!(
            (horse.joint_count(), horse.path_len(), horse.input_len()),
            (12, 20, 40)
        );
        assert_eq!(horse.joints[horse.root].name, "hip");
        let path: Vec<&str> = horse
            .path
            .iter()
            .map(|&j| horse.joints[j].name.as_str())
            .collect();
        let expected = "forehead shoulder knee_fr foot_fr knee_fr shoulder knee_fl foot_fl knee_fl shoulder hip knee_br foot_br knee_br hip knee_bl foot_bl knee_bl hip tail";
        assert_eq!(path.join(" "), expected);
        let at = |name: &str| horse.template[horse.joint_index(name).unwrap()];
        assert!(at("forehead").x > at("shoulder").x && at("hip").x > at("tail").x);
        for (i, joint) in horse.joints.iter().enumerate() {
            let mirror = horse.mirror_of(i);
            assert_eq!(horse.mirror_of(mirror), i);
            assert_eq!(mirror == i, joint.side == Side::Center, "{}", joint.name);
        }
        let pair =
            |a, b| horse.mirror_of(horse.joint_index(a).unwrap()) == horse.joint_index(b).unwrap();
        assert!(pair("knee_fr", "knee_fl") && pair("foot_br", "foot_bl"));
        assert!(horse.views.both_ways && !Figure::human().views.both_ways);
    }

    #[test]
    fn ron_and_json_round_trip() {
        for figure in Figure::shipped() {
            let again = Figure::from_ron(&figure.to_ron().unwrap()).unwrap();
            assert_eq!(&again, figure);
            let json = serde_json::to_string(figure).unwrap();
            assert_eq!(&serde_json::from_str::<Figure>(&json).unwrap(), figure);
        }
        // What is as usual is not written: files stay as they were before there were views.
        assert!(
            !serde_json::to_string(Figure::human())
                .unwrap()
                .contains("views")
        );
    }

    #[test]
    fn an_end_may_be_left_out() {
        let horse = Figure::horse();
        let bobtail = horse.without("tail").unwrap();
        assert_eq!((bobtail.joint_count(), bobtail.path_len()), (11, 19));
        assert_eq!(bobtail.joints[bobtail.path[18]].name, "hip");
        let headless = horse.without("forehead").unwrap();
        assert_eq!(headless.joints[headless.path[0]].name, "shoulder");
        let pair = ["knee_fr", "knee_fl"].map(|name| bobtail.joint_index(name).unwrap());
        assert_eq!(bobtail.mirror_of(pair[0]), pair[1]);
        for joint in ["shoulder", "foot_fr", "hip", "tale"] {
            assert!(horse.without(joint).is_err(), "{joint}");
        }
    }

    #[test]
    fn views_beyond_a_circle_are_refused() {
        let text = HORSE_RON.replace("yaw_deg: 65.0", "yaw_deg: 365.0");
        let message = Figure::from_ron(&text).unwrap_err().to_string();
        assert!(
            message.contains("yaw_deg") && message.contains("365"),
            "{message}"
        );
    }

    #[test]
    fn an_unknown_joint_is_answered_with_the_nearest_name() {
        let message = Figure::human()
            .joint_index("elbowr")
            .unwrap_err()
            .to_string();
        assert!(message.contains("elbow_r"), "{message}");
    }
}
