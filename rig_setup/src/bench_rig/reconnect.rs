//! The rig opened anew after its line failed.

use std::sync::atomic::Ordering;
use std::time::SystemTime;

use rig_driver::Rig;

use super::home::Home;
use super::paced::Paced;
use super::{Again, BenchRig, locked};
use crate::NotReopened;
use crate::come_back::{come_back, counted_on, silence};

impl BenchRig {
    /// Opens the rig anew after its line failed, up to [`PATIENCE`](crate::PATIENCE) after it was heard last:
    /// inactive, at zero volts, its motor as warm as it was. Nothing of the old session stays; a
    /// fault that is latched in the device is not cleared. The time that it took \[s\].
    ///
    /// # Errors
    /// [`NotReopened`] says why: it did not come back, another device came back, the travel is limited
    /// and the encoder did not count on, or there is no way to open it.
    pub fn reconnect(&self) -> Result<f64, NotReopened> {
        let not = |why: String| Err(NotReopened(why));
        let Some(Again(reopen)) = &self.reopen else {
            return not("this rig is not opened again".to_owned());
        };
        // A keeper that failed has ended; one that waits for the rig ends as it finds none.
        self.home.over.store(true, Ordering::Relaxed);
        if let Some(keeper) = locked(&self.keeper).take() {
            let _ = keeper.join();
        }
        let old = locked(&self.home.rig).take();
        let rise = old.as_ref().and_then(|old| old.rig.supervisor().rise());
        let heard = old.as_ref().map_or(SystemTime::UNIX_EPOCH, |old| old.heard);
        // Zero volts, and the end of the session.
        drop(old);
        let opened = come_back(reopen, heard, &self.home.stop)?;
        if let Some(before) = &self.description {
            let difference = opened.description.as_ref().and_then(|now| before.differs_from(now));
            if let Some(what) = difference {
                return not(format!("another device came back: {what}"));
            }
        }
        if opened.rig.period() != self.period {
            return not("another device came back: its cycle is another".to_owned());
        }
        if self.limits.travel.is_some() {
            counted_on(&opened, heard)?;
        }
        let pace = opened.pace;
        let paced = Paced::configured(opened.rig, self.limits, pace, rise)
            .map_err(|error| NotReopened(error.to_string()))?;
        *locked(&self.home.rig) = Some(paced);
        locked(&self.home.failed).take();
        // Its count may have begun anew.
        self.home.begins_at(f64::NAN);
        self.home.over.store(false, Ordering::Relaxed);
        *locked(&self.keeper) = Home::kept(&self.home, pace);
        Ok(silence(heard))
    }
}
