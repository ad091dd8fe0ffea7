//! Which feet carry a body, and how fast it moves over them.

use glam::{Vec2, Vec3};
use stick3d_figure::sketch::Sketch;

use crate::infer::Inference;
use crate::latent::PathError;

/// A foot is down whose sole is nowhere lower than this share of the body's height above the body's lowest point.
const DOWN: f32 = 0.045;
/// A foot has landed whose sole is so near to the ground.
const LANDED: f32 = 0.02;
/// A point of a sole carries that is at most so much higher than the sole's lowest one, as a share of the body's height.
const TREAD: f32 = 0.01;
/// At so many points, about, a sole is looked at.
const SOLE_POINTS: usize = 40;
/// Of several feet down, those that are higher than the lowest by this share of the body's height carry nothing.
const BESIDE: f32 = 0.015;
/// Two feet that slip against each other by more than this share of the body's height cannot both stay.
const SLIP: f32 = 0.1;
/// A stretch of the table between two knots, or beyond the last one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    pub(super) first_step: usize,
    pub(super) last_step: usize,
    /// The steps at the keys whose feet decide; the same twice beyond the ends.
    pub(super) keys: [usize; 2],
}

/// What is known of a body at one time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Step {
    /// Points of each foot's sole, metres.
    pub(super) soles: Vec<Vec<Vec3>>,
    pub(super) lowest_m: f32,
}

/// What figures stand on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stance {
    /// Per foot vertices of its sole.
    pub(super) soles: Vec<Vec<usize>>,
    /// Of the body, metres.
    pub(super) height_m: f32,
}

