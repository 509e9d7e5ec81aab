//! Steps that a session drives by itself, under a voltage limit of their own.

use std::cell::Cell;
use std::sync::Arc;
use std::time::SystemTime;

use rig_driver::safety::MotorThermal;
use rig_setup::{Opened, RigSetupError, Session};

use super::Axis;
use super::repeats::Repeats;
use super::shown::Shown;
use crate::{CommissionError, Stage};

impl Axis<'_> {
    /// A session of the steps by which signs are found, at most `volts`. Where the line fails they
    /// begin anew.
    ///
    /// # Errors
    /// What the steps or the rig say.
    pub fn session<T>(
        &mut self,
        volts: f64,
        work: impl Fn(&mut Session<'_>, &dyn Fn(&str)) -> Result<T, RigSetupError>,
    ) -> Result<T, CommissionError> {
        let mut repeats = Repeats::none();
        let mut opened = self.open_or_wait(&mut repeats)?;
        loop {
            let heard = Cell::new(SystemTime::now());
            match self.met(opened, volts, &heard, &work) {
                Ok(found) => return Ok(found),
                Err(error) => {
                    opened = self.opened_anew(&mut repeats, error, heard.get())?;
                }
            }
        }
    }

    /// The same once; when the rig was `heard` last is told.
    fn met<T>(
        &mut self,
        mut opened: Opened,
        volts: f64,
        heard: &Cell<SystemTime>,
        work: impl Fn(&mut Session<'_>, &dyn Fn(&str)) -> Result<T, RigSetupError>,
    ) -> Result<T, CommissionError> {
        // A speed whose sign is wrong would count as braking, which heats most: while signs are
        // unknown the winding is counted as at rest.
        opened.limits.motor =
            opened.limits.motor.map(|motor| MotorThermal { back_emf: f64::MIN_POSITIVE, ..motor });
        let stop = Arc::clone(&self.stop);
        opened.rig = Box::new(Shown { rig: opened.rig, watch: self.watch() });
        let mut session = Session::new(opened, volts, &stop)?;
        session.warm(self.rise.get());
        let first = session.step(|_| 0.0)?.time;
        let say = |text: &str| self.say(Stage::Meet, text);
        let outcome = work(&mut session, &say);
        heard.set(session.heard());
        let last = session.step(|_| 0.0).map_or(first, |seen| seen.time);
        self.rise.set(session.winding_rise().unwrap_or_default());
        self.count(last - first);
        Ok(outcome?)
    }
}
