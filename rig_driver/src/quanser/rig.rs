//! A card as a rig.

use std::ffi::CString;

use super::hil::{Card, Exchange};
use super::library::load;
use super::{AnalogInput, QuanserError, QuanserOptions, UnwrappedCounter};
use crate::{Measurement, Rig, RigError};

/// A servo on a Quanser card. It has not been run on a real one.
///
/// One exchange with the card a cycle, at its beginning: all inputs are read, and the voltage of
/// the cycle before goes out. That is one whole period of delay, always the same, and half the
/// traffic on the USB. Zero volts never wait: they are written at once.
///
/// Three things put the motor at zero volts when this program cannot: the card's watchdog, reloaded
/// every cycle, when cycles cease; the termination states, when the program ends; and dropping this
/// value, after a panic too.
#[derive(Debug)]
pub struct QuanserRig {
    card: Card,
    options: QuanserOptions,
    exchange: Exchange,
    counter: UnwrappedCounter,
    /// Time of the first cycle on the caller's clock, and of the present one \[s\].
    first: Option<f64>,
    told: Option<f64>,
    last: Measurement,
    cycle: u64,
    watched: bool,
    /// Voltage that the next exchange puts out \[V\], and whether it was cut.
    pending: f64,
    /// Voltage that is at the motor \[V\].
    output: f64,
    asked: f64,
    saturated: bool,
    failed: Option<RigError>,
}

impl QuanserRig {
    /// Opens the card with the motor at zero volts.
    ///
    /// # Errors
    /// [`RigError::OutOfRange`] names a parameter; [`RigError::Quanser`] says what is missing or
    /// which call the card refused.
    pub fn open(options: QuanserOptions) -> Result<Self, RigError> {
        options.check()?;
        let text =
            |name, text: &str| CString::new(text).map_err(|_| QuanserError::ZeroByte { name });
        let (card_type, card) =
            (text("card_type", &options.card_type)?, text("card", &options.card)?);
        let inputs: Vec<AnalogInput> = [options.tachometer, options.potentiometer, options.torque]
            .into_iter()
            .flatten()
            .collect();
        let exchange = Exchange::new(
            inputs.iter().map(|input| input.channel).collect(),
            options.encoder_channel,
            options.output_channel,
        );
        let card = load(options.library.as_deref())?.open(&card_type, &card)?;
        // From here on dropping it leaves zero volts.
        let mut rig = Self {
            card,
            counter: UnwrappedCounter::new(options.encoder_bits),
            exchange,
            options,
            first: None,
            told: None,
            last: Measurement::default(),
            cycle: 0,
            watched: false,
            pending: 0.0,
            output: 0.0,
            asked: 0.0,
            saturated: false,
            failed: None,
        };
        let ranges: Vec<(u32, f64)> =
            inputs.iter().map(|input| (input.channel, input.range)).collect();
        let Self { card, options, .. } = &mut rig;
        card.set_output_range(options.output_channel, 10.0)?;
        card.write(options.output_channel, 0.0)?;
        card.set_safe_states(options.output_channel)?;
        card.clear_watchdog()?;
        card.set_input_ranges(&ranges)?;
        card.set_encoder(options.encoder_channel)?;
        Ok(rig)
    }

    /// Reads the card, puts the pending voltage out and tells the watchdog that the program lives.
    fn exchange(&mut self) -> Result<(), RigError> {
        let Self { card, options, .. } = self;
        if !self.watched {
            // Only now: between opening and the first cycle any time may pass.
            card.start_watchdog(options.watchdog_timeout)?;
            self.watched = true;
        }
        card.read_write(&mut self.exchange, options.card_volts(self.pending))?;
        if card.reload_watchdog()? {
            Ok(())
        } else {
            Err(QuanserError::WatchdogExpired { timeout: options.watchdog_timeout.to_string() }
                .into())
        }
    }

