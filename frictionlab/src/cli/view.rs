//! `frictionlab view`: a recording in the browser.

use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;

use recording::bag::BagReader;
use view::{Hub, View};
use work::BadInput;

use crate::interruption;
use crate::viewing::{Player, ViewPlace, worded, words};

/// Play a bag in the browser, with seek and speed
///
/// Viewers that speak Foxglove's WebSocket protocol connect to the same port and get every topic of
/// the bag. Ctrl-C ends it.
#[derive(Debug, clap::Args)]
pub struct BagViewArgs {
    /// Folder of the bag, or an .mcap file
    #[arg(value_name = "BAG")]
    pub bag: PathBuf,
    /// Where the view is.
    #[command(flatten)]
    pub place: ViewPlace,
}

/// How often the end is looked for.
const WATCH: Duration = Duration::from_millis(50);

/// Plays it until ctrl-C.
///
/// # Errors
/// [`BagError`](recording::bag::BagError) names the bag at fault; [`BadInput`] for a bag without
/// messages and a port that is taken.
pub fn execute(args: &BagViewArgs) -> anyhow::Result<()> {
    let bag = BagReader::open(&args.bag)?;
    let shown = args.bag.display();
    if bag.recorded_topics().is_empty() {
        return Err(BadInput(format!(
            "{shown} has no MCAP file with topics: only those are played"
        ))
        .into());
    }
    let span = bag.span().ok_or_else(|| {
        BadInput(format!(
            "{shown} holds no messages, or was cut off: `frictionlab bag recover` saves what it holds"
        ))
    })?;
    let stop = interruption::watch(interruption::DRIVING)?;
    let hub = Hub::default();
    let player = Player::start(bag, span, &hub)?;
    let options = args.place.options(&format!("view {shown}"));
    let view = View::start(&options, hub, player.steering()).map_err(worded)?;
    work::saying::print(&format!("{}\nctrl-C ends it\n", words(&view)))?;
    while !stop.load(Ordering::Relaxed) {
        thread::sleep(WATCH);
    }
    drop(view);
    Ok(())
}
