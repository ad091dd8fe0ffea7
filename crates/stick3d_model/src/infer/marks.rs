//! What each joint of a sketch says: that it was drawn there, that it was not drawn at all, or that it has to be there.

use stick3d_figure::sketch::Sketch;

/// What a joint of a sketch says of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum JointMark {
    /// It is where it was drawn, as well as hands draw.
    #[default]
    Drawn,
    /// It was not drawn, and stands somewhere; it says nothing.
    Guessed,
    /// The body has to have it there, however crooked the rest is.
    Pinned,
}

/// A sketch, and what each of its joints says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MarkedSketch<'a> {
    /// Where the joints are; those that were not drawn may be anywhere, best as
    /// [`complete_from_template`](stick3d_figure::complete_from_template) puts them.
    pub sketch: &'a Sketch,
    /// One mark per joint of the figure; none at all where every joint was drawn.
    pub marks: &'a [JointMark],
}

impl<'a> From<&'a Sketch> for MarkedSketch<'a> {
    fn from(sketch: &'a Sketch) -> Self {
        Self { sketch, marks: &[] }
    }
}
