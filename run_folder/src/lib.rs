//! What a folder of results holds.
//!
//! [`Run::open`] tells which kind of run a folder is of, and says why where it is none; [`list`]
//! does so for all folders of a folder. [`Contents`] are its parameters, figures and settings, by
//! their places in its document; [`Comparison`] holds two beside each other. [`Run::page`] makes
//! its page anew.
//!
//! A document is read by its names alone: a run of another version, or of an experiment that is not
//! part of this program, has its parameters and settings too.

mod compare;
mod compare_page;
mod contents;
mod kind;
mod list;
mod measure;
mod page;
mod run;

pub use compare::{Compared, Comparison, Setting, Unequal, Verdict};
pub use contents::{Contents, Quantity};
pub use kind::Kind;
pub use list::{Listing, NoRunIn, list};
pub use page::Remade;
pub use run::{NoRun, Run, State};
