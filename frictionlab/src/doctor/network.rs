//! Loopback, multicast on the chosen interface, and the environment variables of ROS.

use std::{
    env, fs,
    net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket},
    time::{Duration, Instant},
};

use ros_node::{Discovery, Range, RosNodeError, rmw};

use super::Finding;

/// The group in which DDS looks for others.
const GROUP: Ipv4Addr = Ipv4Addr::new(239, 255, 0, 1);
/// First port of DDS, and ports a domain.
const PORTS: (u32, u32) = (7400, 250);
/// Ports of a domain with fifty participants: ten for all, and two for each.
const PORTS_USED: u32 = 110;
/// Time in which a datagram comes back from this very machine.
const PATIENCE: Duration = Duration::from_millis(500);

/// The environment, and what it says about where to look; none if it cannot be used.
pub(super) fn environment() -> (Vec<Finding>, Option<Discovery>) {
    let read = |name: &str| env::var(name).ok();
    let mut findings = Vec::new();
    let discovery = match Discovery::from_environment() {
        Ok(discovery) => {
            findings.extend([domain(discovery.domain, ephemeral_ports()), range(discovery.range)]);
            Some(discovery)
        }
        Err(error) => {
            let subject = match &error {
                RosNodeError::Environment(error) => error.name,
                _ => "environment",
            };
            let mend = match subject {
                "ROS_DOMAIN_ID" => {
                    "`export ROS_DOMAIN_ID=42`, or any other number from 0 to 101, the same for all programs; or `unset ROS_DOMAIN_ID`"
                }
                _ => {
                    "`export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`, or SUBNET to be seen by other machines"
                }
            };
            findings.push(Finding::broken(subject, error.to_string(), mend));
            None
        }
    };
    findings.push(peers(read("ROS_STATIC_PEERS").as_deref()));
    findings.push(middleware(read(rmw::VARIABLE).as_deref()));
    (findings, discovery)
}

/// First and last port that the system gives to whoever asks for any.
fn ephemeral_ports() -> Option<(u32, u32)> {
    let text = fs::read_to_string("/proc/sys/net/ipv4/ip_local_port_range").ok()?;
    let mut numbers = text.split_whitespace().map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}

fn domain(id: u16, ephemeral: Option<(u32, u32)>) -> Finding {
    let first = PORTS.0 + PORTS.1 * u32::from(id);
    let last = first + PORTS_USED - 1;
    let finding = match ephemeral {
        Some((from, to)) if last >= from && first <= to => Finding::look(
            "ROS_DOMAIN_ID",
            format!(
                "domain {id}; the system gives the same ports to other programs ({from} to {to}), so that joining may fail at times"
            ),
            "choose a domain from 0 to 101: `export ROS_DOMAIN_ID=42`",
        ),
        _ => Finding::fine("ROS_DOMAIN_ID", format!("domain {id}")),
    };
    finding.with("first port", f64::from(first), "").with(
        "last port of 50 participants",
        f64::from(last),
        "",
    )
}

fn range(range: Range) -> Finding {
    let set = env::var("ROS_AUTOMATIC_DISCOVERY_RANGE").unwrap_or_default();
    let set = if set.is_empty() { "not set".to_owned() } else { set };
    Finding::fine(
        "ROS_AUTOMATIC_DISCOVERY_RANGE",
        match range {
            Range::Localhost => format!("{set}: only this machine sees the nodes"),
            Range::Subnet => {
                format!(
                    "{set}: every machine that multicast reaches sees the nodes, and may command them"
                )
            }
        },
    )
}

fn peers(value: Option<&str>) -> Finding {
    match value.filter(|value| !value.is_empty()) {
        None => Finding::fine("ROS_STATIC_PEERS", "not set"),
        Some(value) => Finding::look(
            "ROS_STATIC_PEERS",
            format!("is {value}, but this middleware finds others by multicast only"),
            "name this machine among the peers of the others, or use ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET where multicast reaches them",
        ),
    }
}

fn middleware(value: Option<&str>) -> Finding {
    match value.and_then(rmw::of) {
        None => {
            Finding::fine(rmw::VARIABLE, "not set: other nodes speak DDS, as the laboratory's do")
        }
        Some(rmw::Said::Fine(said)) => Finding::fine(rmw::VARIABLE, said),
        Some(rmw::Said::Warning(said)) => Finding::look(
            rmw::VARIABLE,
            said,
            "`export RMW_IMPLEMENTATION=rmw_fastrtps_cpp` for the nodes that shall talk to the laboratory's",
        ),
    }
}

/// Loopback and multicast.
pub(super) fn network(range: Range) -> Vec<Finding> {
    let mut findings = vec![loopback()];
    match range {
        Range::Localhost => findings.push(multicast(Ipv4Addr::LOCALHOST, range)),
        Range::Subnet => match interface() {
            Ok(address) => findings.push(multicast(address, range)),
            Err(error) => findings.push(Finding::broken(
                "multicast",
                format!("there is no way to the group {GROUP}: {error}"),
                "connect a network; or `export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`, if all nodes are on this machine",
            )),
        },
    }
    findings
}

