//! A view of work that writes a bag and has no nodes: `run`.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

use msgs::friction_msgs::ExperimentStatus;
use msgs::std_msgs::Header;
use msgs::{cdr, topics};
use serde_json::Value;
use view::{ChannelId, Hub, Service, Steering, ViewError, ViewOptions};
use work::progress::Progress;

use super::at_work::WorkView;
use super::clock::now_ns;
use super::ending::Ending;
use super::pace::Pace;
use super::shelf::{Shelf, WithShelf};
use super::topics::known;

/// A view of what is written into bags. Dropped, it ends.
pub struct BagsView(WorkView);

impl BagsView {
    /// Opens a view of work called `name` that sets `stop` when a viewer wants it to end.
    ///
    /// # Errors
    /// [`ViewError`] if the port is taken or the system refuses.
    pub fn open(
        options: &ViewOptions,
        name: &str,
        stop: &Arc<AtomicBool>,
        (progress, shelf): (&Progress, Arc<Shelf>),
    ) -> Result<Self, ViewError> {
        let hub = Hub::default();
        let channels: BTreeMap<String, ChannelId> = known()
            .into_iter()
            .map(|channel| (channel.topic.clone(), hub.offer(channel)))
            .collect();
        let status = channels.get(topics::EXPERIMENT_STATUS.name).copied();
        let ending = Arc::new(Ending::new(stop));
        let asked: Arc<dyn Steering> = Arc::new(OnlyEnding(Arc::clone(&ending)));
        let asked = Arc::new(WithShelf { asked, shelf });
        let (told, progress, name) = (hub.clone(), progress.clone(), name.to_owned());
        let tell = move || {
            if let Some(status) = status {
                tell(&told, status, &name, &progress);
            }
        };
        let view = WorkView::open(options, &hub, (asked, ending), tell)?;
        let pace = Mutex::new(Pace::default());
        recording::bag::listen(Box::new(move |topic, stamp_ns, bytes| {
            let Some(channel) = channels.get(topic) else { return };
            let shown = hub.viewers() > 0
                && pace.lock().unwrap_or_else(PoisonError::into_inner).shows(stamp_ns);
            if shown {
                hub.publish(*channel, stamp_ns, bytes);
            }
        }));
        Ok(Self(view))
    }

    /// Where it is, in words for people.
    #[must_use]
    pub fn words(&self) -> String {
        self.0.words()
    }

    /// The work is over: whoever looks may go on looking, until ctrl-C where somebody sits at a
    /// terminal, else until the last viewer has left.
    pub fn stay(&self, quiet: bool) {
        self.0.stay(quiet);
    }
}

fn tell(hub: &Hub, channel: ChannelId, name: &str, progress: &Progress) {
    let now = now_ns();
    let status = ExperimentStatus {
        header: Header::at(now),
        experiment: name.to_owned(),
        stage: progress.message(),
        progress: progress.fraction(),
        remaining: f64::NAN,
        ..ExperimentStatus::default()
    };
    if let Ok(bytes) = cdr::encode(&status) {
        hub.publish(channel, now, &bytes);
    }
}

/// All that can be asked of such work is to end.
struct OnlyEnding(Arc<Ending>);

impl Steering for OnlyEnding {
    fn services(&self) -> Vec<Service> {
        Ending::services()
    }

    fn call(&self, service: &str, _: Value) -> Result<Value, String> {
        self.0.call(service).ok_or_else(|| format!("there is no service {service}"))
    }
}
