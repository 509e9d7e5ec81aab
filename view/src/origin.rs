//! Whose page asks.
//!
//! A browser sends requests of any page to this machine. Two headers tell them apart, and no page
//! can forge them: `Host` is the name in the address that the page asked for, so a name that its
//! owner suddenly points to this machine (DNS rebinding) shows there; `Origin` is where the page
//! itself came from. A program that is no browser sends no `Origin`, and is as free as any other
//! program of this machine.

use std::net::IpAddr;

/// The pages and names that are answered.
#[derive(Debug, Clone)]
pub struct Origins {
    port: u16,
    /// Answers on an address of the network too.
    network: bool,
    /// Other pages that may open a socket, as `https://app.foxglove.dev`.
    others: Vec<String>,
}

impl Origins {
    /// For a server that listens on `address` and `port`, and lets the pages of `others` in.
    #[must_use]
    pub fn new(address: IpAddr, port: u16, others: &[String]) -> Self {
        let others = others.iter().map(|other| other.trim_end_matches('/').to_owned()).collect();
        Self { port, network: !address.is_loopback(), others }
    }

    /// Whether a `Host` is a name of this server: an address of this machine with the port. Other
    /// machines' names are no addresses, so nobody can point one here.
    #[must_use]
    pub fn is_host(&self, host: &str) -> bool {
        let Some((name, port)) = host.rsplit_once(':') else {
            return false;
        };
        if port.parse() != Ok(self.port) {
            return false;
        }
        if name.eq_ignore_ascii_case("localhost") {
            return true;
        }
        let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
        bare.parse::<IpAddr>().is_ok_and(|address| address.is_loopback() || self.network)
    }

    /// Whether a page of `origin` may open a socket that it asked of `host`.
    #[must_use]
    pub fn is_allowed(&self, origin: &str, host: &str) -> bool {
        let own = origin
            .strip_prefix("http://")
            .is_some_and(|name| name.eq_ignore_ascii_case(host) && self.is_host(name));
        own || self.others.iter().any(|other| other.eq_ignore_ascii_case(origin))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOOPBACK: IpAddr = IpAddr::V4(std::net::Ipv4Addr::LOCALHOST);

    #[test]
    fn on_loopback_only_its_own_names_count() {
        let origins = Origins::new(LOOPBACK, 8765, &[]);
        for host in ["127.0.0.1:8765", "localhost:8765", "LOCALHOST:8765", "[::1]:8765"] {
            assert!(origins.is_host(host), "{host}");
            assert!(origins.is_allowed(&format!("http://{host}"), host), "{host}");
        }
        for host in [
            "",
            ":8765",
            "127.0.0.1",
            "127.0.0.1:80",
            "evil.example:8765",
            "localhost.evil.example:8765",
            "192.0.2.1:8765",
            "127.0.0.1:8765:8765",
        ] {
            assert!(!origins.is_host(host), "{host}");
        }
    }

    #[test]
    fn pages_from_elsewhere_are_not_let_in() {
        let origins = Origins::new(LOOPBACK, 8765, &["https://app.foxglove.dev/".to_owned()]);
        let host = "localhost:8765";
        for origin in [
            "null",
            "",
            "file://",
            "https://localhost:8765",
            "http://localhost:8766",
            "http://evil.example",
            "http://127.0.0.1:8765",
        ] {
            assert!(!origins.is_allowed(origin, host), "{origin}");
        }
        assert!(origins.is_allowed("https://app.foxglove.dev", host));
    }

    #[test]
    fn on_the_network_addresses_count_and_names_do_not() {
        let origins = Origins::new("192.0.2.1".parse().unwrap(), 8765, &[]);
        assert!(origins.is_host("192.0.2.1:8765"));
        assert!(!origins.is_host("rebound.example:8765"));
    }
}