/// Address of the interface over which the system would reach the group.
fn interface() -> std::io::Result<Ipv4Addr> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
    // Nothing is sent: this only chooses a way.
    socket.connect((GROUP, 7400))?;
    match socket.local_addr()?.ip() {
        IpAddr::V4(address) => Ok(address),
        IpAddr::V6(address) => {
            Err(std::io::Error::other(format!("the way goes over IPv6, {address}")))
        }
    }
}

fn loopback() -> Finding {
    match echo(Ipv4Addr::LOCALHOST, None) {
        Ok(Some(time)) => Finding::fine("loopback", "a datagram to 127.0.0.1 comes back").with(
            "after",
            time.as_secs_f64() * 1e6,
            "us",
        ),
        Ok(None) => Finding::broken(
            "loopback",
            "a datagram to 127.0.0.1 does not come back: the interface lo is down, or a firewall drops it",
            "`sudo ip link set lo up`; if it is up, let everything pass on it (`sudo iptables -I INPUT -i lo -j ACCEPT`)",
        ),
        Err(error) => Finding::broken(
            "loopback",
            format!("no datagram can be sent to 127.0.0.1: {error}"),
            "`sudo ip link set lo up`",
        ),
    }
}

fn multicast(address: Ipv4Addr, range: Range) -> Finding {
    let subject = format!("multicast on {address}");
    let mend = match range {
        Range::Localhost => {
            "`sudo ip link set lo multicast on; sudo ip route add 224.0.0.0/4 dev lo`".to_owned()
        }
        Range::Subnet => format!(
            "let UDP to {GROUP} pass in the firewall (`sudo ufw allow proto udp to 224.0.0.0/4`), and check `ip maddr` and `ip route get {GROUP}`; many WLANs drop multicast"
        ),
    };
    match echo(address, Some(GROUP)) {
        Ok(Some(time)) => Finding::fine(subject, format!("a datagram to {GROUP} comes back")).with(
            "after",
            time.as_secs_f64() * 1e6,
            "us",
        ),
        Ok(None) => Finding::broken(
            subject,
            format!("a datagram to {GROUP} does not come back; nodes do not find each other"),
            mend,
        ),
        Err(error) => {
            Finding::broken(subject, format!("no datagram can be sent to {GROUP}: {error}"), mend)
        }
    }
}

/// Sends a datagram from `address`, to itself or to a group, and waits until it comes back. `None`
/// if it does not.
fn echo(address: Ipv4Addr, group: Option<Ipv4Addr>) -> std::io::Result<Option<Duration>> {
    let bound = if group.is_some() { Ipv4Addr::UNSPECIFIED } else { address };
    let receiver = UdpSocket::bind((bound, 0))?;
    if let Some(group) = group {
        receiver.join_multicast_v4(&group, &address)?;
    }
    receiver.set_read_timeout(Some(PATIENCE))?;
    // Bound to an address, a socket sends to groups over the interface of that address.
    let sender = UdpSocket::bind((address, 0))?;
    let mark = format!("frictionlab doctor {} {:?}", std::process::id(), Instant::now());
    let to = SocketAddr::from((group.unwrap_or(address), receiver.local_addr()?.port()));
    let sent = Instant::now();
    sender.send_to(mark.as_bytes(), to)?;
    let mut heard = [0; 256];
    while sent.elapsed() < PATIENCE {
        match receiver.recv_from(&mut heard) {
            Ok((length, _)) if heard.get(..length) == Some(mark.as_bytes()) => {
                return Ok(Some(sent.elapsed()));
            }
            // Somebody else's.
            Ok(_) => {}
            Err(error)
                if matches!(
                    error.kind(),
                    std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut
                ) =>
            {
                break;
            }
            Err(error) => return Err(error),
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::Verdict;

    #[test]
    fn a_domain_whose_ports_the_system_gives_away_is_worth_a_look() {
        let linux = Some((32_768, 60_999));
        assert_eq!(domain(0, linux).figures[0].value, 7400.0);
        assert_eq!(domain(101, linux).verdict, Verdict::Fine);
        assert_eq!(domain(102, linux).verdict, Verdict::LookAtThis);
        assert_eq!(domain(215, linux).verdict, Verdict::Fine);
        assert_eq!(domain(232, linux).figures[1].value, 65_509.0);
        assert_eq!(domain(150, None).verdict, Verdict::Fine);
    }

    #[test]
    fn a_middleware_that_is_not_dds_is_told() {
        for (name, verdict) in [
            ("rmw_zenoh_cpp", Verdict::LookAtThis),
            ("rmw_email_cpp", Verdict::LookAtThis),
            ("rmw_cyclonedds_cpp", Verdict::Fine),
            ("rmw_fastrtps_dynamic_cpp", Verdict::Fine),
            ("", Verdict::Fine),
        ] {
            assert_eq!(middleware(Some(name)).verdict, verdict, "{name}");
        }
        assert_eq!(peers(Some("10.0.0.7")).verdict, Verdict::LookAtThis);
        assert_eq!(peers(None).verdict, Verdict::Fine);
    }
}
