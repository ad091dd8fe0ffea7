//! The file form of a figure, in which joints are named, and the checks between the two forms.

use glam::Vec2;
use serde::{Deserialize, Serialize};

use super::{Anchor, Figure, FigureError, Joint, Side, Views};
use crate::names;

/// More joints than any figure can be drawn with: a limit for files from elsewhere.
const MAX_JOINTS: usize = 256;
const MAX_PATH: usize = 1024;

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename = "Figure", deny_unknown_fields)]
pub(super) struct FigureFile {
    name: String,
    root: String,
    /// Named only where they are not the usual ones.
    #[serde(default, skip_serializing_if = "Views::are_usual")]
    views: Views,
    joints: Vec<JointEntry>,
    path: Vec<String>,
    bones: Vec<(String, String)>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct JointEntry {
    name: String,
    side: Side,
    template: (f32, f32),
    anchor: Anchor,
    /// Named only where it is not the joint's own name with `r` and `l` exchanged at the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mirror: Option<String>,
}

impl From<Figure> for FigureFile {
    fn from(figure: Figure) -> Self {
        let name = |j: usize| figure.joints[j].name.clone();
        Self {
            root: name(figure.root),
            views: figure.views,
            joints: figure
                .joints
                .iter()
                .enumerate()
                .map(|(i, joint)| JointEntry {
                    name: joint.name.clone(),
                    side: joint.side,
                    template: figure.template[i].into(),
                    anchor: joint.anchor.clone(),
                    mirror: (joint.side != Side::Center
                        && name(figure.mirror[i]) != mirrored_name(&joint.name))
                    .then(|| name(figure.mirror[i])),
                })
                .collect(),
            path: figure.path.iter().map(|&j| name(j)).collect(),
            bones: figure
                .bones
                .iter()
                .map(|&[a, b]| (name(a), name(b)))
                .collect(),
            name: figure.name,
        }
    }
}

impl TryFrom<FigureFile> for Figure {
    type Error = FigureError;

    fn try_from(file: FigureFile) -> Result<Self, FigureError> {
        let check = Check { file: &file };
        check.sizes_and_names()?;
        let path = file
            .path
            .iter()
            .map(|n| check.index(n))
            .collect::<Result<Vec<_>, _>>()?;
        let bones = file
            .bones
            .iter()
            .map(|(a, b)| Ok([check.index(a)?, check.index(b)?]))
            .collect::<Result<Vec<_>, FigureError>>()?;
        check.tree(&bones)?;
        check.path_follows_bones(&path, &bones)?;
        check.template_and_anchors(&bones)?;
        if let Some(fault) = file.views.fault() {
            return check.wrong(fault);
        }
        let (root, mirror) = (check.index(&file.root)?, check.mirrors()?);
        let template = file.joints.iter().map(|j| Vec2::from(j.template)).collect();
        let joints = file
            .joints
            .into_iter()
            .map(|j| Joint {
                name: j.name,
                side: j.side,
                anchor: j.anchor,
            })
            .collect();
        Ok(Self {
            name: file.name,
            joints,
            path,
            bones,
            views: file.views,
            template,
            root,
            mirror,
        })
    }
}

impl FigureFile {
    /// The file without a joint, its bones and its points of the path; a point that is then visited twice at once is
    /// visited once.
    pub(super) fn without(mut self, joint: &str) -> Self {
        self.joints.retain(|entry| entry.name != joint);
        self.bones.retain(|(a, b)| a != joint && b != joint);
        self.path.retain(|name| name != joint);
        self.path.dedup();
        self
    }
}

struct Check<'a> {
    file: &'a FigureFile,
}

