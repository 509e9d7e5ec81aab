//! The `frictionlab` command.
fn main() {}
