//! An observer that is called once a cycle.

use std::ffi::c_char;
use std::ptr::null;

use friction_observer::{Estimate, Seen};

use super::model::FrictionRegime;
use super::values::{self, FrictionValue};
use crate::boundary::{
    Message, asked, changed, guarded, handed_over, place, seen, taken_back, text,
};
use crate::code::{Failure, FrictionCode};
use crate::made::{NODE, Observer, time_step};

/// An observer: which velocity is believed, which technique, which model. One thread at a time may
/// use it.
#[derive(Debug)]
pub struct FrictionObserver(Observer);

/// One cycle's readings and intentions, on the load's side. Set what an observer does not need to
/// zero: one that follows the measured velocity needs the velocity alone.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionSeen {
    /// Measured velocity [rad/s].
    pub velocity: f64,
    /// Measured position [rad].
    pub position: f64,
    /// Velocity that the reference asks for [rad/s].
    pub reference_velocity: f64,
    /// Controlled output minus its reference [rad/s or rad].
    pub error: f64,
    /// Voltage applied during the cycle before [V].
    pub voltage: f64,
    /// Friction torque as a sensor measured it [N m]; not a number (NAN) where there is none.
    pub torque: f64,
}

/// One cycle's estimate.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionEstimate {
    /// Friction torque [N m]; positive opposes positive velocity. Add it to the effort to
    /// compensate.
    pub torque: f64,
    /// Bristle deflection z [rad]; zero for static models and without a model.
    pub deflection: f64,
    /// Level at which the contact slides now, gamma [N m]; zero without a model.
    pub gamma: f64,
    /// Velocity that the estimate was made with [rad/s].
    pub velocity: f64,
    /// Measured minus estimated torque [N m]; not a number without a sensor.
    pub residual: f64,
    /// Stick or slip.
    pub regime: FrictionRegime,
}

impl FrictionEstimate {
    const NONE: Self = Self {
        torque: 0.0,
        deflection: 0.0,
        gamma: 0.0,
        velocity: 0.0,
        residual: f64::NAN,
        regime: FrictionRegime::Stick,
    };
}

impl From<Estimate> for FrictionEstimate {
    fn from(estimate: Estimate) -> Self {
        Self {
            torque: estimate.torque,
            deflection: estimate.deflection,
            gamma: estimate.gamma,
            velocity: estimate.velocity,
            residual: estimate.residual.unwrap_or(f64::NAN),
            regime: estimate.regime.into(),
        }
    }
}

/// Makes an observer at rest that follows the measured velocity with a model: its name and all its
/// parameters.
///
/// `period` is the time between two calls, above 0 and at most 0.01 s. `scheme` says how the
/// velocity between two calls is taken: FRICTION_SCHEME_HELD or FRICTION_SCHEME_MEAN. `message` gets the reason where
/// it fails, cut to `room` bytes, and may be null. `made` is null then. Free it with
/// friction_observer_free.
///
/// # Safety
/// Pointers are null or lead to what their types say; `values` to `count` of them, `message` to
/// `room` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_create(
    name: *const c_char,
    values: *const FrictionValue,
    count: usize,
    period: f64,
    scheme: i32,
    message: *mut c_char,
    room: usize,
    made: *mut *mut FrictionObserver,
) -> FrictionCode {
    let message = Message { into: message, room };
    let make = || {
        // SAFETY: the caller promises all three.
        let model = unsafe { values::model(name, values, count) }?;
        let observer = Observer::following(model, values::scheme(scheme)?, time_step(period)?)?;
        Ok(FrictionObserver(observer))
    };
    // SAFETY: the caller promises both.
    unsafe { handed_over(made, message, make) }
}

/// Makes the observer that a ROS 2 parameter file describes, for instance the `parameters.yaml` of
/// an identification: `yaml` is its text, `node` the node it is for, null for
/// "/friction_observer". `period` 0 means the period that the file says, 0.001 s if none. The rest
/// is as in friction_observer_create.
///
/// # Safety
/// Pointers are null or lead to what their types say; `message` to `room` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_from_yaml(
    yaml: *const c_char,
    node: *const c_char,
    period: f64,
    message: *mut c_char,
    room: usize,
    made: *mut *mut FrictionObserver,
) -> FrictionCode {
    let message = Message { into: message, room };
    let make = || {
        // SAFETY: the caller promises both.
        let yaml = unsafe { text(yaml) }?;
        // SAFETY: it is not null, and the caller promises a text.
        let node = if node.is_null() { NODE } else { unsafe { text(node) }? };
        if !node.starts_with('/') {
            let said = format!("the node's name must begin with a slash, but is {node:?}");
            return Err(Failure::new(FrictionCode::BadFile, said));
        }
        Observer::from_file(yaml, node, period).map(FrictionObserver)
    };
    // SAFETY: the caller promises both.
    unsafe { handed_over(made, message, make) }
}

