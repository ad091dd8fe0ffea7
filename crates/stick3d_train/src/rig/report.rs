//! What was seen and put right while a rig was read.

/// What reading a rig found and put right; nothing of it is an error.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RigReport {
    /// Vertices as they stand in the file.
    pub file_vertices: usize,
    /// Vertices that were joined to another one at the same place.
    pub welded: usize,
    /// Vertices whose weights did not sum to one, and were scaled.
    pub normalized: usize,
    /// Vertices that followed more than [`MAX_INFLUENCES`](super::MAX_INFLUENCES) bones, and kept the strongest.
    pub truncated: usize,
    /// Triangles without area, which are kept.
    pub degenerate: usize,
    /// What else is worth knowing, in sentences.
    pub notes: Vec<String>,
}

impl RigReport {
    /// Everything that is worth telling a person, one line each.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let counts = [
            (
                self.welded,
                "vertices joined to another one at the same place (seams of normals or texture)",
            ),
            (
                self.normalized,
                "vertices had weights that did not sum to one; they were scaled",
            ),
            (
                self.truncated,
                "vertices followed more than eight bones; the strongest were kept",
            ),
            (self.degenerate, "triangles have no area; they were kept"),
        ];
        counts
            .into_iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{count} {what}"))
            .chain(self.notes.iter().cloned())
            .collect()
    }
}