impl Stance {
    /// As the template stands: of what is lower than a foot's joint all that is nearer to it than to others.
    pub(super) fn of_template(
        inference: &mut Inference,
        feet: &[usize],
        positions: &mut [[f32; 3]],
    ) -> Result<Self, PathError> {
        let sketch = Sketch::template(inference.figure());
        let mut latent = vec![0.0; inference.latent_len()];
        inference.encode(&sketch, &mut latent)?;
        let mut joints = vec![Vec3::ZERO; inference.figure().joint_count()];
        inference.joints(&latent, &mut joints)?;
        inference.decode_positions(&latent, positions)?;
        let mut soles = vec![vec![]; feet.len()];
        for (vertex, position) in positions.iter().enumerate() {
            let position = Vec3::from(*position);
            let away = |foot: &usize| flat(joints[feet[*foot]] - position).length_squared();
            let nearest = (0..feet.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
            if let Some(foot) = nearest.filter(|foot| position.y < joints[feet[*foot]].y) {
                soles[foot].push(vertex);
            }
        }
        for sole in &mut soles {
            let apart = sole.len().div_ceil(SOLE_POINTS).max(1);
            *sole = sole.iter().copied().step_by(apart).collect();
        }
        let top = joints.iter().map(|j| j.y).fold(f32::NEG_INFINITY, f32::max);
        Ok(Self {
            soles,
            height_m: (top - lowest(positions)).max(f32::MIN_POSITIVE),
        })
    }

    /// The body of a latent.
    pub(super) fn step(
        &self,
        latent: &[f32],
        inference: &mut Inference,
        positions: &mut [[f32; 3]],
    ) -> Result<Step, PathError> {
        inference.decode_positions(latent, positions)?;
        let points = |sole: &Vec<usize>| sole.iter().map(|v| Vec3::from(positions[*v])).collect();
        Ok(Step {
            soles: self.soles.iter().map(points).collect(),
            lowest_m: lowest(positions),
        })
    }

    /// How high the lowest point of each sole is above the body's, as a share of the body's height.
    fn heights<'a>(&'a self, step: &'a Step) -> impl Iterator<Item = f32> + 'a {
        let lowest = |sole: &Vec<Vec3>| sole.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        let soles = step.soles.iter();
        soles.map(move |sole| (lowest(sole) - step.lowest_m) / self.height_m)
    }
}

fn lowest(positions: &[[f32; 3]]) -> f32 {
    let heights = positions.iter().map(|position| position[1]);
    heights.fold(f32::INFINITY, f32::min)
}

/// How fast the root moves over the ground in every step, metres a second, x and z; `None` where no foot carries it.
pub(super) fn horizontal_velocities(
    steps: &[Step],
    times_s: &[f32],
    intervals: &[Interval],
    stance: &Stance,
) -> Vec<Option<Vec2>> {
    let count = steps.len().saturating_sub(1);
    let mut velocities: Vec<Option<Vec2>> = vec![None; count];
    let mut landings = velocities.clone();
    for interval in intervals {
        let planted = planted_feet(steps, *interval, stance);
        for step in interval.first_step..interval.last_step {
            let velocity = |feet: &[usize]| -> Option<Vec2> {
                let moved = slip(&steps[step], &steps[step + 1], feet, stance)?;
                Some(-moved / (times_s[step + 1] - times_s[step]))
            };
            if planted.is_empty() {
                landings[step] = velocity(&landing_feet(steps, *interval, stance, step));
            } else {
                velocities[step] = velocity(&planted);
            }
        }
    }
    // A low foot that swings forward carries nobody: it would push the body back.
    let onward: Vec2 = velocities.iter().flatten().sum();
    for (velocity, landing) in velocities.iter_mut().zip(landings) {
        *velocity = velocity.or(landing.filter(|landing| landing.dot(onward) >= 0.0));
    }
    velocities
}

/// Where no foot is down all the way from key to key: the feet that have not yet left the ground since the key before, or that
/// are on it until the key after.
fn landing_feet(steps: &[Step], interval: Interval, stance: &Stance, step: usize) -> Vec<usize> {
    let low = |steps: &[Step], foot: usize| {
        let mut heights = steps
            .iter()
            .filter_map(|step| stance.heights(step).nth(foot));
        heights.all(|height| height <= LANDED)
    };
    let since = &steps[interval.first_step..=step + 1];
    let until = &steps[step..=interval.last_step];
    let feet = 0..stance.soles.len();
    feet.filter(|foot| low(since, *foot) || low(until, *foot))
        .collect()
}

/// The feet that are down in both keys of an interval; only the lowest of them where they do not stay together.
pub(super) fn planted_feet(steps: &[Step], interval: Interval, stance: &Stance) -> Vec<usize> {
    let down =
        |step: usize| -> Vec<bool> { stance.heights(&steps[step]).map(|h| h <= DOWN).collect() };
    let [from, to] = interval.keys.map(down);
    let mut feet: Vec<usize> = (0..from.len()).filter(|f| from[*f] && to[*f]).collect();
    let (first, last) = (&steps[interval.first_step], &steps[interval.last_step]);
    let middle = |sole: &[Vec3]| sole.iter().sum::<Vec3>() / sole.len().max(1) as f32;
    let apart =
        |step: &Step, a: usize, b: usize| flat(middle(&step.soles[a]) - middle(&step.soles[b]));
    let slips = feet.iter().any(|&foot| {
        apart(first, feet[0], foot).distance(apart(last, feet[0], foot)) > SLIP * stance.height_m
    });
    if slips {
        let mean_height = |foot: usize| -> f32 {
            let heights = steps[interval.first_step..=interval.last_step].iter();
            heights
                .filter_map(|step| stance.heights(step).nth(foot))
                .sum()
        };
        let lowest = feet
            .iter()
            .copied()
            .min_by(|a, b| mean_height(*a).total_cmp(&mean_height(*b)));
        feet = lowest.into_iter().collect();
    }
    feet
}

/// By how much the planted feet move between two steps, against the root; `None` while all of them are up.
fn slip(from: &Step, to: &Step, planted: &[usize], stance: &Stance) -> Option<Vec2> {
    let heights: Vec<f32> = stance
        .heights(from)
        .zip(stance.heights(to))
        .map(|(a, b)| 0.5 * (a + b))
        .collect();
    let lowest = planted
        .iter()
        .map(|foot| heights[*foot])
        .fold(f32::INFINITY, f32::min);
    if lowest > 2.0 * DOWN {
        return None;
    }
    let (mut sum, mut weights) = (Vec2::ZERO, 0.0);
    for &foot in planted {
        let beside = (1.0 - (heights[foot] - lowest) / BESIDE).max(0.0).powi(2);
        let points = from.soles[foot].iter().zip(&to.soles[foot]);
        let height_m = |(a, b): &(&Vec3, &Vec3)| 0.5 * (a.y + b.y);
        let sole_m = points
            .clone()
            .map(|pair| height_m(&pair))
            .fold(f32::INFINITY, f32::min);
        for pair in points {
            // What treads on the ground stays; a heel that lifts moves on over the ball of the foot.
            let above = (height_m(&pair) - sole_m) / (TREAD * stance.height_m);
            let weight = beside * (1.0 - above).max(0.0).powi(2);
            sum += weight * flat(*pair.1 - *pair.0);
            weights += weight;
        }
    }
    (weights > 0.0).then(|| sum / weights)
}

pub(super) fn flat(v: Vec3) -> Vec2 {
    Vec2::new(v.x, v.z)
}