/// Ends an observer; null is nothing. It must not be used afterwards.
///
/// # Safety
/// `observer` is null or came from one of the functions that make them, and was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_free(observer: *mut FrictionObserver) {
    // SAFETY: the caller promises it.
    unsafe { taken_back(observer) }
}

/// The friction now. The estimate is zero, and the state as it was, where a number other than
/// `torque` is not finite. Allocates nothing.
///
/// # Safety
/// `observer` came from one of the functions that make them; the others are null or lead to what
/// their types say, not to the same place.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_step(
    observer: *mut FrictionObserver,
    now: *const FrictionSeen,
    estimate: *mut FrictionEstimate,
) -> FrictionCode {
    guarded(|| {
        // SAFETY: the caller promises it.
        let estimate = unsafe { place(estimate) }?;
        estimate.write(FrictionEstimate::NONE);
        // SAFETY: the caller promises both.
        let (observer, now) = unsafe { (changed(observer)?, *seen(now)?) };
        let FrictionSeen { velocity, position, reference_velocity, error, voltage, torque } = now;
        let all = [velocity, position, reference_velocity, error, voltage];
        if !all.iter().all(|number| number.is_finite()) {
            return Err(FrictionCode::NotFinite);
        }
        let torque = torque.is_finite().then_some(torque);
        let seen = Seen { velocity, position, reference_velocity, error, voltage, torque };
        estimate.write(observer.0.estimator.estimate(&seen).into());
        Ok(())
    })
}

/// Goes over to the model and the options of `to`, which stays as it is. What estimated before
/// fades out in 0.1 s: the torque does not jump. Both must have the same period. Allocates nothing:
/// make `to` in another thread. Over to itself is nothing.
///
/// # Safety
/// Both are null or came from one of the functions that make them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_change(
    observer: *mut FrictionObserver,
    to: *const FrictionObserver,
) -> FrictionCode {
    guarded(|| {
        if !observer.is_null() && std::ptr::eq(observer, to) {
            return Ok(());
        }
        // SAFETY: the caller promises both, and they are not the same.
        let (observer, to) = unsafe { (changed(observer)?, seen(to)?) };
        if observer.0.dt != to.0.dt {
            return Err(FrictionCode::BadPeriod);
        }
        let changed = observer.0.estimator.change(&to.0.model, *to.0.estimator.options());
        changed.map_err(|_| FrictionCode::BadParameter)?;
        (observer.0.model, observer.0.name) = (to.0.model, to.0.name);
        Ok(())
    })
}

/// Back to rest. Allocates nothing.
///
/// # Safety
/// `observer` is null or came from one of the functions that make them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_reset(observer: *mut FrictionObserver) -> FrictionCode {
    guarded(|| {
        // SAFETY: the caller promises it.
        unsafe { changed(observer) }?.0.estimator.reset();
        Ok(())
    })
}

/// The time between two calls [s]; zero for null.
///
/// # Safety
/// `observer` is null or came from one of the functions that make them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_period(observer: *const FrictionObserver) -> f64 {
    // SAFETY: the caller promises it.
    asked(0.0, || unsafe { seen(observer) }.map_or(0.0, |observer| observer.0.dt.seconds()))
}

/// Whether the observer needs the voltage that was applied: false, and FrictionSeen's voltage may
/// stay zero, for those that only follow a velocity.
///
/// # Safety
/// `observer` is null or came from one of the functions that make them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_needs_voltage(
    observer: *const FrictionObserver,
) -> bool {
    // SAFETY: the caller promises it.
    asked(false, || unsafe { seen(observer) }.is_ok_and(|observer| observer.0.needs_voltage()))
}

/// Whether the observer needs the velocity that the reference asks for, or the error.
///
/// # Safety
/// `observer` is null or came from one of the functions that make them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_needs_reference(
    observer: *const FrictionObserver,
) -> bool {
    // SAFETY: the caller promises it.
    asked(false, || unsafe { seen(observer) }.is_ok_and(|observer| observer.0.needs_reference()))
}

/// The name of the model; null for null. The text stays as long as the program runs.
///
/// # Safety
/// `observer` is null or came from one of the functions that make them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn friction_observer_model(
    observer: *const FrictionObserver,
) -> *const c_char {
    asked(null(), || {
        // SAFETY: the caller promises it.
        let observer = unsafe { seen(observer) };
        observer.map_or(null(), |observer| observer.0.name.as_ptr())
    })
}
