//! Ordered recognition: strokes that follow a figure's sketch path become a sketch.
//!
//! A person draws the path as one long line, one stroke per bone, one stroke per limb, or any mix. Bones that the
//! path retraces (elbow back to neck) may be drawn or skipped. Corners are not looked for one by one: all path points
//! are placed together, at the samples where straight pieces between them explain the ink best.

pub mod any_order;
mod begun;
mod cost;
mod coverage;
mod freely;
mod ink;
mod plan;
mod reading;
mod search;

use glam::Vec2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::figure::Figure;
use crate::sketch::{Sketch, SketchError};
use crate::stroke::Stroke;
pub use freely::{FreeReading, completes, read_freely, recognize_finished};
use ink::{Ink, MAX_STROKES};
use plan::Plan;
use reading::Reading;
use search::{Effort, Search};

/// How much likelier a reading of part of the path must be than the best one of the whole path before finished
/// strokes are taken for unfinished ones.
const COMPLETE_BONUS: f32 = 2.5;

/// How many strokes after the path's end are looked past.
const MAX_SURPLUS: usize = 3;

/// Why strokes are no drawing of a figure.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum RecognizeError {
    /// There is no stroke of any size.
    #[error("nothing is drawn: {strokes} strokes, none of which has two different points")]
    Empty {
        /// How many strokes came.
        strokes: usize,
    },
    /// More strokes than any figure is drawn with.
    #[error("{strokes} strokes are too many to be one figure; at most {MAX_STROKES} are read")]
    TooManyStrokes {
        /// How many strokes came.
        strokes: usize,
    },
    /// The strokes cannot be the whole path.
    #[error(
        "the strokes reach only {reached} of the {path_len} points of figure \"{figure}\"; the next joint to draw is \"{next}\""
    )]
    Incomplete {
        /// The figure.
        figure: String,
        /// How many path points were found.
        reached: usize,
        /// How many there are.
        path_len: usize,
        /// The joint that comes next.
        next: String,
    },
    /// The strokes go on after the path's end.
    #[error(
        "the {strokes} strokes go on after the last joint of figure \"{figure}\"; leave out what is too many"
    )]
    Surplus {
        /// The figure.
        figure: String,
        /// How many strokes came.
        strokes: usize,
    },
    /// What was recognised is no sketch.
    #[error(transparent)]
    Sketch(#[from] SketchError),
}

/// Is the last stroke finished?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Pen {
    /// No: its last bone may be half drawn.
    Down,
    /// Yes: it ends at a joint.
    Up,
}

/// How far a drawing has come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Per joint: where it was drawn, canvas pixels, y up; none where it was not yet.
    pub placed: Vec<Option<Vec2>>,
    /// The joint to which the bone leads that is being drawn, or comes next; none when complete. With the pen up ways
    /// back count as skipped, so that it is a joint not placed yet.
    pub next_joint: Option<usize>,
    /// The joint from which that bone starts.
    pub from_joint: Option<usize>,
    /// The part of the path that is drawn, from 0 to 1, by the length of its bones in the template.
    pub fraction: f32,
    /// All joints are placed and the path is at its end.
    pub complete: bool,
}

/// The sketch that finished strokes show, canvas pixels, y up. The strokes are taken for the whole path.
///
/// # Errors
/// [`RecognizeError`] when there is too little ink for the path.
pub fn recognize(figure: &Figure, strokes: &[Stroke]) -> Result<Sketch, RecognizeError> {
    if strokes.len() > MAX_STROKES {
        return Err(RecognizeError::TooManyStrokes {
            strokes: strokes.len(),
        });
    }
    let plan = Plan::new(figure);
    // A crooked drawing needs more effort, and gets it when the usual finds nothing.
    for effort in [Effort::USUAL, Effort::GREAT] {
        let Some(ink) = Ink::new(strokes) else { break };
        if let Some(reading) = Search::run(&plan, &ink, effort).complete() {
            let placed = placed_joints(&plan, &ink, &reading);
            let points = placed.into_iter().map(Option::unwrap_or_default).collect();
            return Ok(Sketch::new(figure, points)?);
        }
    }
    Err(why_not_complete(figure, &plan, strokes))
}

