//! Many bodies as one body and few differences.

use super::Frame;

/// The first of some bodies, and how the others are made of it.
#[derive(Debug)]
pub(super) struct Morphs {
    /// Positions and normals of the first body.
    pub(super) base: Shape,
    /// In the order in which they were found, and what lifts them last.
    pub(super) targets: Vec<Target>,
    /// How far the farthest vertex of any body is from where its weights put it, metres.
    pub(super) worst_m: f32,
}

/// Positions and normals, or differences of such.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) normals: Vec<[f32; 3]>,
}

/// A difference that is added to the base by weight.
#[derive(Debug)]
pub(super) struct Target {
    /// The body that made it necessary; `None` for what [`lift`] adds.
    pub(super) frame: Option<usize>,
    pub(super) shape: Shape,
    /// One per body, between 0 and 1.
    pub(super) weights: Vec<f32>,
}

/// Takes the body that is farthest from what the targets so far make, and makes what is missing of it the next target, until
/// all vertices of all bodies are within the tolerance or there are so many targets. Every body gets as much of a target
/// as brings it nearest in the sum of squares, so what is left of it is at right angles to the target, and no later
/// target changes an earlier weight.
pub(super) fn reduce(frames: Vec<Frame>, tolerance_m: f32, most_targets: usize) -> Option<Morphs> {
    let mut missing: Vec<Shape> = frames
        .into_iter()
        .map(|frame| Shape {
            positions: frame.positions,
            normals: frame.normals,
        })
        .collect();
    let base = missing.first()?.clone();
    for shape in &mut missing {
        shape.add(-1.0, &base);
    }
    let mut targets = vec![];
    let worst_m = loop {
        let (frame, worst_m) = farthest(&missing);
        // One more may come when they are lifted.
        if worst_m <= tolerance_m || targets.len() + 1 >= most_targets {
            break worst_m;
        }
        targets.push(take_out(&mut missing, frame));
    };
    lift(&mut targets);
    Some(Morphs {
        base,
        targets,
        worst_m,
    })
}

/// Brings all weights between 0 and 1, where Blender's import and Unity hold them: the lowest weight of every target
/// becomes 0, and one more target, always at 1, has what that takes away.
fn lift(targets: &mut Vec<Target>) {
    let Some(mut lowest) = targets.first().map(|target| target.shape.zeros()) else {
        return;
    };
    let mut bodies = 0;
    for Target { shape, weights, .. } in &mut *targets {
        let low = weights.iter().copied().fold(f32::INFINITY, f32::min);
        let high = weights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        lowest.add(low, shape);
        let span = high - low;
        weights.iter_mut().for_each(|w| *w = (*w - low) / span);
        shape.scale(span);
        bodies = weights.len();
    }
    if lowest.longest_m() > 0.0 {
        targets.push(Target {
            frame: None,
            shape: lowest,
            weights: vec![1.0; bodies],
        });
    }
}

/// The body with the farthest vertex, and how far that is.
fn farthest(missing: &[Shape]) -> (usize, f32) {
    let lengths = missing.iter().map(Shape::longest_m).enumerate();
    lengths.fold(
        (0, 0.0),
        |worst, next| {
            if next.1 > worst.1 { next } else { worst }
        },
    )
}

/// Makes what is missing of one body a target, and takes it out of all of them.
fn take_out(missing: &mut [Shape], frame: usize) -> Target {
    let shape = missing[frame].clone();
    let square = shape.dot(&shape);
    let take = |body: &mut Shape| {
        let weight = (body.dot(&shape) / square) as f32;
        body.add(-weight, &shape);
        weight
    };
    Target {
        frame: Some(frame),
        weights: missing.iter_mut().map(take).collect(),
        shape,
    }
}

impl Shape {
    /// No difference at all.
    fn zeros(&self) -> Self {
        let zeros = vec![[0.0; 3]; self.positions.len()];
        Self {
            positions: zeros.clone(),
            normals: zeros,
        }
    }

    fn scale(&mut self, factor: f32) {
        let numbers = self.positions.iter_mut().chain(&mut self.normals);
        numbers.flatten().for_each(|number| *number *= factor);
    }

    /// Adds so much of another.
    fn add(&mut self, weight: f32, other: &Self) {
        let pairs = [
            (&mut self.positions, &other.positions),
            (&mut self.normals, &other.normals),
        ];
        for (to, from) in pairs {
            let numbers = to.as_flattened_mut().iter_mut().zip(from.as_flattened());
            numbers.for_each(|(to, from)| *to += weight * from);
        }
    }

    /// The product of the positions.
    fn dot(&self, other: &Self) -> f64 {
        let pairs = self.positions.iter().zip(&other.positions);
        let product = |(a, b): (&[f32; 3], &[f32; 3])| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        pairs.map(|pair| f64::from(product(pair))).sum()
    }

    /// The longest difference of positions, metres.
    fn longest_m(&self) -> f32 {
        let square = |[x, y, z]: &[f32; 3]| x * x + y * y + z * z;
        let squares = self.positions.iter().map(square);
        squares.fold(0.0, f32::max).sqrt()
    }
}
