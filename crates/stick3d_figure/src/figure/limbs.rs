//! The limbs of a figure: chains of bones from the trunk, or from a fork, to an end.

use super::Figure;

/// A chain of joints that ends freely.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limb {
    /// The joint on which it hangs; not of the limb itself.
    pub base: usize,
    /// Its joints from the base outward; at least one.
    pub joints: Vec<usize>,
}

impl Limb {
    /// The joint at its end.
    pub fn end(&self) -> usize {
        self.joints.last().copied().unwrap_or(self.base)
    }
}

impl Figure {
    /// The limbs, in the order of their ends in [`joints`](Figure::joints): of the human head, arms and legs.
    ///
    /// A limb starts beyond the last joint, from its end inward, at which three or more bones meet, or at the root.
    pub fn limbs(&self) -> Vec<Limb> {
        let bones_at = |joint: usize| self.bones.iter().filter(move |b| b.contains(&joint));
        let ends = (0..self.joint_count()).filter(|j| *j != self.root && bones_at(*j).count() == 1);
        let chain = |end: usize| {
            let (mut joints, mut at) = (vec![end], end);
            loop {
                let before = joints.iter().rev().nth(1).copied();
                let next = bones_at(at)
                    .map(|&[a, b]| if a == at { b } else { a })
                    .find(|joint| Some(*joint) != before);
                let Some(next) = next else {
                    // A figure that is one chain hangs on its own first joint.
                    let base = joints.pop().unwrap_or(end);
                    joints.reverse();
                    return Limb { base, joints };
                };
                if next == self.root || bones_at(next).count() > 2 {
                    joints.reverse();
                    return Limb { base: next, joints };
                }
                joints.push(next);
                at = next;
            }
        };
        ends.map(chain).collect()
    }

    /// The limb that a bone, two joints in any order, is of; none of the trunk's bones are of any.
    pub fn limb_of_bone(&self, bone: [usize; 2]) -> Option<Limb> {
        let has = |limb: &Limb, joint| limb.base == joint || limb.joints.contains(&joint);
        let mut limbs = self.limbs().into_iter();
        limbs.find(|limb| bone.iter().all(|joint| has(limb, *joint)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(figure: &Figure) -> Vec<(String, Vec<String>)> {
        let name = |joint: &usize| figure.joints[*joint].name.clone();
        let limbs = figure.limbs();
        limbs
            .iter()
            .map(|limb| (name(&limb.base), limb.joints.iter().map(name).collect()))
            .collect()
    }

    #[test]
    fn the_human_has_a_head_and_four_limbs() {
        let limbs = named(Figure::human());
        assert_eq!(limbs.len(), 5, "{limbs:?}");
        let arm = (
            "neck".to_owned(),
            vec!["elbow_r".to_owned(), "hand_r".to_owned()],
        );
        assert!(limbs.contains(&arm), "{limbs:?}");
        assert!(limbs.contains(&("neck".to_owned(), vec!["forehead".to_owned()])));
    }

    #[test]
    fn a_bone_is_of_a_limb_or_of_the_trunk() {
        let human = Figure::human();
        let limb_of = |bone: [&str; 2]| {
            let bone = bone.map(|name| human.joint_index(name).unwrap());
            human.limb_of_bone(bone).map(|limb| limb.end())
        };
        let hand = human.joint_index("hand_r").ok();
        assert_eq!(limb_of(["elbow_r", "neck"]), hand);
        assert_eq!(limb_of(["elbow_r", "hand_r"]), hand);
        assert_eq!(limb_of(["neck", "abdomen"]), None);
    }

    #[test]
    fn every_end_of_the_horse_is_of_one_limb() {
        let horse = Figure::horse();
        let limbs = horse.limbs();
        assert_eq!(limbs.len(), 6, "{:?}", named(horse));
        for limb in &limbs {
            assert!(!limb.joints.contains(&limb.base));
            assert_ne!(limb.end(), horse.root);
        }
    }
}
