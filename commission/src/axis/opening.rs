//! How the rig is opened, each time anew and always as the same one.

#[cfg(feature = "ros")]
use std::sync::{Arc, Mutex, PoisonError};

#[cfg(feature = "ros")]
use experiment_runner::nodes::NodesAxis;
use rig_driver::Calibration;
use rig_driver::registry::{Opened, RigDescription, RigSetup};
use rig_setup::{RigChoice, RigSetupError, require_device};

/// What the rig is opened with.
#[derive(Debug, Clone)]
pub(super) struct Opening {
    pub(super) rig: RigChoice,
    pub(super) setup: RigSetup,
    /// Only this device is driven.
    pub(super) expected: Option<RigDescription>,
    /// The encoder has nothing to be held against.
    pub(super) encoder_alone: bool,
    /// The running nodes, once they are found.
    #[cfg(feature = "ros")]
    nodes: Arc<Mutex<Option<NodesAxis>>>,
}

impl Opening {
    /// Of a rig that was not opened yet.
    pub(super) fn new(rig: RigChoice, setup: RigSetup) -> Self {
        Self {
            rig,
            setup,
            expected: None,
            encoder_alone: false,
            #[cfg(feature = "ros")]
            nodes: Arc::default(),
        }
    }

    /// The rig, at zero volts.
    ///
    /// # Errors
    /// What the rig says, or [`RigSetupError::OtherDevice`].
    pub(super) fn open(&self) -> Result<Opened, RigSetupError> {
        let mut opened = match &self.rig {
            RigChoice::Nodes { namespace } => self.open_nodes(namespace.clone())?,
            rig => rig.open(&self.setup)?,
        };
        if self.encoder_alone {
            opened.limits = opened.limits.before_calibration();
            opened.limits.sensors.frozen_cycles = None;
        }
        if let Some(expected) = &self.expected {
            require_device(expected, &self.rig, opened.description.as_ref())?;
        }
        Ok(opened)
    }

    /// Whether it may be opened once more by itself after its line failed.
    pub(super) fn comes_back(&self) -> bool {
        self.rig.comes_back()
    }

    /// What whoever drives the rig for us puts right already.
    #[cfg(feature = "ros")]
    pub(super) fn corrected_by(&self) -> Option<Calibration> {
        let nodes = self.nodes.lock().unwrap_or_else(PoisonError::into_inner);
        nodes.as_ref().map(|nodes| *nodes.calibration())
    }

    /// The same where nobody does.
    #[cfg(not(feature = "ros"))]
    pub(super) const fn corrected_by(&self) -> Option<Calibration> {
        None
    }

    /// The rig of the running nodes, which are found once.
    #[cfg(feature = "ros")]
    fn open_nodes(&self, namespace: Option<String>) -> Result<Opened, RigSetupError> {
        let mut nodes = self.nodes.lock().unwrap_or_else(PoisonError::into_inner);
        let found = match nodes.as_ref() {
            Some(found) => found,
            None => nodes.insert(NodesAxis::find(namespace)?),
        };
        found.open(&self.setup)
    }

    /// There are none.
    #[cfg(not(feature = "ros"))]
    fn open_nodes(&self, _: Option<String>) -> Result<Opened, RigSetupError> {
        Err(RigSetupError::Nodes(
            "this program was built without ROS 2: build it with the feature `ros`".to_owned(),
        ))
    }
}