fn why_not_complete(figure: &Figure, plan: &Plan, strokes: &[Stroke]) -> RecognizeError {
    let Some(ink) = Ink::new(strokes) else {
        return RecognizeError::Empty {
            strokes: strokes.len(),
        };
    };
    let progress = progress(figure, strokes, Pen::Up);
    match progress.next_joint {
        // Every stroke draws at least one bone.
        Some(joint) if ink.strokes.len() <= plan.end() => RecognizeError::Incomplete {
            figure: figure.name.clone(),
            reached: (progress.fraction * plan.end() as f32) as usize + 1,
            path_len: figure.path_len(),
            next: figure.joints[joint].name.clone(),
        },
        _ => RecognizeError::Surplus {
            figure: figure.name.clone(),
            strokes: strokes.len(),
        },
    }
}

/// How far the strokes so far have come along the path. Fast enough to be asked on every frame while drawing.
///
/// What is still to come can change how the strokes so far are read: a straight stroke from the neck may be a whole
/// arm or its upper half, and in a drawing that looks complete the last leg may yet get its lower half. So ask again
/// with every stroke until the next drawing is begun. Up to three strokes for which the path has no room left are looked
/// past; more strokes than anybody draws count as nothing.
pub fn progress(figure: &Figure, strokes: &[Stroke], pen: Pen) -> Progress {
    let plan = Plan::new(figure);
    let read = |strokes: &[Stroke], effort, pen| {
        let ink = Ink::new(strokes)?;
        let reading = reading(&Search::run(&plan, &ink, effort), pen)?;
        Some(progress_of(&plan, &ink, &reading, pen))
    };
    // Before a crooked reading of all strokes is tried, some after the path's end are looked past.
    let surplus = (1..strokes.len()).rev().take(MAX_SURPLUS);
    read(strokes, Effort::USUAL, pen)
        .or_else(|| {
            let mut shorter = surplus.filter_map(|n| read(&strokes[..n], Effort::USUAL, Pen::Up));
            shorter.find(|progress| progress.complete)
        })
        .or_else(|| read(strokes, Effort::GREAT, pen))
        .unwrap_or_else(|| progress_of_nothing(figure))
}

/// The likeliest reading of a drawing that may still grow.
fn reading(search: &Search, pen: Pen) -> Option<Reading> {
    match pen {
        Pen::Down => search.unfinished(),
        Pen::Up => match (search.complete(), search.any()) {
            (Some(complete), Some(any)) if complete.cost <= any.cost + COMPLETE_BONUS => {
                Some(complete)
            }
            (_, any) => any,
        },
    }
}

fn progress_of_nothing(figure: &Figure) -> Progress {
    Progress {
        placed: vec![None; figure.joint_count()],
        next_joint: figure.path.first().copied(),
        from_joint: None,
        fraction: 0.0,
        complete: false,
    }
}

fn progress_of(plan: &Plan, ink: &Ink, reading: &Reading, pen: Pen) -> Progress {
    let reached = reading.visits.last().map_or(0, |visit| visit.path_index);
    let length = |until: usize| -> f32 {
        plan.steps[..until]
            .iter()
            .map(|step| step.template_length)
            .sum()
    };
    let begun = plan
        .steps
        .get(reached)
        .map_or(0.0, |step| step.template_length * reading.begun);
    let next = match pen {
        Pen::Down => reached,
        Pen::Up => (reached..plan.end())
            .find(|&k| !plan.steps[k].retrace)
            .unwrap_or(plan.end()),
    };
    Progress {
        placed: placed_joints(plan, ink, reading),
        next_joint: plan.steps.get(next).map(|step| step.joint),
        from_joint: plan.steps.get(next).map(|_| plan.path[next]),
        fraction: ((length(reached) + begun) / length(plan.end())).clamp(0.0, 1.0),
        complete: reached == plan.end(),
    }
}

/// Per joint the mean of the places it was drawn at.
fn placed_joints(plan: &Plan, ink: &Ink, reading: &Reading) -> Vec<Option<Vec2>> {
    let mut sums = vec![(Vec2::ZERO, 0.0_f32); plan.joint_count];
    for visit in &reading.visits {
        let sum = &mut sums[plan.path[visit.path_index]];
        sum.0 += ink.samples[visit.sample];
        sum.1 += 1.0;
    }
    sums.into_iter()
        .map(|(sum, count)| (count > 0.0).then(|| sum / count))
        .collect()
}

#[cfg(test)]
mod growing;
#[cfg(test)]
mod tests;
