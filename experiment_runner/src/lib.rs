//! Experiments, their recorder, figures and report, and the `frictionlab` command built on them.

pub mod bag;
pub mod report;
