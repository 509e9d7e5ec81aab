//! How a card is wired and what its volts mean.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::{HIGHEST_VOLTAGE, RigError, VOLTAGE_RANGE};

/// An analogue input and its scale: `value = scale (volts - offset)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnalogInput {
    /// Number of the channel.
    pub channel: u32,
    /// Value a volt, in the quantity's unit; not zero.
    pub scale: f64,
    /// Volts at which the value is zero \[V\].
    pub offset: f64,
    /// Range of the channel, +- this many volts \[V\], above zero and at most 10.
    pub range: f64,
}

impl AnalogInput {
    /// The value at `volts`.
    #[must_use]
    pub fn value(&self, volts: f64) -> f64 {
        self.scale * (volts - self.offset)
    }
}

/// Everything the back end has to know of card, wiring, amplifier and sensors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuanserOptions {
    /// File of the HIL library; none for the usual places.
    pub library: Option<PathBuf>,
    /// Kind of card, as the vendor names it.
    pub card_type: String,
    /// Which one: `0` for the first, `0@tcpip://HOST:PORT` through the vendor's proxy.
    pub card: String,
    /// Channel of the encoder.
    pub encoder_channel: u32,
    /// Counts a turn of the load in four-fold quadrature; below zero if it counts backwards, not
    /// zero.
    pub encoder_counts_per_turn: f64,
    /// Bits of the card's counter, from 8 to 32.
    pub encoder_bits: u32,
    /// Tachometer [rad/s a volt, load side]; none to take the difference of encoder positions.
    pub tachometer: Option<AnalogInput>,
    /// Potentiometer [rad a volt]; none if there is none.
    pub potentiometer: Option<AnalogInput>,
    /// Torque sensor [N m a volt]; none if there is none.
    pub torque: Option<AnalogInput>,
    /// Channel of the output to the amplifier.
    pub output_channel: u32,
    /// Motor volts a volt of the card, not zero: gain of the amplifier, below zero if it or the
    /// motor's wiring turns the sign.
    pub amplifier_gain: f64,
    /// Largest magnitude of the motor voltage \[V\], above zero, and at the card at most 10.
    pub voltage_limit: f64,
    /// Period of the control cycle \[s\], above zero and at most 10 ms.
    pub period: f64,
    /// Time after which the card's watchdog puts the motor at zero volts \[s\], from two periods to
    /// 8 s.
    pub watchdog_timeout: f64,
}

impl Default for QuanserOptions {
    /// A Q2-USB with an SRV-02 in high gear: encoder 0, tachometer on input 0, torque sensor on
    /// input 1, amplifier of gain 1 on output 0, 1 kHz, watchdog of 20 ms. Which input carries what
    /// depends on the wiring: see `frictionlab rig check`.
    fn default() -> Self {
        Self {
            library: None,
            card_type: "q2_usb".to_owned(),
            card: "0".to_owned(),
            encoder_channel: 0,
            encoder_counts_per_turn: 4096.0,
            encoder_bits: 16,
            tachometer: Some(AnalogInput { channel: 0, scale: -0.9973, offset: 0.0, range: 10.0 }),
            potentiometer: None,
            torque: Some(AnalogInput { channel: 1, scale: 2.3, offset: 0.0, range: 10.0 }),
            output_channel: 0,
            amplifier_gain: 1.0,
            voltage_limit: 6.0,
            period: 1e-3,
            watchdog_timeout: 0.02,
        }
    }
}

