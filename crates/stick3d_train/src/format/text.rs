//! Lines and words of text formats.

use super::{Fault, ParseError};

/// The lines of a text that say something: without comments (from `#` on), without blank ones.
pub(super) struct Lines<'a> {
    rest: std::str::Lines<'a>,
    /// Number of the line that came last, from 1.
    pub(super) number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        // Some editors put a byte order mark before everything.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        Self {
            rest: text.lines(),
            number: 0,
        }
    }

    /// The next line that says something.
    pub(super) fn next(&mut self) -> Option<&'a str> {
        loop {
            let line = self.rest.next()?;
            self.number += 1;
            let said = line.split('#').next().unwrap_or_default().trim();
            if !said.is_empty() {
                return Some(said);
            }
        }
    }

    /// A fault in the line that came last.
    pub(super) fn fault(&self, fault: Fault) -> ParseError {
        ParseError::line(self.number, fault)
    }
}

/// A word as a number.
pub(super) fn number<T: std::str::FromStr>(word: &str, expected: &'static str) -> Result<T, Fault> {
    word.parse().map_err(|_| Fault::Word {
        expected,
        found: word.chars().take(40).collect(),
    })
}

/// The next three words as coordinates.
pub(super) fn coordinates<'a>(
    words: &mut impl Iterator<Item = &'a str>,
) -> Result<[f64; 3], Fault> {
    let mut next = || {
        let word = words
            .next()
            .ok_or(Fault::Missing("a coordinate of a vertex"))?;
        number(word, "coordinate")
    };
    Ok([next()?, next()?, next()?])
}
