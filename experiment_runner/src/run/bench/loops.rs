//! Loops around the axis: one for each run.

use std::sync::Arc;

use controller::ControlMode;
use friction_model::{AnyModel, ModelName};

use super::{Axis, Bench};
use crate::compensation::Means;
use crate::control_loop::{ControlLoop, RunningLoop};
#[cfg(feature = "ros")]
use crate::nodes::{NodesBench, Task, Wanted};
use crate::paced::Paced;
use crate::profile::Excitation;
use crate::run::{Pace, RunError};
use crate::test_bed::TestBed;
use crate::waveform::Waveform;

impl Bench<'_> {
    /// A loop around the rig that is at rest, following `task`. `planned` is seed and start of a
    /// simulated one.
    ///
    /// # Errors
    /// [`RunError`] names the parameter that is out of range, or says why the real rig may not
    /// move.
    pub fn control_loop(
        &self,
        bed: &TestBed,
        (mode, reference): (ControlMode, Waveform),
        observer: &AnyModel,
        means: Option<Means>,
        (seed, start_ns): (u64, u64),
    ) -> Result<Box<dyn RunningLoop>, RunError> {
        #[cfg(feature = "ros")]
        if let Axis::Nodes(nodes) = &self.axis {
            return lend(nodes, bed, (mode, means), observer, Task::Follow(reference));
        }
        Ok(Box::new(self.loop_here(bed, (mode, reference), observer, means, (seed, start_ns))?))
    }

    /// A loop that is closed here.
    fn loop_here(
        &self,
        bed: &TestBed,
        (mode, reference): (ControlMode, Waveform),
        observer: &AnyModel,
        means: Option<Means>,
        (seed, start_ns): (u64, u64),
    ) -> Result<ControlLoop, RunError> {
        Ok(match &self.axis {
            Axis::Real(rig) => {
                let rig = rig.lend()?;
                bed.loop_around(rig, mode, reference, observer, means, self.now_or(start_ns))?
            }
            _ => self.paced(bed.control_loop(mode, reference, observer, means, seed, start_ns)?),
        })
    }

    /// A simulated loop at the pace that was asked for.
    fn paced(&self, control: ControlLoop) -> ControlLoop {
        match self.options.pace {
            Pace::Offline => control,
            Pace::RealTime => {
                control.through(|rig| Box::new(Paced::new(rig, Arc::clone(self.cancel))))
            }
        }
    }

    /// The same, driven by `excitation`; nothing compensates. With `feed_forward` the reference
    /// also goes through the inverse of the drive.
    ///
    /// # Errors
    /// As for [`control_loop`](Self::control_loop).
    pub fn excited_loop(
        &self,
        excitation: Excitation,
        feed_forward: bool,
        planned: (u64, u64),
    ) -> Result<Box<dyn RunningLoop>, RunError> {
        // Nothing compensates here: the observer only keeps the recorder's topics alike.
        let observer = self.options.compensators.get(ModelName::Proposed);
        let bed = self.options.test_bed.fed_forward(feed_forward);
        #[cfg(feature = "ros")]
        if let Axis::Nodes(nodes) = &self.axis {
            return lend(
                nodes,
                &bed,
                (excitation.mode(), None),
                &observer,
                Task::Excite(excitation),
            );
        }
        let unused = Waveform::ConstantVelocity { velocity: 0.0 };
        let control =
            self.loop_here(&bed, (excitation.mode(), unused), &observer, None, planned)?;
        Ok(Box::new(control.excited(excitation)))
    }
}

/// The nodes for one run.
#[cfg(feature = "ros")]
fn lend(
    nodes: &NodesBench,
    bed: &TestBed,
    (mode, means): (ControlMode, Option<Means>),
    model: &AnyModel,
    task: Task,
) -> Result<Box<dyn RunningLoop>, RunError> {
    let (controller, estimator) = bed.settings(mode, means, nodes.period());
    let wanted = Wanted { controller: &controller, estimator: &estimator, model };
    Ok(Box::new(nodes.lend(wanted, task)?))
}
