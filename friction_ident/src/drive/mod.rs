//! A drive from its voltage and its motion: gain, time constant, delay, deadband, and the inertia
//! as far as it can be known.
//!
//! ```text
//! T w' + w = K (u(t - delay) - friction in volts)
//! u(t - delay) = (T / K) w' + w / K + friction in volts,     T / K = J R_a / (A K_m),   1 / K = A K_m + f_v R_a / (A K_m)
//! ```
//!
//! (thesis appendix A.) What can be told apart depends on what was recorded:
//!
//! * **Voltage and motion.** `T / K`, `1 / K` and the friction in volts. Back-EMF and viscous
//!   friction are one term: `K` is the gain of the drive with its bearings, and `T` its time
//!   constant with them. The inertia is known only as a ratio to the torque per volt.
//! * **And the friction torque.** `K` and `T` of the motor alone, the volts that overcome one unit
//!   of torque, `R_a / (A K_m)`, and the inertia.
//! * **And the motor's constants, or the force per volt.** The inertia, by
//!   `J = (T / K) A K_m / R_a`, with the errors of the constants.
//!
//! Armature inductance is part of the delay.

mod breakaway;
mod combine;
mod constants;
mod fit;
mod fitted;
mod report;
mod with_torque;

pub use breakaway::{Breakaway, breakaways};
pub use combine::combine;
pub use constants::Calibration;
pub use fit::{DriveFit, DriveRecording, fit_drive};
