//! What is identified from recordings, one room a kind: [`axis`] (friction and inertia of a driven
//! axis), [`friction`] (friction models with all their parameters), [`drive`] (a motor's
//! constants), [`servo`] and [`stiction`]; [`look`] shows what a file holds before any of them.
//!
//! Each works everything out first; its document is JSON, its page HTML, its terminal text.
//! [`posterior`] draws from what was found and compares it with what was found elsewhere. [`speeds`] tells where a model was identified; [`verdict`] why a parameter is not; [`asked`] holds the options that the command and requests to the node have in common.

pub mod asked;
pub mod axis;
pub mod drive;
pub mod friction;
pub mod look;
pub mod posterior;
pub mod rows;
pub mod servo;
pub mod speeds;
pub mod stiction;
pub mod verdict;