impl QuanserOptions {
    /// Largest magnitude of the motor voltage that card and amplifier put out \[V\].
    #[must_use]
    pub const fn voltage_range(&self) -> f64 {
        let range = VOLTAGE_RANGE * self.amplifier_gain.abs();
        if range < HIGHEST_VOLTAGE { range } else { HIGHEST_VOLTAGE }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`RigError::OutOfRange`] names the field.
    pub fn check(&self) -> Result<(), RigError> {
        let error = |name, value, expected: &'static str| {
            Err(RigError::OutOfRange { name, value, expected: expected.into() })
        };
        let scale = |value: f64| value != 0.0 && value.is_finite();
        for (names, input) in [
            (["tachometer.scale", "tachometer.offset", "tachometer.range"], &self.tachometer),
            (
                ["potentiometer.scale", "potentiometer.offset", "potentiometer.range"],
                &self.potentiometer,
            ),
            (["torque.scale", "torque.offset", "torque.range"], &self.torque),
        ] {
            let Some(input) = input else { continue };
            if !scale(input.scale) {
                return error(names[0], input.scale, "a finite number other than zero");
            }
            if !input.offset.is_finite() {
                return error(names[1], input.offset, "a finite number");
            }
            if !(input.range > 0.0 && input.range <= 10.0) {
                return error(names[2], input.range, "above 0 and at most 10 V");
            }
        }
        if !scale(self.encoder_counts_per_turn) {
            return error(
                "encoder_counts_per_turn",
                self.encoder_counts_per_turn,
                "a finite number other than zero",
            );
        }
        if !(8..=32).contains(&self.encoder_bits) {
            return error("encoder_bits", f64::from(self.encoder_bits), "from 8 to 32");
        }
        if !scale(self.amplifier_gain) {
            return error("amplifier_gain", self.amplifier_gain, "a finite number other than zero");
        }
        if !(self.voltage_limit > 0.0 && self.voltage_limit <= self.voltage_range()) {
            return error(
                "voltage_limit",
                self.voltage_limit,
                "above 0 and, divided by amplifier_gain, at most 10 V, the card's range, and at most 60 V",
            );
        }
        if !(self.period > 0.0 && self.period <= 0.01) {
            return error("period", self.period, "above 0 and at most 0.01 s");
        }
        if !(self.watchdog_timeout >= 2.0 * self.period && self.watchdog_timeout <= 8.0) {
            return error("watchdog_timeout", self.watchdog_timeout, "from two periods to 8 s");
        }
        Ok(())
    }

    /// Voltage at the card for `volts` at the motor, both \[V\].
    #[must_use]
    pub fn card_volts(&self, volts: f64) -> f64 {
        volts / self.amplifier_gain
    }

    /// Position at an encoder count \[rad\].
    #[must_use]
    pub fn position(&self, counts: i64) -> f64 {
        counts as f64 * (std::f64::consts::TAU / self.encoder_counts_per_turn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_those_of_the_srv02() {
        let options = QuanserOptions { amplifier_gain: 3.0, ..Default::default() };
        options.check().unwrap();
        assert!((options.position(-4096) + std::f64::consts::TAU).abs() < 1e-15);
        assert!((options.tachometer.unwrap().value(2.0) + 1.9946).abs() < 1e-12);
        assert!((options.torque.unwrap().value(10.0) - 23.0).abs() < 1e-12);
        assert_eq!(options.card_volts(6.0), 2.0);
    }

    #[test]
    fn parameters_out_of_range_are_refused_by_name() {
        let good = QuanserOptions::default();
        let input = |scale, range| Some(AnalogInput { channel: 0, scale, offset: 0.0, range });
        for (wrong, name) in [
            (QuanserOptions { tachometer: input(0.0, 10.0), ..good.clone() }, "tachometer.scale"),
            (QuanserOptions { torque: input(1.0, 11.0), ..good.clone() }, "torque.range"),
            (
                QuanserOptions { encoder_counts_per_turn: 0.0, ..good.clone() },
                "encoder_counts_per_turn",
            ),
            (QuanserOptions { encoder_bits: 33, ..good.clone() }, "encoder_bits"),
            (QuanserOptions { amplifier_gain: f64::NAN, ..good.clone() }, "amplifier_gain"),
            (QuanserOptions { voltage_limit: 12.0, ..good.clone() }, "voltage_limit"),
            (QuanserOptions { period: 0.02, ..good.clone() }, "period"),
            (QuanserOptions { watchdog_timeout: 1e-3, ..good.clone() }, "watchdog_timeout"),
        ] {
            let text = wrong.check().unwrap_err().to_string();
            assert!(text.starts_with(name), "{text}");
        }
    }
}
