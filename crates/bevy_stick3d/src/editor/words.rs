//! The few words that say what to do next.

use stick3d_figure::{Figure, Side};

use crate::sketch_input::SketchDrawing;

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
    let figure = drawing.figure();
    if drawing.sketch().is_some() {
        let held = drawing.dragged().or(drawing.hovered());
        return Words {
            headline: match held {
                Some(joint) => format!("Drag the {}", joint_words(figure, joint)),
                None => "Drag any joint".to_owned(),
            },
            hint: "The body follows. Esc starts over, M mirrors.".to_owned(),
        };
    }
    let begun = !drawing.strokes().is_empty();
    let (headline, hint) = match drawing.next_bone() {
        Some((Some(from), to)) => (
            format!(
                "Draw {} to {}",
                joint_words(figure, from),
                joint_words(figure, to)
            ),
            "Scribble over it to take back the last stroke.",
        ),
        Some((None, to)) => (
            match figure.path.get(1) {
                Some(&next) => format!(
                    "Draw {} to {}",
                    joint_words(figure, to),
                    joint_words(figure, next)
                ),
                None => format!("Start at the {}", joint_words(figure, to)),
            },
            "Follow the faint figure: one stroke per bone, or one long line.",
        ),
        None => ("Finish the line".to_owned(), ""),
    };
    let hint = if begun || !hint.starts_with("Scribble") {
        hint
    } else {
        "Follow the faint figure: one stroke per bone, or one long line."
    };
    Words {
        headline,
        hint: hint.to_owned(),
    }
}

/// A joint's name as one says it: `elbow_r` is the right elbow.
pub(super) fn joint_words(figure: &Figure, joint: usize) -> String {
    let Some(joint) = figure.joints.get(joint) else {
        return "next joint".to_owned();
    };
    let (side, suffixes) = match joint.side {
        Side::Center => ("", ["", ""]),
        Side::Right => ("right ", ["_r", "_right"]),
        Side::Left => ("left ", ["_l", "_left"]),
    };
    let name = suffixes
        .iter()
        .filter(|suffix| !suffix.is_empty())
        .find_map(|suffix| joint.name.strip_suffix(suffix))
        .unwrap_or(&joint.name);
    format!("{side}{}", name.replace('_', " "))
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
    }

    #[test]
    fn the_first_words_are_the_first_bone() {
        let words = next_step(&SketchDrawing::default());
        assert_eq!(words.headline, "Draw forehead to neck");
        assert!(words.hint.starts_with("Follow the faint figure"));
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
