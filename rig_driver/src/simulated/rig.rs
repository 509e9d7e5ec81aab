//! The rig itself: drive, friction, sensors and voltage output.

use friction_model::FrictionModel;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::sensors::quantise;
use crate::{Measurement, Plant, Rig, RigError, SimulationOptions, Truth};

/// The simulated test bed under the friction of model `M`.
#[derive(Debug, Clone)]
pub struct SimulatedRig<M: FrictionModel> {
    plant: Plant<M>,
    options: SimulationOptions,
    noise: Pcg64Mcg,
    /// Noise of the current sensor, a stream of its own: rigs with and without it read the same
    /// otherwise.
    current_noise: Pcg64Mcg,
    /// Velocity at the beginning of the cycle before [rad/s].
    velocity_before: f64,
    cycle: u64,
    asked: f64,
    applied: f64,
    saturated: bool,
    fault: bool,
}

impl<M: FrictionModel> SimulatedRig<M> {
    /// A rig at rest at position zero with the motor at zero volts.
    ///
    /// # Errors
    /// [`RigError`] names the option that is out of range.
    pub fn new(options: SimulationOptions, model: M) -> Result<Self, RigError> {
        options.check()?;
        Ok(Self {
            plant: Plant::new(&options.drive, options.friction_coupling, model),
            noise: Pcg64Mcg::seed_from_u64(options.seed),
            current_noise: Pcg64Mcg::seed_from_u64(!options.seed),
            velocity_before: 0.0,
            options,
            cycle: 0,
            asked: 0.0,
            applied: 0.0,
            saturated: false,
            fault: false,
        })
    }
}

impl<M: FrictionModel> Rig for SimulatedRig<M> {
    fn period(&self) -> f64 {
        self.options.period
    }

    fn voltage_range(&self) -> f64 {
        self.options.voltage_range
    }

    fn measure(&mut self) -> Measurement {
        let truth = self.plant.truth(self.applied);
        let sensors = &self.options.sensors;
        let (encoder_counts, encoder_position) = sensors.encoder(truth.position);
        let drive = &self.options.drive;
        let mean_velocity = 0.5 * (self.velocity_before + truth.velocity);
        let current = (self.applied - drive.back_emf() * mean_velocity) / drive.armature_resistance;
        Measurement {
            cycle: self.cycle,
            time: self.cycle as f64 * self.options.period,
            encoder_counts,
            encoder_position,
            tachometer_velocity: sensors.tachometer.read(truth.velocity, &mut self.noise),
            potentiometer_position: sensors.potentiometer.read(truth.position, &mut self.noise),
            torque: sensors.torque.read(truth.friction, &mut self.noise),
            motor_current: Some(sensors.current.read(current, &mut self.current_noise)),
            voltage_asked: self.asked,
            voltage_applied: self.applied,
            saturated: self.saturated,
            watchdog_expired: false,
            fault: self.fault,
        }
    }

    fn truth(&self) -> Option<Truth> {
        Some(self.plant.truth(self.applied))
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        let refused =
            if volts.is_finite() { None } else { Some(RigError::VoltageNotFinite(volts)) };
        self.fault |= refused.is_some();
        self.asked = if refused.is_some() { 0.0 } else { volts };
        let cut = self.asked.clamp(-self.options.voltage_limit, self.options.voltage_limit);
        self.saturated = cut != self.asked;
        self.applied =
            if self.fault { 0.0 } else { quantise(cut, self.options.sensors.voltage_resolution) };
        let h = self.options.period / f64::from(self.options.substeps);
        self.velocity_before = self.plant.velocity();
        if let Some(drift) = self.options.friction_drift {
            self.plant.set_friction_factor(drift.factor(self.cycle as f64 * self.options.period));
        }
        for _ in 0..self.options.substeps {
            self.plant.advance(self.applied, h);
        }
        self.cycle += 1;
        refused.map_or(Ok(()), Err)
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{AnyModel, ModelName, Proposed};

    use super::*;
    use crate::{FrictionDrift, Sensors};

    #[test]
    fn the_same_seed_gives_the_same_run_to_the_last_bit() {
        let run = |seed| {
            let options = SimulationOptions { seed, ..SimulationOptions::default() };
            let mut rig = options.build(AnyModel::test_bed(ModelName::Proposed)).unwrap();
            (0..500)
                .map(|k| {
                    let seen = rig.measure();
                    rig.apply(2.0 * (0.01 * f64::from(k)).sin()).unwrap();
                    seen
                })
                .collect::<Vec<_>>()
        };
        assert_eq!(run(3), run(3));
        assert_ne!(run(3), run(4));
    }

    #[test]
    fn the_voltage_stays_within_its_limit_and_says_so() {
        let mut rig =
            SimulatedRig::new(SimulationOptions::default(), Proposed::test_bed()).unwrap();
        rig.apply(20.0).unwrap();
        let seen = rig.measure();
        assert_eq!(seen.voltage_asked, 20.0);
        assert!(seen.saturated && (seen.voltage_applied - 6.0).abs() <= 0.5 * 20.0 / 4096.0);
    }

    /// At a steady speed the motor's torque A K_m i is the friction.
    #[test]
    fn the_current_drives_the_friction_at_a_steady_speed() {
        let options = SimulationOptions { sensors: Sensors::ideal(), ..Default::default() };
        let mut rig = SimulatedRig::new(options, Proposed::test_bed()).unwrap();
        for _ in 0..2000 {
            rig.apply(2.0).unwrap();
        }
        let seen = rig.measure();
        let driving = options.drive.back_emf() * seen.motor_current.unwrap();
        assert!(
            seen.torque > 0.1 && (driving - seen.torque).abs() < 1e-9,
            "{driving}, not {}",
            seen.torque
        );
    }

    #[test]
    fn a_voltage_that_is_not_a_number_stops_the_motor_for_good() {
        let mut rig =
            SimulatedRig::new(SimulationOptions::default(), Proposed::test_bed()).unwrap();
        assert!(matches!(rig.apply(f64::NAN), Err(RigError::VoltageNotFinite(_))));
        rig.apply(5.0).unwrap();
        let seen = rig.measure();
        assert!(seen.fault);
        assert_eq!(seen.voltage_applied, 0.0);
    }

    #[test]
    fn options_out_of_range_are_refused_by_name() {
        for (options, name) in [
            (SimulationOptions { voltage_limit: 11.0, ..Default::default() }, "voltage_limit"),
            (SimulationOptions { period: 0.0, ..Default::default() }, "period"),
            (SimulationOptions { substeps: 0, ..Default::default() }, "substeps"),
            (
                SimulationOptions {
                    friction_drift: Some(FrictionDrift {
                        change: -1.0,
                        start: 0.0,
                        duration: 60.0,
                    }),
                    ..Default::default()
                },
                "friction_drift.change",
            ),
        ] {
            let message = SimulatedRig::new(options, Proposed::test_bed()).unwrap_err().to_string();
            assert!(message.starts_with(name), "{message}");
        }
    }
}
