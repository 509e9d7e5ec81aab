//! Techniques that need no friction model: their defaults, found by trying on the simulated rig.
//!
//! Mean square errors of the two tracking tasks there, alone 1.7e-4 (rad/s)^2 and 2.1e-3 rad^2:
//! dither 3.9e-4 and 1.9e-3, knocker 2.4e-4 and 1.7e-3, acceleration feedback 5.6e-5 and 5.7e-4,
//! retuned 9.8e-6 and 5.9e-6. Dither and knocker help against stiction, of which this friction has
//! little, and disturb a velocity loop.

use controller::design::{
    LinearDrive, PiSpecification, PositionPoles, pi_from_specification, pid_from_poles,
};
use controller::{
    AccelerationFeedback, ControlMode, ControllerOptions, Dither, DitherShape, Impulse, LagGains,
    PiGains, PidGains, VelocityLaw,
};

/// Retuned PI: crossover [rad/s] and phase margin \[degrees\]. More crossover lets the tachometer's
/// noise grow faster than friction's share falls.
pub const RETUNED_VELOCITY: PiSpecification =
    PiSpecification { crossover: 150.0, phase_margin: 70.0 };

/// Retuned PID: its poles. Sampled at 1 kHz its sensitivity peak is 1.23 and its phase margin 59
/// degrees.
pub const RETUNED_POSITION: PositionPoles =
    PositionPoles { damping: 0.7, natural_frequency: 30.0, real_pole: 40.0 };

/// Factor of the apparent inertia, and of the gains, under acceleration feedback.
const INERTIA: f64 = 3.0;

/// Time constant of the acceleration's filter \[s\].
const FILTER: f64 = 0.01;

/// The dither of a loop.
#[must_use]
pub const fn dither(mode: ControlMode) -> Dither {
    let (amplitude, frequency) = match mode {
        // A slow or strong dither is itself an error of velocity.
        ControlMode::Velocity => (0.2, 125.0),
        ControlMode::Position => (0.6, 30.0),
    };
    Dither { shape: DitherShape::Sine, amplitude, frequency }
}

/// The knocker of a loop.
#[must_use]
pub const fn knocker(mode: ControlMode) -> Impulse {
    match mode {
        ControlMode::Velocity => Impulse { height: 0.3, width: 0.002, period: 0.1 },
        ControlMode::Position => Impulse { height: 1.0, width: 0.01, period: 0.05 },
    }
}

/// Three times the inertia, and the gains that keep the poles where they are.
pub fn accelerate(drive: &LinearDrive, options: &mut ControllerOptions) {
    options.acceleration = Some(AccelerationFeedback::for_inertia(drive, INERTIA, FILTER));
    options.velocity = match options.velocity {
        VelocityLaw::Lag(gains) => VelocityLaw::Lag(LagGains { k_p: INERTIA * gains.k_p, ..gains }),
        VelocityLaw::Pi(PiGains { k_p, k_i }) => {
            VelocityLaw::Pi(PiGains { k_p: INERTIA * k_p, k_i: INERTIA * k_i })
        }
    };
    // f T s^3 + (1 + K K_d') s^2 + f K K_p s + f K K_i with f (1 + K K_d) in the middle.
    let PidGains { k_p, k_i, k_d } = options.pid;
    options.pid = PidGains {
        k_p: INERTIA * k_p,
        k_i: INERTIA * k_i,
        k_d: (INERTIA * (1.0 + drive.gain * k_d) - 1.0) / drive.gain,
    };
}

/// More gain: as much as margins and noise allow. A drive on which the specification cannot be met
/// keeps its gains.
pub fn retune(drive: &LinearDrive, options: &mut ControllerOptions) {
    if let Ok(gains) = pi_from_specification(drive, &RETUNED_VELOCITY) {
        options.velocity = VelocityLaw::Pi(gains);
    }
    if let Ok(gains) = pid_from_poles(drive, &RETUNED_POSITION) {
        options.pid = gains;
    }
}

#[cfg(test)]
mod tests {
    use controller::Controller;
    use controller::design::frequency::margins;
    use controller::design::{LinearLoop, LoopLaw};

    use super::*;

    #[test]
    fn the_retuned_loops_have_the_stated_margins() {
        let drive = LinearDrive::THESIS;
        let mut options = ControllerOptions::default();
        retune(&drive, &mut options);
        let position = LoopLaw::Position {
            gains: options.pid,
            derivative_on: options.derivative_on,
            filter: options.derivative_filter,
        };
        for (law, phase_margin, peak) in
            [(LoopLaw::Velocity(options.velocity), 65.7, 1.07), (position, 59.5, 1.23)]
        {
            let linear = LinearLoop { drive, law };
            let found =
                margins(|w| linear.open_sampled(w, options.period), 0.1, 3.1 / options.period);
            assert!((found.phase_margin.unwrap() - phase_margin).abs() < 0.2, "{found:?}");
            assert!((found.sensitivity_peak - peak).abs() < 0.02, "{found:?}");
        }
    }

    #[test]
    fn three_times_the_inertia_keeps_the_poles_of_the_position_loop() {
        let drive = LinearDrive::THESIS;
        let mut options = ControllerOptions::default();
        let before = options.pid;
        accelerate(&drive, &mut options);
        let heavy = options.acceleration.unwrap().apparent(&drive);
        let characteristic = |drive: LinearDrive, gains| {
            let law =
                LoopLaw::Position { gains, derivative_on: options.derivative_on, filter: 0.0 };
            LinearLoop { drive, law }.characteristic()
        };
        let (light, heavy) = (characteristic(drive, before), characteristic(heavy, options.pid));
        for (a, b) in light.coefficients().iter().zip(heavy.coefficients()) {
            assert!((INERTIA * a - b).abs() < 1e-9 * b.abs().max(1e-9), "{light:?} {heavy:?}");
        }
    }

    #[test]
    fn every_default_can_be_run() {
        for mode in [ControlMode::Velocity, ControlMode::Position] {
            let mut options = ControllerOptions {
                mode,
                dither: Some(dither(mode)),
                impulse: Some(knocker(mode)),
                ..Default::default()
            };
            accelerate(&LinearDrive::THESIS, &mut options);
            Controller::new(options).unwrap();
        }
    }
}
