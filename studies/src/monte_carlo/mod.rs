//! What compensation is worth when what it believes is wrong: every technique over every model,
//! many times, with parameters drawn at random.
//!
//! * [`task`]: what has to be followed.
//! * [`errors`]: the errors of the beliefs, and how they are drawn.
//! * [`trial`]: one run.
//! * [`study`]: all runs, in parallel, in order.
//! * [`worth`]: how much smaller the errors become, as a distribution.
//! * [`ranking`]: which model is the best, as a distribution.
//! * [`page`], [`terminal`]: what a person sees of it.

pub mod errors;
mod options;
pub mod page;
pub mod ranking;
pub mod study;
pub mod task;
pub mod terminal;
pub mod trial;
pub mod worth;

pub use errors::{BeliefErrors, Sharing};
pub use options::{Setting, StudyError, StudyOptions, bench};
pub use study::{Cell, Study};
pub use task::Task;
pub use trial::Trial;
