//! The `stick3d` command.

fn main() {}
