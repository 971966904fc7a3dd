//! Programs that hold a device file or a port, from /proc. Another user's programs can be seen by root alone.

use std::net::SocketAddr;
use std::path::Path;

use super::computer::Computer;

/// A port, and who has it.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum HeldPort {
    /// Nothing has it.
    Free,
    /// These have it; empty where they belong to another user.
    Held(Vec<String>),
    /// The tables could not be read.
    Unknown,
}

/// Programs that have a device file open, as `name (process 123)`.
pub(super) fn holders_of_file(computer: &Computer, path: &Path) -> Vec<String> {
    // A lasting name of udev is a link to the device that programs have open.
    let opened = computer.path(path).canonicalize().ok();
    let named = [Some(path.to_path_buf()), opened];
    holders(computer, &|target| named.iter().flatten().any(|name| name.as_path() == Path::new(target)))
}

/// Programs that have bound a UDP port at this address or at all addresses.
pub(super) fn holders_of_port(computer: &Computer, local: SocketAddr) -> HeldPort {
    let tables: Vec<String> =
        ["/proc/net/udp", "/proc/net/udp6"].iter().filter_map(|table| computer.text(table)).collect();
    if tables.is_empty() {
        return HeldPort::Unknown;
    }
    let sockets: Vec<String> = tables
        .iter()
        .flat_map(|table| table.lines().skip(1))
        .filter_map(|line| bound_socket(line, local.port()))
        .collect();
    if sockets.is_empty() {
        return HeldPort::Free;
    }
    HeldPort::Held(holders(computer, &|target| sockets.iter().any(|socket| socket == target)))
}

/// The link under which a process has the socket of a line of /proc/net/udp open, if its port is this one (proc(5)).
fn bound_socket(line: &str, port: u16) -> Option<String> {
    let mut columns = line.split_whitespace();
    let local = columns.nth(1)?;
    let (_, bound) = local.rsplit_once(':')?;
    let inode = columns.nth(7)?;
    (u16::from_str_radix(bound, 16).ok()? == port).then(|| format!("socket:[{inode}]"))
}

fn holders(computer: &Computer, is_it: &dyn Fn(&str) -> bool) -> Vec<String> {
    let own = std::process::id().to_string();
    let processes = computer.entries("/proc").into_iter();
    let processes = processes.filter(|name| name.bytes().all(|byte| byte.is_ascii_digit()) && *name != own);
    let holds = |process: &String| {
        let folder = format!("/proc/{process}/fd");
        let mut open = computer.entries(&folder).into_iter();
        open.any(|descriptor| {
            computer.link(&format!("{folder}/{descriptor}")).is_some_and(|target| is_it(&target))
        })
    };
    let named = |process: String| {
        let name = computer.text(&format!("/proc/{process}/comm")).unwrap_or_else(|| "a program".to_owned());
        format!("{name} (process {process})")
    };
    processes.filter(holds).map(named).collect()
}
