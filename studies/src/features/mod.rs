//! `frictionlab features`: what tells friction models apart, computed for each model and drawn in
//! one report.

mod compute;
mod describing;
mod page;
mod pictures;
mod tables;
mod terminal;

pub use compute::{FeaturesOptions, FeaturesResults, ModelFeatures, compute};
pub use page::page;
pub use terminal::summary;
