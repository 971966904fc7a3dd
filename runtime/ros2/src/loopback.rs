//! Keeps sockets on this computer. The library of DDS binds its ports on all addresses; a socket that is tied to the loopback
//! device neither hears nor reaches another computer, whatever address is used.

use std::collections::BTreeSet;
use std::fs;
use std::io;

use rustix::process::{PidfdFlags, PidfdGetfdFlags, getpid, pidfd_getfd, pidfd_open};
use socket2::{Socket, Type};

/// The device that reaches nobody else.
const LOOPBACK: &[u8] = b"lo";

/// The sockets that this program has open, by number, with what the kernel calls them.
pub fn open_sockets() -> io::Result<BTreeSet<(i32, String)>> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir("/proc/self/fd")? {
        let entry = entry?;
        let number = entry.file_name().to_str().and_then(|name| name.parse().ok());
        // A file that was closed meanwhile has no target.
        let target = fs::read_link(entry.path()).ok().and_then(|to| to.to_str().map(str::to_owned));
        if let (Some(number), Some(target)) = (number, target.filter(|to| to.starts_with("socket:"))) {
            found.insert((number, target));
        }
    }
    Ok(found)
}

/// Ties every datagram socket that was opened since to the loopback device; gives how many.
pub fn tie_new(before: &BTreeSet<(i32, String)>) -> io::Result<usize> {
    let own = pidfd_open(getpid(), PidfdFlags::empty())?;
    let mut tied = 0;
    for (number, _) in open_sockets()?.difference(before) {
        // A second handle on the same socket: what is set on it holds for the first.
        let Ok(handle) = pidfd_getfd(&own, *number, PidfdGetfdFlags::empty()) else { continue };
        let socket = Socket::from(handle);
        if socket.r#type()? == Type::DGRAM && socket.local_addr()?.as_socket().is_some() {
            socket.bind_device(Some(LOOPBACK))?;
            tied += 1;
        }
    }
    Ok(tied)
}

#[cfg(test)]
mod tests {
    use std::net::UdpSocket;

    use super::*;

    #[test]
    fn tied_socket_reaches_loopback_alone() {
        let before = open_sockets().unwrap();
        let socket = UdpSocket::bind("0.0.0.0:0").unwrap();
        let tied = match tie_new(&before) {
            Ok(tied) => tied,
            Err(error) => {
                return eprintln!("skipped: this kernel does not tie sockets to a device ({error})");
            }
        };
        assert!(tied >= 1);
        let to = UdpSocket::bind("127.0.0.1:0").unwrap();
        assert!(socket.send_to(b"x", to.local_addr().unwrap()).is_ok());
        // What is sent to another computer goes into the loopback device, too, where nobody takes it.
        let device = socket2::SockRef::from(&socket).device().unwrap();
        assert_eq!(device.as_deref(), Some(LOOPBACK));
    }
}
