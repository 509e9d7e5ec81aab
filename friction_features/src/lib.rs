//! What tells friction models apart, computed.

pub mod describing_function;
pub mod limit_cycle;
