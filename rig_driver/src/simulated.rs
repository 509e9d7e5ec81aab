//! The simulated test bed: drive, friction, sensors and voltage output, lock-step and reproducible
//! from a seed.

use friction_model::{AnyModel, FrictionModel, ModelVisitor, Motor};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

use crate::safety::{SafetyLimits, Supervised};
use crate::sensors::quantise;
use crate::{
    FrictionCoupling, FrictionDrift, HIGHEST_VOLTAGE, Measurement, Plant, Rig, RigError, Sensors,
    Truth, VOLTAGE_RANGE,
};

/// Everything a simulated rig is made of, but for its friction model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimulationOptions {
    /// The geared motor.
    pub drive: Motor,
    /// How friction enters the drive.
    pub friction_coupling: FrictionCoupling,
    /// Sensors and converters.
    pub sensors: Sensors,
    /// Largest magnitude of the motor voltage [V], above zero and at most `voltage_range`.
    pub voltage_limit: f64,
    /// Largest magnitude that the rig's amplifier can put out [V], above zero and at most
    /// [`HIGHEST_VOLTAGE`].
    #[serde(default = "usual_range")]
    pub voltage_range: f64,
    /// Period of the control cycle [s], above zero and at most 10 ms.
    pub period: f64,
    /// Integration steps a period.
    pub substeps: u32,
    /// Seed of the sensors' noise.
    pub seed: u64,
    /// How the friction drifts; not at all if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_drift: Option<FrictionDrift>,
    /// Limits of the driver's safety layer around the rig; none to go without, as offline runs do,
    /// where nobody can be hurt.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub safety: Option<SafetyLimits>,
}

/// The range of a rig whose description leaves it out.
const fn usual_range() -> f64 {
    VOLTAGE_RANGE
}

impl Default for SimulationOptions {
    /// The SRV-02 with the thesis's time constant at 1 kHz, two integration steps a period, +-6 V
    /// (the motor's nominal voltage).
    fn default() -> Self {
        Self {
            drive: Motor::SRV02,
            friction_coupling: FrictionCoupling::Physical,
            sensors: Sensors::default(),
            voltage_limit: 6.0,
            voltage_range: VOLTAGE_RANGE,
            period: 1e-3,
            substeps: 2,
            seed: 1,
            friction_drift: None,
            safety: None,
        }
    }
}

impl SimulationOptions {
    /// Checks every field.
    ///
    /// # Errors
    /// [`RigError`] names the field.
    pub fn check(&self) -> Result<(), RigError> {
        self.drive.check()?;
        self.sensors.check()?;
        self.friction_drift.map_or(Ok(()), |drift| drift.check())?;
        let error = |name, value, expected| Err(RigError::OutOfRange { name, value, expected });
        if !(self.voltage_range > 0.0 && self.voltage_range <= HIGHEST_VOLTAGE) {
            return error("voltage_range", self.voltage_range, "above 0 and at most 60 V");
        }
        if !(self.voltage_limit > 0.0 && self.voltage_limit.is_finite()) {
            return error("voltage_limit", self.voltage_limit, "a finite number above 0");
        }
        if self.voltage_limit > self.voltage_range {
            return Err(RigError::BeyondRange {
                limit: self.voltage_limit,
                range: self.voltage_range,
            });
        }
        if !(self.period > 0.0 && self.period <= 0.01) {
            return error("period", self.period, "above 0 and at most 0.01 s");
        }
        if self.substeps == 0 || self.substeps > 10_000 {
            return error("substeps", f64::from(self.substeps), "from 1 to 10000");
        }
        Ok(())
    }
}

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

impl SimulationOptions {
    /// The same rig under the safety layer, with the limits that follow from these options.
    #[must_use]
    pub fn supervised(self) -> Self {
        Self { safety: Some(SafetyLimits::for_simulation(&self)), ..self }
    }

    /// The simulated rig under a friction model chosen while the program runs; active, if it is
    /// under the safety layer.
    ///
    /// # Errors
    /// [`RigError`] names the option that is out of range.
    pub fn build(self, model: AnyModel) -> Result<Box<dyn Rig + Send>, RigError> {
        model.visit(Build(self))
    }
}

/// Builds the rig around a model whose type is known.
struct Build(SimulationOptions);

impl ModelVisitor for Build {
    type Output = Result<Box<dyn Rig + Send>, RigError>;

    fn visit<M>(self, model: M) -> Self::Output
    where
        M: FrictionModel<Continuous: Send + Sync, Memory: Send + Sync, Discrete: Send + Sync>
            + Send
            + Sync
            + 'static,
    {
        let rig = SimulatedRig::new(self.0, model)?;
        Ok(match self.0.safety {
            None => Box::new(rig),
            Some(limits) => Box::new(Supervised::activated(rig, limits)?),
        })
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{ModelName, Proposed};

    use super::*;

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
