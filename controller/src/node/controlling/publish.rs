//! Commands over DDS, by a thread of their own.

use std::sync::atomic::Ordering;
use std::time::Duration;

use msgs::friction_msgs::{ControllerState, MotorVoltage};
use ros_node::queue::{Receiver, Waker};
use ros_node::{Logger, Publisher};

use super::counts::Counts;
use crate::messages;
use crate::node::step::Decided;

/// Publishes commands until the queue's other end is gone.
pub(super) fn publish(
    (voltages, states): &(Publisher<MotorVoltage>, Publisher<ControllerState>),
    mut queue: Receiver<Decided>,
    counts: &Counts,
    logger: &Logger,
) {
    loop {
        let Some(decided) = queue.take() else {
            if queue.is_over() {
                return;
            }
            Waker::sleep(Duration::from_millis(50));
            continue;
        };
        let Decided { stamp_ns, command, fault, stale_reference, fresh_estimate } = decided;
        let sent = voltages
            .publish(messages::motor_voltage(stamp_ns, &command))
            .and_then(|()| states.publish(messages::controller_state(stamp_ns, &command)));
        let count = if sent.is_ok() { &counts.published } else { &counts.refused };
        count.fetch_add(1, Ordering::Relaxed);
        if !fresh_estimate {
            counts.without_estimate.fetch_add(1, Ordering::Relaxed);
        }
        if counts.stale.swap(stale_reference, Ordering::Relaxed) != stale_reference {
            logger.info(if stale_reference {
                "no reference comes: zero velocity"
            } else {
                "a reference comes"
            });
        }
        if let Some(fault) = fault
            && !counts.faulty.swap(true, Ordering::Relaxed)
        {
            logger.error(&format!(
                "zero volts from now on: {fault}; mend the joint states, then call ~/reset"
            ));
        } else if fault.is_none() {
            counts.faulty.store(false, Ordering::Relaxed);
        }
    }
}