impl Check<'_> {
    fn wrong<T>(&self, message: String) -> Result<T, FigureError> {
        Err(FigureError::Inconsistent {
            figure: self.file.name.clone(),
            message,
        })
    }

    fn index(&self, name: &str) -> Result<usize, FigureError> {
        self.file
            .joints
            .iter()
            .position(|j| j.name == name)
            .ok_or_else(|| FigureError::UnknownJoint {
                figure: self.file.name.clone(),
                name: name.to_owned(),
                suggestion: names::suggestion(
                    name,
                    self.file.joints.iter().map(|j| j.name.as_str()),
                ),
            })
    }

    fn sizes_and_names(&self) -> Result<(), FigureError> {
        let joints = &self.file.joints;
        if self.file.name.is_empty() {
            return self.wrong("the figure needs a name".into());
        }
        if !(2..=MAX_JOINTS).contains(&joints.len()) {
            return self.wrong(format!(
                "{} joints; a figure has between 2 and {MAX_JOINTS}",
                joints.len()
            ));
        }
        if self.file.path.len() > MAX_PATH {
            return self.wrong(format!(
                "a path of {} points; at most {MAX_PATH} are allowed",
                self.file.path.len()
            ));
        }
        for (i, joint) in joints.iter().enumerate() {
            if joint.name.is_empty() {
                return self.wrong(format!("joint {i} has no name"));
            }
            if joints[..i].iter().any(|j| j.name == joint.name) {
                return Err(FigureError::DuplicateJoint {
                    figure: self.file.name.clone(),
                    name: joint.name.clone(),
                });
            }
        }
        Ok(())
    }

    /// A tree: one bone fewer than joints, and no bone closes a ring.
    fn tree(&self, bones: &[[usize; 2]]) -> Result<(), FigureError> {
        let count = self.file.joints.len();
        if bones.len() + 1 != count {
            return self.wrong(format!(
                "{} bones for {count} joints; a tree needs {}",
                bones.len(),
                count - 1
            ));
        }
        let mut group: Vec<usize> = (0..count).collect();
        for &[a, b] in bones {
            let (keep, merge) = (group[a], group[b]);
            if keep == merge {
                let name = |j: usize| &self.file.joints[j].name;
                return self.wrong(format!(
                    "the bone from \"{}\" to \"{}\" closes a ring; bones must form a tree",
                    name(a),
                    name(b)
                ));
            }
            for g in &mut group {
                if *g == merge {
                    *g = keep;
                }
            }
        }
        Ok(())
    }

    fn path_follows_bones(&self, path: &[usize], bones: &[[usize; 2]]) -> Result<(), FigureError> {
        for (i, joint) in self.file.joints.iter().enumerate() {
            if !path.contains(&i) {
                return self.wrong(format!(
                    "joint \"{}\" is never visited by the path",
                    joint.name
                ));
            }
        }
        for (at, pair) in path.windows(2).enumerate() {
            let (a, b) = (pair[0], pair[1]);
            if !bones.iter().any(|bone| *bone == [a, b] || *bone == [b, a]) {
                let name = |j: usize| &self.file.joints[j].name;
                return self.wrong(format!(
                    "path points {at} and {} are \"{}\" and \"{}\", which no bone joins",
                    at + 1,
                    name(a),
                    name(b)
                ));
            }
        }
        Ok(())
    }

    fn template_and_anchors(&self, bones: &[[usize; 2]]) -> Result<(), FigureError> {
        for joint in &self.file.joints {
            let (x, y) = joint.template;
            if !(x.abs() <= 1.0e3 && y.abs() <= 1.0e3) {
                return self.wrong(format!(
                    "the template point of \"{}\" is ({x}, {y}); metres within 1000 are expected",
                    joint.name
                ));
            }
            if matches!(&joint.anchor, Anchor::Bones(bones) if bones.is_empty()) {
                return self.wrong(format!(
                    "joint \"{}\" is anchored to no bone; name at least one",
                    joint.name
                ));
            }
        }
        for &[a, b] in bones {
            let (a, b) = (&self.file.joints[a], &self.file.joints[b]);
            if Vec2::from(a.template).distance(b.template.into()) < 1.0e-4 {
                return self.wrong(format!(
                    "\"{}\" and \"{}\" are at one place in the template; a bone needs a length",
                    a.name, b.name
                ));
            }
        }
        Ok(())
    }

    fn mirrors(&self) -> Result<Vec<usize>, FigureError> {
        let joints = &self.file.joints;
        let mut mirrors = Vec::with_capacity(joints.len());
        for (i, joint) in joints.iter().enumerate() {
            let opposite = match joint.side {
                Side::Center => {
                    mirrors.push(i);
                    continue;
                }
                Side::Left => Side::Right,
                Side::Right => Side::Left,
            };
            let expected = joint
                .mirror
                .clone()
                .unwrap_or_else(|| mirrored_name(&joint.name));
            match joints
                .iter()
                .position(|j| j.name == expected && j.side == opposite)
            {
                Some(mirror) => mirrors.push(mirror),
                None => {
                    return Err(FigureError::NoMirror {
                        figure: self.file.name.clone(),
                        name: joint.name.clone(),
                        expected,
                    });
                }
            }
        }
        match (0..joints.len()).find(|&i| mirrors[mirrors[i]] != i) {
            Some(i) => self.wrong(format!(
                "\"{}\" mirrors to a joint that mirrors to another one; mirrors go in pairs",
                joints[i].name
            )),
            None => Ok(mirrors),
        }
    }
}

