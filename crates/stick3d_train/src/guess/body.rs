//! The bones that carry a body's surface, as one tree.

use glam::Vec3;
use stick3d_figure::Side;

use super::name::BoneName;
use super::words::Role;
use crate::rig::{Rig, Skeleton};

/// What of a rig's surface follows a bone by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Flesh {
    /// Sum of the weights of all vertices.
    pub(super) weight: f32,
    /// Where it is: the weighted mean of the vertices, the bone's head without any; model space, metres.
    pub(super) middle: Vec3,
    /// The lowest vertex that follows it more than others do, the bone's head without any; metres.
    pub(super) low_m: f32,
}

impl Flesh {
    /// What follows every bone of a rig.
    pub(super) fn of(rig: &Rig) -> Vec<Self> {
        let bones = &rig.skeleton.bones;
        let mut weights = vec![0.0_f32; bones.len()];
        let mut sums = vec![Vec3::ZERO; bones.len()];
        let mut lows = vec![f32::INFINITY; bones.len()];
        for (position, list) in rig.mesh.positions.iter().zip(&rig.influences) {
            for (nth, &(bone, weight)) in list.iter().enumerate() {
                let bone = usize::from(bone);
                weights[bone] += weight;
                sums[bone] += weight * *position;
                if nth == 0 {
                    lows[bone] = lows[bone].min(position.y);
                }
            }
        }
        let flesh = |bone: usize| Self {
            weight: weights[bone],
            middle: if weights[bone] > 0.0 {
                sums[bone] / weights[bone]
            } else {
                bones[bone].head
            },
            low_m: if lows[bone].is_finite() {
                lows[bone]
            } else {
                bones[bone].head.y
            },
        };
        (0..bones.len()).map(flesh).collect()
    }
}

/// One bone of a body.
#[derive(Debug, Clone)]
pub(super) struct BodyBone {
    pub(super) name: String,
    pub(super) says: BoneName,
    pub(super) parent: Option<usize>,
    pub(super) head: Vec3,
    pub(super) flesh: Flesh,
    /// Whether it or a bone below it carries surface.
    pub(super) lives: bool,
    /// How far its chains reach, summed along the bones, metres.
    pub(super) reach_m: f32,
}

/// The bones of a rig, numbered as in its skeleton.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub(super) bones: Vec<BodyBone>,
    children: Vec<Vec<usize>>,
    /// Height of the ground and of the body above it, metres.
    pub(super) ground_m: f32,
    pub(super) height_m: f32,
    /// The largest extent, metres.
    pub(super) extent_m: f32,
}

impl Body {
    /// Takes a skeleton and what follows its bones; hangs separate trees where they are nearest.
    pub(super) fn new(skeleton: &Skeleton, flesh: &[Flesh]) -> Self {
        let says = BoneName::read_all(skeleton.bones.iter().map(|bone| bone.name.as_str()));
        let bones = skeleton.bones.iter().zip(says).zip(flesh);
        let bones = bones.map(|((bone, says), flesh)| BodyBone {
            name: bone.name.clone(),
            says,
            parent: bone.parent,
            head: bone.head,
            flesh: *flesh,
            lives: flesh.weight > 0.0,
            reach_m: 0.0,
        });
        let mut body = Self {
            bones: bones.collect(),
            children: Vec::new(),
            ground_m: 0.0,
            height_m: 0.0,
            extent_m: 0.0,
        };
        body.note_life();
        body.join_trees();
        body.note_reach();
        body.note_size();
        body
    }

    /// What hangs on a bone and carries surface.
    pub(super) fn children(&self, bone: usize) -> &[usize] {
        &self.children[bone]
    }

