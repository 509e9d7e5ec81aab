//! The options of a view, and the lines that tell where it is.

use std::net::{IpAddr, Ipv4Addr};

use view::{View, ViewOptions};

/// Options of a view.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ViewArgs {
    /// Show what goes on in a browser on this machine, and steer it from there; viewers that speak
    /// Foxglove's WebSocket protocol connect to the same port
    #[arg(long)]
    pub view: bool,
    /// With --view: the port [default: 8765, or the next free one]
    #[arg(long, value_name = "PORT", requires = "view")]
    pub view_port: Option<u16>,
    /// With --view: listen on this address of this machine, for whoever has the token that is
    /// printed then [default: 127.0.0.1, without a token]
    #[arg(long, value_name = "ADDRESS", requires = "view")]
    pub view_address: Option<IpAddr>,
    /// With --view: a page from elsewhere that may connect, as https://app.foxglove.dev. May be
    /// given several times
    #[arg(long, value_name = "URL", requires = "view")]
    pub view_origin: Vec<String>,
}

impl ViewArgs {
    /// What the view is to be, if there is to be one.
    #[must_use]
    pub fn options(&self, name: &str) -> Option<ViewOptions> {
        self.view.then(|| ViewOptions {
            address: self.view_address.unwrap_or(Ipv4Addr::LOCALHOST.into()),
            port: self.view_port,
            origins: self.view_origin.clone(),
            name: format!("frictionlab {name}"),
        })
    }
}

/// Where a view is, in words for people.
#[must_use]
pub fn words(view: &View) -> String {
    match view.urls() {
        (page, None) => format!("view: {page}"),
        (page, Some(read_only)) => {
            format!("view: {page}\nview for those who only look: {read_only}")
        }
    }
}
