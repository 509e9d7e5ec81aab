//! Parameters of ROS 2 nodes, declared once, without ROS.
//!
//! - [`parameters!`]: structs whose fields are parameters, each with its unit, range and meaning on
//!   one line; [`Declared`] is what they can do;
//! - [`Declaration`]: one parameter, as a node tells it and as it holds values to it;
//! - [`Values`]: the values of a node;
//! - [`mod@file`]: parameter files, read and written as rcl reads them;
//! - [`markdown_table`]: declarations for the documentation;
//! - [`nearest()`]: the name that is meant by a misspelt one.
//!
//! ```
//! use parameters::{Declared, ValueRange, Values, file, parameters};
//!
//! parameters! {
//!     /// Parameters of the node `talker`.
//!     #[derive(Debug, Clone, PartialEq)]
//!     pub struct Talker {
//!         rate: f64 = 10.0, "How often it talks", unit("Hz"), range(ValueRange::POSITIVE);
//!         word: String = "hello".to_owned(), "What it says";
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = "/**/talker:\n  ros__parameters:\n    rate: 2.5\n";
//! let given = file::Parameters::parse(text)?.of_node("/axis_1/talker");
//! let declared = Talker::default().declarations();
//! let talker = Talker::default().with(&Values::given(&declared, &given)?);
//! assert_eq!(talker, Talker { rate: 2.5, word: "hello".to_owned() });
//! # Ok(())
//! # }
//! ```

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod declaration;
mod declared;
mod error;
#[cfg(feature = "yaml")]
pub mod file;
mod named;
mod nearest;
mod range;
mod spec;
mod table;
mod value;
mod values;

pub use declaration::Declaration;
#[doc(hidden)]
pub use declared::joined;
pub use declared::{Declared, OutOfRange};
pub use error::ParameterError;
pub use named::Named;
pub use nearest::{nearest, with_nearest};
pub use range::ValueRange;
pub use spec::Spec;
#[doc(hidden)]
pub use strum;
pub use table::markdown_table;
pub use value::ParameterValue;
pub use values::Values;
