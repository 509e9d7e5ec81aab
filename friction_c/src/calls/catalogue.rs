//! What there is: the version, the codes, the models and their parameters.

use std::ffi::c_char;
use std::ptr::null;

use crate::boundary::{asked, guarded, place, text};
use crate::catalogue::{FrictionParameter, Model, models};
use crate::code::FrictionCode;

/// Version of the library, for instance "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn friction_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// What a code means, in a sentence; null for a number that is no code.
#[unsafe(no_mangle)]
pub extern "C" fn friction_code_meaning(code: i32) -> *const c_char {
    let known = FrictionCode::ALL.into_iter().find(|known| *known as i32 == code);
    known.map_or(null(), |code| code.meaning().as_ptr())
}

/// How many models there are.
#[unsafe(no_mangle)]
pub extern "C" fn friction_model_count() -> usize {
    asked(0, || models().len())
}

/// The name of a model, as files have it; null beyond the last.
#[unsafe(no_mangle)]
pub extern "C" fn friction_model_name(index: usize) -> *const c_char {
    asked(null(), || models().get(index).map_or(null(), |model| model.name.as_ptr()))
}

/// The name of a model, as people read it; null beyond the last.
#[unsafe(no_mangle)]
pub extern "C" fn friction_model_title(index: usize) -> *const c_char {
    asked(null(), || models().get(index).map_or(null(), |model| model.title.as_ptr()))
}

/// How many parameters a model has; zero for a model that is not there.
///
/// # Safety
/// `model` is null or a text.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_parameter_count(model: *const c_char) -> usize {
    // SAFETY: the caller promises it.
    asked(0, || unsafe { named(model) }.map_or(0, Model::parameters))
}

/// One parameter of a model.
///
/// # Safety
/// `model` is null or a text, `into` is null or leads to a place for a parameter.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_parameter_at(
    model: *const c_char,
    index: usize,
    into: *mut FrictionParameter,
) -> FrictionCode {
    guarded(|| {
        // SAFETY: the caller promises both.
        let (model, into) = unsafe { (named(model)?, place(into)?) };
        into.write(model.parameter(index).ok_or(FrictionCode::OutOfRange)?);
        Ok(())
    })
}

/// The model of that name.
///
/// # Safety
/// `name` is null or a text.
unsafe fn named(name: *const c_char) -> Result<&'static Model, FrictionCode> {
    // SAFETY: the caller promises it.
    let name = unsafe { text(name) }?;
    let known = models().iter().find(|model| model.name.as_bytes() == name.as_bytes());
    known.ok_or(FrictionCode::UnknownModel)
}
