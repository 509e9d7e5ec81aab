//! What transitions do with the axis.

use std::sync::atomic::Ordering;

use super::{
    super::{control::Asked, parameters::RigSettings},
    Axis, UnconfiguredRig, locked,
};
use crate::{Rig, safety::Request, station::Hands};

/// What a transition does with the axis.
pub(super) struct AxisHands<'a> {
    pub(super) axis: &'a Axis,
    pub(super) settings: Option<&'a RigSettings>,
    pub(super) opened: Option<UnconfiguredRig>,
}

impl AxisHands<'_> {
    fn settings(&self) -> Result<&RigSettings, String> {
        self.settings.ok_or_else(|| "the parameters were not read".to_owned())
    }
}

impl Hands for AxisHands<'_> {
    fn open(&mut self) -> Result<(), String> {
        if self.axis.answered_within && locked(&self.axis.in_cycle).is_none() {
            return Err(
                "observer and controller are lost with the thread that had them; start the program again"
                    .to_owned(),
            );
        }
        let given = locked(&self.axis.opened).take();
        let mut rig = match given {
            Some(rig) => rig,
            None => self.settings()?.open().map_err(|error| error.to_string())?,
        };
        if self.axis.clears_back_end.load(Ordering::Relaxed) {
            // People cleared the stop; a device that holds one of its own, as a button, says so
            // here.
            Rig::clear(&mut rig).map_err(|error| error.to_string())?;
            self.axis.clears_back_end.store(false, Ordering::Relaxed);
        }
        self.opened = Some(rig);
        Ok(())
    }

    fn start(&mut self) -> Result<(), String> {
        let rig = self.opened.take().ok_or_else(|| "no rig was opened".to_owned())?;
        self.axis.start(self.settings()?, rig)
    }

    fn send(&mut self, number: u64, request: Request) -> Result<(), String> {
        match &*locked(&self.axis.running) {
            Some((rig, _)) => rig.send(number, Asked::Safety(request)),
            None => return Err("there is no rig; configure the node first".to_owned()),
        }
        Ok(())
    }

    fn answer(&mut self, number: u64) -> Option<Result<(), String>> {
        match &*locked(&self.axis.running) {
            Some((rig, _)) => rig.answer(number).map(|answer| answer.map(drop)),
            None => Some(Err("the rig is closed".to_owned())),
        }
    }

    fn end(&mut self) {
        // Dropped, it leaves zero volts.
        self.opened = None;
        self.axis.close();
    }

    fn has_ended(&mut self) -> bool {
        // Closing waited for the thread.
        true
    }
}
