//! Many bodies as one body and few differences.

use super::Frame;

/// The first of some bodies, and how the others are made of it.
#[derive(Debug)]
pub(super) struct Morphs {
    /// Positions and normals of the first body.
    pub(super) base: Shape,
    /// Those that hold most come first.
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
    /// The body that made it necessary.
    pub(super) frame: usize,
    pub(super) shape: Shape,
    /// One per body, between -1 and 1.
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
        if worst_m <= tolerance_m || targets.len() == most_targets {
            break worst_m;
        }
        targets.push(take_out(&mut missing, frame));
    };
    Some(Morphs {
        base,
        targets,
        worst_m,
    })
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
    let mut shape = missing[frame].clone();
    let square = shape.dot(&shape);
    let mut weights: Vec<f32> = missing
        .iter_mut()
        .map(|body| {
            let weight = (body.dot(&shape) / square) as f32;
            body.add(-weight, &shape);
            weight
        })
        .collect();
    let most = weights.iter().fold(1.0_f32, |most, w| most.max(w.abs()));
    weights.iter_mut().for_each(|weight| *weight /= most);
    let numbers = shape.positions.iter_mut().chain(&mut shape.normals);
    numbers.flatten().for_each(|number| *number *= most);
    Target {
        frame,
        shape,
        weights,
    }
}

impl Shape {
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
