//! What the search knows of a figure's path before any ink is seen.

use crate::figure::Figure;

/// One step of the sketch path, from path point `k` to `k + 1`.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// The joint it leads to.
    pub(super) joint: usize,
    /// The joint it leads to has been visited before: the bone is drawn a second time, or may be skipped.
    pub(super) retrace: bool,
    /// The two joints of the same bone on the other side of the body.
    pub(super) mirrored: [usize; 2],
    /// Length of the bone in the template.
    pub(super) template_length: f32,
}

/// A figure's path as the search needs it.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// The joint of every path point.
    pub(super) path: Vec<usize>,
    /// One per path point but the last.
    pub(super) steps: Vec<Step>,
    /// Per path point: is it the first visit of a joint in mid-limb (elbow, knee), where one person lifts the pen
    /// and another does not, but each does the same at all of them?
    pub(super) mid_limb: Vec<bool>,
    /// Per path point: do more than two bones meet there?
    pub(super) branches: Vec<bool>,
    /// Per path point: the joints that have been visited and will be visited again.
    pub(super) open: Vec<Vec<usize>>,
    pub(super) joint_count: usize,
    /// The longest way between two joints along the template's bones: no drawing extends further.
    pub(super) reach: f32,
}

impl Plan {
    pub(super) fn new(figure: &Figure) -> Self {
        let path = figure.path.clone();
        let visited = |k: usize, joint: usize| path[..=k].contains(&joint);
        let steps: Vec<Step> = (0..path.len().saturating_sub(1))
            .map(|k| Step {
                joint: path[k + 1],
                retrace: visited(k, path[k + 1]),
                mirrored: [figure.mirror_of(path[k]), figure.mirror_of(path[k + 1])],
                template_length: figure.template[path[k]].distance(figure.template[path[k + 1]]),
            })
            .collect();
        let mid_limb = (0..path.len())
            .map(|k| k > 0 && !steps[k - 1].retrace && figure.bones_at(path[k]) == 2)
            .collect();
        let branches = path
            .iter()
            .map(|joint| figure.bones_at(*joint) > 2)
            .collect();
        let open = (0..path.len())
            .map(|k| {
                (0..figure.joint_count())
                    .filter(|joint| visited(k, *joint) && path[k + 1..].contains(joint))
                    .collect()
            })
            .collect();
        let reach = reach(figure);
        Self {
            path,
            steps,
            mid_limb,
            branches,
            open,
            joint_count: figure.joint_count(),
            reach,
        }
    }

    /// Does the path turn back here, at the end of a limb?
    pub(super) fn turns_back(&self, k: usize) -> bool {
        k > 0 && !self.steps[k - 1].retrace && self.steps.get(k).is_some_and(|step| step.retrace)
    }

    /// The last path index.
    pub(super) fn end(&self) -> usize {
        self.path.len() - 1
    }
}

/// The longest way between two joints of the tree.
pub(super) fn reach(figure: &Figure) -> f32 {
    let farthest = |from: usize| {
        let mut way = vec![f32::NAN; figure.joint_count()];
        way[from] = 0.0;
        let mut queue = vec![from];
        while let Some(at) = queue.pop() {
            for (bone, &[a, b]) in figure.bones.iter().enumerate() {
                let next = if a == at {
                    b
                } else if b == at {
                    a
                } else {
                    continue;
                };
                if way[next].is_nan() {
                    way[next] = way[at] + figure.template_bone_length(bone);
                    queue.push(next);
                }
            }
        }
        way.into_iter()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or_default()
    };
    farthest(farthest(0).0).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_human_has_six_retraces_and_four_middles_of_limbs() {
        let human = Figure::human();
        let plan = Plan::new(human);
        let retraces: Vec<usize> = (0..16).filter(|&k| plan.steps[k].retrace).collect();
        assert_eq!(retraces, [3, 4, 7, 8, 12, 13]);
        let middles: Vec<&str> = (0..17)
            .filter(|&k| plan.mid_limb[k])
            .map(|k| human.joints[plan.path[k]].name.as_str())
            .collect();
        assert_eq!(middles, ["elbow_r", "elbow_l", "knee_r", "knee_l"]);
        let neck = human.joint_index("neck").unwrap();
        let elbow = human.joint_index("elbow_r").unwrap();
        assert_eq!(plan.open[3], [neck, elbow]);
        assert!(plan.open[16].is_empty());
        // Hand to foot: 0.33 + 0.43 + 0.54 + 0.46 + 0.47.
        assert!((plan.reach - 2.23).abs() < 0.02, "{}", plan.reach);
    }
}
