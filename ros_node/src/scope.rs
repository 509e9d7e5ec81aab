//! Only this machine is heard: a filter in the kernel, before the middleware.
//!
//! RustDDS 0.15 binds its sockets to every address of the machine, also where it was told to use
//! the loopback only, and obeys whoever reaches them. So each of its sockets gets a filter that
//! keeps what this machine sent, and drops all else before anybody parses it: what arrives by the
//! loopback interface, and multicast of this machine that a network card loops back. The sender's
//! address does not count, since anybody can write one.
//!
//! Between the middleware's binding its sockets and the filter lies about a millisecond. What comes
//! then is still heard: a foreign participant can become known, and is sent what readers are sent
//! until its lease ends. It can command nothing, as the process has no endpoint of a node yet, and
//! whatever it sends later is dropped.

use std::{
    collections::BTreeSet,
    fs, io,
    io::{IoSlice, IoSliceMut},
    mem::MaybeUninit,
    os::fd::{AsRawFd, OwnedFd, RawFd},
};

use nix::sys::socket::{ControlMessage, MsgFlags, sendmsg};
use rustix::net::{
    AddressFamily, RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, SocketFlags, SocketType,
    recvmsg, socketpair,
};
use socket2::{Domain, SockFilter, SockRef, Type};

use crate::RosNodeError;

/// Sockets of a participant, at least: for discovery and for messages, each to one and to many, and
/// one to send by.
const SOCKETS: usize = 5;
/// The kernel gives the loopback interface this number in every network namespace.
const LOOPBACK: u32 = 1;

/// The sockets that this process had before a participant came.
pub(crate) struct Scope {
    before: BTreeSet<String>,
}

impl Scope {
    /// To be called before the participant is built.
    pub(crate) fn new() -> Self {
        Self {
            before: sockets()
                .map(|all| all.into_iter().map(|(_, name)| name).collect())
                .unwrap_or_default(),
        }
    }

    /// To be called once the participant is built, before it has a node: from here on only this
    /// machine is heard.
    ///
    /// # Errors
    /// [`RosNodeError::Scope`] if the system does not grant that.
    pub(crate) fn close(&self) -> Result<(), RosNodeError> {
        let filtered = self.filter().map_err(|error| RosNodeError::Scope(error.to_string()))?;
        if filtered < SOCKETS {
            let text = format!("only {filtered} of at least {SOCKETS} sockets were found");
            return Err(RosNodeError::Scope(text));
        }
        Ok(())
    }

    /// Filters all UDP sockets of the process; how many of them are new.
    fn filter(&self) -> io::Result<usize> {
        let mut new = 0;
        for (descriptor, name) in sockets()? {
            let Ok(socket) = duplicate(descriptor) else {
                // It was closed meanwhile, and so is none of the participant's; if it is still
                // there, nothing can be promised.
                if fs::read_link(format!("/proc/self/fd/{descriptor}"))
                    .is_ok_and(|now| *now == *name)
                {
                    return Err(io::Error::other("a socket of this process cannot be duplicated"));
                }
                continue;
            };
            let socket = SockRef::from(&socket);
            if matches!(socket.r#type(), Ok(Type::DGRAM))
                && matches!(socket.domain(), Ok(Domain::IPV4 | Domain::IPV6))
            {
                socket.attach_filter(&only_this_machine())?;
                new += usize::from(!self.before.contains(&name));
            }
        }
        Ok(new)
    }
}

/// The program of the filter, in the kernel's own language: what it returns is how many bytes of
/// the packet are kept.
fn only_this_machine() -> [SockFilter; 6] {
    const LOAD_WORD: u16 = 0x20;
    const JUMP_IF_EQUAL: u16 = 0x15;
    const RETURN: u16 = 0x06;
    /// What is not in the packet lies from here on.
    const BESIDE: u32 = -0x1000_i32 as u32;
    const KIND_OF_PACKET: u32 = BESIDE + 4;
    const INTERFACE: u32 = BESIDE + 8;
    /// Sent by this machine to many, and looped back by the kernel. No packet from a wire has this
    /// kind.
    const LOOPED_BACK: u32 = 5;
    [
        SockFilter::new(LOAD_WORD, 0, 0, INTERFACE),
        SockFilter::new(JUMP_IF_EQUAL, 2, 0, LOOPBACK),
        SockFilter::new(LOAD_WORD, 0, 0, KIND_OF_PACKET),
        SockFilter::new(JUMP_IF_EQUAL, 0, 1, LOOPED_BACK),
        SockFilter::new(RETURN, 0, 0, u32::MAX),
        SockFilter::new(RETURN, 0, 0, 0),
    ]
}

/// The sockets of this process: descriptors, and names that no other socket has.
fn sockets() -> io::Result<Vec<(RawFd, String)>> {
    let mut all = Vec::new();
    for entry in fs::read_dir("/proc/self/fd")? {
        let entry = entry?;
        let target = fs::read_link(entry.path()).unwrap_or_default();
        let descriptor = entry.file_name().to_str().and_then(|number| number.parse().ok());
        if let (Some(descriptor), Some(name)) =
            (descriptor, target.to_str().filter(|name| name.starts_with("socket:")))
        {
            all.push((descriptor, name.to_owned()));
        }
    }
    Ok(all)
}

/// A second descriptor of the same socket. The library keeps the first to itself, so it is sent by
/// its number through a pair of sockets, as one process would give it to another.
fn duplicate(descriptor: RawFd) -> io::Result<OwnedFd> {
    let (here, there) =
        socketpair(AddressFamily::UNIX, SocketType::STREAM, SocketFlags::CLOEXEC, None)?;
    let descriptors = [descriptor];
    let rights = [ControlMessage::ScmRights(&descriptors)];
    sendmsg::<()>(here.as_raw_fd(), &[IoSlice::new(&[0])], &rights, MsgFlags::empty(), None)?;
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
    let mut received = RecvAncillaryBuffer::new(&mut space);
    recvmsg(&there, &mut [IoSliceMut::new(&mut [0])], &mut received, RecvFlags::CMSG_CLOEXEC)?;
    let sent = received.drain().find_map(|message| match message {
        RecvAncillaryMessage::ScmRights(mut all) => all.next(),
        _ => None,
    });
    sent.ok_or_else(|| io::Error::other("a socket of this process was not passed on"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{
        net::{Ipv4Addr, UdpSocket},
        time::Duration,
    };

    #[test]
    fn what_this_machine_sends_is_kept_and_a_process_that_has_no_participant_is_not_closed() {
        let scope = Scope::new();
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).unwrap();
        let error = scope.close().unwrap_err().to_string();
        assert!(error.contains("ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET"), "{error}");
        socket.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        let port = socket.local_addr().unwrap().port();
        let sender = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).unwrap();
        sender.send_to(b"local", (Ipv4Addr::LOCALHOST, port)).unwrap();
        let mut room = [0; 16];
        assert_eq!(socket.recv(&mut room).unwrap(), 5);
    }
}
