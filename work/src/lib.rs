//! What all long work of the laboratory shares, whoever asks for it: where its results go
//! ([`destination`]), how much is told ([`saying`], [`progress`]), jobs on all cores
//! ([`sequencer`]), parts of it ([`part`]), options without a terminal ([`line`](mod@line)), and how it ends ([`ending`]).

pub mod destination;
pub mod drive_errors;
pub mod ending;
pub mod line;
pub mod model_name;
pub mod part;
pub mod progress;
pub mod saying;
pub mod sequencer;
pub mod suggestion;

pub use ending::{BadInput, Interrupted};