    /// The readings in units.
    fn readings(&mut self) -> Measurement {
        let options = &self.options;
        let mut volts = self.exchange.volts().iter();
        let mut value = |input: &Option<AnalogInput>| {
            input.as_ref().and_then(|input| volts.next().map(|&volts| input.value(volts)))
        };
        let (tachometer, potentiometer, torque) =
            (value(&options.tachometer), value(&options.potentiometer), value(&options.torque));
        let encoder_counts = self.counter.read(self.exchange.count());
        let encoder_position = options.position(encoder_counts);
        let time = match (self.told, self.first) {
            (Some(now), Some(first)) => now - first,
            _ => self.cycle as f64 * options.period,
        };
        let elapsed = time - self.last.time;
        let by_difference = if elapsed > 0.0 && self.cycle > 0 {
            (encoder_position - self.last.encoder_position) / elapsed
        } else {
            0.0
        };
        Measurement {
            cycle: self.cycle,
            time,
            encoder_counts,
            encoder_position,
            tachometer_velocity: tachometer.unwrap_or(by_difference),
            potentiometer_position: potentiometer.unwrap_or(encoder_position),
            torque: torque.unwrap_or(0.0),
            motor_current: None,
            voltage_asked: 0.0,
            voltage_applied: 0.0,
            saturated: false,
            watchdog_expired: false,
            fault: false,
        }
    }

    /// Keeps the failure, the first one, and tries to leave zero volts.
    fn fail(&mut self, error: RigError) {
        (self.pending, self.output) = (0.0, 0.0);
        // What failed is told; that this fails too would tell nothing new, and the watchdog is not
        // reloaded any more.
        let _ = self.card.write(self.options.output_channel, 0.0);
        self.failed.get_or_insert(error);
    }
}

impl Rig for QuanserRig {
    fn period(&self) -> f64 {
        self.options.period
    }

    fn voltage_range(&self) -> f64 {
        self.options.voltage_range()
    }

    fn tell_time(&mut self, now: f64) {
        self.first.get_or_insert(now);
        self.told = Some(now);
    }

    fn measure(&mut self) -> Measurement {
        // The exchange puts `pending` out; until then the voltage of the exchange before was at the
        // motor.
        let applied_before = self.output;
        self.output = self.pending;
        if self.failed.is_none() {
            match self.exchange() {
                Ok(()) => self.last = self.readings(),
                Err(error) => self.fail(error),
            }
        }
        let expired =
            matches!(&self.failed, Some(RigError::Quanser(QuanserError::WatchdogExpired { .. })));
        self.last.cycle = self.cycle;
        self.last.voltage_asked = self.asked;
        self.last.voltage_applied = applied_before;
        self.last.saturated = self.saturated;
        self.last.watchdog_expired = expired;
        self.last.fault = self.failed.is_some();
        self.cycle += 1;
        self.last
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        if !volts.is_finite() {
            self.asked = 0.0;
            self.fail(RigError::VoltageNotFinite(volts));
            return Err(RigError::VoltageNotFinite(volts));
        }
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        self.asked = volts;
        self.pending = volts.clamp(-self.options.voltage_limit, self.options.voltage_limit);
        self.saturated = self.pending != volts;
        if volts == 0.0 { self.halt() } else { Ok(()) }
    }

    fn halt(&mut self) -> Result<(), RigError> {
        (self.asked, self.pending) = (0.0, 0.0);
        self.output = 0.0;
        self.card.write(self.options.output_channel, 0.0).map_err(|error| {
            self.failed.get_or_insert(error.clone().into());
            error.into()
        })
    }

    fn clear(&mut self) -> Result<(), RigError> {
        self.card.write(self.options.output_channel, 0.0)?;
        self.card.clear_watchdog()?;
        self.watched = false;
        self.failed = None;
        Ok(())
    }
}

impl Drop for QuanserRig {
    fn drop(&mut self) {
        // Nobody is left to be told. The watchdog is stopped only if zero volts were written: else
        // it shall expire. Closing the card, which comes next, writes the termination states once
        // more.
        let zero = self.card.write(self.options.output_channel, 0.0);
        let terminated = self.card.write_termination_states();
        if zero.is_ok() && terminated.is_ok() {
            let _ = self.card.stop_watchdog();
        }
    }
}
