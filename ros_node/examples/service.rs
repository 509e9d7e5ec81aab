//! A service and its client. `ros2 service call /counter/count std_srvs/srv/Trigger` asks the same
//! while it runs.

use std::{
    sync::atomic::{AtomicU32, Ordering},
    time::Duration,
};

use msgs::std_srvs::{Trigger, TriggerRequest, TriggerResponse};
use ros_node::{Discovery, Participant, RosNodeError};

fn main() -> Result<(), RosNodeError> {
    let discovery = Discovery::from_environment()?;
    let (here, there) = (Participant::join(&discovery)?, Participant::join(&discovery)?);

    let counter = here.node("counter")?;
    let count = AtomicU32::new(0);
    counter.serve::<Trigger>("~/count", move |_| {
        let message = format!("asked {} times", 1 + count.fetch_add(1, Ordering::Relaxed));
        TriggerResponse { success: true, message }
    })?;

    let asking = there.node("asking")?;
    let client = asking.client::<Trigger>("/counter/count")?;
    // The first request may be sent before the server is found; it is sent again then.
    let answer = client.call_until_answered(&TriggerRequest::default(), Duration::from_secs(60))?;
    println!("{}", answer.message);
    Ok(())
}
