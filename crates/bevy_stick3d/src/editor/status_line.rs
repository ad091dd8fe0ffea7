//! The quiet line that says what was done and what went wrong.

/// How long good news stays, seconds.
const NOTE_S: f32 = 4.0;

/// One line: a note that goes away, or a problem that stays until something works again.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct StatusLine {
    text: String,
    is_problem: bool,
    left_s: f32,
}

impl StatusLine {
    /// Says what was done.
    pub(super) fn note(&mut self, text: impl Into<String>) {
        *self = Self {
            text: text.into(),
            is_problem: false,
            left_s: NOTE_S,
        };
    }

    /// Says what went wrong, until something else is said.
    pub(super) fn problem(&mut self, text: impl Into<String>) {
        *self = Self {
            text: text.into(),
            is_problem: true,
            left_s: f32::INFINITY,
        };
    }

    /// Says nothing.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Lets time pass.
    pub(super) fn tick(&mut self, seconds: f32) {
        self.left_s -= seconds;
    }

    /// The text, and whether it is a problem.
    pub(super) fn shown(&self) -> Option<(&str, bool)> {
        (self.left_s > 0.0 && !self.text.is_empty()).then_some((&*self.text, self.is_problem))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_fade_and_problems_stay() {
        let mut status = StatusLine::default();
        assert_eq!(status.shown(), None);
        status.note("saved");
        assert_eq!(status.shown(), Some(("saved", false)));
        status.tick(NOTE_S + 1.0);
        assert_eq!(status.shown(), None);
        status.problem("no such file");
        status.tick(1.0e6);
        assert_eq!(status.shown(), Some(("no such file", true)));
        status.clear();
        assert_eq!(status.shown(), None);
    }
}