    /// The bones that carry surface, or have bones below them that do.
    pub(super) fn living(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.bones.len()).filter(|&bone| self.bones[bone].lives)
    }

    /// A bone and all that it hangs on, upward.
    pub(super) fn upward(&self, bone: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(bone), |&at| self.bones[at].parent)
    }

    /// Whether `bone` is `ancestor` or hangs below it.
    pub(super) fn is_below(&self, bone: usize, ancestor: usize) -> bool {
        self.upward(bone).any(|at| at == ancestor)
    }

    /// A bone and all living ones below it.
    pub(super) fn below(&self, bone: usize) -> Vec<usize> {
        let mut all = vec![bone];
        let mut next = 0;
        while next < all.len() {
            all.extend(self.children(all[next]));
            next += 1;
        }
        all
    }

    /// The lowest point that follows a bone or one below it, metres.
    pub(super) fn low_m(&self, bone: usize) -> f32 {
        let lows = self.below(bone).into_iter();
        lows.map(|b| self.bones[b].flesh.low_m.min(self.bones[b].head.y))
            .fold(f32::INFINITY, f32::min)
    }

    /// The bone and, at every one, the child whose chains reach farthest; helpers only where nothing else hangs.
    pub(super) fn chain(&self, bone: usize) -> Vec<usize> {
        let longest = |at: &usize| {
            let length = |child: usize| {
                let step = self.bones[child].head.distance(self.bones[*at].head);
                step + self.bones[child].reach_m
            };
            self.children(*at)
                .iter()
                .copied()
                .filter(|&child| !self.bones[child].says.trimming)
                .max_by(|&a, &b| {
                    let [first, second] = [a, b].map(|bone| &self.bones[bone]);
                    let limb = second.says.helper.cmp(&first.says.helper);
                    limb.then(length(a).total_cmp(&length(b)))
                        .then(first.flesh.weight.total_cmp(&second.flesh.weight))
                })
        };
        std::iter::successors(Some(bone), longest).collect()
    }

    /// The living bones of a role by their names, on a side where the role has two: of the surest names, those that
    /// carry surface, the topmost of every chain.
    pub(super) fn named(&self, role: Role, side: Side, sides: &[Side]) -> Vec<usize> {
        let fits = |bone: usize| {
            let says = &self.bones[bone].says;
            let there = if role.is_paired() {
                sides[bone] == side
            } else {
                says.side.is_none()
            };
            let tier = role.tier(&says.stem, &says.numbered)?;
            (there && !says.helper).then_some(((tier, says.rank), bone))
        };
        let all: Vec<_> = self.living().filter_map(fits).collect();
        let Some(best) = all.iter().map(|(sure, _)| *sure).min() else {
            return Vec::new();
        };
        let best = all.iter().filter(|(sure, _)| *sure == best);
        let mut bones: Vec<usize> = best.map(|(_, bone)| *bone).collect();
        if bones.iter().any(|&b| self.bones[b].flesh.weight > 0.0) {
            bones.retain(|&b| self.bones[b].flesh.weight > 0.0);
        }
        let all = bones.clone();
        bones.retain(|&b| {
            !all.iter()
                .any(|&other| other != b && self.is_below(b, other))
        });
        bones
    }

    /// The name of a bone, as it stands in the file.
    pub(super) fn name(&self, bone: usize) -> String {
        self.bones[bone].name.clone()
    }

    fn note_life(&mut self) {
        if !self.bones.iter().any(|bone| bone.lives) {
            self.bones.iter_mut().for_each(|bone| bone.lives = true);
        }
        // Parents come before children.
        for bone in (0..self.bones.len()).rev() {
            if let Some(parent) = self.bones[bone].parent.filter(|_| self.bones[bone].lives) {
                self.bones[parent].lives = true;
            }
        }
    }

    /// Hangs every tree but the one with most surface on the nearest bone of another tree; files that keep only some of
    /// a rig's bones lose what joins limbs to the trunk.
    fn join_trees(&mut self) {
        let weigh = |body: &Self, root: usize| -> f32 {
            let below = body.living().filter(|&bone| body.is_below(bone, root));
            below.map(|bone| body.bones[bone].flesh.weight).sum()
        };
        let mut roots: Vec<(f32, usize)> = self
            .living()
            .filter(|&bone| self.bones[bone].parent.is_none())
            .map(|root| (weigh(self, root), root))
            .collect();
        roots.sort_by(|a, b| a.0.total_cmp(&b.0));
        roots.pop();
        for (_, root) in roots {
            let own = &self.bones[root];
            let may_carry = |&bone: &usize| {
                let other = &self.bones[bone];
                let across = own.says.side.is_some()
                    && other.says.side.is_some()
                    && other.says.side != own.says.side;
                other.flesh.weight > 0.0 && !across && !self.is_below(bone, root)
            };
            let away = |bone: usize| self.bones[bone].head.distance(own.head);
            let nearest = self
                .living()
                .filter(may_carry)
                .min_by(|&a, &b| away(a).total_cmp(&away(b)));
            self.bones[root].parent = nearest;
        }
        self.children = vec![Vec::new(); self.bones.len()];
        for bone in 0..self.bones.len() {
            if let Some(parent) = self.bones[bone].parent.filter(|_| self.bones[bone].lives) {
                self.children[parent].push(bone);
            }
        }
    }

    fn note_reach(&mut self) {
        let mut order: Vec<usize> = self.living().collect();
        order.sort_by_cached_key(|&bone| std::cmp::Reverse(self.upward(bone).count()));
        for bone in order {
            if let Some(parent) = self.bones[bone].parent {
                let step = self.bones[bone].head.distance(self.bones[parent].head);
                let reach = step + self.bones[bone].reach_m;
                self.bones[parent].reach_m = self.bones[parent].reach_m.max(reach);
            }
        }
    }

    fn note_size(&mut self) {
        let solid = || self.living().filter(|&b| self.bones[b].flesh.weight > 0.0);
        let points = || solid().flat_map(|b| [self.bones[b].head, self.bones[b].flesh.middle]);
        let low = points().fold(Vec3::INFINITY, Vec3::min);
        let high = points().fold(Vec3::NEG_INFINITY, Vec3::max);
        let lowest = solid()
            .map(|b| self.bones[b].flesh.low_m)
            .fold(low.y, f32::min);
        (self.ground_m, self.height_m) = (lowest, high.y - lowest);
        self.extent_m = (high - low).max_element().max(self.height_m);
    }
}
