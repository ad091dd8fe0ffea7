//! The few words that say what to do next, and what figures and joints are called.

use stick3d_figure::names::suggestion;
use stick3d_figure::{Figure, Side};

use crate::sketch_input::{DrawingOrder, SketchDrawing};

/// What the editor says above the canvas.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Words {
    /// What to do.
    pub(super) headline: String,
    /// A little more.
    pub(super) hint: String,
}

/// What to do next with a drawing.
pub(super) fn next_step(drawing: &SketchDrawing) -> Words {
    let (headline, hint) = match (drawing.sketch(), drawing.order()) {
        (Some(_), _) => finished(drawing),
        (None, DrawingOrder::Any) => in_any_order(drawing),
        (None, DrawingOrder::Guided) => guided(drawing),
    };
    Words {
        headline,
        hint: hint.to_owned(),
    }
}

fn finished(drawing: &SketchDrawing) -> (String, &'static str) {
    let Some(joint) = drawing.dragged().or(drawing.hovered()) else {
        let hint = "Click a joint to pin it, a bone to turn its limb's depth round. X swaps left and right.";
        return ("Drag any joint".to_owned(), hint);
    };
    let headline = format!("Drag the {}", joint_words(drawing.figure(), joint));
    let hint = match (drawing.is_free_drag(), drawing.pins().get(joint)) {
        (true, _) => "Alt: bones stretch.",
        (false, Some(true)) => {
            "Pinned: a click lets it go. Bones keep their length, Alt stretches."
        }
        _ => "Bones keep their length, Alt stretches. A click pins it.",
    };
    (headline, hint)
}

fn in_any_order(drawing: &SketchDrawing) -> (String, &'static str) {
    if drawing.strokes().is_empty() {
        return (
            format!("Draw the {}", drawing.figure().name.replace('_', " ")),
            "Any strokes in any order: the faint figure shows how.",
        );
    }
    let figure = drawing.figure();
    let placed = &drawing.live_progress().placed;
    let ends = |joint: &usize| figure.bones_at(*joint) == 1;
    let mut missing = (0..placed.len()).filter(|joint| placed[*joint].is_none());
    let hint = "Enter: finished, the rest as it stands. X swaps left and right. A scribble undoes.";
    if drawing.guess().is_none() {
        return ("Go on: the body comes with its torso".to_owned(), hint);
    }
    let headline = match (missing.clone().find(ends), missing.next()) {
        (Some(joint), _) | (None, Some(joint)) => {
            format!("Go on, to the {}", joint_words(figure, joint))
        }
        (None, None) => "Finish the line".to_owned(),
    };
    (headline, hint)
}

fn guided(drawing: &SketchDrawing) -> (String, &'static str) {
    let figure = drawing.figure();
    let bone = |from: usize, to: usize| {
        format!(
            "Draw {} to {}",
            joint_words(figure, from),
            joint_words(figure, to)
        )
    };
    let headline = match drawing.next_bone() {
        Some((Some(from), to)) => bone(from, to),
        Some((None, to)) => match figure.path.get(1) {
            Some(&next) => bone(to, next),
            None => format!("Start at the {}", joint_words(figure, to)),
        },
        None => return ("Finish the line".to_owned(), ""),
    };
    let hint = if drawing.strokes().is_empty() {
        "Follow the faint figure: one stroke per bone, or one long line."
    } else {
        "Scribble over it to take back the last stroke."
    };
    (headline, hint)
}

/// What to do next with the drawing of a key, the `place`th of `count` from 0.
pub(super) fn key_words(place: usize, count: usize, drawing: &SketchDrawing) -> Words {
    Words {
        headline: match place {
            0 => "Source".to_owned(),
            last if last + 1 == count => "Target".to_owned(),
            between => format!("Key {}", between + 1),
        },
        hint: next_step(drawing).headline,
    }
}