/// The name with its last letter exchanged: `knee_fr` becomes `knee_fl`.
fn mirrored_name(name: &str) -> String {
    match (name.strip_suffix('r'), name.strip_suffix('l')) {
        (Some(stem), _) => format!("{stem}l"),
        (_, Some(stem)) => format!("{stem}r"),
        _ => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::HUMAN_RON;
    use super::*;

    fn message_of(from: &str, to: &str) -> String {
        assert!(HUMAN_RON.contains(from), "{from}");
        Figure::from_ron(&HUMAN_RON.replacen(from, to, 1))
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn what_does_not_fit_together_is_named() {
        assert!(message_of("root: \"abdomen\"", "root: \"abdome\"").contains("mean \"abdomen\""));
        assert!(message_of("name: \"neck\"", "name: \"forehead\"").contains("two joints"));
        assert!(message_of("(\"neck\", \"abdomen\"),", "").contains("9 bones for 11 joints"));
        assert!(
            message_of("(\"neck\", \"abdomen\")", "(\"forehead\", \"elbow_l\")").contains("ring")
        );
        assert!(message_of("\"forehead\", \"neck\",\n", "\"neck\",\n").contains("never visited"));
        assert!(message_of("        \"abdomen\",\n", "").contains("no bone joins"));
        assert!(message_of("(0.0, 1.50)", "(0.0, 1.70)").contains("at one place"));
        assert!(message_of("(0.0, 1.50)", "(0.0, NaN)").contains("NaN"));
        assert!(message_of("Bones([\"pelvis\"])", "Bones([])").contains("no bone"));
        assert!(
            message_of(
                "name: \"hand_r\", side: Right",
                "name: \"hand_r\", side: Left"
            )
            .contains("hand_l")
        );
        assert!(message_of("side: Center", "side: Middle").contains("line 7"));
    }

    #[test]
    fn a_mirror_may_be_named() {
        let text = HUMAN_RON
            .replace("hand_r", "paw_one")
            .replace("hand_l", "paw_two")
            .replace(
                "(name: \"paw_one\",",
                "(name: \"paw_one\", mirror: Some(\"paw_two\"),",
            )
            .replace(
                "(name: \"paw_two\",",
                "(name: \"paw_two\", mirror: Some(\"paw_one\"),",
            );
        let figure = Figure::from_ron(&text).unwrap();
        let one = figure.joint_index("paw_one").unwrap();
        assert_eq!(
            figure.mirror_of(one),
            figure.joint_index("paw_two").unwrap()
        );
        assert_eq!(Figure::from_ron(&figure.to_ron().unwrap()).unwrap(), figure);
    }
}
