//! The models from outside: against references, closed forms and each other, at random parameters
//! and motions. One program, so that all of it is linked once and nothing waits for the slowest.

mod arbitrary;
mod bits;
mod bounds;
mod derivatives;
mod injection;
mod memory;
mod paper_models;
mod passivity;
mod reference;
mod robustness;
mod schemes;
mod single_precision;
mod static_models;
mod stick_slip;
mod whole_range;
