//! Friction models and observers for C and C++.
//!
//! What C sees is `include/friction.h`, which is written from the modules in `calls`; the README
//! has an example. The rest is safe Rust:
//!
//! | module | what it holds |
//! |---|---|
//! | `calls` | the functions of the header, by what they are about |
//! | `boundary` | pointers that are checked, texts in and out, panics that stop here |
//! | `catalogue` | models and parameters as texts that end with a zero byte |
//! | `made` | models and observers from names and values, and from parameter files |
//! | `code` | what a call answers |

mod boundary;
mod calls;
mod catalogue;
mod code;
mod made;

pub use calls::*;
pub use catalogue::FrictionParameter;
pub use code::FrictionCode;
