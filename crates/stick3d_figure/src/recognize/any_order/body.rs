//! What the search in any order knows of a figure before any ink is seen: its tree of bones as chains between
//! branchings and ends.

use std::cmp::Ordering;
use std::collections::VecDeque;

use glam::Vec2;

use crate::figure::{Figure, Side};

/// Bones one after the other, from a joint where chains meet to the next such joint or to an end of the tree.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    /// The joint it hangs on.
    pub(super) from: usize,
    /// Its other joints in order, the last of them a branching or an end.
    pub(super) joints: Vec<usize>,
    /// Per bone the length in the template, metres.
    pub(super) lengths: Vec<f32>,
    /// Per bone the direction in the template.
    pub(super) directions: Vec<Vec2>,
    /// Other chains hang on its last joint.
    pub(super) branches: bool,
    /// It lies in the middle of the body.
    pub(super) center: bool,
    /// A loop may stand for its last joint: the sketch path starts there, at the head.
    pub(super) head: bool,
    /// The chain before this one that is its mirror and hangs on the same joint: the ink does not tell the two apart.
    pub(super) twin: Option<usize>,
}

impl Chain {
    /// The length of its bones in the template, metres.
    pub(super) fn length(&self) -> f32 {
        self.lengths.iter().sum()
    }

    /// The last joint.
    pub(super) fn end(&self) -> usize {
        self.joints.last().copied().unwrap_or(self.from)
    }
}

/// A figure as chains, each after the one it hangs on.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) joint_count: usize,
    /// The joint at which the search starts: the branching nearest to the root.
    pub(super) start: usize,
    /// Those to other branchings first: they are the trunk.
    pub(super) chains: Vec<Chain>,
    /// Whether it is drawn facing either way.
    pub(super) both_ways: bool,
    /// The longest way between two joints along the template's bones: no drawing extends further.
    pub(super) reach: f32,
}

impl Body {
    pub(super) fn new(figure: &Figure) -> Self {
        let neighbours = neighbours(figure);
        let start = start(figure, &neighbours);
        let mut chains = Vec::new();
        let mut queue = VecDeque::from([(start, None)]);
        while let Some((from, before)) = queue.pop_front() {
            for &first in &neighbours[from] {
                if Some(first) == before {
                    continue;
                }
                let chain = chain(figure, &neighbours, from, first);
                if chain.branches {
                    let before = chain.joints.iter().rev().nth(1).copied().unwrap_or(from);
                    queue.push_back((chain.end(), Some(before)));
                }
                chains.push(chain);
            }
        }
        // Long chains explain the most ink, so they are placed before short ones; twins follow one another.
        let length = |chain: &Chain| {
            let mirrored = figure.mirror_of(chain.end());
            let twin = chains.iter().find(|other| other.end() == mirrored);
            chain.length().max(twin.map_or(0.0, Chain::length))
        };
        let mut order: Vec<(bool, f32, Chain)> = chains
            .iter()
            .map(|chain| (!chain.branches, length(chain), chain.clone()))
            .collect();
        order.sort_by(|a, b| {
            let longer = b.1.total_cmp(&a.1);
            let within = if a.0 && b.0 { longer } else { Ordering::Equal };
            a.0.cmp(&b.0).then(within)
        });
        let mut chains: Vec<Chain> = order.into_iter().map(|(.., chain)| chain).collect();
        for i in 0..chains.len() {
            chains[i].twin = (0..i).find(|&earlier| {
                chains[earlier].from == chains[i].from
                    && chains[earlier].end() != chains[i].end()
                    && chains[earlier].end() == figure.mirror_of(chains[i].end())
            });
        }
        Self {
            joint_count: figure.joint_count(),
            start,
            chains,
            both_ways: figure.views.both_ways,
            reach: super::super::plan::reach(figure),
        }
    }
}

fn neighbours(figure: &Figure) -> Vec<Vec<usize>> {
    let mut neighbours = vec![Vec::new(); figure.joint_count()];
    for &[a, b] in &figure.bones {
        neighbours[a].push(b);
        neighbours[b].push(a);
    }
    neighbours
}

/// The branching nearest to the root; in a figure without one, an end of its only chain.
fn start(figure: &Figure, neighbours: &[Vec<usize>]) -> usize {
    let mut seen = vec![false; figure.joint_count()];
    let mut queue = VecDeque::from([figure.root]);
    let mut end = figure.root;
    while let Some(joint) = queue.pop_front() {
        if neighbours[joint].len() > 2 {
            return joint;
        }
        if neighbours[joint].len() == 1 {
            end = joint;
        }
        seen[joint] = true;
        queue.extend(
            neighbours[joint]
                .iter()
                .copied()
                .filter(|&next| !seen[next]),
        );
    }
    end
}

fn chain(figure: &Figure, neighbours: &[Vec<usize>], from: usize, first: usize) -> Chain {
    let mut joints = vec![first];
    let (mut before, mut at) = (from, first);
    while let [a, b] = neighbours[at][..] {
        (before, at) = (at, if a == before { b } else { a });
        joints.push(at);
    }
    let starts = std::iter::once(from).chain(joints.iter().copied());
    let bones: Vec<Vec2> = starts
        .zip(&joints)
        .map(|(a, &b)| figure.template[b] - figure.template[a])
        .collect();
    Chain {
        from,
        lengths: bones.iter().map(|bone| bone.length()).collect(),
        directions: bones.iter().map(|bone| bone.normalize_or_zero()).collect(),
        branches: neighbours[at].len() > 2,
        center: figure.joints[at].side == Side::Center,
        head: neighbours[at].len() == 1 && figure.path.first() == Some(&at),
        twin: None,
        joints,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(figure: &Figure) -> Vec<String> {
        let name = |joint: usize| figure.joints[joint].name.clone();
        let line = |chain: &Chain| {
            let joints: Vec<String> = chain.joints.iter().map(|&j| name(j)).collect();
            format!("{}: {}", name(chain.from), joints.join(" "))
        };
        Body::new(figure).chains.iter().map(line).collect()
    }

    #[test]
    fn the_shipped_figures_are_a_trunk_and_limbs() {
        assert_eq!(
            names(Figure::human()),
            [
                "abdomen: neck",
                "abdomen: knee_r foot_r",
                "abdomen: knee_l foot_l",
                "neck: elbow_r hand_r",
                "neck: elbow_l hand_l",
                "neck: forehead",
            ]
        );
        let horse = names(Figure::horse());
        assert_eq!(horse[0], "hip: shoulder");
        assert_eq!(horse.len(), 7);
        for figure in Figure::shipped() {
            let body = Body::new(figure);
            let twins = body.chains.iter().filter(|chain| chain.twin.is_some());
            assert_eq!(twins.count(), 2);
            assert_eq!(body.chains.iter().filter(|chain| chain.head).count(), 1);
        }
    }
}
