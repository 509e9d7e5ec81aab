//! The control thread's part: requests, the stop and the permission, in every cycle before a
//! voltage is put out.

use super::Station;
use crate::{
    Rig, RigError,
    safety::{Fault, Request, State, Supervised},
};

/// What was found before the voltage of a cycle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Checked {
    /// The press that counts as seen once zero volts are out.
    press: Option<u64>,
    /// What the back end said to the emergency stop.
    pub(crate) refused: Option<RigError>,
}

impl Station {
    /// Does a request that has begun. It is no error that a motor which is to rest does so already;
    /// and nothing is activated under a stop.
    pub(crate) fn carry_out<R: Rig>(
        &self,
        rig: &mut Supervised<R>,
        request: Request,
    ) -> Result<State, RigError> {
        let state = rig.supervisor().state();
        match request {
            Request::Deactivate if !state.moves() => Ok(state),
            Request::Activate if self.latch.is_set() => {
                Err(RigError::NotActive(State::EmergencyStopped))
            }
            _ => rig.request(request),
        }
    }

    /// Looks at stop and permission. To be called right before the voltage of a cycle is put out,
    /// whatever came of everything before. `heard` is the newest press that the back end has
    /// acknowledged; the control thread keeps it.
    pub(crate) fn check<R: Rig>(&self, rig: &mut Supervised<R>, heard: &mut u64) -> Checked {
        let permitted = self.permission.is_given();
        let set = self.latch.is_set();
        let newest = self.latch.newest();
        let mut checked = Checked { press: None, refused: None };
        if set {
            let stopped = rig.supervisor().state() == State::EmergencyStopped;
            if !stopped || *heard < newest {
                match rig.request(Request::EmergencyStop) {
                    // Finalized is as good.
                    Ok(_) | Err(RigError::Refused(_)) => *heard = newest,
                    // Asked again in the next cycle.
                    Err(error) => checked.refused = Some(error),
                }
            }
            checked.press = (*heard >= newest).then_some(newest);
        } else if rig.supervisor().state().moves() && !permitted {
            // A node that leaves asks for rest right after; that a cycle came first is no fault.
            let rests = self.permission.has_left() && rig.request(Request::Deactivate).is_ok();
            if !rests {
                rig.fault(Fault::PermissionWithdrawn, 0.0, 0.0);
            }
        }
        checked
    }

    /// Notes what became of the voltage.
    pub(crate) fn note(&self, checked: &Checked, driven: bool) {
        if let Some(press) = checked.press
            && driven
        {
            self.latch.note_seen(press);
        }
    }
}
