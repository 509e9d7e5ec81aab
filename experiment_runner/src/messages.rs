//! A control cycle as the six messages that describe it, for bags.

use msgs::{
    cdr,
    friction_msgs::{ControllerState, FrictionEstimate, MotorVoltage, Reference, RigMeasurement},
    sensor_msgs::JointState,
    topics,
};

use recording::bag::{BagError, BagWriter, TopicHandle};

use crate::cycle::CycleSample;

/// Everything one cycle has to say.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleMessages {
    /// For `/joint_states`: joint `load_shaft`, effort = friction torque.
    pub joint_state: JointState,
    /// For `/rig_measurement`.
    pub rig_measurement: RigMeasurement,
    /// For `/reference`.
    pub reference: Reference,
    /// For `/motor_voltage`.
    pub motor_voltage: MotorVoltage,
    /// For `/friction_estimate`.
    pub friction_estimate: FrictionEstimate,
    /// For `/controller_state`.
    pub controller_state: ControllerState,
}

impl From<&CycleSample> for CycleMessages {
    fn from(sample: &CycleSample) -> Self {
        let stamp = sample.stamp_ns;
        Self {
            joint_state: rig_driver::messages::joint_state(stamp, &sample.measurement),
            rig_measurement: rig_driver::messages::rig_measurement(stamp, &sample.measurement),
            reference: controller::messages::reference(stamp, &sample.reference),
            motor_voltage: controller::messages::motor_voltage(stamp, &sample.command),
            friction_estimate: friction_observer::messages::friction_estimate(
                stamp,
                &sample.estimate,
            ),
            controller_state: controller::messages::controller_state(stamp, &sample.command),
        }
    }
}

/// The six topics of a bag that [`CycleMessages`] go to.
#[derive(Debug, Clone, Copy)]
pub struct CycleTopics {
    handles: [TopicHandle; 6],
}

impl CycleTopics {
    /// Opens the topics.
    ///
    /// # Errors
    /// [`BagError`] if the disk refuses, or a topic carries another type already.
    pub fn open(bag: &mut BagWriter) -> Result<Self, BagError> {
        Ok(Self {
            handles: [
                bag.topic::<JointState>(topics::JOINT_STATES.name)?,
                bag.topic::<RigMeasurement>(topics::RIG_MEASUREMENT.name)?,
                bag.topic::<Reference>(topics::REFERENCE.name)?,
                bag.topic::<MotorVoltage>(topics::MOTOR_VOLTAGE.name)?,
                bag.topic::<FrictionEstimate>(topics::FRICTION_ESTIMATE.name)?,
                bag.topic::<ControllerState>(topics::CONTROLLER_STATE.name)?,
            ],
        })
    }

    /// Writes one cycle, which was encoded before, perhaps on another thread. Sequence numbers are
    /// the cycle's number.
    ///
    /// # Errors
    /// [`BagError`] if the disk refuses.
    pub fn write(&self, bag: &mut BagWriter, cycle: &EncodedCycle) -> Result<(), BagError> {
        // A message has its four bytes of encoding at least: what is empty was not said.
        for (handle, part) in
            self.handles.into_iter().zip(cycle.parts()).filter(|(_, part)| !part.is_empty())
        {
            bag.write_cdr(handle, cycle.stamp_ns, cycle.sequence, part)?;
        }
        Ok(())
    }
}

/// Who said something in a cycle, where nodes may be inactive. The rig always does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spoken {
    /// There was a reference.
    pub reference: bool,
    /// The observer said an estimate.
    pub estimate: bool,
    /// The controller gave a command.
    pub command: bool,
}

impl Spoken {
    /// All of them.
    pub const ALL: Self = Self { reference: true, estimate: true, command: true };
}

/// One cycle's six messages as bytes, ready for a bag. Can be used again: its memory stays.
#[derive(Debug, Clone, Default)]
pub struct EncodedCycle {
    stamp_ns: u64,
    sequence: u32,
    bytes: Vec<u8>,
    ends: [usize; 6],
    scratch: Vec<u8>,
}

impl EncodedCycle {
    /// Encodes a cycle, in place of what was there.
    ///
    /// # Errors
    /// [`BagError::Encode`]; it cannot happen with the laboratory's own messages, whose strings are
    /// short.
    pub fn encode(&mut self, sample: &CycleSample) -> Result<(), BagError> {
        self.encode_spoken(sample, sample.measurement.torque, Spoken::ALL)
    }

    /// Encodes what was said in a cycle, in place of what was there; `effort` is the friction
    /// torque of `/joint_states` [N m].
    ///
    /// # Errors
    /// As for [`encode`](Self::encode).
    pub fn encode_spoken(
        &mut self,
        sample: &CycleSample,
        effort: f64,
        spoken: Spoken,
    ) -> Result<(), BagError> {
        let mut messages = CycleMessages::from(sample);
        messages.joint_state.effort = vec![effort];
        self.stamp_ns = sample.stamp_ns;
        // Sequence numbers of MCAP have 32 bits; they wrap after seven weeks at 1 kHz.
        self.sequence = sample.measurement.cycle as u32;
        self.bytes.clear();
        let mut part = 0;
        macro_rules! append {
            ($message:expr, $spoken:expr) => {
                if $spoken {
                    cdr::encode_into($message, &mut self.scratch)?;
                    self.bytes.extend_from_slice(&self.scratch);
                }
                self.ends[part] = self.bytes.len();
                part += 1;
            };
        }
        append!(&messages.joint_state, true);
        append!(&messages.rig_measurement, true);
        append!(&messages.reference, spoken.reference);
        append!(&messages.motor_voltage, spoken.command);
        append!(&messages.friction_estimate, spoken.estimate);
        append!(&messages.controller_state, spoken.command);
        debug_assert_eq!(part, self.ends.len());
        Ok(())
    }

    /// Bytes of each message, in the order of [`CycleMessages`].
    fn parts(&self) -> impl Iterator<Item = &[u8]> {
        let starts = std::iter::once(0).chain(self.ends);
        starts.zip(self.ends).map(|(start, end)| &self.bytes[start..end])
    }
}
