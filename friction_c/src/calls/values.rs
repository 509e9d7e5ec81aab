//! Values of parameters, as C hands them over.

use std::ffi::c_char;

use friction_model::{AnyModel, Scheme};

use crate::boundary;
use crate::code::{Failure, FrictionCode};
use crate::made;

/// The value of one parameter. Values of the same name make a list, in their order; `forward.f_c`
/// and `backward.f_c` are the `f_c` of one direction alone.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct FrictionValue {
    /// Name of the parameter.
    pub name: *const c_char,
    /// Its value, in the parameter's unit.
    pub value: f64,
}

/// The model that C asks for.
///
/// # Errors
/// See [`made::model`].
///
/// # Safety
/// `name` is null or a text, `values` is null or leads to `count` values, whose names are texts.
pub unsafe fn model(
    name: *const c_char,
    values: *const FrictionValue,
    count: usize,
) -> Result<AnyModel, Failure> {
    // SAFETY: the caller promises all three.
    let (name, values) = unsafe { (boundary::text(name)?, boundary::array(values, count)?) };
    let mut read = Vec::with_capacity(values.len());
    for given in values {
        // SAFETY: the caller promises a text.
        read.push((unsafe { boundary::text(given.name) }?, given.value));
    }
    made::model(name, &read)
}

/// Each velocity is held until the next step: what the thesis has, and what others fit with.
pub const FRICTION_SCHEME_HELD: i32 = 0;

/// From one step to the next the velocity is the mean of both: nearer to the continuous model.
pub const FRICTION_SCHEME_MEAN: i32 = 1;

/// How velocities between two steps are taken.
///
/// # Errors
/// [`FrictionCode::OutOfRange`].
pub fn scheme(number: i32) -> Result<Scheme, Failure> {
    match number {
        FRICTION_SCHEME_HELD => Ok(Scheme::Held),
        FRICTION_SCHEME_MEAN => Ok(Scheme::Mean),
        other => Err(Failure::new(
            FrictionCode::OutOfRange,
            format!("the scheme must be 0 (held) or 1 (mean), but is {other}"),
        )),
    }
}
