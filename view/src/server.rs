//! The server: its address, its limits, its threads.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};
use tokio::sync::Semaphore;

use crate::access::Tokens;
use crate::shared::Shared;
use crate::{Hub, Origins, PORT, Steering, ViewError, http};

/// Connections at once; one more is closed at once.
pub(crate) const CONNECTIONS: usize = 96;
/// Viewers at once; one more is told so.
pub(crate) const VIEWERS: usize = 16;
/// Files that are read at once; whoever wants one more waits.
const READING: usize = 2;
/// Ports that are tried after the usual one.
const MORE_PORTS: u16 = 50;
/// Threads that wait for whoever does what viewers ask for.
const WAITING_THREADS: usize = 24;
/// Pause where the system grants no connection.
const AFTER_FAILURE: Duration = Duration::from_millis(50);
/// Longest wait for the threads when the view ends.
const LEAVING: Duration = Duration::from_millis(500);

/// Where the view listens, and who is let in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ViewOptions {
    /// The address. Any but loopback wants a token.
    pub address: IpAddr,
    /// Loopback wants one too: what is asked for here is done by somebody who is let in elsewhere by
    /// a key, and other users of this machine have none.
    pub token: bool,
    /// The port; `None` for [`PORT`], or the next free one after it. 0 takes any free one.
    pub port: Option<u16>,
    /// Pages from elsewhere that may open a socket, as `https://app.foxglove.dev`.
    pub origins: Vec<String>,
    /// What the server is called, for people.
    pub name: String,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            address: IpAddr::V4(Ipv4Addr::LOCALHOST),
            token: false,
            port: None,
            origins: Vec::new(),
            name: "frictionlab".to_owned(),
        }
    }
}

impl ViewOptions {
    /// Whether only those are let in who have a token.
    #[must_use]
    pub fn wants_token(&self) -> bool {
        self.token || !self.address.is_loopback()
    }
}

/// A running server. Dropped, it ends.
#[derive(Debug)]
pub struct View {
    hub: Hub,
    address: SocketAddr,
    tokens: Option<Tokens>,
    runtime: Option<Runtime>,
}

impl View {
    /// Opens it.
    ///
    /// # Errors
    /// [`ViewError::Listen`] if the port is taken, [`ViewError::NotHere`] for another machine's address,
    /// [`ViewError::System`].
    pub fn start(
        options: &ViewOptions,
        hub: Hub,
        steering: Arc<dyn Steering>,
    ) -> Result<Self, ViewError> {
        let listener = listen(options)?;
        let address = listener.local_addr().map_err(ViewError::System)?;
        listener.set_nonblocking(true).map_err(ViewError::System)?;
        let tokens = options.wants_token().then(Tokens::draw).transpose();
        let tokens = tokens.map_err(ViewError::System)?;
        let session = crate::Token::draw().map_err(ViewError::System)?.as_str().to_owned();
        let shared = Arc::new(Shared {
            hub: hub.clone(),
            steering,
            origins: Origins::new(options.address, address.port(), &options.origins),
            tokens: tokens.clone(),
            name: options.name.clone(),
            session,
            viewers: Arc::new(Semaphore::new(VIEWERS)),
            key: crate::Token::draw().map_err(ViewError::System)?,
            reading: Arc::new(Semaphore::new(READING)),
        });
        let runtime = Builder::new_multi_thread()
            .worker_threads(1)
            .max_blocking_threads(WAITING_THREADS)
            .thread_name("view")
            .enable_io()
            .enable_time()
            .build()
            .map_err(ViewError::System)?;
        let _inside = runtime.enter();
        let listener = TcpListener::from_std(listener).map_err(ViewError::System)?;
        runtime.spawn(accept(listener, shared));
        drop(_inside);
        Ok(Self { hub, address, tokens, runtime: Some(runtime) })
    }

    /// Its channels.
    #[must_use]
    pub fn hub(&self) -> &Hub {
        &self.hub
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Addresses for a browser: for those who steer, and where there are tokens for those who only
    /// look. A token stands behind `#`, which no browser sends.
    #[must_use]
    pub fn urls(&self) -> (String, Option<String>) {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(Ipv4Addr::LOCALHOST.into());
        }
        let page = format!("http://{address}/");
        match &self.tokens {
            None => (page, None),
            Some(tokens) => (
                format!("{page}#token={}", tokens.full.as_str()),
                Some(format!("{page}#token={}", tokens.read_only.as_str())),
            ),
        }
    }
}

impl Drop for View {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_timeout(LEAVING);
        }
    }
}

/// The port that was asked for, or the first free one from the usual one on.
fn listen(options: &ViewOptions) -> Result<std::net::TcpListener, ViewError> {
    let ports = options.port.map_or(PORT..=PORT + MORE_PORTS, |port| port..=port);
    let mut last = None;
    for port in ports {
        let address = SocketAddr::new(options.address, port);
        match std::net::TcpListener::bind(address) {
            Ok(listener) => return Ok(listener),
            Err(source) if source.kind() == std::io::ErrorKind::AddrNotAvailable => {
                return Err(ViewError::NotHere { address: options.address });
            }
            Err(source) => last = Some((address, source)),
        }
    }
    let (address, source) = last.unwrap_or_else(|| {
        (SocketAddr::new(options.address, PORT), std::io::ErrorKind::AddrInUse.into())
    });
    Err(ViewError::Listen { address, source })
}

async fn accept(listener: TcpListener, shared: Arc<Shared>) {
    let connections = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(AFTER_FAILURE).await;
            continue;
        };
        let Ok(place) = Arc::clone(&connections).try_acquire_owned() else { continue };
        let _ = stream.set_nodelay(true);
        tokio::spawn(http::serve(stream, Arc::clone(&shared), place));
    }
}
