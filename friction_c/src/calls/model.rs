//! A model that is stepped once a period.

use std::ffi::c_char;

use friction_model::{AnyModel, AnyStepper, Regime};

use super::values::{self, FrictionValue};
use crate::boundary::{Message, changed, guarded, handed_over, place, seen, taken_back, text};
use crate::code::FrictionCode;
use crate::made::time_step;

/// A friction model with its state. One thread at a time may use it.
#[derive(Debug)]
pub struct FrictionModel {
    model: AnyModel,
    stepper: AnyStepper,
}

/// Whether the surfaces hold or slide.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionRegime {
    /// The bristles deflect with the motion.
    Stick = 0,
    /// Gross sliding.
    Slip = 1,
}

impl From<Regime> for FrictionRegime {
    fn from(regime: Regime) -> Self {
        match regime {
            Regime::Stick => Self::Stick,
            Regime::Slip => Self::Slip,
        }
    }
}

/// The inner quantities that every model can be asked for.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionState {
    /// Bristle deflection z [rad or m]; zero for static models.
    pub deflection: f64,
    /// Level at which the contact slides now, gamma [N m or N].
    pub gamma: f64,
    /// Stick or slip.
    pub regime: FrictionRegime,
}

/// Makes a model at rest from its name and all its parameters.
///
/// `period` is the time between two steps, above 0 and at most 0.01 s. `scheme` says how the
/// velocity between two steps is taken: FRICTION_SCHEME_HELD or FRICTION_SCHEME_MEAN. `message` gets the reason where
/// it fails, cut to `room` bytes, and may be null. `made` is null then. Free it with
/// friction_model_free.
///
/// # Safety
/// Pointers are null or lead to what their types say; `values` to `count` of them, `message` to
/// `room` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_model_create(
    name: *const c_char,
    values: *const FrictionValue,
    count: usize,
    period: f64,
    scheme: i32,
    message: *mut c_char,
    room: usize,
    made: *mut *mut FrictionModel,
) -> FrictionCode {
    let message = Message { into: message, room };
    let make = || {
        // SAFETY: the caller promises all three.
        let model = unsafe { values::model(name, values, count) }?;
        let stepper = model.start_by(values::scheme(scheme)?, time_step(period)?);
        Ok(FrictionModel { model, stepper })
    };
    // SAFETY: the caller promises both.
    unsafe { handed_over(made, message, make) }
}

/// Ends a model; null is nothing. It must not be used afterwards.
///
/// # Safety
/// `model` is null or came from friction_model_create, and was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_model_free(model: *mut FrictionModel) {
    // SAFETY: the caller promises it.
    unsafe { taken_back(model) }
}

/// The friction now at `velocity` [rad/s or m/s]; the state then advances by one period. The
/// friction opposes motion: it is positive at positive velocity. `friction` [N m or N] is zero, and
/// the state as it was, where the velocity is refused. Allocates nothing.
///
/// # Safety
/// `model` came from friction_model_create; `friction` is null or leads to a double.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_model_step(
    model: *mut FrictionModel,
    velocity: f64,
    friction: *mut f64,
) -> FrictionCode {
    guarded(|| {
        // SAFETY: the caller promises both.
        let (friction, model) = unsafe { (place(friction)?, changed(model)) };
        friction.write(0.0);
        let model = model?;
        if !velocity.is_finite() {
            return Err(FrictionCode::NotFinite);
        }
        friction.write(model.stepper.step(velocity));
        Ok(())
    })
}

/// The inner quantities at `velocity` [rad/s or m/s]. Changes nothing, allocates nothing.
///
/// # Safety
/// `model` came from friction_model_create; `state` is null or leads to a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_model_state(
    model: *const FrictionModel,
    velocity: f64,
    state: *mut FrictionState,
) -> FrictionCode {
    guarded(|| {
        // SAFETY: the caller promises both.
        let (state, model) = unsafe { (place(state)?, seen(model)) };
        state.write(FrictionState { deflection: 0.0, gamma: 0.0, regime: FrictionRegime::Stick });
        let model = model?;
        if !velocity.is_finite() {
            return Err(FrictionCode::NotFinite);
        }
        let inner = model.stepper.internals(velocity);
        let regime = inner.regime.into();
        state.write(FrictionState { deflection: inner.deflection, gamma: inner.gamma, regime });
        Ok(())
    })
}

/// The friction after a long time at constant `velocity` [rad/s or m/s]. Changes nothing, allocates
/// nothing.
///
/// # Safety
/// `model` came from friction_model_create; `friction` is null or leads to a double.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_model_steady_state(
    model: *const FrictionModel,
    velocity: f64,
    friction: *mut f64,
) -> FrictionCode {
    guarded(|| {
        // SAFETY: the caller promises both.
        let (friction, model) = unsafe { (place(friction)?, seen(model)) };
        friction.write(0.0);
        let model = model?;
        if !velocity.is_finite() {
            return Err(FrictionCode::NotFinite);
        }
        friction.write(model.model.steady_state(velocity));
        Ok(())
    })
}

/// The value of a parameter that is no list; of a model with two directions the forward one.
///
/// # Safety
/// `model` came from friction_model_create; `name` is null or a text; `value` is null or leads to a
/// double.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_model_parameter(
    model: *const FrictionModel,
    name: *const c_char,
    value: *mut f64,
) -> FrictionCode {
    guarded(|| {
        // SAFETY: the caller promises all three.
        let (value, model, name) = unsafe { (place(value)?, seen(model), text(name)) };
        value.write(0.0);
        value.write(model?.model.parameter(name?).ok_or(FrictionCode::BadParameter)?);
        Ok(())
    })
}

/// Back to rest. Allocates nothing.
///
/// # Safety
/// `model` is null or came from friction_model_create.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_model_reset(model: *mut FrictionModel) -> FrictionCode {
    guarded(|| {
        // SAFETY: the caller promises it.
        unsafe { changed(model) }?.stepper.reset();
        Ok(())
    })
}
