//! The options of a view.

use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::ValueHint;
use commission::Board;
use view::{ViewError, ViewOptions};
use work::BadInput;
use work::destination::RUNS;
use work::progress::Progress;

use super::bags::BagsView;
use super::commissioning::CommissionView;
use super::shelf::Shelf;

/// Options of a view of what a command does.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ViewArgs {
    /// Show what goes on in a browser on this machine, and steer it from there; viewers that speak
    /// Foxglove's WebSocket protocol connect to the same port
    #[arg(long)]
    pub view: bool,
    /// The folder whose reports and bags the view lists [default: runs, or where --runs says]
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub view_runs: Option<PathBuf>,
    /// Where it is.
    #[command(flatten)]
    pub place: ViewPlace,
}

/// Where a view is.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ViewPlace {
    /// The view's port [default: 8765, or the next free one]
    #[arg(long, value_name = "PORT")]
    pub view_port: Option<u16>,
    /// Let the view listen on this address of this machine, for whoever has the token that is
    /// printed then [default: 127.0.0.1, without a token]
    #[arg(long, value_name = "ADDRESS")]
    pub view_address: Option<IpAddr>,
    /// Pages from elsewhere that may connect to the view.
    #[arg(
        long,
        value_name = "URL",
        help = "A page from elsewhere that may connect to the view, as https://app.foxglove.dev. May be \
                given several times"
    )]
    pub view_origin: Vec<String>,
}

impl ViewArgs {
    /// What the view is to be, if there is to be one: whoever says where it is wants it.
    #[must_use]
    pub fn options(&self, name: &str) -> Option<ViewOptions> {
        let ViewPlace { view_port, view_address, view_origin } = &self.place;
        let placed = view_port.is_some() || view_address.is_some() || !view_origin.is_empty();
        (self.view || placed).then(|| self.place.options(name))
    }
}

impl ViewPlace {
    /// What the view is to be.
    #[must_use]
    pub fn options(&self, name: &str) -> ViewOptions {
        ViewOptions {
            address: self.view_address.unwrap_or(Ipv4Addr::LOCALHOST.into()),
            token: false,
            port: self.view_port,
            origins: self.view_origin.clone(),
            name: format!("frictionlab {name}"),
        }
    }
}

impl ViewArgs {
    /// The folder whose reports and bags are listed; `usual` where nothing else is said.
    #[must_use]
    pub fn runs<'a>(&'a self, usual: &'a str) -> &'a Path {
        self.view_runs.as_deref().unwrap_or(Path::new(usual))
    }

    /// Opens the view that is asked for, of work called `what` in `folder` that sets `stop` when a viewer wants
    /// it to end, and tells on standard error where it is.
    ///
    /// # Errors
    /// [`BadInput`] if the port is taken.
    pub fn of_bags(
        &self,
        command: &str,
        (what, folder): (&str, &Path),
        stop: &Arc<AtomicBool>,
        progress: &Progress,
        quiet: bool,
    ) -> anyhow::Result<Option<BagsView>> {
        let Some(options) = self.options(command) else { return Ok(None) };
        let shelf = Shelf::new(self.runs(RUNS));
        shelf.add(folder);
        let view = BagsView::open(&options, what, stop, (progress, shelf)).map_err(worded)?;
        tell(&view.words(), &options, quiet);
        Ok(Some(view))
    }

    /// Opens the view that is asked for, of a commission that writes on that board; a viewer may set
    /// `stop`.
    ///
    /// # Errors
    /// [`BadInput`] if the port is taken.
    pub fn of_commission(
        &self,
        board: &Board,
        stop: &Arc<AtomicBool>,
        quiet: bool,
    ) -> anyhow::Result<Option<CommissionView>> {
        let Some(options) = self.options("commission") else { return Ok(None) };
        let view = CommissionView::open(&options, board, stop, Shelf::new(self.runs(RUNS)))
            .map_err(worded)?;
        tell(&view.words(), &options, quiet);
        Ok(Some(view))
    }
}

/// Tells where a view is.
fn tell(words: &str, options: &ViewOptions, quiet: bool) {
    // A token is told once, also where nothing else is.
    if !quiet || options.wants_token() {
        eprintln!("{words}");
    }
}

/// A view that cannot be opened, as the command tells it.
#[must_use]
pub fn worded(error: ViewError) -> anyhow::Error {
    if error.is_bad_input() { BadInput(error.to_string()).into() } else { error.into() }
}
