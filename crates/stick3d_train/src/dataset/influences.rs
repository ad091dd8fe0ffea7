//! Which bones move which vertex, with *helper bones* for what blending alone cannot hold.

use std::collections::BTreeMap;

use crate::rig::Rig;

/// Weights below this are left out of a helper bone: a tenth of a millimetre at an arm's length.
const LEAST_WEIGHT: f32 = 1e-4;

/// Sparse weights of bones and helper bones on vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct InfluenceTable {
    /// Per vertex: bone and weight, the bones of the rig first.
    pub rows: Vec<Vec<(u16, f32)>>,
    /// How many bones there are, helpers included.
    pub bone_count: usize,
    /// Which bones of the rig the first of them are; their weights sum to 1 at each vertex.
    pub rig_bones: Vec<usize>,
    /// Between which bones each helper is.
    pub helpers: Vec<(u16, u16)>,
}

impl InfluenceTable {
    /// The rig's own bones, and helper bones between the `helper_limit` pairs that share the most surface.
    ///
    /// Dual quaternions bend a joint along an arc where blended matrices cut the corner. The difference is, to first
    /// order, an affine map times the product of the two weights, so a helper bone weighs `4 · w_a · w_b` (1 half way).
    /// Bones without weight get no number.
    #[must_use]
    pub fn new(rig: &Rig, helper_limit: usize) -> Self {
        let (rows, rig_bones) = renumbered(&rig.influences);
        let rig_bone_count = rig_bones.len();
        let mut shared: BTreeMap<(u16, u16), f64> = BTreeMap::new();
        for row in &rows {
            for_pairs(row, |pair, weight| {
                *shared.entry(pair).or_default() += f64::from(weight);
            });
        }
        let mut pairs: Vec<((u16, u16), f64)> = shared.into_iter().collect();
        pairs.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        pairs.truncate(helper_limit);
        // A pair that hardly overlaps has columns that hardly differ: it only spoils the equations.
        pairs.retain(|(_, weight)| *weight >= 4.0);
        let helpers: Vec<(u16, u16)> = pairs.into_iter().map(|(pair, _)| pair).collect();
        let number: BTreeMap<(u16, u16), u16> = helpers
            .iter()
            .enumerate()
            .map(|(i, pair)| (*pair, (rig_bone_count + i) as u16))
            .collect();
        let rows = rows
            .into_iter()
            .map(|mut row| {
                let mut extra = vec![];
                for_pairs(&row, |pair, weight| {
                    extra.extend(number.get(&pair).map(|helper| (*helper, weight)));
                });
                extra.sort_by_key(|(helper, _)| *helper);
                row.extend(extra);
                row
            })
            .collect();
        Self {
            rows,
            bone_count: rig_bone_count + helpers.len(),
            rig_bones,
            helpers,
        }
    }
}

/// The same influences with the bones that have any numbered from 0.
fn renumbered(influences: &[Vec<(u16, f32)>]) -> (Vec<Vec<(u16, f32)>>, Vec<usize>) {
    let mut numbers: BTreeMap<u16, u16> = influences
        .iter()
        .flatten()
        .filter(|(_, w)| *w > 0.0)
        .map(|(bone, _)| (*bone, 0))
        .collect();
    for (number, slot) in numbers.values_mut().enumerate() {
        *slot = number as u16;
    }
    let row = |row: &Vec<(u16, f32)>| -> Vec<(u16, f32)> {
        row.iter()
            .filter_map(|(bone, weight)| Some((*numbers.get(bone)?, *weight)))
            .filter(|i| i.1 > 0.0)
            .collect()
    };
    (
        influences.iter().map(row).collect(),
        numbers.keys().map(|bone| usize::from(*bone)).collect(),
    )
}

fn for_pairs(row: &[(u16, f32)], mut each: impl FnMut((u16, u16), f32)) {
    for (i, (a, weight_a)) in row.iter().enumerate() {
        for (b, weight_b) in &row[i + 1..] {
            let weight = 4.0 * weight_a * weight_b;
            if weight >= LEAST_WEIGHT {
                each((*a.min(b), *a.max(b)), weight);
            }
        }
    }
}
