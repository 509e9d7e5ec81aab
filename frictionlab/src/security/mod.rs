//! Keystores of DDS Security: made and looked at from the command line.

#[cfg(feature = "security")]
mod check;

#[cfg(feature = "security")]
pub use check::{Enclave, NoKeystore, look, table};
