//! What an identification leaves open: parameters drawn together as likely as the recordings leave
//! them ([`mod@samples`]), tables of them for simulators ([`randomisation`]), and whether two
//! identifications differ ([`mod@compare`]). All of it is worked out of `identification.json`, so that it
//! can be asked of what was found long ago, of friction models and of driven axes.

pub mod compare;
pub mod randomisation;
pub mod reported;
pub mod samples;

pub use compare::{Comparison, compare};
pub use randomisation::{Table, table};
pub use reported::{Report, Reported};
pub use samples::{Samples, samples};

#[cfg(test)]
mod tests;
