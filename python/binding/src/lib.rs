//! The laboratory from Python: the extension module of the wheel `frictionlab`.
//!
//! What a call means is said by the crates that the command stands on; here arguments come in and
//! results go out. Objects, tables and pictures are made of them in Python, in the package
//! `frictionlab`, which nobody needs to know this module beside.
//!
//! [`calls`] is what all functions share: work without the interpreter's lock that ctrl-C ends,
//! and errors as exceptions. Nothing here panics into Python.

mod arrays;
mod calls;
mod design;
mod errors;
mod export;
mod features;
mod identify;
mod models;
mod posterior;
mod simulate;

use pyo3::prelude::*;

/// The extension module.
#[pymodule]
#[pyo3(name = "_native")]
mod native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::design::design;
    #[pymodule_export]
    use crate::export::export;
    #[pymodule_export]
    use crate::features::features;
    #[pymodule_export]
    use crate::identify::{Found, identify, identify_each, joints};
    #[pymodule_export]
    use crate::models::{Contact, Model, catalogue};
    #[pymodule_export]
    use crate::posterior::{compare, randomisation, samples};
    #[pymodule_export]
    use crate::simulate::simulate;

    /// The version of the package.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
