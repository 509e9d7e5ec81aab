//! A control cycle as the six messages that describe it, for bags.

use msgs::{
    cdr,
    friction_msgs::{ControllerState, FrictionEstimate, MotorVoltage, Reference, RigMeasurement},
    sensor_msgs::JointState,
    topics,
};

use crate::{
    bag::{BagError, BagWriter, TopicHandle},
    cycle::CycleSample,
};

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
            friction_estimate: friction_observer::messages::friction_estimate(stamp, &sample.estimate),
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

    /// Writes one cycle, which was encoded before, perhaps on another thread. Sequence numbers are the cycle's number.
    ///
    /// # Errors
    /// [`BagError`] if the disk refuses.
    pub fn write(&self, bag: &mut BagWriter, cycle: &EncodedCycle) -> Result<(), BagError> {
        for (handle, part) in self.handles.into_iter().zip(cycle.parts()) {
            bag.write_cdr(handle, cycle.stamp_ns, cycle.sequence, part)?;
        }
        Ok(())
    }
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
    /// [`BagError::Encode`]; it cannot happen with the laboratory's own messages, whose strings are short.
    pub fn encode(&mut self, sample: &CycleSample) -> Result<(), BagError> {
        let messages = CycleMessages::from(sample);
        self.stamp_ns = sample.stamp_ns;
        // Sequence numbers of MCAP have 32 bits; they wrap after seven weeks at 1 kHz.
        self.sequence = sample.measurement.cycle as u32;
        self.bytes.clear();
        let mut part = 0;
        macro_rules! append {
            ($message:expr) => {
                cdr::encode_into($message, &mut self.scratch)?;
                self.bytes.extend_from_slice(&self.scratch);
                self.ends[part] = self.bytes.len();
                part += 1;
            };
        }
        append!(&messages.joint_state);
        append!(&messages.rig_measurement);
        append!(&messages.reference);
        append!(&messages.motor_voltage);
        append!(&messages.friction_estimate);
        append!(&messages.controller_state);
        debug_assert_eq!(part, self.ends.len());
        Ok(())
    }

    /// Bytes of each message, in the order of [`CycleMessages`].
    fn parts(&self) -> impl Iterator<Item = &[u8]> {
        let starts = std::iter::once(0).chain(self.ends);
        starts.zip(self.ends).map(|(start, end)| &self.bytes[start..end])
    }
}