/// A joint's name as one says it: `elbow_r` is the right elbow, `knee_fl` the left front knee.
pub(super) fn joint_words(figure: &Figure, joint: usize) -> String {
    let Some(joint) = figure.joints.get(joint) else {
        return "next joint".to_owned();
    };
    let side = match joint.side {
        Side::Center => return joint.name.replace('_', " "),
        Side::Right => "right",
        Side::Left => "left",
    };
    let (stem, ending) = joint.name.rsplit_once('_').unwrap_or((&joint.name, ""));
    // The ending is the side by its letter or word, and before it may stand the end of the body.
    let end = match ending
        .strip_suffix(side)
        .or(ending.strip_suffix(&side[..1]))
    {
        Some("") => "",
        Some("f" | "front") => "front ",
        Some("b" | "back") => "back ",
        Some("h" | "hind") => "hind ",
        _ => return format!("{side} {}", joint.name.replace('_', " ")),
    };
    format!("{side} {end}{}", stem.replace('_', " "))
}

/// The text with a capital letter at its beginning.
pub(super) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// A sentence about the figures there are, for one that was asked for and is not there.
pub(super) fn known_figures<'a>(
    asked: &str,
    figures: impl Iterator<Item = &'a Figure> + Clone,
) -> String {
    let mut sentence = suggestion(asked, figures.map(|figure| &*figure.name));
    if !sentence.ends_with('?') {
        sentence.push('.');
    }
    sentence
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_spoken() {
        let human = Figure::human();
        let words = |name| joint_words(human, human.joint_index(name).unwrap());
        assert_eq!(words("elbow_r"), "right elbow");
        assert_eq!(words("foot_l"), "left foot");
        assert_eq!(words("forehead"), "forehead");
        assert_eq!(joint_words(human, 99), "next joint");
        let renamed = |from: &str, to: &str| {
            let mut figure = human.clone();
            let joint = figure.joint_index(from).unwrap();
            figure.joints[joint].name = to.to_owned();
            joint_words(&figure, joint)
        };
        assert_eq!(renamed("knee_l", "knee_fl"), "left front knee");
        assert_eq!(renamed("foot_r", "foot_br"), "right back foot");
        assert_eq!(renamed("foot_r", "fore_paw_right"), "right fore paw");
        assert_eq!(renamed("foot_r", "talon"), "right talon");
        assert_eq!(renamed("neck", "tail_base"), "tail base");
    }

    #[test]
    fn the_first_words_are_the_first_bone() {
        let mut drawing = SketchDrawing::default();
        let words = next_step(&drawing);
        assert_eq!(words.headline, "Draw the human");
        assert!(words.hint.starts_with("Any strokes in any order"));
        drawing.set_order(DrawingOrder::Guided);
        let words = next_step(&drawing);
        assert_eq!(words.headline, "Draw forehead to neck");
        assert!(words.hint.starts_with("Follow the faint figure"));
    }

    #[test]
    fn keys_are_named_by_their_place() {
        let drawing = SketchDrawing::default();
        let name = |place, count| key_words(place, count, &drawing).headline;
        assert_eq!([name(0, 2), name(1, 2)], ["Source", "Target"]);
        assert_eq!(
            [name(0, 3), name(1, 3), name(2, 3)],
            ["Source", "Key 2", "Target"]
        );
        assert_eq!(key_words(0, 2, &drawing).hint, "Draw the human");
    }

    #[test]
    fn a_finished_sketch_is_dragged() {
        let human = Figure::human();
        let mut drawing = SketchDrawing::default();
        drawing
            .load(&stick3d_figure::Sketch::template(human))
            .unwrap();
        assert_eq!(next_step(&drawing).headline, "Drag any joint");
        let elbow = human.joint_index("elbow_r").unwrap();
        drawing.press(drawing.sketch().unwrap().points()[elbow], 0.0);
        assert_eq!(next_step(&drawing).headline, "Drag the right elbow");
    }
}
