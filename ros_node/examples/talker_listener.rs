//! A publisher and a subscriber. Each stands on a participant of its own, as if they were two
//! programs; the example ends when ten messages were heard.

use std::{sync::mpsc::channel, time::Duration};

use msgs::{friction_msgs::Reference, std_msgs::Header, topics};
use ros_node::{Discovery, Participant, RosNodeError};

fn main() -> Result<(), RosNodeError> {
    let discovery = Discovery::from_environment()?;
    let (here, there) = (Participant::join(&discovery)?, Participant::join(&discovery)?);

    let listener = there.node("listener")?;
    let (heard, hears) = channel();
    listener.subscribe(&topics::REFERENCE, move |message| {
        // The receiver is gone once enough was heard.
        let _ = heard.send(message.velocity);
    })?;

    let talker = here.node("talker")?;
    let publisher = talker.publisher(&topics::REFERENCE)?;
    let mut count = 0;
    for stamp in 1_u32.. {
        let velocity = 0.1 * f64::from(stamp % 10);
        publisher.publish(Reference {
            header: Header::at(u64::from(stamp)),
            velocity,
            ..Reference::default()
        })?;
        // A subscriber hears nothing until discovery has found it: the talker goes on.
        if let Ok(velocity) = hears.recv_timeout(Duration::from_millis(10)) {
            listener.logger().info(&format!("heard {velocity} rad/s"));
            count += 1;
        }
        if count == 10 {
            break;
        }
    }
    println!("heard {count}");
    Ok(())
}
