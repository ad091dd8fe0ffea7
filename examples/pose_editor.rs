//! The pose editor.

fn main() {}
